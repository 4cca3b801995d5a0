#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/output/grid/grid.hpp"
#include "server/output/tables/islands.hpp"

namespace isthmus {

/// An island as people like to see it: its grid in light colours, the way of each robot in a colour of its
/// own, patches as dots, and a scale bar.
class Picture {
 public:
  explicit Picture(const OccupancyGrid& grid);

  /// `robot` chooses the colour, and runs on when there are more robots than colours.
  void line(const Eigen::Vector2d& map_from, const Eigen::Vector2d& map_to, std::size_t robot);
  void dot(const Eigen::Vector2d& map_point, std::size_t robot);
  void scale_bar();
  void write(const std::string& path) const;

 private:
  Eigen::Vector2d to_pixels(const Eigen::Vector2d& map_point) const;
  void fill_disc(const Eigen::Vector2d& centre_pixels, double radius_pixels, std::uint8_t colour);
  void set(int column, int row, std::uint8_t colour);

  double resolution_m_ = 0.05;
  double left_m_ = 0;
  double top_m_ = 0;
  int width_ = 0;
  int height_ = 0;
  std::vector<std::uint8_t> pixels_;
};

/// Writes island-K-trajectory.png for successive islands, of which `first` is one and each has a picture made
/// from its grid.
void write_pictures(const MapCopy& map, const RankedIslands& islands, std::size_t first,
                    std::vector<Picture> pictures, const std::string& directory);

}  // namespace isthmus
