#include "tools/evaluate/alignment.hpp"

#include <cmath>
#include <numbers>

namespace isthmus {
namespace {

using PairsByRobot = std::map<std::string, std::vector<PosePair>>;

AbsoluteErrors errors_of(const std::vector<PosePair>& pairs, const Pose& truth_from_map) {
  std::vector<double> translation_m;
  std::vector<double> rotation_deg;
  double squares = 0;
  for (const PosePair& pair : pairs) {
    const Pose estimate = truth_from_map * pair.map_from_robot;
    const double distance =
        std::hypot(estimate.x - pair.truth_from_robot.x, estimate.y - pair.truth_from_robot.y);
    translation_m.push_back(distance);
    squares += distance * distance;
    rotation_deg.push_back(std::abs(wrap_angle(estimate.yaw - pair.truth_from_robot.yaw)) * 180 /
                           std::numbers::pi);
  }
  AbsoluteErrors errors;
  errors.count = pairs.size();
  errors.rms_m = std::sqrt(squares / static_cast<double>(pairs.size()));
  errors.translation_m = statistics(std::move(translation_m));
  errors.rotation_deg = statistics(std::move(rotation_deg));
  return errors;
}

}  // namespace

Pose align(std::span<const PosePair> pairs) {
  if (pairs.empty()) return {};
  Eigen::Vector2d truth_mean = Eigen::Vector2d::Zero();
  Eigen::Vector2d map_mean = Eigen::Vector2d::Zero();
  for (const PosePair& pair : pairs) {
    truth_mean += Eigen::Vector2d(pair.truth_from_robot.x, pair.truth_from_robot.y);
    map_mean += Eigen::Vector2d(pair.map_from_robot.x, pair.map_from_robot.y);
  }
  truth_mean /= static_cast<double>(pairs.size());
  map_mean /= static_cast<double>(pairs.size());
  double dot = 0;
  double cross = 0;
  for (const PosePair& pair : pairs) {
    const Eigen::Vector2d t = Eigen::Vector2d(pair.truth_from_robot.x, pair.truth_from_robot.y) - truth_mean;
    const Eigen::Vector2d m = Eigen::Vector2d(pair.map_from_robot.x, pair.map_from_robot.y) - map_mean;
    dot += m.dot(t);
    cross += m.x() * t.y() - m.y() * t.x();
  }
  const double yaw = std::atan2(cross, dot);
  const Eigen::Vector2d shift = truth_mean - rotate(yaw, map_mean);
  return {shift.x(), shift.y(), yaw};
}

std::vector<AbsoluteErrors> evaluate_absolute(const std::map<std::string, Trajectory>& truth,
                                              const TeamTrajectories& team) {
  std::map<int, PairsByRobot> by_island;
  for (const auto& [robot, trajectory] : truth) {
    for (const StampedPose& row : trajectory.rows()) {
      const auto estimate = team.pose(robot, row.utime);
      if (estimate)
        by_island[estimate->island][robot].push_back({row.map_from_robot, estimate->map_from_robot});
    }
  }
  std::vector<AbsoluteErrors> all;
  for (const auto& [island, by_robot] : by_island) {
    std::vector<PosePair> pairs;
    for (const auto& [robot, own] : by_robot) pairs.insert(pairs.end(), own.begin(), own.end());
    const Pose truth_from_map = align(pairs);
    for (const auto& [robot, own] : by_robot) {
      all.push_back(errors_of(own, truth_from_map));
      all.back().robot = robot;
      all.back().island = island;
    }
  }
  return all;
}

}  // namespace isthmus
