#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "server/output/pictures/layout.hpp"
#include "server/output/pictures/overview.hpp"

namespace isthmus {
namespace {

void expect_apart(const std::vector<PixelBox>& boxes, int width, int height) {
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    RC_ASSERT(boxes[i].left >= 0 && boxes[i].top >= 0);
    RC_ASSERT(boxes[i].right <= width && boxes[i].bottom <= height);
    for (std::size_t j = 0; j < i; ++j) RC_ASSERT(!boxes[i].overlaps(boxes[j]));
  }
}

RC_GTEST_PROP(SheetLayoutProperty, NothingIsOnTheMapWhateverItsSize, ()) {
  SheetParts parts;
  parts.map_width = *rc::gen::inRange(1, 4800);
  parts.map_height = *rc::gen::inRange(1, 4800);
  parts.em = *rc::gen::inRange(13, 25);
  parts.title_width = *rc::gen::inRange(0, 3000);
  parts.tick_width = *rc::gen::inRange(0, 100);
  parts.bar_width = *rc::gen::inRange(1, 1300);
  parts.legend_entries = *rc::gen::inRange<std::size_t>(0, 60);
  parts.legend_width = *rc::gen::inRange(10, 600);
  parts.panel_height = *rc::gen::inRange(0, 400);
  const SheetLayout layout = lay_out(parts);
  std::vector<PixelBox> boxes = {layout.map,    layout.title, layout.x_axis,
                                 layout.y_axis, layout.bar,   layout.panel};
  boxes.insert(boxes.end(), layout.legend.begin(), layout.legend.end());
  expect_apart(boxes, layout.width, layout.height);
  RC_ASSERT(layout.map.width() == parts.map_width);
  RC_ASSERT(layout.map.height() == parts.map_height);
}

RC_GTEST_PROP(OverviewPlanProperty, IslandsOfAnySizeStandApart, ()) {
  OverviewParts parts;
  for (std::size_t k = *rc::gen::inRange<std::size_t>(0, 70); k > 0; --k) {
    parts.sizes_m.emplace_back(0.1 * *rc::gen::inRange(0, 5000), 0.1 * *rc::gen::inRange(0, 5000));
    parts.label_widths.push_back(*rc::gen::inRange(50, 300));
  }
  parts.title_width = *rc::gen::inRange(0, 1000);
  parts.legend_entries = *rc::gen::inRange<std::size_t>(0, 43);
  parts.legend_width = *rc::gen::inRange(10, 600);
  const OverviewPlan plan = plan_overview(parts);
  std::vector<PixelBox> boxes = plan.maps;
  boxes.insert(boxes.end(), plan.labels.begin(), plan.labels.end());
  boxes.insert(boxes.end(), plan.legend.begin(), plan.legend.end());
  if (!plan.maps.empty()) boxes.push_back(plan.bar);
  expect_apart(boxes, plan.width, plan.height);
}

RC_GTEST_PROP(CellScaleProperty, CellsOrPixelsAreWhole, ()) {
  const int width = *rc::gen::inRange(1, 40000), height = *rc::gen::inRange(1, 40000);
  const CellScale scale = cell_scale(width, height);
  RC_ASSERT(scale.pixels_per_cell >= 1 && scale.cells_per_pixel >= 1);
  RC_ASSERT(std::min(scale.pixels_per_cell, scale.cells_per_pixel) == 1);
  RC_ASSERT(std::max(width, height) * scale.pixels_per_cell / scale.cells_per_pixel <= 4800);
}

}  // namespace
}  // namespace isthmus
