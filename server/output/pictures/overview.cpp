#include "server/output/pictures/overview.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "server/output/pictures/layout.hpp"
#include "server/output/pictures/marks.hpp"
#include "server/output/pictures/shade.hpp"
#include "server/output/pictures/sizes.hpp"

namespace isthmus {
namespace {

constexpr double em_px = 16;
constexpr double marks_em = 0.75;  ///< marks on small maps are smaller
constexpr std::size_t max_islands = 60;
constexpr double rows_width_px = 1700, rows_height_px = 1300;
constexpr double most_pixels_per_m = 60;
constexpr double smaller = 0.93;  ///< scales are tried one after the other
constexpr double least_side_px = 6;
constexpr double heading_em = 4, map_gap_em = 1.5, label_em = 1.6, bar_row_em = 2.6;
constexpr double least_width_px = 320;

/// Rows of islands in a scale; their right and lower ends.
Eigen::Vector2d set_in_rows(const OverviewParts& parts, std::size_t shown, double pixels_per_m,
                            OverviewPlan& plan) {
  plan.labels.clear();
  plan.maps.clear();
  const double left = margin_em * em_px, first_top = (margin_em + heading_em) * em_px;
  double x = left, y = first_top, row_bottom = first_top, right = left;
  for (std::size_t k = 0; k < shown; ++k) {
    const Eigen::Vector2d size = (parts.sizes_m[k] * pixels_per_m).array().ceil().max(least_side_px);
    const double width = std::max(size.x(), parts.label_widths[k]);
    if (x > left && x + width > left + rows_width_px) {
      x = left;
      y = row_bottom + map_gap_em * em_px;
    }
    const double top = y + label_em * em_px;
    plan.labels.push_back({x, y, x + parts.label_widths[k], top});
    plan.maps.push_back(
        {std::round(x), std::round(top), std::round(x) + size.x(), std::round(top) + size.y()});
    row_bottom = std::max(row_bottom, plan.maps.back().bottom);
    right = std::max(right, std::ceil(x) + width);
    x += width + map_gap_em * em_px;
  }
  return {right, row_bottom};
}

std::vector<std::string> labels_of(const std::vector<IslandContent>& contents) {
  std::vector<std::string> labels;
  for (const IslandContent& content : contents)
    labels.push_back("Island " + std::to_string(content.island) + ": " +
                     counted(content.patches, "patch", "patches"));
  return labels;
}

SheetText overview_text(const std::vector<IslandContent>& contents) {
  if (contents.empty()) return {"No island", "nothing has been mapped"};
  std::set<std::size_t> robots;
  std::size_t patches = 0;
  std::int64_t from = contents.front().from_utime, to = contents.front().to_utime;
  for (const IslandContent& content : contents) {
    robots.insert(content.robots.begin(), content.robots.end());
    patches += content.patches;
    from = std::min(from, content.from_utime);
    to = std::max(to, content.to_utime);
  }
  SheetText text{counted(contents.size(), "island", "islands"),
                 counted(robots.size(), "robot", "robots") + ", " + counted(patches, "patch", "patches")};
  if (const std::string time = time_text(from, to); !time.empty()) text.subtitle += "; " + time;
  if (contents.size() > max_islands)
    text.subtitle += "; the " + std::to_string(max_islands) + " with most patches";
  return text;
}

Legend overview_legend(const std::vector<IslandContent>& contents, const std::vector<std::string>& names) {
  std::set<std::size_t> robots;
  for (const IslandContent& content : contents) robots.insert(content.robots.begin(), content.robots.end());
  Legend legend;
  add_robots(legend, {robots.begin(), robots.end()}, names);
  if (!robots.empty()) {
    legend.push_back(start_entry());
    legend.push_back(end_entry());
  }
  return legend;
}

OverviewParts parts_of(const std::vector<MapBox>& boxes, const std::vector<std::string>& labels,
                       const SheetText& text, const Legend& legend) {
  OverviewParts parts;
  for (const MapBox& box : boxes) parts.sizes_m.push_back(box.high - box.low);
  for (const std::string& label : labels)
    parts.label_widths.push_back(Canvas::size_of(label, {.size_px = em_px}).x());
  parts.title_width =
      std::max(Canvas::size_of(text.title, {.size_px = title_size_em * em_px, .bold = true}).x(),
               Canvas::size_of(text.subtitle, {.size_px = em_px}).x());
  parts.legend_entries = legend.size();
  parts.legend_width = legend_width(legend, em_px);
  return parts;
}

}  // namespace

OverviewPlan plan_overview(const OverviewParts& parts) {
  OverviewPlan plan;
  plan.em = em_px;
  const std::size_t shown = std::min(parts.sizes_m.size(), max_islands);
  double widest_m = 1e-3;
  for (std::size_t k = 0; k < shown; ++k) widest_m = std::max(widest_m, parts.sizes_m[k].x());
  plan.pixels_per_m = std::min(most_pixels_per_m, rows_width_px / widest_m);
  const double least_pixels_per_m = least_side_px / widest_m;
  Eigen::Vector2d end = set_in_rows(parts, shown, plan.pixels_per_m, plan);
  while (end.y() > rows_height_px && plan.pixels_per_m > least_pixels_per_m) {
    plan.pixels_per_m *= smaller;
    end = set_in_rows(parts, shown, plan.pixels_per_m, plan);
  }
  const double legend_left = end.x() + 2 * map_gap_em * em_px;
  double right = std::max(end.x(), margin_em * em_px + parts.title_width), bottom = end.y();
  for (std::size_t i = 0; i < parts.legend_entries; ++i) {
    const auto top = [](std::size_t row) {
      return (margin_em + heading_em) * em_px + entry_em * em_px * static_cast<double>(row);
    };
    plan.legend.push_back({legend_left, top(i), legend_left + parts.legend_width, top(i + 1)});
    right = std::max(right, plan.legend.back().right);
    bottom = std::max(bottom, plan.legend.back().bottom);
  }
  if (shown > 0) plan.bar = {margin_em * em_px, end.y() + 0.6 * em_px, end.x(), end.y() + bar_row_em * em_px};
  plan.width = static_cast<int>(std::ceil(std::max(right, least_width_px) + margin_em * em_px));
  plan.height = static_cast<int>(std::ceil(std::max(bottom, plan.bar.bottom) + margin_em * em_px));
  return plan;
}

OverviewSheet::OverviewSheet(const std::vector<IslandContent>& contents, const std::vector<MapBox>& boxes,
                             const std::vector<std::string>& robots)
    : labels_(labels_of(contents)),
      legend_(overview_legend(contents, robots)),
      plan_(plan_overview(parts_of(boxes, labels_, overview_text(contents), legend_))),
      canvas_(plan_.width, plan_.height) {
  const SheetText text = overview_text(contents);
  const Eigen::Vector2d at(margin_em * em_px, margin_em * em_px);
  canvas_.text(text.title, at, {0, 0}, {.size_px = title_size_em * em_px, .bold = true});
  canvas_.text(text.subtitle, at + Eigen::Vector2d(0, 1.75 * em_px), {0, 0},
               {.size_px = em_px, .colour = ink::faint});
  for (std::size_t k = 0; k < plan_.maps.size(); ++k) {
    windows_.push_back(
        {plan_.maps[k], {boxes[k].low.x(), boxes[k].high.y()}, plan_.pixels_per_m, marks_em * em_px});
    canvas_.text(labels_[k], {plan_.labels[k].left, plan_.labels[k].top}, {0, 0}, {.size_px = em_px});
  }
  if (!windows_.empty())
    draw_scale_bar(canvas_, plan_.bar,
                   round_length(std::max(least_side_px, plan_.bar.width() / 4) / plan_.pixels_per_m),
                   plan_.pixels_per_m, em_px);
  draw_legend(canvas_, legend_, plan_.legend, em_px);
}

void OverviewSheet::draw(std::size_t island, const OccupancyGrid& grid) {
  const MapWindow& window = windows_.at(island);
  const double cell_px = grid.resolution_m * window.pixels_per_m;
  const int together = std::max(1, static_cast<int>(std::floor(1 / cell_px)));
  canvas_.clip(window.box);
  canvas_.fill(window.box, ink::unknown);
  canvas_.image(shade(grid, together),
                window.pixels({grid.origin_x_m, grid.origin_y_m + grid.height * grid.resolution_m}),
                cell_px * together);
  canvas_.unclip();
  canvas_.frame(
      {window.box.left - 0.5, window.box.top - 0.5, window.box.right + 0.5, window.box.bottom + 0.5},
      {.colour = ink::faint, .width_px = 1});
}

}  // namespace isthmus
