#include "server/output/pictures/map_sheet.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "server/output/pictures/shade.hpp"
#include "server/output/pictures/sizes.hpp"

namespace isthmus {
namespace {

constexpr double y_tick_step_em = 3.5;

double tick_step(double pixels_per_m, double step_px) { return round_length_above(step_px / pixels_per_m); }

SheetParts parts_of(const MapFrame& frame, const SheetText& text, const Legend& legend, double bar_m,
                    double panel_em) {
  const double scale = frame.pixels_per_m;
  SheetParts parts;
  parts.map_width = frame.width_px();
  parts.map_height = frame.height_px();
  parts.em = em_of(parts.map_width, parts.map_height);
  const double em = parts.em;
  parts.title_width = std::max(Canvas::size_of(text.title, {.size_px = title_size_em * em, .bold = true}).x(),
                               Canvas::size_of(text.subtitle, {.size_px = em}).x());
  const double step = tick_step(scale, y_tick_step_em * em);
  const double top_m = frame.left_top_m.y(), bottom_m = top_m - parts.map_height / scale;
  for (const double y : ticks(bottom_m, top_m, step))
    parts.tick_width =
        std::max(parts.tick_width, Canvas::size_of(tick_text(y, step), {.size_px = small_em * em}).x());
  parts.bar_width = scale_bar_width(bar_m, scale, em);
  parts.legend_entries = legend.size();
  parts.legend_width = legend_width(legend, em);
  parts.panel_height = panel_em * em;
  return parts;
}

}  // namespace

MapSheet::MapSheet(const OccupancyGrid& grid, const SheetText& text, const Legend& legend, double panel_em,
                   const MapBox& held)
    : MapSheet(grid, map_frame(grid, held), text, legend, panel_em) {}

MapSheet::MapSheet(const OccupancyGrid& grid, const MapFrame& frame, const SheetText& text,
                   const Legend& legend, double panel_em)
    : bar_m_(scale_bar_length_m(frame.width_px(), frame.pixels_per_m)),
      layout_(lay_out(parts_of(frame, text, legend, bar_m_, panel_em))),
      window_{layout_.map, frame.left_top_m, frame.pixels_per_m, layout_.em},
      canvas_(layout_.width, layout_.height) {
  const double em = layout_.em;
  canvas_.text(text.title, {layout_.title.left, layout_.title.top}, {0, 0},
               {.size_px = title_size_em * em, .bold = true});
  canvas_.text(text.subtitle, {layout_.title.left, layout_.title.top + 1.75 * em}, {0, 0},
               {.size_px = em, .colour = ink::faint});
  canvas_.fill(layout_.map, ink::unknown);
  canvas_.image(shade(grid, frame.cells.cells_per_pixel),
                Eigen::Vector2d(layout_.map.left, layout_.map.top) + frame.grid_px(),
                frame.cells.pixels_per_cell);
  draw_axes();
  draw_scale_bar(canvas_, layout_.bar, bar_m_, window_.pixels_per_m, em);
  draw_legend(canvas_, legend, layout_.legend, em);
}

void MapSheet::draw_axes() {
  const double em = layout_.em, tick = tick_em * em;
  const PixelBox& map = layout_.map;
  const Pen pen = {.colour = ink::faint, .width_px = 1};
  const Font small = {.size_px = small_em * em, .colour = ink::faint};
  canvas_.frame({map.left - 0.5, map.top - 0.5, map.right + 0.5, map.bottom + 0.5}, pen);
  const Eigen::Vector2d low(window_.left_top_m.x(), window_.right_bottom_m().y());
  const Eigen::Vector2d high(window_.right_bottom_m().x(), window_.left_top_m.y());
  const double x_step = tick_step(window_.pixels_per_m, x_tick_step_em * em);
  for (const double x : ticks(low.x(), high.x(), x_step)) {
    const double at = window_.pixels({x, 0}).x();
    canvas_.line(std::array{Eigen::Vector2d(at, map.bottom + 1), Eigen::Vector2d(at, map.bottom + 1 + tick)},
                 pen);
    canvas_.text(tick_text(x, x_step), {at, map.bottom + 1 + 1.2 * tick}, {0.5, 0}, small);
  }
  const double y_step = tick_step(window_.pixels_per_m, y_tick_step_em * em);
  for (const double y : ticks(low.y(), high.y(), y_step)) {
    const double at = window_.pixels({0, y}).y();
    canvas_.line(std::array{Eigen::Vector2d(map.left - 1 - tick, at), Eigen::Vector2d(map.left - 1, at)},
                 pen);
    canvas_.text(tick_text(y, y_step), {map.left - 1 - 1.8 * tick, at}, {1, 0.5}, small);
  }
  canvas_.text("x in m", {(map.left + map.right) / 2, layout_.x_axis.bottom}, {0.5, 1}, small);
  canvas_.text_upwards("y in m", {layout_.y_axis.left, (map.top + map.bottom) / 2}, {0.5, 0}, small);
}

}  // namespace isthmus
