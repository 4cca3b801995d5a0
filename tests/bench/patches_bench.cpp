#include <benchmark/benchmark.h>

#include <cmath>
#include <numbers>
#include <random>

#include "patches/manifold.hpp"
#include "tests/support/solids.hpp"

namespace isthmus {
namespace {

// An office as a laser sees it: a room with doors and boxes, and a centimetre of noise.
Scan office_scan(std::size_t beams, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise_m(0, 0.01);
  Scan scan;
  scan.bearing0_rad = -0.75 * std::numbers::pi;
  scan.bearing_step_rad = 1.5 * std::numbers::pi / static_cast<double>(beams - 1);
  for (std::size_t i = 0; i < beams; ++i) {
    const double bearing = scan.bearing0_rad + static_cast<double>(i) * scan.bearing_step_rad;
    const double wall_m = std::min(5 / std::max(std::abs(std::cos(bearing)), 1e-9),
                                   3 / std::max(std::abs(std::sin(bearing)), 1e-9));
    const bool door = std::fmod(bearing + 10, 0.7) < 0.1;
    const bool box = std::fmod(bearing + 10, 0.45) < 0.07;
    scan.ranges_m.push_back(static_cast<float>((door ? 2.2 : box ? 0.6 : 1) * wall_m + noise_m(random)));
  }
  return scan;
}

std::size_t beams_of(const benchmark::State& state) { return static_cast<std::size_t>(state.range(0)); }

void free_space(benchmark::State& state) {
  const Scan scan = office_scan(beams_of(state));
  for (auto _ : state) benchmark::DoNotOptimize(free_space_of(scan, {}, {}));
  const Polysolid free = free_space_of(scan, {}, {});
  state.counters["vertices"] = static_cast<double>(free.polygons().front().outer.size());
}
BENCHMARK(free_space)->Arg(181)->Arg(1081);

void points_with_normals(benchmark::State& state) {
  const Scan scan = office_scan(beams_of(state));
  for (auto _ : state) benchmark::DoNotOptimize(to_points(scan, {}, {}));
}
BENCHMARK(points_with_normals)->Arg(181)->Arg(1081);

void patch(benchmark::State& state) {
  const Scan scan = office_scan(beams_of(state));
  for (auto _ : state) benchmark::DoNotOptimize(make_patch(PatchId{0}, "R1", scan, {}, {}));
}
BENCHMARK(patch)->Arg(181)->Arg(1081);

// The second argument: how far apart, in metres. Far ones are told by their boxes, near ones by an edge.
void overlap_of_patches(benchmark::State& state) {
  Manifold manifold;
  manifold.add(make_patch(PatchId{0}, "R1", office_scan(beams_of(state)), {}, {}), {});
  manifold.add(make_patch(PatchId{1}, "R1", office_scan(beams_of(state), 2), {}, {}),
               {static_cast<double>(state.range(1)), 0.3, 0.2});
  for (auto _ : state) benchmark::DoNotOptimize(manifold.overlap(PatchId{0}, PatchId{1}));
}
BENCHMARK(overlap_of_patches)->Args({181, 3})->Args({181, 50})->Args({1081, 3})->Args({1081, 50});

void union_of_two(benchmark::State& state) {
  const Polysolid a = free_space_of(office_scan(beams_of(state)), {}, {});
  const Polysolid b = transformed({3, 0.3, 0.2}, free_space_of(office_scan(beams_of(state), 2), {}, {}));
  for (auto _ : state) benchmark::DoNotOptimize(testing::united({a, b}));
}
BENCHMARK(union_of_two)->Arg(181)->Arg(1081)->Unit(benchmark::kMicrosecond);

void union_of_many(benchmark::State& state) {
  std::vector<Polysolid> parts;
  for (int i = 0; i < state.range(0); ++i) {
    const auto seed = static_cast<unsigned>(i);
    parts.push_back(transformed({2.0 * i, 0.1 * i, 0.3 * i}, free_space_of(office_scan(181, seed), {}, {})));
  }
  for (auto _ : state) benchmark::DoNotOptimize(testing::united(parts));
}
BENCHMARK(union_of_many)->Arg(10)->Arg(40)->Unit(benchmark::kMillisecond);

std::vector<Eigen::Vector2d> queries() {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> coordinate_m(-6, 6);
  std::vector<Eigen::Vector2d> points(4096);
  for (Eigen::Vector2d& point : points) point = {coordinate_m(random), coordinate_m(random)};
  return points;
}

void contains_by_star(benchmark::State& state) {
  const Star star(office_scan(beams_of(state)), {}, 20, 0);
  const auto points = queries();
  std::size_t i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(star.contains(points[i++ % points.size()]));
}
BENCHMARK(contains_by_star)->Arg(181)->Arg(1081);

void contains_by_polysolid(benchmark::State& state) {
  const Polysolid free = free_space_of(office_scan(beams_of(state)), {}, {});
  const auto points = queries();
  std::size_t i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(contains(free, points[i++ % points.size()]));
}
BENCHMARK(contains_by_polysolid)->Arg(181)->Arg(1081);

void point_index_build(benchmark::State& state) {
  const auto points = to_points(office_scan(beams_of(state)), {}, {});
  for (auto _ : state) benchmark::DoNotOptimize(PointIndex(points));
}
BENCHMARK(point_index_build)->Arg(181)->Arg(1081);

void point_index_nearest(benchmark::State& state) {
  const PointIndex index(to_points(office_scan(beams_of(state)), {}, {}));
  const auto points = queries();
  std::size_t i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(index.nearest(points[i++ % points.size()]));
}
BENCHMARK(point_index_nearest)->Arg(181)->Arg(1081);

}  // namespace
}  // namespace isthmus
