#pragma once

#include <string>

#include "server/engine/record/map_copy.hpp"
#include "server/output/latency.hpp"

namespace isthmus {

/// What a run cost; measured by the program that drove the engine.
struct RunCost {
  double wall_s = 0;
  double cpu_s = 0;
  double peak_rss_mb = 0;
  double finish_s = 0;   ///< after the last event: waiting work and the last fit
  bool finished = true;  ///< false: of that some was left, for want of time
  LatencyHistogram event_latency;
};
/// CPU time and peak memory of this process so far.
double process_cpu_s();
/// To be called before a program begins threads: memory that they give back is not kept apart for each.
/// Copies of the map go from thread to thread, and what that leaves in glibc's arenas grows for hours.
void share_memory_among_threads();
double process_peak_rss_mb();
/// Resident memory of this process now; 0 where the system does not tell.
double process_rss_mb();

struct OutputOptions {
  double resolution_m = 0.05;
  Pose align;  ///< applied to every island's frame before export: out_from_map
};

/// The map with every island's frame moved; relations and covariances are relative and stay.
MapCopy aligned(const MapCopy& map, const Pose& out_from_map);

/// Writes every output file of tools/README.md (grids, trajectories, CSVs, graph.g2o, report.json) into a
/// directory, made where missing. Each file is complete or absent: written under a temporary name, synced and
/// renamed. Throws std::runtime_error naming the file and the reason.
void write_outputs(const MapCopy& map, const RunCost& cost, const std::string& directory,
                   const OutputOptions& options = {});

}  // namespace isthmus
