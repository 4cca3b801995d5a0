#include <benchmark/benchmark.h>

#include <cmath>
#include <random>

#include "relations/confidence.hpp"
#include "relations/fit.hpp"

namespace isthmus {
namespace {

double uniform(std::mt19937& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random()) / 4294967295.0;
}

QuadraticFormBuilder rows(std::mt19937& random, const Pose& a_from_b, int count) {
  QuadraticFormBuilder builder;
  for (int i = 0; i < count; ++i) {
    const double yaw = (i % 2 == 0 ? 0.1 : 1.7) + uniform(random, -0.05, 0.05);
    const Eigen::Vector2d normal(std::cos(yaw), std::sin(yaw));
    const Eigen::Vector2d point(uniform(random, -8, 8), uniform(random, -8, 8));
    builder.point_on_line(point, a_from_b * point + uniform(random, -0.03, 0.03) * normal, normal, 0.03);
  }
  return builder;
}

struct Building {
  RelationGraph graph;
  std::vector<Pose> poses;
};

/// Rounds through a ring of 100 m, a patch a metre: each patch has odometry to the one before, matches with
/// the three before and, from the second round on, with three of the round before.
Building building(int patches) {
  std::mt19937 random(1);
  Building made;
  for (int i = 0; i < patches; ++i) {
    made.graph.add_patch(PatchId{i});
    const double angle = 2 * 3.14159265358979 * (i % 100) / 100;
    made.poses.push_back({16 * std::cos(angle), 16 * std::sin(angle) + 0.002 * i, wrap_angle(angle + 1.57)});
  }
  const auto match = [&](int a, int b) {
    if (a < 0) return;
    Relation relation;
    relation.a = PatchId{a};
    relation.b = PatchId{b};
    const Pose a_from_b =
        ominus(made.poses[static_cast<std::size_t>(b)], made.poses[static_cast<std::size_t>(a)]);
    relation.measurement = Correspondences{rows(random, a_from_b, 30).build(), 30, {}};
    made.graph.add(relation);
    if (a != b - 1) return;
    relation.measurement =
        RelativePose{a_from_b * Pose{0.02, 0, 0.01}, Eigen::Vector3d(400, 400, 2500).asDiagonal()};
    made.graph.add(relation);
  };
  for (int i = 1; i < patches; ++i)
    for (const int back : {1, 2, 3, 99, 100, 101}) match(i - back, i);
  return made;
}

void build_form_of_200_rows(benchmark::State& state) {
  std::mt19937 random(1);
  const QuadraticFormBuilder builder = rows(random, {1, 0, 0.1}, 200);
  for (auto _ : state) benchmark::DoNotOptimize(builder.build());
}
BENCHMARK(build_form_of_200_rows);

void minimum_of_form(benchmark::State& state) {
  std::mt19937 random(1);
  const QuadraticForm form = rows(random, {1, 0, 0.1}, 200).build();
  for (auto _ : state) benchmark::DoNotOptimize(form.least());
}
BENCHMARK(minimum_of_form);

void fit_of_window(benchmark::State& state) {
  const auto size = static_cast<int>(state.range(0));
  const Building map = building(1000);
  std::vector<PatchId> window;
  for (int i = 0; i < size; ++i) window.push_back(PatchId{999 - i});
  std::vector<Pose> start = map.poses;
  fit(map.graph, window, start);
  start[999] = start[999] * Pose{0.05, 0.02, 0.01};
  for (auto _ : state) {
    std::vector<Pose> poses = start;
    benchmark::DoNotOptimize(fit(map.graph, window, poses));
  }
}
BENCHMARK(fit_of_window)->Arg(20)->Arg(50)->Arg(100)->Unit(benchmark::kMicrosecond);

void fit_of_island_from_afar(benchmark::State& state) {
  const Building map = building(static_cast<int>(state.range(0)));
  std::mt19937 random(2);
  std::vector<Pose> start = map.poses;
  for (std::size_t i = 1; i < start.size(); ++i)
    start[i] = start[i] * Pose{uniform(random, -1, 1), 0, uniform(random, -0.5, 0.5)};
  FitOptions options;
  options.chordal_start = true;
  for (auto _ : state) {
    std::vector<Pose> poses = start;
    benchmark::DoNotOptimize(fit_island(map.graph, PatchId{0}, poses, options));
  }
}
BENCHMARK(fit_of_island_from_afar)->Arg(1000)->Arg(5000)->Unit(benchmark::kMillisecond);

void local_confidence(benchmark::State& state) {
  const Building map = building(5000);
  for (auto _ : state)
    benchmark::DoNotOptimize(local_relative_covariances(map.graph, map.poses, PatchId{2500},
                                                        static_cast<std::size_t>(state.range(0))));
}
BENCHMARK(local_confidence)->Arg(200)->Unit(benchmark::kMicrosecond);

void exact_confidence_of_20_patches(benchmark::State& state) {
  const Building map = building(static_cast<int>(state.range(0)));
  std::vector<PatchId> others;
  for (int i = 0; i < 20; ++i) others.push_back(PatchId{i * 40});
  for (auto _ : state)
    benchmark::DoNotOptimize(exact_relative_covariances(map.graph, map.poses, PatchId{500}, others));
}
BENCHMARK(exact_confidence_of_20_patches)->Arg(1000)->Arg(5000)->Unit(benchmark::kMillisecond);

void copy_of_graph(benchmark::State& state) {
  const Building map = building(5000);
  for (auto _ : state) benchmark::DoNotOptimize(RelationGraph(map.graph));
}
BENCHMARK(copy_of_graph)->Unit(benchmark::kMillisecond);

void withdrawal_of_many(benchmark::State& state) {
  const Building map = building(5000);
  std::vector<RelationId> gone;
  for (const auto& [id, relation] : map.graph.relations())
    if (id.value % 50 == 0) gone.push_back(id);
  for (auto _ : state) {
    state.PauseTiming();
    RelationGraph graph = map.graph;
    state.ResumeTiming();
    graph.remove(gone);
    benchmark::DoNotOptimize(graph.island(PatchId{4999}));
  }
}
BENCHMARK(withdrawal_of_many)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace isthmus
