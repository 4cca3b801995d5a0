#include "tools/simulate/wild/wheel_faults.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "tools/simulate/plan/random.hpp"

namespace isthmus {
namespace {

constexpr double fast_rps = 0.6;
constexpr double turn_ends_rps = 0.2;

struct Reading {
  double time_s = 0;
  Pose odom_from_robot;
};
using Readings = std::vector<Reading>;

double dt_s(const Readings& readings, std::size_t i) {
  return std::max(1e-6, readings[i].time_s - readings[i - 1].time_s);
}

// Calls `change` with each step of the way, the seconds that it took and whether a fast turn has just begun
// or goes on, and strings what it makes of the steps together again.
template <class Change>
Readings changed(const Readings& readings, Change change) {
  Readings told = readings;
  bool turning = false;
  for (std::size_t i = 1; i < readings.size(); ++i) {
    const Pose step = ominus(readings[i].odom_from_robot, readings[i - 1].odom_from_robot);
    const double rate_rps = std::abs(step.yaw) / dt_s(readings, i);
    const bool begins = !turning && rate_rps > fast_rps;
    turning = rate_rps > (turning ? turn_ends_rps : fast_rps);
    told[i].odom_from_robot = told[i - 1].odom_from_robot * change(step, dt_s(readings, i), begins, turning);
  }
  return told;
}

Readings slipped(const Readings& readings, const WheelFaults& faults, Random& random) {
  double kept = 1;
  return changed(readings, [&](Pose step, double, bool begins, bool turning) {
    if (begins) {
      const double slip = faults.slip_share * random.uniform(-1, 1);
      kept = random.chance(faults.slip_chance) ? 1 + slip : 1;
    }
    if (turning) step.yaw *= kept;
    return step;
  });
}

Readings jumped(const Readings& readings, const WheelFaults& faults, Random& random) {
  return changed(readings, [&](Pose step, double seconds, bool, bool) {
    const bool moves = std::hypot(step.x, step.y) > 1e-6 || std::abs(step.yaw) > 1e-6;
    if (moves && random.chance(faults.jumps_per_min * seconds / 60))
      step.yaw += faults.jump_rad * random.uniform(-1, 1);
    return step;
  });
}

// What turns faster than it can be told is told when the turn is over.
Readings told_late(const Readings& readings, const WheelFaults& faults) {
  double owed_rad = 0;
  return changed(readings, [&](Pose step, double seconds, bool, bool) {
    const double most = faults.told_rps * seconds;
    owed_rad += step.yaw;
    step.yaw = std::clamp(owed_rad, -most, most);
    owed_rad -= step.yaw;
    return step;
  });
}

Readings frozen(const Readings& readings, const WheelFaults& faults, Random& random) {
  Readings told = readings;
  double until_s = readings.front().time_s;
  Pose held;
  std::size_t i = 0;
  changed(readings, [&](const Pose& step, double seconds, bool begins, bool) {
    const double time_s = readings[++i].time_s;
    const bool freezes = (begins && random.chance(faults.freeze_chance)) ||
                         random.chance(faults.freezes_per_min * seconds / 60);
    if (time_s >= until_s && freezes) {
      until_s = time_s + faults.freeze_s * random.uniform(0.2, 1);
      held = readings[i - 1].odom_from_robot;
    }
    if (time_s < until_s) told[i].odom_from_robot = held;
    return step;
  });
  return told;
}

Readings lagging(const Readings& readings, double lag_s) {
  Readings told = readings;
  std::size_t before = 0;
  for (Reading& reading : told) {
    const double then_s = reading.time_s - lag_s;
    while (before + 1 < readings.size() && readings[before + 1].time_s <= then_s) ++before;
    const Reading& a = readings[before];
    const Reading& b = readings[std::min(before + 1, readings.size() - 1)];
    const double gap_s = b.time_s - a.time_s;
    const double share = gap_s > 0 ? std::clamp((then_s - a.time_s) / gap_s, 0.0, 1.0) : 0;
    const Pose step = ominus(b.odom_from_robot, a.odom_from_robot);
    reading.odom_from_robot = a.odom_from_robot * Pose{share * step.x, share * step.y, share * step.yaw};
  }
  return told;
}

Readings with_faults(Readings readings, const WheelFaults& faults, Random random) {
  if (readings.empty()) return readings;
  readings = slipped(readings, faults, random);
  readings = jumped(readings, faults, random);
  if (faults.told_rps > 0) readings = told_late(readings, faults);
  readings = frozen(readings, faults, random);
  return faults.lag_s > 0 ? lagging(readings, faults.lag_s) : readings;
}

// A scan and its odometry have one stamp, and keep one.
void jitter(SimulatedRun& run, const std::string& robot, double jitter_s, Random random) {
  std::map<std::int64_t, std::int64_t> told;
  for (Event& event : run.events) {
    auto* odometry = std::get_if<OdometryEvent>(&event.body);
    if (odometry == nullptr || odometry->robot != robot) continue;
    const auto off_us = std::llround(1e6 * random.uniform(-jitter_s, jitter_s));
    const std::int64_t stamp = odometry->utime + off_us;
    told[odometry->utime] = stamp;
    odometry->utime = stamp;
  }
  for (Event& event : run.events) {
    auto* scan = std::get_if<ScanEvent>(&event.body);
    if (scan != nullptr && scan->robot == robot) scan->scan.utime = told.at(scan->scan.utime);
  }
  for (RobotTruth& truth : run.truth) {
    if (truth.robot != robot) continue;
    for (TruePose& pose : truth.poses) pose.utime = told.at(pose.utime);
  }
}

}  // namespace

void spoil_wheels(SimulatedRun& run, const std::string& robot, const WheelFaults& faults,
                  std::uint64_t seed) {
  std::vector<OdometryEvent*> events;
  Readings readings;
  for (Event& event : run.events) {
    auto* odometry = std::get_if<OdometryEvent>(&event.body);
    if (odometry == nullptr || odometry->robot != robot) continue;
    events.push_back(odometry);
    readings.push_back({1e-6 * static_cast<double>(odometry->utime), odometry->odom_from_robot});
  }
  readings = with_faults(std::move(readings), faults, Random(seed, robot + " wheel faults"));
  for (std::size_t i = 0; i < events.size(); ++i) events[i]->odom_from_robot = readings[i].odom_from_robot;
  if (faults.jitter_s > 0) jitter(run, robot, faults.jitter_s, Random(seed, robot + " jitter"));
}

}  // namespace isthmus
