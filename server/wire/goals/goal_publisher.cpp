#include "server/wire/goals/goal_publisher.hpp"

#include <exception>
#include <utility>

#include "server/wire/goals/goal_message.hpp"
#include "server/wire/message/encoded.hpp"
#include "server/wire/questions/low_priority.hpp"

namespace isthmus {
namespace {

ExpeditionOptions expedition_options(const ExplorationConfiguration& configuration) {
  ExpeditionOptions options;
  options.coordination.speed_mps = configuration.speed_m_s;
  options.exploration.search = {configuration.search_place, configuration.search_radius_m};
  return options;
}

}  // namespace

GoalPublisher::GoalPublisher(SendGoal send, const ExplorationConfiguration& configuration, ShowGoals show,
                             GoalLimits limits)
    : send_(std::move(send)),
      show_(std::move(show)),
      configuration_(configuration),
      limits_(limits),
      expedition_(expedition_options(configuration)),
      thread_([this](const std::stop_token& stop) { loop(stop); }) {}

void GoalPublisher::note(const RobotPose& pose) {
  const std::lock_guard lock(mutex_);
  robots_[pose.robot] = {pose.pose, pose.utime, Clock::now()};
}

void GoalPublisher::note_radius(const std::string& robot, double radius_m) {
  const std::lock_guard lock(mutex_);
  radii_m_[robot] = radius_m;
}

/// As it is known now.
void GoalPublisher::add_team(Work& work) const {
  for (const auto& [name, robot] : robots_) {
    if (Clock::now() - robot.heard > limits_.silent) continue;
    Footprint footprint;
    if (const auto radius = radii_m_.find(name); radius != radii_m_.end())
      footprint.radius_m = radius->second;
    footprint.clearance_m = configuration_.clearance_m;
    if (check(footprint) != Refusal::none) continue;
    work.team[name] = {robot.pose, footprint};
    work.pose_utimes[name] = robot.utime;
  }
}

void GoalPublisher::offer(std::shared_ptr<const MapCopy> map, std::int64_t utime) {
  const std::lock_guard lock(mutex_);
  offer_ = {std::move(map), utime, {}, {}};
  add_team(offer_);
  offered_.notify_one();
}

void GoalPublisher::loop(const std::stop_token& stop) {
  take_lower_priority();
  while (!stop.stop_requested()) {
    Work work;
    {
      std::unique_lock lock(mutex_);
      if (!offered_.wait(lock, stop, [this] { return offer_.map != nullptr; })) return;
      work = std::exchange(offer_, {});
    }
    const Clock::time_point begun = Clock::now();
    try {
      tell(work);
    } catch (const std::exception&) {
      continue;  // robots go on with what they were told
    }
    std::unique_lock lock(mutex_);
    const auto pause = (limits_.time_share - 1) * (Clock::now() - begun);
    offered_.wait_for(lock, stop, pause, [] { return false; });
  }
}

void GoalPublisher::tell(const Work& work) {
  planner_.update(work.map);
  const double time_s = 1e-6 * static_cast<double>(work.utime);
  TeamGoals told;
  for (const auto& [robot, order] : expedition_.plan(planner_, work.team, time_s)) {
    goal_t message = goal_message(*work.map, robot, work.team.at(robot).pose, order);
    message.utime = work.utime;
    message.pose_utime = work.pose_utimes.at(robot);
    send_(robot + "_GOAL", encoded(message));
    told.goals.push_back(std::move(message));
  }
  told.frontiers = expedition_.frontiers();
  if (show_) show_(std::move(told));
}

}  // namespace isthmus
