#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "server/output/pictures/canvas.hpp"

namespace isthmus {

/// Values over something else, in one style. Where a value is no number, the line has a gap.
struct PlotSeries {
  WayStyle style;
  std::vector<Eigen::Vector2d> points;
  bool joined = true;      ///< by lines; else each is a marker
  std::size_t marker = 0;  ///< its shape; there are `plot_markers`
};

/// Shapes of markers: disc, square, triangle, diamond, cross.
inline constexpr std::size_t plot_markers = 5;

/// `radius` is in pixels; the shapes are of about the same size.
void draw_marker(Canvas& canvas, const Eigen::Vector2d& at, double radius, std::size_t marker, Rgb colour);

struct PlotText {
  std::string x;  ///< names of the axes, with units
  std::string y;
};

/// A small plot in a box, its axes with round numbers; y begins at zero. Text is `em` high.
void draw_plot(Canvas& canvas, const PixelBox& box, double em, const PlotText& text,
               const std::vector<PlotSeries>& series);

}  // namespace isthmus
