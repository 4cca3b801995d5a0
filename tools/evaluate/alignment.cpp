#include "tools/evaluate/alignment.hpp"

#include <cmath>
#include <numbers>

namespace isthmus {
namespace {

using PairsByRobot = std::map<std::string, std::vector<PosePair>>;

PoseErrors errors_of(const std::vector<PosePair>& pairs, const Pose& truth_from_map) {
  std::vector<double> translation_m;
  std::vector<double> rotation_deg;
  for (const PosePair& pair : pairs) {
    const Pose estimate = truth_from_map * pair.map_from_robot;
    translation_m.push_back(
        std::hypot(estimate.x - pair.truth_from_robot.x, estimate.y - pair.truth_from_robot.y));
    rotation_deg.push_back(std::abs(wrap_angle(estimate.yaw - pair.truth_from_robot.yaw)) * 180 /
                           std::numbers::pi);
  }
  return {pairs.size(), statistics(std::move(translation_m)), statistics(std::move(rotation_deg))};
}

/// By island; what has no pose is counted into `missing`.
std::map<int, PairsByRobot> pair_up(const std::map<std::string, Trajectory>& truth,
                                    const TeamTrajectories& team,
                                    std::map<std::string, std::size_t>& missing) {
  std::map<int, PairsByRobot> by_island;
  for (const auto& [robot, trajectory] : truth) {
    missing[robot] = 0;
    for (const StampedPose& row : trajectory.rows()) {
      const auto estimate = team.pose(robot, row.utime);
      if (!estimate) {
        ++missing[robot];
      } else if (trajectory.nearest(estimate->utime, std::abs(estimate->utime - row.utime))->utime ==
                 row.utime) {
        by_island[estimate->island][robot].push_back(
            {row.map_from_robot, estimate->map_from_robot, row.utime});
      }
    }
  }
  return by_island;
}

IslandErrors errors_of_island(int island, const PairsByRobot& by_robot, const TagsToCompare& tags) {
  std::vector<PosePair> all;
  for (const auto& [robot, pairs] : by_robot) all.insert(all.end(), pairs.begin(), pairs.end());
  IslandErrors errors;
  errors.island = island;
  errors.truth_from_map = align(all);
  errors.pairs = by_robot;
  errors.team = errors_of(all, errors.truth_from_map);
  for (const auto& [robot, pairs] : by_robot) errors.robots[robot] = errors_of(pairs, errors.truth_from_map);
  std::vector<double> distances_m;
  for (const auto& [barcode, position] : tags.truth) {
    const auto placed = tags.map.find(barcode);
    if (placed == tags.map.end() || placed->second.island != island) continue;
    distances_m.push_back((errors.truth_from_map * placed->second.position - position).norm());
  }
  errors.tags = distances_m.size();
  errors.tag_translation_m = statistics(std::move(distances_m));
  return errors;
}

}  // namespace

Pose align(std::span<const PosePair> pairs) {
  if (pairs.empty()) return {};
  Eigen::Vector2d truth_mean = Eigen::Vector2d::Zero();
  Eigen::Vector2d map_mean = Eigen::Vector2d::Zero();
  for (const PosePair& pair : pairs) {
    truth_mean += position(pair.truth_from_robot);
    map_mean += position(pair.map_from_robot);
  }
  truth_mean /= static_cast<double>(pairs.size());
  map_mean /= static_cast<double>(pairs.size());
  double dot = 0;
  double cross = 0;
  for (const PosePair& pair : pairs) {
    const Eigen::Vector2d t = position(pair.truth_from_robot) - truth_mean;
    const Eigen::Vector2d m = position(pair.map_from_robot) - map_mean;
    dot += m.dot(t);
    cross += m.x() * t.y() - m.y() * t.x();
  }
  const double yaw = std::atan2(cross, dot);
  const Eigen::Vector2d shift = truth_mean - rotate(yaw, map_mean);
  return {shift.x(), shift.y(), yaw};
}

AbsoluteErrors evaluate_absolute(const std::map<std::string, Trajectory>& truth, const TeamTrajectories& team,
                                 const TagsToCompare& tags) {
  AbsoluteErrors errors;
  errors.missing_tags = tags.truth.size();
  for (const auto& [island, by_robot] : pair_up(truth, team, errors.missing)) {
    errors.islands.push_back(errors_of_island(island, by_robot, tags));
    errors.missing_tags -= errors.islands.back().tags;
  }
  return errors;
}

}  // namespace isthmus
