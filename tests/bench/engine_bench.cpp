#include <benchmark/benchmark.h>

#include "server/engine/engine.hpp"
#include "server/engine/localise/extend.hpp"
#include "tests/support/walls.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

// One robot driving to and fro in the furnished room: the cost of a scan, patches included.
void a_scan_from_event_to_answer(benchmark::State& state) {
  Engine engine;
  RobotEvent robot;
  robot.robot = "R1";
  robot.laser = laser_of();
  engine.handle({0, robot});
  std::int64_t utime = 0;
  std::vector<Scan> scans;
  std::vector<Pose> poses;
  for (int i = 0; i < 60; ++i) {
    const int there = i < 30 ? i : 59 - i;
    poses.push_back({-2 + 0.1 * there, -1, 0});
    scans.push_back(scan_from(furnished_room(), poses.back()));
  }
  std::size_t i = 0;
  for (auto _ : state) {
    utime += 200'000;
    scans[i].utime = utime;
    engine.handle({utime, OdometryEvent{"R1", utime, poses[i]}});
    benchmark::DoNotOptimize(engine.handle({utime, ScanEvent{"R1", scans[i]}}));
    i = (i + 1) % scans.size();
  }
}
BENCHMARK(a_scan_from_event_to_answer)->Unit(benchmark::kMicrosecond);

void coverage_by_twenty_patches(benchmark::State& state) {
  std::vector<LocalPatch> patches;
  for (int i = 0; i < 20; ++i) {
    const Pose view{-2 + 0.15 * i, -1, 0.1 * i};
    patches.push_back({patch_from(furnished_room(), PatchId{i}, view), view});
  }
  const Star star(scan_from(furnished_room(), {0, -1, 0.5}), laser_of(), 20, 0);
  for (auto _ : state) benchmark::DoNotOptimize(uncovered_share(star, patches, {0, -1, 0.5}, {}));
}
BENCHMARK(coverage_by_twenty_patches)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace isthmus
