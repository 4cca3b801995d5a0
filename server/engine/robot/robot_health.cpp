#include "server/engine/robot/robot_health.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace isthmus {
namespace {

double length(const Pose& step) { return std::hypot(step.x, step.y); }

}  // namespace

double MotionAccounts::explained() const { return laser > 0 ? std::clamp(1 - apart / laser, 0.0, 1.0) : 1; }

double MotionAccounts::ratio() const {
  if (laser > 0) return odometry / laser;
  return odometry > 0 ? std::numeric_limits<double>::infinity() : 1;
}

void RobotHealth::heard_stamp(std::int64_t utime, std::int64_t receive_utime) {
  // In doubles: stamps are anything that a robot may send.
  const double ahead_s = 1e-6 * (static_cast<double>(utime) - static_cast<double>(receive_utime));
  sums_.clock_ahead_s = std::max(sums_.clock_ahead_s.value_or(ahead_s), ahead_s);
}

void RobotHealth::heard_odometry(const Pose& odom_from_robot) {
  if (any_odometry_) {
    const Pose step = ominus(odom_from_robot, last_odometry_);
    sums_.odometry_way_m += length(step);
    sums_.odometry_turn_rad += std::abs(step.yaw);
  }
  any_odometry_ = true;
  last_odometry_ = odom_from_robot;
  ++sums_.odometry_messages;
}

void RobotHealth::heard_scan(const Scan& scan, const Laser& laser, const MatchOptions& match,
                             const HealthOptions& options) {
  const auto hits = std::ranges::count_if(
      scan.ranges_m, [&](float range_m) { return classify(range_m, laser) == BeamKind::hit; });
  ++sums_.scans;
  if (hits == 0) ++sums_.scans_without_return;
  if (hits < match.min_pairs) ++sums_.scans_with_few_returns;
  sums_.max_beams = std::max(sums_.max_beams, static_cast<std::int64_t>(scan.ranges_m.size()));
  compare_with_reference(scan, laser, match, options);
}

void RobotHealth::compare_with_reference(const Scan& scan, const Laser& laser, const MatchOptions& match,
                                         const HealthOptions& options) {
  if (std::abs(scan.utime - reference_.utime) < options.reference_age_us) return;
  int both = 0, changed = 0;
  for (std::size_t i = 0; i < std::min(scan.ranges_m.size(), reference_.ranges_m.size()); ++i) {
    const float now_m = scan.ranges_m[i], then_m = reference_.ranges_m[i];
    if (classify(now_m, laser) != BeamKind::hit || classify(then_m, laser) != BeamKind::hit) continue;
    ++both;
    const double allowed_m = options.changed_m + options.changed_range_share * std::min(now_m, then_m);
    if (std::abs(now_m - then_m) > allowed_m) ++changed;
  }
  const Pose moved = ominus(last_odometry_, reference_odometry_);
  reference_ = scan;
  reference_odometry_ = last_odometry_;
  if (both < match.min_pairs || changed <= options.changed_share * both) return;
  ++sums_.scans_changed;
  if (length(moved) < options.still_m && std::abs(moved.yaw) < options.common.yaw_rad(options.still_m))
    ++sums_.scans_changed_still;
}

void RobotHealth::matched(const Pose& odometry_step, const Pose& laser_step, bool well_seen,
                          const HealthOptions& options) {
  ++sums_.scans_matched;
  add_turn(odometry_step.yaw, laser_step.yaw, options);
  compare_lags(odometry_step.yaw, laser_step.yaw);
  if (well_seen) {
    add_way(odometry_step, laser_step, options);
  } else {
    way_ = {};
  }
}

void RobotHealth::unmatched() {
  ++sums_.scans_unmatched;
  break_off();
}

void RobotHealth::break_off() {
  way_ = {};
  turn_ = {};
  turns_kept_ = 0;
}

void RobotHealth::add_way(const Pose& odometry_step, const Pose& laser_step, const HealthOptions& options) {
  way_.odometry = way_.odometry * odometry_step;
  way_.laser = way_.laser * laser_step;
  ++way_.scans;
  const bool closes = std::max(length(way_.laser), length(way_.odometry)) >= options.closing_way_m ||
                      std::abs(way_.laser.yaw) >= options.max_turn_in_way_rad ||
                      way_.scans >= options.max_scans;
  if (!closes) return;
  const std::complex<double> odometry(way_.odometry.x, way_.odometry.y), laser(way_.laser.x, way_.laser.y);
  way_ = {};
  if (std::max(std::abs(odometry), std::abs(laser)) < options.min_way_m) return;
  sums_.way.odometry += std::abs(odometry);
  sums_.way.laser += std::abs(laser);
  sums_.way.apart += std::abs(laser - odometry);
  const std::complex<double> turned = laser * std::conj(odometry);
  if (std::abs(turned) > 0) direction_ += std::abs(laser) / std::abs(turned) * turned;
}

void RobotHealth::add_turn(double odometry_rad, double laser_rad, const HealthOptions& options) {
  turn_.odometry_rad += odometry_rad;
  turn_.laser_rad += laser_rad;
  ++turn_.scans;
  const double odometry = turn_.odometry_rad, laser = turn_.laser_rad;
  const double more = std::max(std::abs(odometry), std::abs(laser));
  if (more < options.closing_turn_rad && turn_.scans < options.max_scans) return;
  turn_ = {};
  if (more < options.common.yaw_rad(options.min_way_m)) return;
  sums_.turn.odometry += std::abs(odometry);
  sums_.turn.laser += std::abs(laser);
  sums_.turn.apart += std::abs(laser - odometry);
  turn_product_ += odometry * laser;
  odometry_turn_squared_ += odometry * odometry;
  laser_turn_squared_ += laser * laser;
}

// Each turn of the laser against those of odometry some scans before and after.
void RobotHealth::compare_lags(double odometry_rad, double laser_rad) {
  std::shift_left(odometry_turns_.begin(), odometry_turns_.end(), 1);
  std::shift_left(laser_turns_.begin(), laser_turns_.end(), 1);
  odometry_turns_.back() = odometry_rad;
  laser_turns_.back() = laser_rad;
  turns_kept_ = std::min(turns_kept_ + 1, lags);
  if (turns_kept_ < lags) return;
  for (std::size_t i = 0; i < off_at_lag_.size(); ++i)
    off_at_lag_[i] += std::abs(laser_turns_[max_lag_scans] - odometry_turns_[i]);
  compare_offsets();
}

// The same between the scans: odometry is taken to turn evenly from one to the next. Counted in scans and not
// in seconds, as the stamps of many a log tell when a message was handled, not when it was measured.
void RobotHealth::compare_offsets() {
  const double laser_rad = laser_turns_[max_lag_scans];
  turn_compared_rad_ += std::abs(laser_rad);
  for (int i = 0; i < offsets; ++i) {
    const int scans_before = max_lag_scans + min_offset_scans + i / offsets_per_scan;
    const double share = static_cast<double>(i % offsets_per_scan) / offsets_per_scan;
    const auto before = static_cast<std::size_t>(scans_before);
    const double odometry_rad = (1 - share) * odometry_turns_[before] +
                                share * odometry_turns_[std::min<std::size_t>(before + 1, lags - 1)];
    off_at_offset_[static_cast<std::size_t>(i)] += std::abs(laser_rad - odometry_rad);
  }
}

HealthFigures RobotHealth::figures(const HealthOptions& options) const {
  HealthFigures figures = sums_;
  if (figures.way.laser > 0) figures.direction_steadiness = std::abs(direction_) / figures.way.laser;
  figures.direction_rad = std::arg(direction_);
  const double squares = std::sqrt(odometry_turn_squared_ * laser_turn_squared_);
  figures.turn_correlation = squares > 0 ? turn_product_ / squares : 0;
  const auto best = std::ranges::min_element(off_at_lag_);
  figures.best_lag_scans = static_cast<int>(best - off_at_lag_.begin()) - max_lag_scans;
  const double off_at_none = off_at_lag_[max_lag_scans];
  figures.off_at_best_lag = off_at_none > 0 ? *best / off_at_none : 1;
  if (off_at_none <= *best) figures.best_lag_scans = 0;
  if (turn_compared_rad_ < options.min_offset_turn_rad) return figures;
  const auto offset = std::ranges::min_element(off_at_offset_);
  const auto tenths = static_cast<double>(offset - off_at_offset_.begin());
  figures.offset_scans =
      *offset < off_at_none ? (min_offset_scans * offsets_per_scan + tenths) / offsets_per_scan : 0;
  figures.off_at_offset = off_at_none > 0 ? std::min(1.0, *offset / off_at_none) : 1;
  return figures;
}

}  // namespace isthmus
