#include "server/output/pictures/way_pen.hpp"

#include "server/output/pictures/marks.hpp"

namespace isthmus {
namespace {

/// Rows farther apart than this are not one way: a restart, or a robot put back on its map.
constexpr double max_step_m = 1.5;
/// Shorter steps are not seen.
constexpr double min_step_px = 0.7;
constexpr std::size_t points_at_once = 4096;

}  // namespace

WayPen::WayPen(Canvas& canvas, const MapWindow& window, const WayStyle& style)
    : canvas_(canvas),
      window_(window),
      pen_{.colour = style.colour, .width_px = way_line_px(window.em), .dashes = style.dashes} {}

WayPen::~WayPen() { lift(); }

void WayPen::to(const Eigen::Vector2d& map_point) {
  if (!points_.empty() && (map_point - last_m_).norm() > max_step_m) lift();
  last_m_ = map_point;
  const Eigen::Vector2d at = window_.pixels(map_point);
  if (!points_.empty() && (at - points_.back()).norm() < min_step_px) return;
  points_.push_back(at);
  if (points_.size() < points_at_once) return;
  draw();
  points_ = {at};
}

void WayPen::lift() {
  draw();
  points_.clear();
  pen_.dashes_from_px = 0;
}

void WayPen::draw() {
  if (points_.size() < 2) return;
  canvas_.clip(window_.box);
  canvas_.line(points_, pen_);
  canvas_.unclip();
  for (std::size_t i = 1; i < points_.size(); ++i)
    pen_.dashes_from_px += (points_[i] - points_[i - 1]).norm();
}

}  // namespace isthmus
