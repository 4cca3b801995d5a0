#pragma once

#include <functional>
#include <string>
#include <vector>

#include "server/output/pictures/canvas.hpp"

namespace isthmus {

/// A line of a legend: `draw` puts the mark into the box left of the text.
struct LegendEntry {
  std::string text;
  std::function<void(Canvas&, const PixelBox&, double em)> draw;
};
using Legend = std::vector<LegendEntry>;

/// Of the widest entry, with its mark.
double legend_width(const Legend& legend, double em);
void draw_legend(Canvas& canvas, const Legend& legend, const std::vector<PixelBox>& boxes, double em);

/// A way as a robot drives it.
LegendEntry way_entry(const std::string& name, const WayStyle& style);
LegendEntry line_entry(const std::string& text, const Pen& pen);
/// Nothing but text, after a gap.
LegendEntry note_entry(const std::string& text);

/// A bar of so many metres with its number, from the box's left end on. Its width with the number.
double scale_bar_width(double length_m, double pixels_per_m, double em);
void draw_scale_bar(Canvas& canvas, const PixelBox& box, double length_m, double pixels_per_m, double em);
/// A round length for the bar of a map that is so many pixels wide.
double scale_bar_length_m(double map_width_px, double pixels_per_m);

}  // namespace isthmus
