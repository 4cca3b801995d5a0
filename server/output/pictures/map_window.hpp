#pragma once

#include "patches/pose.hpp"
#include "server/output/pictures/canvas.hpp"

namespace isthmus {

/// A rectangle of a canvas that shows a rectangle of an island's plane.
struct MapWindow {
  PixelBox box;
  Eigen::Vector2d left_top_m = Eigen::Vector2d::Zero();  ///< of the map, at the box's left top
  double pixels_per_m = 1;
  double em = 14;  ///< height of a line of text on this sheet

  Eigen::Vector2d pixels(const Eigen::Vector2d& map_point) const {
    return {box.left + (map_point.x() - left_top_m.x()) * pixels_per_m,
            box.top + (left_top_m.y() - map_point.y()) * pixels_per_m};
  }
  Eigen::Vector2d right_bottom_m() const {
    return left_top_m + Eigen::Vector2d(box.width(), -box.height()) / pixels_per_m;
  }
};

}  // namespace isthmus
