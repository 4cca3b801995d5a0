#include <benchmark/benchmark.h>

#include "scanmatch/features/scan_features.hpp"
#include "tests/support/noisy_scan.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

void features_of_a_scan(benchmark::State& state) {
  NoisyLaser laser;
  laser.beams = static_cast<int>(state.range(0));
  laser.range_sigma_m = laser.bearing_sigma_rad = 0.003;
  Walls walls = furnished_room();
  add_pillar(walls, {1, -2}, 0.2);
  std::mt19937 random(1);
  const Scan scan = laser.scan(walls, {-1, 0, 0.3}, random);
  for (auto _ : state) benchmark::DoNotOptimize(find_features(scan, laser.laser(), {}));
}
BENCHMARK(features_of_a_scan)->Arg(90)->Arg(181)->Arg(541)->Arg(1081)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace isthmus
