#include "tools/evaluate/error_pictures.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>

#include "server/output/format/atomic_file.hpp"
#include "server/output/format/number.hpp"
#include "server/output/grid/grid_files.hpp"
#include "server/output/pictures/island_content.hpp"
#include "server/output/pictures/layout.hpp"
#include "server/output/pictures/map_sheet.hpp"
#include "server/output/pictures/marks.hpp"
#include "server/output/pictures/plot.hpp"
#include "tools/text/csv.hpp"

namespace isthmus {
namespace {

constexpr double plot_em = 15;  ///< height, in lines of text
/// Above zero: a fifth of 1, 2 or 5 is a round number too.
constexpr int scale_steps = 5;
/// Errors farther apart than this along a way do not belong together.
constexpr std::int64_t max_gap_us = 3'000'000;
constexpr double max_gap_m = 1.5;
/// Around the ways where there is no grid.
constexpr double margin_m = 2;
constexpr double casing_times = 1.9;  ///< what surrounds the colours of errors, in widths of their line
constexpr double error_line_times = 2;
constexpr double dot_em = 0.28;
constexpr Rgb true_wall_colour = {213, 94, 0};

using Errors = std::vector<ErrorAt>;

/// The island's grid; where there is none, nothing known around its errors.
OccupancyGrid grid_of(const ErrorPictures& pictures, int island, const Errors& errors) {
  const std::string stem = pictures.output + "/island-" + std::to_string(island);
  if (std::filesystem::exists(stem + ".yaml")) return read_grid(stem);
  MapBox box;
  for (const ErrorAt& one : errors) box.include(one.map_point);
  OccupancyGrid grid;
  grid.origin_x_m = box.low.x() - margin_m;
  grid.origin_y_m = box.low.y() - margin_m;
  const Eigen::Vector2d size = box.high - box.low + Eigen::Vector2d::Constant(2 * margin_m);
  constexpr double max_cells_a_side = 4000;
  grid.resolution_m = std::max(grid.resolution_m, size.maxCoeff() / max_cells_a_side);
  grid.width = static_cast<int>(std::ceil(size.x() / grid.resolution_m));
  grid.height = static_cast<int>(std::ceil(size.y() / grid.resolution_m));
  grid.pixels.assign(static_cast<std::size_t>(grid.width) * static_cast<std::size_t>(grid.height),
                     OccupancyGrid::unknown);
  return grid;
}

/// From yellow for none to dark blue for the largest: what is wrong stands out.
Rgb colour_of(double error_m, double scale_m) { return scale_colour(1 - error_m / scale_m); }

/// Of the robots that have errors the names, by the number of their colours.
std::map<std::size_t, std::string> robots_of(const ErrorPictures& pictures, const Errors& errors) {
  std::set<std::string> names;
  for (const ErrorAt& one : errors) names.insert(one.robot);
  std::map<std::size_t, std::string> index;
  for (std::size_t i = 0; i < pictures.robots.size(); ++i)
    if (names.erase(pictures.robots[i]) > 0) index.emplace(i, pictures.robots[i]);
  for (const std::string& name : names) index.emplace(pictures.robots.size() + index.size(), name);
  return index;
}

/// A robot whose values are markers in the plot.
LegendEntry marker_entry(const std::string& robot, std::size_t index) {
  return {robot, [index](Canvas& canvas, const PixelBox& box, double em) {
            draw_marker(canvas, {(box.left + box.right) / 2, (box.top + box.bottom) / 2}, dot_em * em, index,
                        way_style(index).colour);
          }};
}

Legend legend_of(const ErrorPictures& pictures, const Errors& errors, double scale_m) {
  Legend legend;
  for (int i = scale_steps; i >= 0; --i) {
    const double error_m = scale_m * i / scale_steps;
    const Rgb colour = colour_of(error_m, scale_m);
    legend.push_back({tick_text(error_m, scale_m / scale_steps) + " m off",
                      [colour](Canvas& canvas, const PixelBox& box, double) { canvas.fill(box, colour); }});
  }
  if (!pictures.walls.empty())
    legend.push_back(line_entry("true wall", {.colour = true_wall_colour, .width_px = 1.5}));
  legend.push_back(note_entry("below, over time:"));
  for (const auto& [index, robot] : robots_of(pictures, errors))
    legend.push_back(pictures.joined ? way_entry(robot, way_style(index)) : marker_entry(robot, index));
  return legend;
}

void draw_walls(MapSheet& sheet, const std::vector<TrueWall>& walls, const Pose& map_from_truth) {
  for (const TrueWall& wall : walls)
    sheet.canvas().line(std::array{sheet.window().pixels(map_from_truth * wall.a),
                                   sheet.window().pixels(map_from_truth * wall.b)},
                        {.colour = true_wall_colour, .width_px = 1.5, .opacity = 0.8});
}

bool follows(const ErrorAt& before, const ErrorAt& one) {
  return before.robot == one.robot && one.utime - before.utime < max_gap_us &&
         (one.map_point - before.map_point).norm() < max_gap_m;
}

void draw_way(MapSheet& sheet, const Errors& errors, double scale_m) {
  const MapWindow& window = sheet.window();
  const double width = error_line_times * way_line_px(window.em);
  const auto segments = [&](double times, const auto& colour) {
    for (std::size_t i = 1; i < errors.size(); ++i)
      if (follows(errors[i - 1], errors[i]))
        sheet.canvas().line(
            std::array{window.pixels(errors[i - 1].map_point), window.pixels(errors[i].map_point)},
            {.colour = colour(errors[i]), .width_px = times * width});
  };
  segments(casing_times, [](const ErrorAt&) { return ink::faint; });
  segments(1, [&](const ErrorAt& one) { return colour_of(one.error_m, scale_m); });
}

/// The largest last, so that none hides it.
void draw_dots(MapSheet& sheet, Errors errors, double scale_m) {
  std::ranges::stable_sort(errors, {}, &ErrorAt::error_m);
  const double radius = dot_em * sheet.window().em;
  for (const ErrorAt& one : errors) {
    const Eigen::Vector2d at = sheet.window().pixels(one.map_point);
    sheet.canvas().disc(at, radius + 1, ink::faint);
    sheet.canvas().disc(at, radius, colour_of(one.error_m, scale_m));
  }
}

std::vector<PlotSeries> series_of(const ErrorPictures& pictures, const Errors& errors) {
  std::vector<PlotSeries> series;
  std::int64_t first_utime = errors.front().utime;
  for (const ErrorAt& one : errors) first_utime = std::min(first_utime, one.utime);
  for (const auto& [index, robot] : robots_of(pictures, errors)) {
    PlotSeries own{way_style(index), {}, pictures.joined, index};
    std::int64_t last_utime = first_utime;
    for (const ErrorAt& one : errors) {
      if (one.robot != robot) continue;
      if (one.utime - last_utime > max_gap_us) own.points.push_back({std::nan(""), std::nan("")});
      own.points.push_back({1e-6 * static_cast<double>(one.utime - first_utime), one.error_m});
      last_utime = one.utime;
    }
    series.push_back(std::move(own));
  }
  return series;
}

void write_island(const ErrorPictures& pictures, int island, const Errors& errors, const std::string& file) {
  double most = 0;
  for (const ErrorAt& one : errors) most = std::max(most, one.error_m);
  const double scale_m = round_length_above(std::max(most, 0.01));
  MapSheet sheet(grid_of(pictures, island, errors), error_sheet_text(pictures.what, island, errors),
                 legend_of(pictures, errors, scale_m), plot_em);
  sheet.canvas().clip(sheet.window().box);
  const auto motion = pictures.truth_from_map.find(island);
  if (motion != pictures.truth_from_map.end()) draw_walls(sheet, pictures.walls, inverse(motion->second));
  if (pictures.joined) {
    draw_way(sheet, errors, scale_m);
  } else {
    draw_dots(sheet, errors, scale_m);
  }
  sheet.canvas().unclip();
  draw_plot(sheet.canvas(), sheet.layout().panel, sheet.layout().em,
            {"seconds from the first", "error of " + pictures.what + " in m"}, series_of(pictures, errors));
  sheet.write(file);
}

}  // namespace

std::vector<TrueWall> read_floor_plan(const std::string& file) {
  CsvReader csv(file);
  std::vector<TrueWall> walls;
  while (csv.next())
    walls.push_back({{csv.finite("ax_m"), csv.finite("ay_m")}, {csv.finite("bx_m"), csv.finite("by_m")}});
  return walls;
}

std::vector<ErrorAt> errors_of_poses(const AbsoluteErrors& errors) {
  std::vector<ErrorAt> all;
  for (const IslandErrors& island : errors.islands)
    for (const auto& [robot, pairs] : island.pairs)
      for (const PosePair& pair : pairs) {
        const Eigen::Vector2d there = position(island.truth_from_map * pair.map_from_robot);
        all.push_back({island.island, robot, pair.utime, position(pair.map_from_robot),
                       (there - position(pair.truth_from_robot)).norm()});
      }
  return all;
}

std::vector<ErrorAt> errors_of_relations(const std::vector<TrueRelation>& relations,
                                         const TeamTrajectories& team) {
  std::vector<ErrorAt> all;
  for (const TrueRelation& relation : relations) {
    const auto from = team.pose(relation.robot1, relation.utime1);
    const std::optional<Pose> error = relation_error(relation, team);
    if (!from || !error) continue;
    all.push_back({from->island, relation.robot1, relation.utime1, position(from->map_from_robot),
                   position(*error).norm()});
  }
  std::ranges::stable_sort(all, {}, &ErrorAt::utime);
  return all;
}

SheetText error_sheet_text(const std::string& what, int island, const std::vector<ErrorAt>& errors) {
  double squares = 0, most = 0;
  std::int64_t from_utime = errors.front().utime, to_utime = from_utime;
  for (const ErrorAt& one : errors) {
    squares += one.error_m * one.error_m;
    most = std::max(most, one.error_m);
    from_utime = std::min(from_utime, one.utime);
    to_utime = std::max(to_utime, one.utime);
  }
  return {"Island " + std::to_string(island) + ": error of " + what,
          std::to_string(errors.size()) + " compared with the truth; rmse " +
              fixed(std::sqrt(squares / static_cast<double>(errors.size())), 3) + " m, largest " +
              fixed(most, 3) + " m; " + time_text(from_utime, to_utime)};
}

void write_error_pictures(const ErrorPictures& pictures, const std::string& directory) {
  std::map<int, Errors> by_island;
  for (const ErrorAt& one : pictures.errors) by_island[one.island].push_back(one);
  make_directory(directory);
  for (const auto& [island, errors] : by_island)
    write_island(pictures, island, errors,
                 directory + "/island-" + std::to_string(island) + '-' + pictures.name + ".png");
}

}  // namespace isthmus
