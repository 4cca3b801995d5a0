#include "server/output/grid/picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "server/output/format/atomic_file.hpp"
#include "server/output/format/png.hpp"
#include "server/output/tables/trajectories.hpp"

namespace isthmus {
namespace {

enum Colour : std::uint8_t { wall, unknown, floor, ink, first_robot };

/// Walls, unknown, free, the scale bar; then robots, told apart by the colour-blind too (Okabe and Ito 2008).
const std::vector<Rgb> palette = {{38, 42, 51},  {214, 217, 222}, {252, 252, 252}, {90, 96, 108},
                                  {0, 114, 178}, {213, 94, 0},    {0, 158, 115},   {204, 121, 167},
                                  {230, 159, 0}, {86, 180, 233},  {136, 86, 167},  {120, 94, 60}};

std::uint8_t robot_colour(std::size_t robot) {
  return static_cast<std::uint8_t>(first_robot + robot % (palette.size() - first_robot));
}

std::uint8_t grid_colour(std::uint8_t pixel) {
  if (pixel == OccupancyGrid::occupied) return wall;
  return pixel == OccupancyGrid::free ? floor : unknown;
}

constexpr double line_radius_m = 0.03;
constexpr double dot_radius_m = 0.11;
/// Rows farther apart than this are not one way: a restart, or a robot put back on its map.
constexpr double max_step_m = 1.5;

}  // namespace

Picture::Picture(const OccupancyGrid& grid)
    : resolution_m_(grid.resolution_m),
      left_m_(grid.origin_x_m),
      top_m_(grid.origin_y_m + grid.height * grid.resolution_m),
      width_(grid.width),
      height_(grid.height),
      pixels_(grid.pixels.size()) {
  std::transform(grid.pixels.begin(), grid.pixels.end(), pixels_.begin(), grid_colour);
}

void Picture::line(const Eigen::Vector2d& map_from, const Eigen::Vector2d& map_to, std::size_t robot) {
  const Eigen::Vector2d from = to_pixels(map_from);
  const Eigen::Vector2d to = to_pixels(map_to);
  const int parts = std::max(1, static_cast<int>(std::ceil(2 * (to - from).norm())));
  for (int i = 0; i <= parts; ++i) {
    fill_disc(from + (to - from) * (static_cast<double>(i) / parts), line_radius_m / resolution_m_,
              robot_colour(robot));
  }
}

void Picture::dot(const Eigen::Vector2d& map_point, std::size_t robot) {
  fill_disc(to_pixels(map_point), std::max(1.5, dot_radius_m / resolution_m_), robot_colour(robot));
}

void Picture::scale_bar() {
  double length_m = 1;
  for (const double candidate_m : {2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0}) {
    if (candidate_m / resolution_m_ <= 0.25 * width_) length_m = candidate_m;
  }
  const int length = static_cast<int>(length_m / resolution_m_);
  const int thickness = std::max(2, height_ / 200);
  const int left = 2 * thickness;
  const int bottom = height_ - 2 * thickness;
  for (int column = left; column < left + length; ++column) {
    const bool end = column < left + thickness || column >= left + length - thickness;
    for (int row = bottom - (end ? 3 : 1) * thickness; row < bottom; ++row) set(column, row, ink);
  }
}

void Picture::write(const std::string& path) const {
  AtomicFile file(path);
  file.write(palette_png(width_, height_, pixels_, palette));
  file.commit();
}

Eigen::Vector2d Picture::to_pixels(const Eigen::Vector2d& map_point) const {
  return {(map_point.x() - left_m_) / resolution_m_, (top_m_ - map_point.y()) / resolution_m_};
}

void Picture::fill_disc(const Eigen::Vector2d& centre_pixels, double radius_pixels, std::uint8_t colour) {
  const double reach = std::max(radius_pixels, 0.5);
  for (int row = static_cast<int>(centre_pixels.y() - reach); row <= centre_pixels.y() + reach; ++row) {
    for (int column = static_cast<int>(centre_pixels.x() - reach); column <= centre_pixels.x() + reach;
         ++column) {
      const Eigen::Vector2d pixel_centre(column + 0.5, row + 0.5);
      if ((pixel_centre - centre_pixels).squaredNorm() <= reach * reach) set(column, row, colour);
    }
  }
}

void Picture::set(int column, int row, std::uint8_t colour) {
  if (column < 0 || column >= width_ || row < 0 || row >= height_) return;
  pixels_[static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) +
          static_cast<std::size_t>(column)] = colour;
}

void write_pictures(const MapCopy& map, const RankedIslands& islands, std::size_t first,
                    std::vector<Picture> pictures, const std::string& directory) {
  const auto picture_of = [&](PatchId patch) -> Picture* {
    const int k = islands.rank(patch);
    const bool here = k >= 0 && static_cast<std::size_t>(k) >= first &&
                      static_cast<std::size_t>(k) - first < pictures.size();
    return here ? &pictures[static_cast<std::size_t>(k) - first] : nullptr;
  };
  std::map<std::string, std::size_t> robots;
  for (const std::string& robot : robots_of(map)) robots.emplace(robot, robots.size());

  std::map<std::int32_t, ProjectedRow> previous;  // by session
  for_each_row(map, [&](const ProjectedRow& row) {
    Picture* picture = picture_of(row.patch);
    const Eigen::Vector2d here(row.map_from_robot.x, row.map_from_robot.y);
    const auto last = previous.find(row.session.number);
    if (picture && last != previous.end() && picture_of(last->second.patch) == picture) {
      const Eigen::Vector2d there(last->second.map_from_robot.x, last->second.map_from_robot.y);
      if ((here - there).norm() < max_step_m) picture->line(there, here, robots.at(row.session.robot));
    }
    if (last != previous.end()) previous.erase(last);
    previous.emplace(row.session.number, row);
  });

  for (std::size_t i = 0; i < map.patches.size(); ++i) {
    Picture* picture = picture_of(map.patches[i]->id);
    const auto robot = robots.find(map.patches[i]->robot);
    if (!picture || robot == robots.end()) continue;
    picture->dot({map.poses[i].x, map.poses[i].y}, robot->second);
  }
  for (std::size_t k = 0; k < pictures.size(); ++k) {
    pictures[k].scale_bar();
    pictures[k].write(directory + "/island-" + std::to_string(first + k) + "-trajectory.png");
  }
}

}  // namespace isthmus
