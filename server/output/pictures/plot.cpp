#include "server/output/pictures/plot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "server/output/pictures/layout.hpp"
#include "server/output/pictures/marks.hpp"
#include "server/output/pictures/sizes.hpp"

namespace isthmus {
namespace {

constexpr double top_em = 2.2, bottom_em = 2.8, left_em = 1.2, right_em = 2;
constexpr double plot_y_tick_step_em = 2.2;
constexpr double marker_em = 0.24;

struct Range {
  double low = 0;
  double high = 1;
};

/// Of x as it is; of y from zero on.
std::array<Range, 2> ranges_of(const std::vector<PlotSeries>& series) {
  const double inf = std::numeric_limits<double>::infinity();
  Range x{inf, -inf}, y{0, 0};
  for (const PlotSeries& one : series)
    for (const Eigen::Vector2d& point : one.points) {
      if (!point.allFinite()) continue;
      x = {std::min(x.low, point.x()), std::max(x.high, point.x())};
      y.high = std::max(y.high, point.y());
    }
  if (!(x.low < x.high)) x = {std::isfinite(x.low) ? x.low : 0, (std::isfinite(x.low) ? x.low : 0) + 1};
  if (!(y.high > 0)) y.high = 1;
  return {x, y};
}

/// The inside of a plot, and where its values are.
struct Axes {
  PixelBox box;
  Range x, y;

  Eigen::Vector2d pixels(const Eigen::Vector2d& value) const {
    return {box.left + (value.x() - x.low) / (x.high - x.low) * box.width(),
            box.bottom - (value.y() - y.low) / (y.high - y.low) * box.height()};
  }
};

void draw_axes(Canvas& canvas, const Axes& axes, double em, double y_step, const PlotText& text) {
  const Pen pen = {.colour = ink::faint, .width_px = 1};
  const Font small = {.size_px = small_em * em, .colour = ink::faint};
  const double tick = tick_em * em;
  canvas.frame(axes.box, pen);
  const double x_step =
      round_length_above(x_tick_step_em * em * (axes.x.high - axes.x.low) / axes.box.width());
  for (const double x : ticks(axes.x.low, axes.x.high, x_step)) {
    const Eigen::Vector2d at = axes.pixels({x, 0});
    canvas.line(std::array{at, Eigen::Vector2d(at.x(), at.y() + tick)}, pen);
    canvas.text(tick_text(x, x_step), {at.x(), at.y() + 1.2 * tick}, {0.5, 0}, small);
  }
  for (const double y : ticks(axes.y.low, axes.y.high, y_step)) {
    const Eigen::Vector2d at = axes.pixels({axes.x.low, y});
    canvas.line(std::array{Eigen::Vector2d(at.x() - tick, at.y()), at}, pen);
    canvas.text(tick_text(y, y_step), {at.x() - 1.5 * tick, at.y()}, {1, 0.5}, small);
  }
  canvas.text(text.x, {(axes.box.left + axes.box.right) / 2, axes.box.bottom + bottom_em * em}, {0.5, 1},
              small);
  canvas.text(text.y, {axes.box.left, axes.box.top - 0.3 * em}, {0, 1}, small);
}

void draw_series(Canvas& canvas, const Axes& axes, double em, const PlotSeries& series) {
  std::vector<Eigen::Vector2d> line;
  const auto flush = [&] {
    if (line.size() > 1)
      canvas.line(
          line, {.colour = series.style.colour, .width_px = way_line_px(em), .dashes = series.style.dashes});
    line.clear();
  };
  for (const Eigen::Vector2d& point : series.points) {
    if (!point.allFinite()) {
      flush();
    } else if (series.joined) {
      line.push_back(axes.pixels(point));
    } else {
      draw_marker(canvas, axes.pixels(point), marker_em * em, series.marker, series.style.colour);
    }
  }
  flush();
}

}  // namespace

void draw_marker(Canvas& canvas, const Eigen::Vector2d& at, double radius, std::size_t marker, Rgb colour) {
  using Corners = std::vector<Eigen::Vector2d>;
  static const std::array<Corners, plot_markers> shapes = {
      Corners{},
      {{-0.9, -0.9}, {0.9, -0.9}, {0.9, 0.9}, {-0.9, 0.9}},
      {{0, -1.25}, {1.15, 0.8}, {-1.15, 0.8}},
      {{0, -1.35}, {1.1, 0}, {0, 1.35}, {-1.1, 0}},
      {}};
  const std::size_t shape = marker % plot_markers;
  if (shape == 0) return canvas.disc(at, radius, colour);
  if (shape + 1 == plot_markers) {
    for (const double side : {-1.0, 1.0})
      canvas.line(std::array{Eigen::Vector2d(at + radius * Eigen::Vector2d(-1, -side)),
                             Eigen::Vector2d(at + radius * Eigen::Vector2d(1, side))},
                  {.colour = colour, .width_px = 0.6 * radius});
    return;
  }
  Corners corners = shapes[shape];
  for (Eigen::Vector2d& corner : corners) corner = at + radius * corner;
  canvas.polygon(corners, colour);
}

void draw_plot(Canvas& canvas, const PixelBox& box, double em, const PlotText& text,
               const std::vector<PlotSeries>& series) {
  auto [x, y] = ranges_of(series);
  const double height = box.height() - (top_em + bottom_em) * em;
  if (height < em) return;
  const double y_step = round_length_above(plot_y_tick_step_em * em * y.high / height);
  y.high = y_step * std::ceil(y.high / y_step - 1e-9);
  double widest = 0;
  for (const double value : ticks(0, y.high, y_step))
    widest = std::max(widest, Canvas::size_of(tick_text(value, y_step), {.size_px = small_em * em}).x());
  const Axes axes{{box.left + widest + left_em * em, box.top + top_em * em, box.right - right_em * em,
                   box.bottom - bottom_em * em},
                  x,
                  y};
  draw_axes(canvas, axes, em, y_step, text);
  canvas.clip(axes.box);
  for (const PlotSeries& one : series) draw_series(canvas, axes, em, one);
  canvas.unclip();
}

}  // namespace isthmus
