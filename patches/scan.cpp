#include "patches/scan.hpp"

#include <algorithm>
#include <cmath>

namespace isthmus {
namespace {

// Sums over a run of points, from which a line is fitted.
struct Moments {
  int n = 0;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double xx = 0, xy = 0, yy = 0;

  void add(const Eigen::Vector2d& d) {
    ++n;
    sum += d;
    xx += d.x() * d.x();
    xy += d.x() * d.y();
    yy += d.y() * d.y();
  }
};

struct Line {
  Eigen::Vector2d normal = Eigen::Vector2d::Zero();  ///< unit, up to its sign
  double spread_m2 = 0;
};

// Through the points; without a normal where they are not flat or too short.
Line line_through(const Moments& m, const NormalOptions& options) {
  if (m.n < options.min_points) return {};
  const Eigen::Vector2d mean = m.sum / m.n;
  const double xx = m.xx / m.n - mean.x() * mean.x();
  const double yy = m.yy / m.n - mean.y() * mean.y();
  const double xy = m.xy / m.n - mean.x() * mean.y();
  const double half_trace = 0.5 * (xx + yy);
  const double root = std::hypot(0.5 * (xx - yy), xy);
  const double across = std::max(0.0, half_trace - root);
  const double along = half_trace + root;
  if (across > options.max_flatness_m * options.max_flatness_m || along < options.min_elongation * across ||
      along < 1e-6) {
    return {};
  }
  const double line_yaw = 0.5 * std::atan2(2 * xy, xx - yy);
  return {{-std::sin(line_yaw), std::cos(line_yaw)}, m.n * along};
}

// The ends of a scan's beams in order, and where surfaces end among them.
class Ends {
 public:
  /// `reach_m`: how far apart two neighbours on one surface may lie, by point. Keeps references.
  Ends(const std::vector<ScanPoint>& points, const std::vector<double>& reach_m, const NormalOptions& options)
      : points_(points), reach_m_(reach_m), options_(options) {}

  /// The line through a point and its neighbours on the same surface.
  Line line_at(std::size_t point) const {
    Moments moments;
    moments.add(Eigen::Vector2d::Zero());
    for (const std::ptrdiff_t step : {-1, 1})
      add_neighbours(static_cast<std::ptrdiff_t>(point), step, moments);
    return line_through(moments, options_);
  }

 private:
  void add_neighbours(std::ptrdiff_t point, std::ptrdiff_t step, Moments& moments) const {
    int taken = 0;
    for (std::ptrdiff_t k = point + step; is_there(k); k += step) {
      const Eigen::Vector2d offset = at(k) - at(point);
      if (jumps(k - step, k, reach_m_[static_cast<std::size_t>(point)])) return;
      if (++taken > options_.sure_neighbours && offset.norm() > options_.half_width_m) return;
      moments.add(offset);
    }
  }

  // Between two neighbours. On one surface gaps grow little from beam to beam; a shadow's is wide at once.
  bool jumps(std::ptrdiff_t one, std::ptrdiff_t next, double reach_m) const {
    const double gap = gap_m(one, next);
    if (gap <= options_.max_jump_m) return false;
    return gap > reach_m ||
           gap > options_.most_gap_growth * std::max(gap_m(2 * one - next, one), gap_m(next, 2 * next - one));
  }

  bool is_there(std::ptrdiff_t k) const { return k >= 0 && k < static_cast<std::ptrdiff_t>(points_.size()); }
  const Eigen::Vector2d& at(std::ptrdiff_t k) const { return points_[static_cast<std::size_t>(k)].position; }
  double gap_m(std::ptrdiff_t one, std::ptrdiff_t next) const {
    return is_there(one) && is_there(next) ? (at(next) - at(one)).norm() : 0;
  }

  const std::vector<ScanPoint>& points_;
  const std::vector<double>& reach_m_;
  const NormalOptions& options_;
};

}  // namespace

BeamKind classify(float range_m, const Laser& laser) {
  if (std::isnan(range_m) || range_m <= 0 || range_m < laser.range_min_m) return BeamKind::ignored;
  // Of what is sent as the largest range, 5.6 m as a float is less than as a double.
  return range_m >= static_cast<float>(laser.range_max_m) ? BeamKind::no_return : BeamKind::hit;
}

std::vector<ScanPoint> to_points(const Scan& scan, const Laser& laser, const NormalOptions& options) {
  std::vector<ScanPoint> points;
  std::vector<double> reach;
  points.reserve(scan.ranges_m.size());
  reach.reserve(scan.ranges_m.size());
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const float range_m = scan.ranges_m[i];
    if (classify(range_m, laser) != BeamKind::hit) continue;
    const double bearing = scan.bearing0_rad + static_cast<double>(i) * scan.bearing_step_rad;
    const Eigen::Vector2d end(range_m * std::cos(bearing), range_m * std::sin(bearing));
    points.push_back(
        {laser.robot_from_laser * end, Eigen::Vector2d::Zero(), static_cast<std::int32_t>(i), 0});
    reach.push_back(options.reach_beams * range_m * std::abs(scan.bearing_step_rad));
  }
  const Eigen::Vector2d eye(laser.robot_from_laser.x, laser.robot_from_laser.y);
  const Ends ends(points, reach, options);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Line line = ends.line_at(i);
    points[i].normal =
        line.normal.dot(eye - points[i].position) < 0 ? Eigen::Vector2d(-line.normal) : line.normal;
    points[i].spread_m2 = static_cast<float>(line.spread_m2);
  }
  return points;
}

}  // namespace isthmus
