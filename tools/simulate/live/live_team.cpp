#include "tools/simulate/live/live_team.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "tools/simulate/live/reachable_ground.hpp"

namespace isthmus {
namespace {

constexpr int scan_ticks = 4;
/// Robots have seen one another before they scan, so that none is a wall on the others' first patches.
constexpr int first_scan_tick = 40;
constexpr int control_ticks = 2;
constexpr int look_ticks = 10;
constexpr int introduction_ticks = 100;
constexpr std::size_t odometry_kept = 1200;
constexpr double trail_m = 0.3;
/// A robot that does not get on goes back a little and tries again.
constexpr double try_again_s = 6;
constexpr double try_again_m = 0.6;

double apart_m(const LiveRobot& a, const LiveRobot& b) {
  return (position(a.world_from_robot()) - position(b.world_from_robot())).norm();
}

}  // namespace

std::vector<Pose> own_starts(const Scenario& scenario, std::size_t robots) {
  if (scenario.robots.size() < robots || robots == 0)
    throw std::runtime_error("the scenario has fewer robots");
  std::vector<Pose> starts;
  for (std::size_t i = 0; i < robots; ++i) starts.push_back(scenario.robots[i].start);
  return starts;
}

std::vector<Pose> starts_side_by_side(const Scenario& scenario, std::size_t robots, double clearance_m) {
  constexpr double start_room_m = 0.15;
  if (scenario.robots.size() < robots || robots == 0)
    throw std::runtime_error("the scenario has fewer robots");
  const RobotPlan& first = scenario.robots.front();
  std::vector<Pose> starts;
  for (const Eigen::Vector2d& at : starts_beside(RayCaster(scenario.plan), position(first.start), robots,
                                                 first.radius_m + clearance_m + start_room_m))
    starts.push_back({at.x(), at.y(), first.start.yaw});
  return starts;
}

std::optional<Pose> LiveTeam::Member::odom_from_robot_at(std::int64_t utime) const {
  const auto found = std::ranges::lower_bound(odometry, utime, {}, [](const auto& row) { return row.first; });
  if (found == odometry.end() || found->first != utime) return std::nullopt;
  return found->second;
}

LiveTeam::LiveTeam(const Scenario& scenario, std::uint64_t seed, const std::vector<Pose>& starts)
    : start_utime_(scenario.start_utime), caster_(scenario.plan) {
  for (std::size_t i = 0; i < starts.size(); ++i) {
    const RobotPlan& plan = scenario.robots.at(i);
    members_.push_back(std::make_unique<Member>(plan, starts[i], seed, scenario.start_utime));
    truth_.push_back({plan.name, {}});
  }
}

void LiveTeam::sense(const Take& take) {
  for (std::size_t i = 0; i < members_.size(); ++i) {
    Member& member = *members_[i];
    const int turn = tick_ + static_cast<int>(i);
    if (turn % introduction_ticks == 0 || tick_ == 0) take(member.robot.introduction(time_s()));
    take(member.robot.odometry(time_s()));
    member.odometry.emplace_back(utime(), member.robot.odom_from_robot());
    if (member.odometry.size() > odometry_kept) member.odometry.pop_front();
    member.pilot.note_odometry(member.robot.odom_from_robot(), time_s());
    if (tick_ >= first_scan_tick && turn % scan_ticks == 0) scan(i, take);
    if (turn % look_ticks == 0) look(i, take);
  }
}

void LiveTeam::scan(std::size_t i, const Take& take) {
  Member& member = *members_[i];
  std::vector<Passerby> bodies;
  for (std::size_t other = 0; other < members_.size(); ++other)
    if (other != i)
      bodies.push_back(
          {position(members_[other]->robot.world_from_robot()), members_[other]->robot.plan().radius_m});
  ScanEvent event = member.robot.scan(time_s(), caster_, bodies);
  truth_[i].poses.push_back({event.scan.utime, 0, member.robot.world_from_robot()});
  member.pilot.note_scan(event.scan, declared_laser(member.robot.plan().laser));
  take(std::move(event));
}

void LiveTeam::look(std::size_t i, const Take& take) {
  for (std::size_t other = 0; other < members_.size(); ++other) {
    if (other == i) continue;
    const LiveRobot& target = members_[other]->robot;
    if (auto seen = members_[i]->robot.look(time_s(), caster_, position(target.world_from_robot()),
                                            target.plan().barcode))
      take(*std::move(seen));
  }
}

void LiveTeam::try_again(Member& member) const {
  if (member.pilot.stuck_s() < control_ticks * tick_s) member.tried_again = false;
  if (member.pilot.is_backing_off() || member.pilot.stuck_s() < try_again_s) return;
  if (!std::exchange(member.tried_again, true)) member.pilot.back_off(try_again_m, 0);
}

void LiveTeam::move() {
  for (const auto& member : members_) {
    if (tick_ % control_ticks == 0) try_again(*member);
    const bool free = member->robot.move(member->pilot.drive(), tick_s, caster_);
    touched_walls_ += !free && !member->touches_wall;
    member->touches_wall = !free;
    const Eigen::Vector2d here = position(member->robot.world_from_robot());
    if (member->trail.empty() || (member->trail.back() - here).norm() >= trail_m)
      member->trail.push_back(here);
  }
  count_touching_robots();
  ++tick_;
}

void LiveTeam::count_touching_robots() {
  std::set<std::pair<std::size_t, std::size_t>> touching;
  for (std::size_t a = 0; a < members_.size(); ++a)
    for (std::size_t b = a + 1; b < members_.size(); ++b) {
      const LiveRobot &one = members_[a]->robot, &other = members_[b]->robot;
      if (apart_m(one, other) < one.plan().radius_m + other.plan().radius_m) touching.emplace(a, b);
    }
  for (const auto& pair : touching) touched_robots_ += !touching_.contains(pair);
  touching_ = std::move(touching);
}

double LiveTeam::way_m() const {
  double way = 0;
  for (const auto& member : members_) way += member->robot.driven_m();
  return way;
}

}  // namespace isthmus
