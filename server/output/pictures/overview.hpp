#pragma once

#include <vector>

#include "server/output/pictures/island_content.hpp"

namespace isthmus {

/// Where islands are on the sheet of all of them, in one scale. Islands stand in rows, in their order.
struct OverviewPlan {
  int width = 0;
  int height = 0;
  double em = 16;
  double pixels_per_m = 1;
  std::vector<PixelBox> labels;  ///< above the map of each island that is shown
  std::vector<PixelBox> maps;
  PixelBox bar;
  std::vector<PixelBox> legend;
};

struct OverviewParts {
  std::vector<Eigen::Vector2d> sizes_m;  ///< of islands, by K
  std::vector<double> label_widths;      ///< in pixels
  double title_width = 0;
  std::size_t legend_entries = 0;
  double legend_width = 0;
};

OverviewPlan plan_overview(const OverviewParts& parts);

/// The sheet of all islands of a map.
class OverviewSheet {
 public:
  OverviewSheet(const std::vector<IslandContent>& contents, const std::vector<MapBox>& boxes,
                const std::vector<std::string>& robots);

  const OverviewPlan& plan() const { return plan_; }
  Canvas& canvas() { return canvas_; }
  bool shows(std::size_t island) const { return island < windows_.size(); }
  const MapWindow& window(std::size_t island) const { return windows_.at(island); }
  void draw(std::size_t island, const OccupancyGrid& grid);

 private:
  std::vector<std::string> labels_;
  Legend legend_;
  OverviewPlan plan_;
  std::vector<MapWindow> windows_;
  Canvas canvas_;
};

}  // namespace isthmus
