#include "tools/simulate/live/steering.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "patches/pose.hpp"

namespace isthmus {
namespace {

constexpr double ahead_s = 1.5;
constexpr int steps_ahead = 6;
constexpr int turn_rates = 6;  // each way
constexpr double speed_shares[] = {0, 0.1, 0.2, 0.4, 0.7, 1};
constexpr double heading_m_per_rad = 0.25;  // what facing the target is worth
constexpr double wanted_room_m = 0.2;       // beyond the margin: more of it is worth nothing
constexpr double room_worth = 0.2;
constexpr double face_on_spot_rad = 1;

double nearest(const Eigen::Vector2d& point, std::span<const Eigen::Vector2d> obstacles) {
  double least = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector2d& obstacle : obstacles) least = std::min(least, (obstacle - point).squaredNorm());
  return std::sqrt(least);
}

/// Where it goes, and how near it comes to something.
struct Trial {
  Pose end;
  double clearance_m = std::numeric_limits<double>::infinity();
};

Trial attempt(const Motion& motion, std::span<const Eigen::Vector2d> obstacles) {
  constexpr double step_s = ahead_s / steps_ahead;
  Trial trial;
  for (int step = 0; step < steps_ahead; ++step) {
    const double heading = trial.end.yaw + 0.5 * step_s * motion.turn_rate_rps;
    trial.end = {trial.end.x + step_s * motion.speed_mps * std::cos(heading),
                 trial.end.y + step_s * motion.speed_mps * std::sin(heading),
                 trial.end.yaw + step_s * motion.turn_rate_rps};
    trial.clearance_m = std::min(trial.clearance_m, nearest(position(trial.end), obstacles));
  }
  return trial;
}

double bearing(const Pose& from, const Eigen::Vector2d& to) {
  return wrap_angle(std::atan2(to.y() - from.y, to.x() - from.x) - from.yaw);
}

}  // namespace

Motion steer(const DrivePlan& drive, double radius_m, const Eigen::Vector2d& target,
             std::span<const Eigen::Vector2d> obstacles, double margin_m) {
  const double error = bearing({}, target);
  const double most = drive.turn_rate_rps;
  if (std::abs(error) > face_on_spot_rad) return {0, std::clamp(2 * error, -most, most)};
  std::vector<Eigen::Vector2d> near;
  const double reach_m = drive.speed_mps * ahead_s + radius_m + margin_m + wanted_room_m;
  for (const Eigen::Vector2d& obstacle : obstacles)
    if (obstacle.norm() <= reach_m) near.push_back(obstacle);
  const double now_m = nearest({0, 0}, near);
  Motion best;
  double best_worth = -std::numeric_limits<double>::infinity();
  for (const double share : speed_shares) {
    for (int turn = -turn_rates; turn <= turn_rates; ++turn) {
      const Motion motion{share * drive.speed_mps, most * turn / turn_rates};
      const Trial trial = attempt(motion, near);
      const double clear_m = trial.clearance_m - radius_m - margin_m;
      if (share > 0 && clear_m < 0 && trial.clearance_m <= now_m) continue;
      const double worth = target.norm() - (target - position(trial.end)).norm() -
                           heading_m_per_rad * std::abs(bearing(trial.end, target)) +
                           room_worth * std::clamp(clear_m, 0.0, wanted_room_m);
      if (worth <= best_worth) continue;
      best_worth = worth;
      best = motion;
    }
  }
  return best;
}

}  // namespace isthmus
