#include "server/engine/record/bridge.hpp"

#include "relations/fit.hpp"
#include "relations/odometry_relation.hpp"
#include "server/engine/robot/odometry_noise.hpp"

namespace isthmus {
namespace {

// Of a robot that nothing is known of, on a path of many steps.
Eigen::Matrix3d covariance_of(const Pose& step, const OdometryNoiseOptions& options) {
  return options.first_path_scale * OdometryNoise(options).covariance(step, options);
}

}  // namespace

std::vector<Pose> bridge(const Pose& from, std::span<const Pose> steps, const Pose& to,
                         const OdometryNoiseOptions& options) {
  RelationGraph graph;
  std::vector<Pose> poses;
  std::vector<PatchId> between;
  const auto add = [&](const Pose& pose) {
    const PatchId id{static_cast<std::int32_t>(poses.size())};
    graph.add_patch(id);
    poses.push_back(pose);
    return id;
  };
  PatchId last = add(from);
  for (const Pose& step : steps.first(steps.size() - 1)) {
    const PatchId next = add(poses.back() * step);
    graph.add(odometry_relation(last, next, step, covariance_of(step, options)));
    between.push_back(next);
    last = next;
  }
  graph.add(odometry_relation(last, add(to), steps.back(), covariance_of(steps.back(), options)));
  const FitReport report = fit(graph, between, poses);
  const double chi_squared = 2 * report.cost_after;
  if (!report.ok || chi_squared > options.common.surprise.bound(3)) return {};
  return {poses.begin() + 1, poses.end() - 1};
}

}  // namespace isthmus
