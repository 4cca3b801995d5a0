#include "server/exploration/timed_way.hpp"

#include <algorithm>
#include <utility>

namespace isthmus {
namespace {

double distance_m(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& point) {
  const Eigen::Vector2d by = b - a;
  const double length = by.squaredNorm();
  const double share = length > 0 ? std::clamp((point - a).dot(by) / length, 0.0, 1.0) : 0;
  return (point - a - share * by).norm();
}

}  // namespace

TimedWay::TimedWay(std::vector<Eigen::Vector2d> points, double speed_mps)
    : points_(std::move(points)), along_m_{0}, speed_mps_(speed_mps) {
  for (std::size_t i = 1; i < points_.size(); ++i)
    along_m_.push_back(along_m_.back() + (points_[i] - points_[i - 1]).norm());
}

std::size_t TimedWay::point_before(double along_m) const {
  const auto after = std::upper_bound(along_m_.begin(), along_m_.end(), along_m);
  return static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, after - along_m_.begin() - 1));
}

Eigen::Vector2d TimedWay::at_m(double along_m) const {
  if (along_m >= length_m()) return points_.back();
  const std::size_t i = point_before(along_m);
  const double leg = along_m_[i + 1] - along_m_[i];
  return points_[i] + (points_[i + 1] - points_[i]) * (std::max(0.0, along_m - along_m_[i]) / leg);
}

Eigen::Vector2d TimedWay::heading_at_s(double time_s) const {
  const double along_m = time_s * speed_mps_;
  if (along_m >= length_m()) return Eigen::Vector2d::Zero();
  const std::size_t i = point_before(along_m);
  return (points_[i + 1] - points_[i]).normalized();
}

double TimedWay::nearest_m(const Eigen::Vector2d& point, double from_s, double to_s) const {
  const double from_m = std::max(0.0, from_s * speed_mps_), to_m = std::max(from_m, to_s * speed_mps_);
  Eigen::Vector2d at = at_m(from_m);
  double least = (point - at).norm();
  for (std::size_t i = point_before(from_m) + 1; i < points_.size() && along_m_[i] < to_m; ++i) {
    least = std::min(least, distance_m(at, points_[i], point));
    at = points_[i];
  }
  return std::min(least, distance_m(at, at_m(to_m), point));
}

}  // namespace isthmus
