#include "server/output/pictures/map_sheet.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "server/output/pictures/shade.hpp"
#include "server/output/pictures/sizes.hpp"

namespace isthmus {
namespace {

/// Lines of text on a picture that is shown in whole are then neither tiny nor huge.
constexpr double lines_a_side = 85;
constexpr double least_em = 13, most_em = 32;

constexpr double y_tick_step_em = 3.5;

double em_of(double width_px, double height_px) {
  return std::clamp(std::max(width_px, height_px) / lines_a_side, least_em, most_em);
}

double tick_step(double pixels_per_m, double step_px) { return round_length_above(step_px / pixels_per_m); }

SheetParts parts_of(const OccupancyGrid& grid, const CellScale& cells, const SheetText& text,
                    const Legend& legend, double bar_m, double panel_em) {
  const double scale = cells.pixels_per_m(grid.resolution_m);
  SheetParts parts;
  const auto side = [&](int n) {
    return std::ceil(static_cast<double>(n) / cells.cells_per_pixel) * cells.pixels_per_cell;
  };
  parts.map_width = side(grid.width);
  parts.map_height = side(grid.height);
  parts.em = em_of(parts.map_width, parts.map_height);
  const double em = parts.em;
  parts.title_width = std::max(Canvas::size_of(text.title, {.size_px = title_size_em * em, .bold = true}).x(),
                               Canvas::size_of(text.subtitle, {.size_px = em}).x());
  const double step = tick_step(scale, y_tick_step_em * em);
  const double bottom_m = grid.origin_y_m, top_m = bottom_m + grid.height * grid.resolution_m;
  for (const double y : ticks(bottom_m, top_m, step))
    parts.tick_width =
        std::max(parts.tick_width, Canvas::size_of(tick_text(y, step), {.size_px = small_em * em}).x());
  parts.bar_width = scale_bar_width(bar_m, scale, em);
  parts.legend_entries = legend.size();
  parts.legend_width = legend_width(legend, em);
  parts.panel_height = panel_em * em;
  return parts;
}

MapWindow window_of(const OccupancyGrid& grid, const CellScale& cells, const SheetLayout& layout) {
  return {layout.map,
          {grid.origin_x_m, grid.origin_y_m + grid.height * grid.resolution_m},
          cells.pixels_per_m(grid.resolution_m),
          layout.em};
}

double bar_length_m(const OccupancyGrid& grid) {
  const double scale = cell_scale(grid.width, grid.height).pixels_per_m(grid.resolution_m);
  return scale_bar_length_m(grid.width * grid.resolution_m * scale, scale);
}

}  // namespace

MapSheet::MapSheet(const OccupancyGrid& grid, const SheetText& text, const Legend& legend, double panel_em)
    : bar_m_(bar_length_m(grid)),
      layout_(lay_out(parts_of(grid, cell_scale(grid.width, grid.height), text, legend, bar_m_, panel_em))),
      window_(window_of(grid, cell_scale(grid.width, grid.height), layout_)),
      canvas_(layout_.width, layout_.height) {
  const double em = layout_.em;
  const CellScale cells = cell_scale(grid.width, grid.height);
  canvas_.text(text.title, {layout_.title.left, layout_.title.top}, {0, 0},
               {.size_px = title_size_em * em, .bold = true});
  canvas_.text(text.subtitle, {layout_.title.left, layout_.title.top + 1.75 * em}, {0, 0},
               {.size_px = em, .colour = ink::faint});
  canvas_.image(shade(grid, cells.cells_per_pixel), {layout_.map.left, layout_.map.top},
                cells.pixels_per_cell);
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
