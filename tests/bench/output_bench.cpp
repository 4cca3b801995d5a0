#include <benchmark/benchmark.h>

#include <cmath>
#include <numbers>

#include "server/output/grid/grid.hpp"
#include "server/output/output.hpp"

namespace isthmus {
namespace {

/// Patches every metre along a corridor of a hall of rooms: beams of 1 to 6 m that vary from one to the next.
MapCopy corridor(int patches, int beams) {
  MapCopy map;
  for (int i = 0; i < patches; ++i) {
    Scan scan{i, -std::numbers::pi, 2 * std::numbers::pi / beams, {}};
    for (int beam = 0; beam < beams; ++beam) {
      const double bearing = scan.bearing0_rad + beam * scan.bearing_step_rad;
      const double wall_m = std::min(1.0 / (std::abs(std::sin(bearing)) + 0.05), 8.0);
      const bool door = (beam / 9) % 4 == 0;
      scan.ranges_m.push_back(static_cast<float>(door ? wall_m + 2 : wall_m));
    }
    const PatchId id{i};
    map.patches.push_back(make_patch(id, "R1", scan, Laser{}, {}));
    map.poses.push_back({1.0 * (i % 50), 8.0 * (i / 50), 0.01 * i});
    map.graph.add_patch(id);
    if (i == 0) continue;
    Relation relation;
    relation.a = PatchId{i - 1};
    relation.b = id;
    relation.measurement =
        RelativePose{ominus(map.poses.back(), map.poses[map.poses.size() - 2]), Eigen::Matrix3d::Identity()};
    map.graph.add(relation);
  }
  return map;
}

void RenderIsland(benchmark::State& state) {
  const MapCopy map = corridor(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  const std::vector<PatchId> patches = map.graph.patches_of(PatchId{0});
  for (auto _ : state) benchmark::DoNotOptimize(render_island(map, patches, 0.05));
}
BENCHMARK(RenderIsland)->Args({600, 180})->Args({600, 360})->Args({5000, 360})->Unit(benchmark::kMillisecond);

void MapSha256(benchmark::State& state) {
  const MapCopy map = corridor(600, 360);
  for (auto _ : state) benchmark::DoNotOptimize(map_sha256(map));
}
BENCHMARK(MapSha256)->Unit(benchmark::kMillisecond);

void AppendTrajectory(benchmark::State& state) {
  TrajectoryStore store;
  for (auto _ : state) store.append({1, 0, PatchId{0}, {1, 2, 3}});
}
BENCHMARK(AppendTrajectory);

void AddLatency(benchmark::State& state) {
  LatencyHistogram latency;
  double seconds = 1e-6;
  for (auto _ : state) latency.add(seconds = seconds > 1 ? 1e-6 : seconds * 1.1);
  benchmark::DoNotOptimize(latency.max_s());
}
BENCHMARK(AddLatency);

}  // namespace
}  // namespace isthmus
