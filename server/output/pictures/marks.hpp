#pragma once

#include <string>
#include <vector>

#include "server/output/pictures/canvas.hpp"
#include "server/output/pictures/legend.hpp"
#include "server/output/pictures/map_window.hpp"

namespace isthmus {

/// Widths of lines and sizes of marks follow the height of a line of text.
double way_line_px(double em);
double legend_line_px(double em);

/// Where a robot's way begins: a ring, with a stroke to where it looks.
void draw_start(Canvas& canvas, const MapWindow& window, const Pose& map_from_robot, const WayStyle& style);
/// Where it ends: an arrowhead to where it looks.
void draw_end(Canvas& canvas, const MapWindow& window, const Pose& map_from_robot, const WayStyle& style);
void draw_patch(Canvas& canvas, const MapWindow& window, const Eigen::Vector2d& map_point, Rgb colour);
void draw_tag(Canvas& canvas, const MapWindow& window, const Eigen::Vector2d& map_point);
/// How a closure's arc is drawn.
struct ClosureStyle {
  bool is_merge = false;
  double opacity = 1;  ///< less: thin too, and without ends
};
/// Of one of so many closed loops on a picture: many are faint, or nothing else would be seen.
ClosureStyle loop_style(std::size_t loops);
/// An arc between two patches that a closure relates: ways run straight between them as often as not.
void draw_closure(Canvas& canvas, const MapWindow& window, const Eigen::Vector2d& map_from,
                  const Eigen::Vector2d& map_to, const ClosureStyle& style);
/// The middle of that arc, in the map.
Eigen::Vector2d closure_middle(const Eigen::Vector2d& map_from, const Eigen::Vector2d& map_to);
/// The ellipse that holds a point of that covariance (in the map's axes, m²) with 95 %, enlarged so many
/// times.
void draw_ellipse(Canvas& canvas, const MapWindow& window, const Eigen::Vector2d& map_point,
                  const Eigen::Matrix2d& covariance, double times, const Pen& pen);

LegendEntry start_entry();
LegendEntry end_entry();
LegendEntry patch_entry();
LegendEntry tag_entry();
/// `named`: with their ids.
LegendEntry closure_entry(const ClosureStyle& style, bool named);

/// Words on a map, each where it covers none of those before, as near to its point as can be, and inside the
/// window.
class Labels {
 public:
  explicit Labels(const MapWindow& window) : window_(window) {}
  void draw(Canvas& canvas, const std::string& text, const Eigen::Vector2d& map_point, const Font& font);
  /// Nothing is written over the mark of a start or end at that point.
  void keep_free(const Eigen::Vector2d& map_point);
  const std::vector<PixelBox>& taken() const { return taken_; }

 private:
  MapWindow window_;
  std::vector<PixelBox> taken_;
};

}  // namespace isthmus
