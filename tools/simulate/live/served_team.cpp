#include "tools/simulate/live/served_team.hpp"

#include <memory>
#include <set>
#include <utility>

#include "server/paths/questions/relative_pose.hpp"

namespace isthmus {

void ServedTeam::sense() {
  team_.sense([this](decltype(Event::body) body) { handle(std::move(body)); });
}

void ServedTeam::handle(decltype(Event::body) body) {
  for (const RobotPose& pose : engine_.handle({team_.utime(), std::move(body)}).poses) {
    for (std::size_t i = 0; i < team_.size(); ++i) {
      if (team_[i].name() != pose.robot) continue;
      answers_[i] = pose;
      localise(i);
    }
  }
}

/// Where the frame of the planner's map lies in that of the robot's odometry.
void ServedTeam::localise(std::size_t i) {
  const auto& answer = answers_[i];
  if (!answer || check(planner_.map(), answer->pose) != Refusal::none) return;
  if (const auto then = team_[i].odom_from_robot_at(answer->utime))
    team_[i].pilot.localise(*then * inverse(planner_.project(answer->pose)));
}

void ServedTeam::update_map() {
  planner_.update(std::make_shared<const MapCopy>(engine_.copy()));
  for (std::size_t i = 0; i < team_.size(); ++i) localise(i);
}

void ServedTeam::follow(std::size_t i, const std::vector<ManifoldPose>& path,
                        std::optional<double> map_heading_rad) {
  Pilot& pilot = team_[i].pilot;
  if (pilot.is_backing_off()) return;
  if (path.empty()) return pilot.halt();
  std::vector<Eigen::Vector2d> points;
  for (const ManifoldPose& pose : path) points.push_back(position(planner_.project(pose)));
  pilot.follow(std::move(points), map_heading_rad);
}

void ServedTeam::obey(std::size_t i, const ExplorationOrder& order) {
  std::optional<double> heading;
  if (order.is_last) heading = planner_.project(order.goal->viewpoint).yaw;
  follow(i, order.path, heading);
}

std::map<std::string, ExpeditionMember> ServedTeam::members() const {
  std::map<std::string, ExpeditionMember> members;
  for (std::size_t i = 0; i < team_.size(); ++i)
    if (answers_[i] && check(planner_.map(), answers_[i]->pose) == Refusal::none)
      members[team_[i].name()] = {answers_[i]->pose, footprint(i)};
  return members;
}

std::size_t ServedTeam::islands() const {
  std::set<IslandId> islands;
  for (const auto& [name, member] : members()) islands.insert(planner_.map().graph.island(member.pose.patch));
  return islands.size();
}

}  // namespace isthmus
