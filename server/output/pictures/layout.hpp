#pragma once

#include <vector>

#include "server/output/pictures/canvas.hpp"

namespace isthmus {

/// How cells of a grid become pixels; one of the two is 1.
struct CellScale {
  int pixels_per_cell = 1;
  int cells_per_pixel = 1;

  double pixels_per_m(double resolution_m) const {
    return pixels_per_cell / (cells_per_pixel * resolution_m);
  }
};

/// Small maps are enlarged and large ones shrunk to what a screen shows; long and narrow ones are allowed
/// more.
CellScale cell_scale(int width_cells, int height_cells);

/// The largest of 1, 2, 5, 10, 20, 50 … (and .5, .2, .1 …) that is not above a limit > 0.
double round_length(double at_most);
/// The smallest of them that is not below it.
double round_length_above(double at_least);
/// The whole multiples of `step` from low to high.
std::vector<double> ticks(double low, double high, double step);
/// A multiple of `step` with as many decimals as the step has.
std::string tick_text(double value, double step);

/// What is to be put on a sheet, in pixels but for counts.
struct SheetParts {
  double map_width = 0;
  double map_height = 0;
  double em = 14;  ///< height of a line of text, which all gaps are measured in
  double title_width = 0;
  double tick_width = 0;  ///< of the longest number at the y axis
  double bar_width = 0;   ///< of the scale bar with its number
  std::size_t legend_entries = 0;
  double legend_width = 0;  ///< of its longest entry
  double panel_height = 0;  ///< of a plot below; 0: none
};

/// Where everything is on a sheet with one map. Nothing overlaps the map, nor anything else.
struct SheetLayout {
  int width = 0;
  int height = 0;
  double em = 14;
  PixelBox title;  ///< two lines
  PixelBox map;
  PixelBox x_axis;  ///< numbers and name, below the map
  PixelBox y_axis;  ///< to its left
  PixelBox bar;
  std::vector<PixelBox> legend;  ///< of each entry
  PixelBox panel;
};

/// The legend is right of the map; below it where the map is long and low.
SheetLayout lay_out(const SheetParts& parts);

}  // namespace isthmus
