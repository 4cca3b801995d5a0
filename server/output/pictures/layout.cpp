#include "server/output/pictures/layout.hpp"

#include <algorithm>
#include <cmath>

#include "server/output/format/number.hpp"
#include "server/output/pictures/sizes.hpp"

namespace isthmus {
namespace {

constexpr double longest_px = 2400;
constexpr double wanted_px = 1800;
constexpr int max_pixels_per_cell = 6;
/// From this ratio of its sides on a map may be longer, up to so many times.
constexpr double long_ratio = 4;
constexpr double longer_at_most = 2;

/// Of the line's height.
constexpr double title_em = 3.6;
constexpr double x_axis_em = 3;
constexpr double y_name_em = 1.8;
constexpr double tick_gap_em = 0.9;
constexpr double bar_em = 2.2;
constexpr double column_gap_em = 1.5;
/// A map lower than its legend by more than this has it below.
constexpr double low_map_ratio = 2;

double decade(double length) { return std::pow(10, std::floor(std::log10(length))); }

/// Entries in columns of so many rows, the first column first.
std::vector<PixelBox> columns(const SheetParts& parts, const Eigen::Vector2d& left_top, std::size_t rows) {
  std::vector<PixelBox> boxes;
  const double column = parts.legend_width + column_gap_em * parts.em, row = entry_em * parts.em;
  for (std::size_t i = 0; i < parts.legend_entries; ++i) {
    const double left = left_top.x() + column * static_cast<double>(i / rows);
    const auto below = static_cast<double>(i % rows);
    boxes.push_back(
        {left, left_top.y() + row * below, left + parts.legend_width, left_top.y() + row * (below + 1)});
  }
  return boxes;
}

/// Right of the map, in as few columns as its height allows; below everything where it is too low.
std::vector<PixelBox> legend_boxes(const SheetParts& parts, const SheetLayout& layout) {
  const double entry = entry_em * parts.em;
  const double column = entry * static_cast<double>(parts.legend_entries);
  const bool is_low = parts.map_width > low_map_ratio * parts.map_height && column > parts.map_height;
  if (!is_low) {
    const auto rows = static_cast<std::size_t>(std::max(
        {parts.map_height / entry, std::min<double>(12, static_cast<double>(parts.legend_entries)), 1.0}));
    return columns(parts,
                   {std::max(layout.map.right, layout.bar.right) + column_gap_em * parts.em, layout.map.top},
                   rows);
  }
  const double step = parts.legend_width + column_gap_em * parts.em;
  const double across = std::max(1.0, std::floor((parts.map_width + column_gap_em * parts.em) / step));
  const auto rows = static_cast<std::size_t>(std::ceil(static_cast<double>(parts.legend_entries) / across));
  return columns(parts, {layout.map.left, layout.bar.bottom + 0.6 * parts.em},
                 std::max<std::size_t>(rows, 1));
}

}  // namespace

CellScale cell_scale(int width_cells, int height_cells) {
  const double longer = std::max({width_cells, height_cells, 1});
  const double shorter = std::max(std::min(width_cells, height_cells), 1);
  const double stretched = std::clamp(longer / shorter / long_ratio, 1.0, longer_at_most);
  if (longer > longest_px * stretched)
    return {1, static_cast<int>(std::ceil(longer / (longest_px * stretched)))};
  return {std::clamp(static_cast<int>(wanted_px / longer), 1, max_pixels_per_cell), 1};
}

double round_length(double at_most) {
  const double ten = decade(at_most);
  const double times = at_most / ten * (1 + 1e-9);
  return ten * (times >= 5 ? 5 : times >= 2 ? 2 : 1);
}

double round_length_above(double at_least) {
  const double ten = decade(at_least);
  const double times = at_least / ten * (1 - 1e-9);
  return ten * (times <= 1 ? 1 : times <= 2 ? 2 : times <= 5 ? 5 : 10);
}

std::vector<double> ticks(double low, double high, double step) {
  std::vector<double> all;
  for (double i = std::ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; ++i) all.push_back(i * step);
  return all;
}

std::string tick_text(double value, double step) {
  const int decimals = std::max(0, -static_cast<int>(std::floor(std::log10(step) + 1e-9)));
  return fixed(value, decimals);
}

SheetLayout lay_out(const SheetParts& parts) {
  const double em = parts.em;
  SheetLayout layout;
  layout.em = em;
  const double left = margin_em * em;
  layout.title = {left, left, left + parts.title_width, left + title_em * em};
  const double axis = y_name_em * em + parts.tick_width + tick_gap_em * em;
  // Whole pixels, so that cells are as sharp as they are drawn.
  layout.map.left = std::ceil(left + axis);
  layout.map.top = std::ceil(layout.title.bottom);
  layout.map.right = layout.map.left + parts.map_width;
  layout.map.bottom = layout.map.top + parts.map_height;
  layout.y_axis = {left, layout.map.top, layout.map.left, layout.map.bottom};
  layout.x_axis = {layout.map.left, layout.map.bottom, layout.map.right, layout.map.bottom + x_axis_em * em};
  layout.bar = {layout.map.left, layout.x_axis.bottom, layout.map.left + parts.bar_width,
                layout.x_axis.bottom + bar_em * em};
  layout.legend = legend_boxes(parts, layout);

  double right = std::max({layout.map.right, layout.title.right, layout.bar.right});
  double bottom = layout.bar.bottom;
  for (const PixelBox& entry : layout.legend) {
    right = std::max(right, entry.right);
    bottom = std::max(bottom, entry.bottom);
  }
  layout.panel = {layout.map.left, bottom, right, bottom + parts.panel_height};
  layout.width = static_cast<int>(std::ceil(right + margin_em * em));
  layout.height = static_cast<int>(std::ceil(layout.panel.bottom + margin_em * em));
  return layout;
}

}  // namespace isthmus
