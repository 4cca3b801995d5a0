#include "scanmatch/features/segment_ends.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace isthmus {
namespace {

/// What a corner says of the other wall, that wall says itself: counted at a ninth here, two corners add at
/// most a fifth to a wall's weight.
constexpr double shared_weight = 9;

/// One end of a segment: where along the line, and how it errs with (α, ρ) of the line at its centre and by
/// itself.
struct End {
  EndKind kind = EndKind::unknown;
  double along_m = 0;
  double by_across = 0;  ///< d along / d (shift of the line across itself, there)
  double variance = 0;   ///< m², independent of the line's own
};

/// Where the line meets the ray of a bearing; nothing where that is behind the laser.
std::optional<double> along_on_ray(const Line& line, double bearing_rad) {
  const Eigen::Vector2d ray(std::cos(bearing_rad), std::sin(bearing_rad));
  const double facing = line.across().dot(ray);
  if (std::abs(facing) < 1e-6) return std::nullopt;
  const double range = line.across().dot(line.centre) / facing;
  if (!(range > 0)) return std::nullopt;
  return line.along_m(range * ray);
}

/// How far the next two beams' ends lie behind the line, the nearer one counts; negative where the next one
/// lies before it; 0 where beams are missing or it is within its noise.
double behind_m(const Line& line, const BeamPoint& last, int side, const ScanAround& around, int point,
                const SegmentationOptions& options) {
  const Eigen::Vector2d across = line.across();
  double nearest = std::numeric_limits<double>::infinity();
  for (int k = 1; k <= 2; ++k) {
    const int next = point + k * side;
    if (next < 0 || next >= static_cast<int>(around.points.size())) return k == 1 ? 0 : nearest;
    const BeamPoint& beside = around.points[static_cast<std::size_t>(next)];
    if (beside.beam != last.beam + k * side) return k == 1 ? 0 : nearest;
    const double depth = line.across_m(beside.position);
    const double noise =
        across.dot(beside.covariance * across) + across_variance(line, line.along_m(beside.position));
    if (std::abs(depth) < options.worst_sigmas * std::sqrt(noise)) return 0;
    nearest = std::min(nearest, depth);
  }
  return nearest;
}

EndKind kind_beside(const Line& line, const BeamPoint& last, int side, const ScanAround& around, int point,
                    const SegmentationOptions& options) {
  const int beam = last.beam + side;
  if (beam < 0 || beam >= around.beams) return EndKind::view_edge;
  const double bearing = last.bearing_rad + side * around.step_rad;
  const std::optional<double> along = along_on_ray(line, bearing);
  const double range = along ? line.at(*along).norm() : std::numeric_limits<double>::infinity();
  if (range > around.range_max_m) return EndKind::range_limit;
  const double behind = behind_m(line, last, side, around, point, options);
  if (behind > options.edge_m) return EndKind::edge;
  return behind < 0 ? EndKind::occluded : EndKind::unknown;
}

/// Half of what lies between the last beam on the line and the next one.
double half_spacing(const Line& line, const BeamPoint& last, int side, const ScanAround& around) {
  const double own = line.along_m(last.position);
  const std::optional<double> next = along_on_ray(line, last.bearing_rad + side * around.step_rad);
  const double spacing = next ? std::abs(*next - own) : last.range_m * around.step_rad;
  return 0.5 * spacing;
}

End end_of(const LineInScan& in_scan, int side, const ScanAround& around,
           const SegmentationOptions& options) {
  const Line& line = in_scan.run.line;
  const int point = side < 0 ? in_scan.run.points.first : in_scan.run.points.last;
  const BeamPoint& last = around.points[static_cast<std::size_t>(point)];
  const std::optional<Line>& other = side < 0 ? in_scan.before : in_scan.after;
  const double half = half_spacing(line, last, side, around);
  End end;
  end.along_m = line.along_m(last.position);
  if (other) {
    const Eigen::Vector2d at = meeting_point(line, *other).value_or(last.position);
    const double sine = other->across().dot(line.along);
    end.kind = EndKind::corner;
    end.along_m = line.along_m(at);
    end.by_across = -line.across().dot(other->across()) / sine;
    end.variance = shared_weight * across_variance(*other, other->along_m(at)) / (sine * sine);
    return end;
  }
  end.kind = kind_beside(line, last, side, around, point, options);
  if (end.kind != EndKind::edge) return end;
  end.along_m += side * half;
  end.variance = half * half / 3 + line.along.dot(last.covariance * line.along);
  return end;
}

/// Of (α, ρ at the middle, d_A, d_B) by (α, ρ at the centre), and what the ends add by themselves.
Eigen::Matrix4d covariance_of(const Line& line, const End& a, const End& b) {
  const double middle = 0.5 * (a.along_m + b.along_m);
  Eigen::Matrix<double, 4, 2> by;
  by << 1, 0, -middle, 1, -a.by_across * a.along_m, a.by_across, -b.by_across * b.along_m, b.by_across;
  const Eigen::Vector2d own(line.alpha_variance, line.rho_variance);
  Eigen::Matrix4d covariance = by * own.asDiagonal() * by.transpose();
  covariance(2, 2) += a.variance;
  covariance(3, 3) += b.variance;
  return covariance;
}

}  // namespace

ScanSegment segment_of(const LineInScan& in_scan, const ScanAround& around,
                       const SegmentationOptions& options) {
  const Line& line = in_scan.run.line;
  const End a = end_of(in_scan, -1, around, options), b = end_of(in_scan, 1, around, options);
  ScanSegment segment;
  segment.end_a = a.kind;
  segment.end_b = b.kind;
  segment.points = in_scan.run.points.size();
  segment.observed.feature =
      segment_feature(line.at(a.along_m), line.at(b.along_m), is_real(a.kind), is_real(b.kind));
  const std::array<bool, 4> known = known_components(segment.observed.feature);
  const LocalMatrix rows = rows_of(LocalMatrix(covariance_of(line, a, b)), known);
  segment.observed.covariance = rows_of(LocalMatrix(rows.transpose()), known);
  return segment;
}

}  // namespace isthmus
