#include "scanmatch/features/scan_features.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "scanmatch/features/circle_fit.hpp"
#include "scanmatch/features/segment_ends.hpp"

namespace isthmus {
namespace {

/// Sine of a beam's angle to a line: flatter beams are taken to be no farther apart on it than at this.
constexpr double min_facing = 0.05;

/// Whether what stands beside a surface lies well behind it on both sides, or brings no return; not at the
/// scan's edge.
bool stands_free(const ScanAround& around, const PointRun& surface, double clear_m) {
  const auto behind = [&](int own, int side) {
    const BeamPoint& last = around.points[static_cast<std::size_t>(own)];
    if (last.beam + side < 0 || last.beam + side >= around.beams) return false;
    const int next = own + side;
    if (next < 0 || next >= static_cast<int>(around.points.size())) return true;
    const BeamPoint& beside = around.points[static_cast<std::size_t>(next)];
    return beside.beam != last.beam + side || beside.range_m > last.range_m + clear_m;
  };
  return behind(surface.first, -1) && behind(surface.last, 1);
}

std::optional<ObservedFeature> pole_of(const ScanAround& around, const PointRun& surface,
                                       const PoleOptions& options) {
  const auto own = around.points.subspan(static_cast<std::size_t>(surface.first),
                                         static_cast<std::size_t>(surface.size()));
  if (own.size() < 4 || (own.back().position - own.front().position).norm() > 2 * options.max_radius_m)
    return std::nullopt;
  if (!stands_free(around, surface, options.clear_m)) return std::nullopt;
  const std::optional<Circle> circle = fit_circle(own, options.max_radius_m);
  if (!circle || circle->radius_m < options.min_radius_m) return std::nullopt;
  if (circle->chi_squared > options.chi_squared_per_point * static_cast<double>(own.size()))
    return std::nullopt;
  const std::optional<Line> line = fit_line(own);
  if (line && line->chi_squared < circle->chi_squared + options.better_than_line.bound(1))
    return std::nullopt;
  const bool known = std::sqrt(circle->covariance(2, 2)) <= options.known_sigma_m;
  const int q = known ? 3 : 2;
  return ObservedFeature{pole_feature(circle->centre, circle->radius_m, known),
                         circle->covariance.topLeftCorner(q, q)};
}

/// Whether two lines that follow one another in a scan end where they meet.
bool meet(const LineRun& one, const LineRun& next, const ScanAround& around,
          const ScanFeatureOptions& options) {
  if (next.points.first - one.points.last > options.segmentation.missing_beams + 1) return false;
  const double sine = std::abs(next.line.across().dot(one.line.along));
  if (sine < std::sin(options.min_corner_rad)) return false;
  const std::optional<Eigen::Vector2d> at = meeting_point(one.line, next.line);
  if (!at) return false;
  const auto spacing = [&](const BeamPoint& point, const Line& line) {
    const double facing = std::abs(line.across().dot(point.position.normalized()));
    return 2 * point.range_m * around.step_rad / std::max(facing, min_facing);
  };
  const BeamPoint& last = around.points[static_cast<std::size_t>(one.points.last)];
  const BeamPoint& first = around.points[static_cast<std::size_t>(next.points.first)];
  return (last.position - *at).norm() < options.corner_gap_m + spacing(last, one.line) &&
         (first.position - *at).norm() < options.corner_gap_m + spacing(first, next.line);
}

/// The corner of two lines, the second to the left of the first: its free side is what lies counter-clockwise
/// from the second wall to the first. Its place follows from each line's shift there, its heading is the mean
/// of both turns.
std::optional<ObservedFeature> corner_of(const Line& right, const Line& left) {
  const std::optional<Eigen::Vector2d> at = meeting_point(right, left);
  if (!at) return std::nullopt;
  const Eigen::Vector2d to_right = -right.along, to_left = left.along;
  const double left_rad = std::atan2(to_left.y(), to_left.x());
  double opening = std::atan2(to_right.y(), to_right.x()) - left_rad;
  if (opening < 0) opening += 2 * std::numbers::pi;
  const Feature corner = corner_feature(*at, left_rad + 0.5 * opening, opening);

  Eigen::Matrix2d shifts;  // of the apex in the corner's axes, to shifts across both lines
  const Eigen::Vector2d x = along(corner), y = -across(corner);
  shifts << right.across().dot(x), right.across().dot(y), left.across().dot(x), left.across().dot(y);
  Eigen::Matrix<double, 2, 4> across_by;  // by (α, ρ) of both
  across_by << -right.along_m(*at), 1, 0, 0, 0, 0, -left.along_m(*at), 1;
  Eigen::Matrix<double, 3, 4> by;
  by.topRows<2>() = shifts.inverse() * across_by;
  by.row(2) << 0.5, 0, 0.5, 0;
  const Eigen::Vector4d variances(right.alpha_variance, right.rho_variance, left.alpha_variance,
                                  left.rho_variance);
  return ObservedFeature{corner, by * variances.asDiagonal() * by.transpose()};
}

/// In the robot's frame. Covariances of segments and corners are in their own frames, those of poles in
/// its axes.
ObservedFeature from_laser(const Pose& robot_from_laser, ObservedFeature seen) {
  seen.feature = robot_from_laser * seen.feature;
  if (seen.feature.kind != FeatureKind::pole) return seen;
  LocalMatrix turn = LocalMatrix::Identity(seen.covariance.rows(), seen.covariance.rows());
  turn.topLeftCorner<2, 2>() << std::cos(robot_from_laser.yaw), -std::sin(robot_from_laser.yaw),
      std::sin(robot_from_laser.yaw), std::cos(robot_from_laser.yaw);
  seen.covariance = turn * seen.covariance * turn.transpose();
  return seen;
}

void add_lines(const std::vector<LineRun>& lines, const ScanAround& around, const Laser& laser,
               const ScanFeatureOptions& options, ScanFeatures& features) {
  for (std::size_t i = 0; i < lines.size(); ++i) {
    LineInScan in_scan{lines[i], std::nullopt, std::nullopt};
    if (i > 0 && meet(lines[i - 1], lines[i], around, options)) in_scan.before = lines[i - 1].line;
    if (i + 1 < lines.size() && meet(lines[i], lines[i + 1], around, options))
      in_scan.after = lines[i + 1].line;
    ScanSegment segment = segment_of(in_scan, around, options.segmentation);
    segment.observed = from_laser(laser.robot_from_laser, segment.observed);
    if (is_sound(segment.observed)) features.segments.push_back(segment);
    if (!in_scan.after) continue;
    const std::optional<ObservedFeature> corner = corner_of(lines[i].line, *in_scan.after);
    if (corner && is_sound(*corner)) features.corners.push_back(from_laser(laser.robot_from_laser, *corner));
  }
}

}  // namespace

std::string_view name(EndKind kind) {
  switch (kind) {
    case EndKind::corner:
      return "corner";
    case EndKind::edge:
      return "edge";
    case EndKind::occluded:
      return "occluded";
    case EndKind::range_limit:
      return "range_limit";
    case EndKind::view_edge:
      return "view_edge";
    case EndKind::unknown:
      break;
  }
  return "unknown";
}

ScanFeatures find_features(const Scan& scan, const Laser& laser, const ScanFeatureOptions& options) {
  const std::vector<BeamPoint> points = beam_points(scan, laser, options.noise);
  const ScanAround around{points, std::abs(scan.bearing_step_rad), static_cast<int>(scan.ranges_m.size()),
                          laser.range_max_m};
  ScanFeatures features;
  for (const PointRun& surface : surfaces(points, around.step_rad, options.segmentation)) {
    const std::optional<ObservedFeature> pole = pole_of(around, surface, options.poles);
    if (pole && is_sound(*pole)) {
      features.poles.push_back(from_laser(laser.robot_from_laser, *pole));
      continue;
    }
    add_lines(lines_of(points, surface, options.segmentation), around, laser, options, features);
  }
  return features;
}

}  // namespace isthmus
