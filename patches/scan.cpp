#include "patches/scan.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <optional>
#include <vector>

namespace isthmus {
namespace {

// Sums over a run of points, from which a line is fitted, and over the bends at each that has a neighbour on
// either side: how far it is from the middle between them, times two.
struct Moments {
  int n = 0;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double xx = 0, xy = 0, yy = 0;
  int bends = 0;
  double bend_xx = 0, bend_xy = 0, bend_yy = 0;

  void add(const Eigen::Vector2d& d) {
    ++n;
    sum += d;
    xx += d.x() * d.x();
    xy += d.x() * d.y();
    yy += d.y() * d.y();
  }

  void add_bend(const Eigen::Vector2d& d) {
    ++bends;
    bend_xx += d.x() * d.x();
    bend_xy += d.x() * d.y();
    bend_yy += d.y() * d.y();
  }
};

struct Line {
  Eigen::Vector2d normal = Eigen::Vector2d::Zero();  ///< unit, up to its sign
  double spread_m2 = 0;
  double off_m = 0;         ///< along the normal, from where the sums begin
  double roughness_m2 = 0;  ///< variance across it

  bool is_there() const { return normal.squaredNorm() > 0.5; }
  // Of a beam's angle to it; `beam` is of length 1.
  double sine(const Eigen::Vector2d& beam) const { return std::abs(normal.dot(beam)); }
};

// Of the variance across a line, the share that is noise: from points that stand aside of both their
// neighbours. What stands out of a wall for some points together, and a corner, is none (Gasser, Sroka and
// Jennen-Steinmetz, 1986, "Residual variance and residual pattern in nonlinear regression", eq. 3, for points
// at even distances).
double share_of_noise(const Moments& m, const Eigen::Vector2d& normal, double across) {
  const double x = normal.x(), y = normal.y();
  const double squared_bends = x * x * m.bend_xx + 2 * x * y * m.bend_xy + y * y * m.bend_yy;
  const double noise = m.bends > 0 ? squared_bends / (6 * m.bends) : 0;
  return noise < across ? noise / across : 1;
}

// Through the points; without a normal where they are too few or too short a row.
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
  if (along < options.min_elongation * across || along < 1e-6) return {};
  const double line_yaw = 0.5 * std::atan2(2 * xy, xx - yy);
  const Eigen::Vector2d normal(-std::sin(line_yaw), std::cos(line_yaw));
  // Between the first point and the mean of all, as the variance is noise or form (Wiener's filter).
  return {normal, m.n * along, share_of_noise(m, normal, across) * normal.dot(mean), across};
}

// The ends of a scan's beams in order, and where surfaces end among them.
class Ends {
 public:
  /// `reach_m`: how far apart two neighbours on one surface may lie, by point. Keeps references.
  Ends(const std::vector<ScanPoint>& points, const std::vector<double>& reach_m, const NormalOptions& options)
      : points_(points), reach_m_(reach_m), options_(options) {}

  /// The line through a point and its neighbours on the same surface: those before (-1) and after (1) it, or
  /// those on one side only.
  Line line_at(std::size_t point, std::initializer_list<std::ptrdiff_t> sides = {-1, 1}) const {
    Moments moments;
    moments.add(Eigen::Vector2d::Zero());
    const auto k = static_cast<std::ptrdiff_t>(point);
    int with_neighbours = 0;
    for (const std::ptrdiff_t side : sides) {
      if (add_neighbours(k, side, moments) > 0) ++with_neighbours;
    }
    if (with_neighbours == 2) moments.add_bend(bend(k, 1));
    return line_through(moments, options_);
  }

  /// The noise across a line by which a point stands aside of its two neighbours, whose bend has six times
  /// the variance of a point; nothing at an end or beside a jump.
  std::optional<double> stands_aside_m(std::size_t point, const Line& line) const {
    const auto k = static_cast<std::ptrdiff_t>(point);
    if (!is_there(k - 1) || !is_there(k + 1)) return std::nullopt;
    if (jumps(k, k - 1, reach_m_[point]) || jumps(k, k + 1, reach_m_[point])) return std::nullopt;
    return std::abs(line.normal.dot(bend(k, 1))) / std::sqrt(6.0);
  }

 private:
  // As many as are on its surface.
  int add_neighbours(std::ptrdiff_t point, std::ptrdiff_t step, Moments& moments) const {
    int taken = 0;
    for (std::ptrdiff_t k = point + step; is_there(k); k += step, ++taken) {
      const Eigen::Vector2d offset = at(k) - at(point);
      if (jumps(k - step, k, reach_m_[static_cast<std::size_t>(point)])) break;
      if (taken >= options_.sure_neighbours && offset.norm() > options_.half_width_m) break;
      moments.add(offset);
      if (taken > 0) moments.add_bend(bend(k - step, step));
    }
    return taken;
  }

  Eigen::Vector2d bend(std::ptrdiff_t k, std::ptrdiff_t step) const {
    return at(k - step) - 2 * at(k) + at(k + step);
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

// What a laser's ranges err by at random, of one scan. The end of a beam errs along the beam, as bearings are
// the laser's own: across a line by the sine of the angle between the two. Most points lie between two
// neighbours on one surface, so the median tells noise from form.
class RangeNoise {
 public:
  RangeNoise(const Ends& ends, const std::vector<Line>& lines, const std::vector<Eigen::Vector2d>& beams,
             const NormalOptions& options) {
    std::vector<double> errors_m;
    for (std::size_t i = 0; i < lines.size(); ++i) {
      if (!lines[i].is_there() || lines[i].sine(beams[i]) * options.reach_beams < 1) continue;
      if (const auto aside_m = ends.stands_aside_m(i, lines[i])) {
        errors_m.push_back(*aside_m / lines[i].sine(beams[i]));
      }
    }
    if (errors_m.empty()) return;
    const auto middle = errors_m.begin() + static_cast<std::ptrdiff_t>(errors_m.size() / 2);
    std::nth_element(errors_m.begin(), middle, errors_m.end());
    constexpr double sigma_of_median = 1.4826;  // of absolute values, normally distributed
    sigma_m_ = sigma_of_median * *middle;
  }

  /// Whether noise makes a line at a beam as rough as it is, within so many standard deviations.
  bool explains(const Line& line, const Eigen::Vector2d& beam, double sigmas) const {
    return !sigma_m_ || line.roughness_m2 <= sigmas * sigmas * variance_across_m2(line, beam);
  }

  /// Whether a line is as smooth as a surface that is rough by so much, seen with that noise.
  bool is_flat(const Line& line, const Eigen::Vector2d& beam, double max_flatness_m) const {
    return line.roughness_m2 <= max_flatness_m * max_flatness_m + variance_across_m2(line, beam);
  }

  /// Of the end of a beam across a line, or along the beam where there is none.
  double variance_across_m2(const Line& line, const Eigen::Vector2d& beam) const {
    const double across_m = sigma_m_.value_or(0) * (line.is_there() ? line.sine(beam) : 1);
    return across_m * across_m;
  }

 private:
  std::optional<double> sigma_m_;
};

// The smoother of the lines of either side that `serves`, where it is smoother than `line` or that is none.
template <class Serves>
Line smoother_side(const Ends& ends, std::size_t point, Line line, const Serves& serves) {
  for (const std::ptrdiff_t step : {-1, 1}) {
    const Line side = ends.line_at(point, {step});
    if (side.is_there() && (!line.is_there() || side.roughness_m2 < line.roughness_m2) && serves(side))
      line = side;
  }
  return line;
}

// The line of a point, from its neighbours on both sides or on one.
Line line_of(const Ends& ends, std::size_t point, const Line& line, const Eigen::Vector2d& beam,
             const RangeNoise& noise, const NormalOptions& options) {
  const auto is_flat = [&](const Line& its) { return noise.is_flat(its, beam, options.max_flatness_m); };
  const auto is_explained = [&](const Line& its) { return noise.explains(its, beam, options.noise_sigmas); };
  // Through both walls of a corner.
  if (!is_flat(line)) return smoother_side(ends, point, {}, is_flat);
  // Through what stands out, and what it hides.
  if (line.is_there() && line.sine(beam) < options.grazing_sine && !is_explained(line))
    return smoother_side(ends, point, line, is_explained);
  return line;
}

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
        {laser.robot_from_laser * end, Eigen::Vector2d::Zero(), static_cast<std::int32_t>(i), 0, 0});
    reach.push_back(options.reach_beams * range_m * std::abs(scan.bearing_step_rad));
  }
  const Eigen::Vector2d eye(laser.robot_from_laser.x, laser.robot_from_laser.y);
  const Ends ends(points, reach, options);
  std::vector<Line> lines;
  std::vector<Eigen::Vector2d> beams;
  lines.reserve(points.size());
  beams.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    lines.push_back(ends.line_at(i));
    beams.push_back((points[i].position - eye).normalized());
  }
  const RangeNoise noise(ends, lines, beams, options);
  for (std::size_t i = 0; i < points.size(); ++i) {
    Line line = line_of(ends, i, lines[i], beams[i], noise, options);
    points[i].noise_m2 = static_cast<float>(noise.variance_across_m2(line, beams[i]));
    if (!line.is_there()) continue;
    if (line.normal.dot(eye - points[i].position) < 0) {
      line.normal = -line.normal;
      line.off_m = -line.off_m;
    }
    points[i].normal = line.normal;
    points[i].spread_m2 = static_cast<float>(line.spread_m2);
    points[i].line_off_m = static_cast<float>(line.off_m);
  }
  return points;
}

}  // namespace isthmus
