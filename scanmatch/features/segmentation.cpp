#include "scanmatch/features/segmentation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace isthmus {
namespace {

std::span<const BeamPoint> of(std::span<const BeamPoint> points, const PointRun& run) {
  return points.subspan(static_cast<std::size_t>(run.first), static_cast<std::size_t>(run.size()));
}

bool is_jump(const BeamPoint& one, const BeamPoint& next, double step_rad,
             const SegmentationOptions& options) {
  const int beams = next.beam - one.beam;
  if (beams > options.missing_beams + 1) return true;
  const double turn = std::min(beams * step_rad, 0.5 * options.jump_angle_rad);
  const double slant =
      std::min(one.range_m, next.range_m) * std::sin(turn) / std::sin(options.jump_angle_rad - turn);
  const double noise = options.jump_sigmas * std::sqrt(one.covariance.trace() + next.covariance.trace());
  return (next.position - one.position).norm() > slant + noise;
}

/// The mean χ² of few points scatters by 1 / √freedom: so many times as much is allowed them.
constexpr double short_run_slack = 3;

bool is_straight(std::span<const BeamPoint> points, const Line& line, const SegmentationOptions& options) {
  const double freedom = std::max<double>(1, static_cast<double>(points.size()) - 2);
  const double bound =
      1 + (options.chi_squared_per_point - 1) * std::max(1.0, short_run_slack / std::sqrt(freedom));
  if (line.worst_sigmas <= options.worst_sigmas && line.chi_squared <= bound * freedom) return true;
  return std::all_of(points.begin(), points.end(), [&](const BeamPoint& p) {
    return std::abs(line.across_m(p.position)) < options.step_m;
  });
}

int farthest_from_chord(std::span<const BeamPoint> points, const PointRun& run) {
  const auto at = [&](int i) { return points[static_cast<std::size_t>(i)].position; };
  const Eigen::Vector2d chord = at(run.last) - at(run.first);
  int farthest = run.first + 1;
  double most = -1;
  for (int i = run.first + 1; i < run.last; ++i) {
    const Eigen::Vector2d offset = at(i) - at(run.first);
    const double distance = std::abs(chord.x() * offset.y() - chord.y() * offset.x());
    if (distance > most) {
      most = distance;
      farthest = i;
    }
  }
  return farthest;
}

/// Pieces that are straight, in order. The point of a split is given to the piece after it.
std::vector<LineRun> split(std::span<const BeamPoint> points, const PointRun& surface,
                           const SegmentationOptions& options) {
  std::vector<LineRun> pieces;
  std::vector<PointRun> waiting{surface};
  while (!waiting.empty()) {
    const PointRun run = waiting.back();
    waiting.pop_back();
    if (run.size() < 3) continue;
    const std::optional<Line> line = fit_line(of(points, run));
    if (line && is_straight(of(points, run), *line, options)) {
      pieces.push_back({run, *line});
      continue;
    }
    const int at = farthest_from_chord(points, run);
    waiting.push_back({at, run.last});
    waiting.push_back({run.first, at - 1});
  }
  return pieces;
}

/// Neighbours with few stray points between them that are one line.
std::vector<LineRun> merge(std::span<const BeamPoint> points, const std::vector<LineRun>& pieces,
                           const SegmentationOptions& options) {
  std::vector<LineRun> merged;
  for (const LineRun& piece : pieces) {
    if (!merged.empty() && piece.points.first - merged.back().points.last <= options.missing_beams + 1) {
      const PointRun both{merged.back().points.first, piece.points.last};
      const std::optional<Line> line = fit_line(of(points, both));
      if (line && is_straight(of(points, both), *line, options)) {
        merged.back() = {both, *line};
        continue;
      }
    }
    merged.push_back(piece);
  }
  return merged;
}

double squared_sigmas(const Line& line, const BeamPoint& point) {
  const Eigen::Vector2d across = line.across();
  return std::pow(line.across_m(point.position), 2) / across.dot(point.covariance * across);
}

/// The last point of `one`, for which both lines fit the points around their border best; points that fit
/// neither within `worst_sigmas` stay outside.
void settle_border(std::span<const BeamPoint> points, LineRun& one, LineRun& next,
                   const SegmentationOptions& options) {
  constexpr int reach = 4;
  const int from = std::max(one.points.first + 2, one.points.last - reach);
  const int to = std::min(next.points.last - 2, next.points.first + reach);
  const auto at = [&](int i) -> const BeamPoint& { return points[static_cast<std::size_t>(i)]; };
  double least = std::numeric_limits<double>::infinity();
  int best = one.points.last;
  for (int border = from; border < to; ++border) {
    double cost = 0;
    for (int i = from; i <= to; ++i) cost += squared_sigmas(i <= border ? one.line : next.line, at(i));
    if (cost < least) {
      least = cost;
      best = border;
    }
  }
  one.points.last = best;
  next.points.first = best + 1;
  const double bound = options.worst_sigmas * options.worst_sigmas;
  while (one.points.size() > 3 && squared_sigmas(one.line, at(one.points.last)) > bound) --one.points.last;
  while (next.points.size() > 3 && squared_sigmas(next.line, at(next.points.first)) > bound)
    ++next.points.first;
  one.line = fit_line(of(points, one.points)).value_or(one.line);
  next.line = fit_line(of(points, next.points)).value_or(next.line);
}

}  // namespace

std::vector<PointRun> surfaces(std::span<const BeamPoint> points, double step_rad,
                               const SegmentationOptions& options) {
  std::vector<PointRun> runs;
  const int count = static_cast<int>(points.size());
  int first = 0;
  for (int i = 1; i <= count; ++i) {
    const std::size_t k = static_cast<std::size_t>(i);
    if (i < count && !is_jump(points[k - 1], points[k], step_rad, options)) continue;
    if (i > first) runs.push_back({first, i - 1});
    first = i;
  }
  return runs;
}

std::vector<LineRun> lines_of(std::span<const BeamPoint> points, const PointRun& surface,
                              const SegmentationOptions& options) {
  std::vector<LineRun> lines = merge(points, split(points, surface, options), options);
  for (std::size_t i = 1; i < lines.size(); ++i)
    if (lines[i].points.first - lines[i - 1].points.last <= options.missing_beams + 1)
      settle_border(points, lines[i - 1], lines[i], options);
  std::erase_if(lines, [&](const LineRun& run) {
    const auto own = of(points, run.points);
    return run.points.size() < options.min_points ||
           run.line.along_m(own.back().position) - run.line.along_m(own.front().position) <
               options.min_length_m;
  });
  return lines;
}

}  // namespace isthmus
