#pragma once

#include <string>
#include <vector>

#include "server/engine/record/map_copy.hpp"
#include "tools/simulate/run/simulation.hpp"

namespace isthmus {

/// A closure that was tried out, with what its last trial found, and whether what it says is true.
struct LabelledClosure {
  std::string run;
  ClosureRecord closure;
  double off_m = 0;  ///< what it says of its ends, from the truth
  double off_rad = 0;

  /// By less than 1 m and 20 degrees.
  bool is_true() const;
};

/// The closures of a map that came to be judged by what their trials found and whose ends' true poses are
/// known; those of fixed tags and measured starts are left out.
std::vector<LabelledClosure> label_closures(const std::string& run, const MapCopy& map,
                                            const std::vector<RobotTruth>& truth);

/// A row for each. Throws std::runtime_error naming the file and the reason.
void write_labelled_closures(const std::vector<LabelledClosure>& closures, const std::string& file);

/// A find of scans with whether the robot was there, by the same bounds.
struct LabelledFind {
  std::string run;
  FindRecord find;
  bool is_true = false;
};

/// The finds of a map whose ends' true poses are known.
std::vector<LabelledFind> label_finds(const std::string& run, const MapCopy& map,
                                      const std::vector<RobotTruth>& truth);

/// A row for each: the table that tools/fit_evidence.py takes. Throws std::runtime_error naming the file and
/// the reason.
void write_labelled_finds(const std::vector<LabelledFind>& finds, const std::string& file);

}  // namespace isthmus
