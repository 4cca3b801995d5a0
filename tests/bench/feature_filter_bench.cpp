#include <benchmark/benchmark.h>

#include <cmath>

#include "server/features/feature_filter.hpp"
#include "server/features/fusion/fusion.hpp"
#include "server/features/fusion/landmark_tree.hpp"

namespace isthmus {
namespace {

/// A map of so many landmarks on a line, every third of a metre apart from the next.
FeatureState line_of_landmarks(int count, double from_m) {
  FeatureState state;
  add_robot(state, {}, Eigen::Matrix3d::Zero());
  for (int i = 0; i < count; ++i) {
    move_robot(state, 0, {0.5, 0, 0}, 1e-4 * Eigen::Matrix3d::Identity());
    const double y = from_m + 2 * (i % 5);
    add_feature(state, 0, {point_feature({1, y}), 1e-4 * LocalMatrix::Identity(2, 2)});
  }
  return state;
}

void a_scan_of_eight(benchmark::State& state) {
  FeatureFilter filter;
  filter.replace(line_of_landmarks(static_cast<int>(state.range(0)), -4));
  const Pose robot_from_map = inverse(filter.state().robots[0].map_from_robot);
  std::vector<ObservedFeature> seen;
  for (std::size_t i = 0; i < 8; ++i)
    seen.push_back({robot_from_map * filter.state().features[i].feature, 1e-2 * LocalMatrix::Identity(2, 2)});
  for (auto _ : state) benchmark::DoNotOptimize(filter.observe(0, seen));
}
BENCHMARK(a_scan_of_eight)->Arg(25)->Arg(100)->Arg(400)->Unit(benchmark::kMicrosecond);

void fusion_of_95_with_60(benchmark::State& state) {
  const FeatureState one = line_of_landmarks(95, -4), two = line_of_landmarks(60, -4);
  // The second robot ends where the first one's 60th step ended: 60 duplicates, behind one another.
  const RobotAlignment alignment{{-17.5, 0, 0}, Eigen::Vector3d(4e-4, 4e-4, 4e-4).asDiagonal()};
  for (auto _ : state) benchmark::DoNotOptimize(fuse(one, 0, two, 0, alignment));
}
BENCHMARK(fusion_of_95_with_60)->Unit(benchmark::kMillisecond);

/// The part of a fusion that looks for twins, of n landmarks with n: a tree made, and each asked for what
/// lies within a metre. n log n. The rest of a fusion of n with n and m pairs costs m² n for the pairs, and
/// n² m once for the joint covariance, which has n² numbers: no map of 10⁴ landmarks has one (3 GB).
void twins_of_n_landmarks(benchmark::State& state) {
  const auto count = static_cast<int>(state.range(0));
  std::vector<Feature> landmarks;
  for (int i = 0; i < count; ++i)  // spread over the plane, two each square metre, whatever their number
    landmarks.push_back(
        point_feature({std::fmod(0.618034 * i, 1.0) * std::sqrt(0.5 * count), std::sqrt(0.5 / count) * i}));
  for (auto _ : state) {
    const LandmarkTree tree(landmarks);
    std::size_t found = 0;
    for (const Feature& landmark : landmarks) found += tree.within(landmark.a, 1).size();
    benchmark::DoNotOptimize(found);
  }
  state.SetComplexityN(count);
}
BENCHMARK(twins_of_n_landmarks)
    ->RangeMultiplier(4)
    ->Range(40, 10'240)
    ->Unit(benchmark::kMicrosecond)
    ->Complexity(benchmark::oNLogN);

/// All of a fusion of n with n landmarks of which a tenth are shared.
void fusion_of_n_with_n(benchmark::State& state) {
  const auto count = static_cast<int>(state.range(0));
  const FeatureState one = line_of_landmarks(count, -4), two = line_of_landmarks(count, -4);
  const RobotAlignment alignment{{0.45 * count, 0, 0}, Eigen::Vector3d(4e-4, 4e-4, 4e-4).asDiagonal()};
  for (auto _ : state) benchmark::DoNotOptimize(fuse(one, 0, two, 0, alignment));
  state.SetComplexityN(count);
}
BENCHMARK(fusion_of_n_with_n)
    ->RangeMultiplier(2)
    ->Range(50, 800)
    ->Unit(benchmark::kMillisecond)
    ->Complexity();

void alignment_of_95_with_60(benchmark::State& state) {
  const FeatureState one = line_of_landmarks(95, -4), two = line_of_landmarks(60, -4);
  const RobotAlignment alignment{{-17.5, 0, 0}, Eigen::Vector3d(4e-4, 4e-4, 4e-4).asDiagonal()};
  for (auto _ : state) benchmark::DoNotOptimize(aligned(one, 0, two, 0, alignment));
}
BENCHMARK(alignment_of_95_with_60)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace isthmus
