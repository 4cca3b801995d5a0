#pragma once

#include <Eigen/Core>
#include <vector>

namespace isthmus {

/// A way in an island's plane, driven at an even speed from now on, and where it is after a time: at its end
/// it stays. Metres and seconds.
class TimedWay {
 public:
  /// `points`: at least one; the first is where it is now.
  TimedWay(std::vector<Eigen::Vector2d> points, double speed_mps);

  double length_m() const { return along_m_.back(); }
  double end_s() const { return length_m() / speed_mps_; }
  Eigen::Vector2d at_s(double time_s) const { return at_m(time_s * speed_mps_); }
  Eigen::Vector2d at_m(double along_m) const;
  /// The direction that it drives in then; zero where it stands.
  Eigen::Vector2d heading_at_s(double time_s) const;
  /// The number of the point at which the way has come so far, or before.
  std::size_t point_before(double along_m) const;

  /// How near it comes to a point between two times.
  double nearest_m(const Eigen::Vector2d& point, double from_s, double to_s) const;

 private:
  std::vector<Eigen::Vector2d> points_;
  std::vector<double> along_m_;  // by point
  double speed_mps_;
};

}  // namespace isthmus
