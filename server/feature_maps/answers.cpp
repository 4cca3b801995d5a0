// What a FeatureMapper tells while it maps.

#include <algorithm>

#include "server/feature_maps/mapper/feature_mapper.hpp"

namespace isthmus {
namespace {

/// Named by its first journey, as an island of patches by its first patch.
IslandId island_of(const Team& team) {
  return {*std::min_element(team.journeys.begin(), team.journeys.end())};
}

}  // namespace

std::vector<RobotPose> FeatureMapper::take_answers() {
  std::vector<RobotPose> answers;
  for (const std::string& name : std::exchange(moved_, {})) {
    const FeatureRobot& robot = robots_.at(name);
    if (robot.journey < 0 || journey(robot).rows.empty()) continue;
    const Journey& own = journey(robot);
    const Team& team = teams_[static_cast<std::size_t>(own.team)];
    RobotPose pose;
    pose.robot = name;
    pose.utime = own.rows.back().utime;
    pose.island = island_of(team);
    const OdometryPath here = pose_of(robot);
    pose.map_from_robot = here.start_from_end;
    pose.pose.patch_from_object = pose.map_from_robot;
    pose.covariance = here.covariance;
    pose.map_from_odom = pose.map_from_robot * inverse(robot.odom_from_robot);
    pose.matched = robot.matched;
    answers.push_back(std::move(pose));
  }
  return answers;
}

FeatureMaps FeatureMapper::summary() const {
  FeatureMaps summary{options_.kind, {}, {}, {}, {}, counts_};
  for (const auto& [id, fusion] : fusions_) summary.fusions.push_back(fusion);
  for (const Team& team : teams_)
    if (!team.journeys.empty())
      summary.teams.push_back({FeatureFilter(options_.filter), team.journeys, team.landmarks});
  return summary;
}

std::optional<FusionState> FeatureMapper::state_of_fusion(std::int32_t id) const {
  const auto found = fusions_.find(id);
  if (found == fusions_.end()) return std::nullopt;
  return found->second.state;
}

std::vector<TagRecord> FeatureMapper::tag_records() const {
  std::vector<TagRecord> records;
  for (const Team& team : teams_) {
    for (const auto& [barcode, id] : team.landmarks) {
      const auto index = index_of(team.filter.state(), id);
      if (!index || team.journeys.empty()) continue;
      TagRecord& record = records.emplace_back();
      record.barcode = barcode;
      record.island = island_of(team);
      record.position = team.filter.state().features[*index].feature.a;
      record.covariance = feature_covariance(team.filter.state(), *index).topLeftCorner<2, 2>();
      record.placed = true;
    }
  }
  const auto is_placed = [&](std::int32_t barcode) {
    return std::any_of(records.begin(), records.end(),
                       [&](const TagRecord& record) { return record.barcode == barcode; });
  };
  for (const std::int32_t barcode : tags_)
    if (!is_placed(barcode)) records.emplace_back().barcode = barcode;
  return records;
}

std::vector<std::string> FeatureMapper::robot_names() const {
  std::vector<std::string> names;
  for (const auto& [name, robot] : robots_) names.push_back(name);
  return names;
}

bool FeatureMapper::has_waiting() const {
  return std::any_of(robots_.begin(), robots_.end(),
                     [](const auto& entry) { return !entry.second.waiting.empty(); });
}

}  // namespace isthmus
