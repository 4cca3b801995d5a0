#pragma once

#include <string>

#include "server/output/grid/grid.hpp"
#include "server/output/pictures/layout.hpp"
#include "server/output/pictures/legend.hpp"
#include "server/output/pictures/map_frame.hpp"
#include "server/output/pictures/map_window.hpp"

namespace isthmus {

struct SheetText {
  std::string title;
  std::string subtitle;
};

/// A picture of one island's grid: beside the map, and never on it, title, axes in metres, a scale bar with
/// its number, and a legend; and below all that a panel, where one is asked for.
class MapSheet {
 public:
  /// `panel_em`: height of the panel in lines of text; `held`: of all that is to be drawn on the map.
  MapSheet(const OccupancyGrid& grid, const SheetText& text, const Legend& legend, double panel_em = 0,
           const MapBox& held = {});

  const SheetLayout& layout() const { return layout_; }
  const MapWindow& window() const { return window_; }
  Canvas& canvas() { return canvas_; }
  double scale_bar_m() const { return bar_m_; }

  void write(const std::string& path) const { canvas_.write(path); }

 private:
  MapSheet(const OccupancyGrid& grid, const MapFrame& frame, const SheetText& text, const Legend& legend,
           double panel_em);
  void draw_axes();

  double bar_m_;
  SheetLayout layout_;
  MapWindow window_;
  Canvas canvas_;
};

}  // namespace isthmus
