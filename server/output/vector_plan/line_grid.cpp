#include "server/output/vector_plan/line_grid.hpp"

#include <algorithm>
#include <cmath>

namespace isthmus {
namespace {

constexpr double cell_m = 1;
constexpr double step_m = 0.5;

/// Points along a line, its ends among them.
template <class Visit>
void walk(const Eigen::Vector2d& from, const Eigen::Vector2d& to, const Visit& visit) {
  const int steps = std::max(1, static_cast<int>(std::ceil((to - from).norm() / step_m)));
  for (int i = 0; i <= steps; ++i) visit(from + (to - from) * (static_cast<double>(i) / steps));
}

int cell_of(double coordinate_m) { return static_cast<int>(std::floor(coordinate_m / cell_m)); }

}  // namespace

void LineGrid::insert(int line, const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  walk(from, to, [&](const Eigen::Vector2d& point) {
    for (int x = cell_of(point.x() - step_m); x <= cell_of(point.x() + step_m); ++x) {
      for (int y = cell_of(point.y() - step_m); y <= cell_of(point.y() + step_m); ++y) {
        std::vector<int>& lines = cells_[{x, y}];
        if (std::find(lines.begin(), lines.end(), line) == lines.end()) lines.push_back(line);
      }
    }
  });
}

std::vector<int> LineGrid::near(const Eigen::Vector2d& from, const Eigen::Vector2d& to) const {
  std::vector<int> lines;
  std::pair<int, int> last{0, 0};
  bool first = true;
  walk(from, to, [&](const Eigen::Vector2d& point) {
    const std::pair<int, int> cell{cell_of(point.x()), cell_of(point.y())};
    if (!first && cell == last) return;
    first = false;
    last = cell;
    const auto found = cells_.find(cell);
    if (found != cells_.end()) lines.insert(lines.end(), found->second.begin(), found->second.end());
  });
  std::sort(lines.begin(), lines.end());
  lines.erase(std::unique(lines.begin(), lines.end()), lines.end());
  return lines;
}

}  // namespace isthmus
