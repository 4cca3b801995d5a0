#pragma once

#include <array>
#include <complex>
#include <cstdint>
#include <optional>
#include <tuple>

#include "patches/scan.hpp"
#include "scanmatch/match.hpp"
#include "server/engine/input/options/robot_options.hpp"

namespace isthmus {

/// Ways and turns by two accounts of the same motion: odometry's, and that of matches that determine it.
struct MotionAccounts {
  double odometry = 0;  ///< m or rad, sums of absolute values
  double laser = 0;
  double apart = 0;  ///< of their differences

  /// Share of the motion seen by the laser that odometry tells too, 0 to 1; 1 where there was none.
  double explained() const;
  /// What odometry says for each metre or radian of the laser's; infinite where the laser saw none.
  double ratio() const;

  auto members() { return std::tie(odometry, laser, apart); }
};

/// What is known of a robot's own data.
struct HealthFigures {
  /// The most that a stamp lay ahead of the time of its receipt: what a robot's clock is ahead, less the time
  /// that its fastest message took. Nothing before a message came. A robot that was out of reach sends
  /// late, so the least delay counts.
  std::optional<double> clock_ahead_s;
  std::int64_t odometry_messages = 0;
  double odometry_way_m = 0;  ///< from message to message, matched or not
  double odometry_turn_rad = 0;
  std::int64_t scans = 0;  ///< heard, whatever became of them
  std::int64_t scans_without_return = 0;
  std::int64_t scans_with_few_returns = 0;  ///< fewer than a match needs
  std::int64_t max_beams = 0;
  std::int64_t scans_changed = 0;        ///< that show much else than one half a second before
  std::int64_t scans_changed_still = 0;  ///< while odometry said that nothing moved
  std::int64_t scans_matched = 0;
  std::int64_t scans_unmatched = 0;
  MotionAccounts way;   ///< metres
  MotionAccounts turn;  ///< radians
  /// Mean direction of the laser's way from odometry's, and its length: 1 where it is always the same.
  double direction_rad = 0;
  double direction_steadiness = 0;
  double turn_correlation = 0;  ///< -1: one turns against the other
  /// The shift, in scans, at which odometry's turns fit the laser's best: positive where odometry comes
  /// later, and what is off at that shift for each radian that is off at none.
  int best_lag_scans = 0;
  double off_at_best_lag = 1;
  /// The same to a tenth of a scan; nothing before the robot has turned enough to tell. Where it is negative
  /// a scan is older than the odometry that comes with it. What was learned of it before, and is taken out
  /// (HealthRecord::scan_delay_s), is no part of it.
  std::optional<double> offset_scans;
  double off_at_offset = 1;

  auto members() {
    return std::tie(clock_ahead_s, odometry_messages, odometry_way_m, odometry_turn_rad, scans,
                    scans_without_return, scans_with_few_returns, max_beams, scans_changed,
                    scans_changed_still, scans_matched, scans_unmatched, way, turn, direction_rad,
                    direction_steadiness, turn_correlation, best_lag_scans, off_at_best_lag, offset_scans,
                    off_at_offset);
  }
};

/// Gathers evidence whether a robot's sensors agree with one another and with what it declares. Constant
/// memory.
///
/// A match begins where odometry puts the robot and is fitted together with it, so it errs towards odometry.
/// How far it departs is evidence all the same: along a direction that the beams determine they outweigh the
/// prediction by some fifty to one, and a match that ends far from it, or fits badly, is tried again with the
/// prediction held loosely and from other beginnings (localise.hpp). Where the beams leave a direction open,
/// a match only repeats odometry: those ways are left out.
///
/// One fault hides from this: odometry that stands still holds matches in place, scan after scan, so that a
/// map of the first place may seem to explain all. So scans are also compared beam by beam, with no pose at
/// all.
class RobotHealth {
 public:
  /// Of any message of the robot, microseconds.
  void heard_stamp(std::int64_t utime, std::int64_t receive_utime);
  void heard_odometry(const Pose& odom_from_robot);
  void heard_scan(const Scan& scan, const Laser& laser, const MatchOptions& match,
                  const HealthOptions& options);

  /// A matched scan: the motion since the last scan by odometry and by the match, both in the robot's frame
  /// then. `well_seen`: the beams determine both directions of the plane.
  void matched(const Pose& odometry_step, const Pose& laser_step, bool well_seen,
               const HealthOptions& options);
  /// A scan that was not matched, or one with which the robot began a new island.
  void unmatched();

  HealthFigures figures(const HealthOptions& options) const;

  auto members() {
    return std::tie(sums_, reference_, reference_odometry_, any_odometry_, last_odometry_, way_, turn_,
                    direction_, turn_product_, odometry_turn_squared_, laser_turn_squared_, odometry_turns_,
                    laser_turns_, turns_kept_, off_at_lag_, off_at_offset_, turn_compared_rad_);
  }

 private:
  static constexpr int max_lag_scans = 3;
  static constexpr int lags = 2 * max_lag_scans + 1;
  static constexpr int offsets_per_scan = 10;
  static constexpr int min_offset_scans = -2;
  static constexpr int max_offset_scans = 1;
  static constexpr int offsets = (max_offset_scans - min_offset_scans) * offsets_per_scan + 1;

  // Short ways are summed over a few scans, or the trembling of matches at rest would count as motion.
  struct Way {
    Pose odometry;
    Pose laser;
    int scans = 0;

    auto members() { return std::tie(odometry, laser, scans); }
  };
  struct Turn {
    double odometry_rad = 0;
    double laser_rad = 0;
    int scans = 0;

    auto members() { return std::tie(odometry_rad, laser_rad, scans); }
  };

  void add_way(const Pose& odometry_step, const Pose& laser_step, const HealthOptions& options);
  void add_turn(double odometry_rad, double laser_rad, const HealthOptions& options);
  void compare_lags(double odometry_rad, double laser_rad);
  void compare_offsets();
  void break_off();

  void compare_with_reference(const Scan& scan, const Laser& laser, const MatchOptions& match,
                              const HealthOptions& options);

  HealthFigures sums_;
  Scan reference_;  ///< of half a second ago
  Pose reference_odometry_;
  bool any_odometry_ = false;
  Pose last_odometry_;
  Way way_;
  Turn turn_;
  std::complex<double> direction_;  // of the laser's ways from odometry's, each as long as the laser's
  double turn_product_ = 0;
  double odometry_turn_squared_ = 0;
  double laser_turn_squared_ = 0;
  std::array<double, lags> odometry_turns_ = {};  // of the last scans, the newest last
  std::array<double, lags> laser_turns_ = {};
  int turns_kept_ = 0;
  std::array<double, lags> off_at_lag_ = {};
  std::array<double, offsets> off_at_offset_ = {};
  double turn_compared_rad_ = 0;  // of the laser, in absolute values
};

}  // namespace isthmus
