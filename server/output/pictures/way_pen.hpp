#pragma once

#include <vector>

#include "server/output/pictures/map_window.hpp"

namespace isthmus {

/// Draws one way as it comes, point by point, however long it is.
class WayPen {
 public:
  WayPen(Canvas& canvas, const MapWindow& window, const WayStyle& style);
  ~WayPen();
  WayPen(const WayPen&) = delete;
  WayPen& operator=(const WayPen&) = delete;

  /// On from the last point; to a new beginning where that is too far for one step of a robot, as after it
  /// was put back on its map.
  void to(const Eigen::Vector2d& map_point);
  /// Draws what was not drawn yet.
  void lift();

 private:
  void draw();

  Canvas& canvas_;
  MapWindow window_;
  Pen pen_;
  Eigen::Vector2d last_m_ = Eigen::Vector2d::Zero();
  std::vector<Eigen::Vector2d> points_;
};

}  // namespace isthmus
