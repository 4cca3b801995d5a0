#include "tools/simulate/campaigns/paths/grid_optimum.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <queue>
#include <utility>

namespace isthmus {
namespace {

constexpr float unreached = std::numeric_limits<float>::infinity();
constexpr double half_diagonal_cells = 0.5 * std::numbers::sqrt2;

/// Squared distances along one line to the nearest entry, given those across it (Felzenszwalb and
/// Huttenlocher 2012).
void lower_envelope(std::vector<float>& line) {
  const auto n = static_cast<int>(line.size());
  std::vector<int> vertex;
  std::vector<double> from;
  const auto meet = [&](int p, int q) {
    const auto height = [&](int i) {
      return static_cast<double>(line[static_cast<std::size_t>(i)]) + static_cast<double>(i) * i;
    };
    return (height(q) - height(p)) / (2.0 * (q - p));
  };
  for (int q = 0; q < n; ++q) {
    if (line[static_cast<std::size_t>(q)] == unreached) continue;
    while (!vertex.empty() && meet(vertex.back(), q) <= from.back()) {
      vertex.pop_back();
      from.pop_back();
    }
    from.push_back(vertex.empty() ? -1e18 : meet(vertex.back(), q));
    vertex.push_back(q);
  }
  if (vertex.empty()) return;
  const std::vector<float> before = line;
  std::size_t k = 0;
  for (int q = 0; q < n; ++q) {
    while (k + 1 < vertex.size() && from[k + 1] < q) ++k;
    const int away = q - vertex[k];
    line[static_cast<std::size_t>(q)] =
        static_cast<float>(away * away) + before[static_cast<std::size_t>(vertex[k])];
  }
}

/// Distances between centres, in cells, to the nearest marked cell; row by row.
std::vector<float> distances(const std::vector<std::uint8_t>& marked, int width, int height) {
  std::vector<float> squares(marked.size());
  for (std::size_t i = 0; i < marked.size(); ++i) squares[i] = marked[i] ? 0 : unreached;
  const auto transform = [&](int lines, int length, std::size_t line_step, std::size_t step) {
    std::vector<float> line(static_cast<std::size_t>(length));
    for (int l = 0; l < lines; ++l) {
      float* first = squares.data() + static_cast<std::size_t>(l) * line_step;
      for (std::size_t i = 0; i < line.size(); ++i) line[i] = first[i * step];
      lower_envelope(line);
      for (std::size_t i = 0; i < line.size(); ++i) first[i * step] = line[i];
    }
  };
  const auto row = static_cast<std::size_t>(width);
  transform(width, height, 1, row);
  transform(height, width, row, 1);
  for (float& square : squares) square = std::sqrt(square);
  return squares;
}

/// A step to another cell, and the cells on the way.
struct Step {
  Cell by;
  std::vector<Cell> between;
};

std::vector<Step> steps() {
  std::vector<Step> found;
  for (int y = -4; y <= 4; ++y) {
    for (int x = -4; x <= 4; ++x) {
      if (std::gcd(x, y) != 1) continue;
      Step step{{x, y}, {}};
      constexpr int parts = 64;
      for (int part = 1; part < parts; ++part) {
        const double share = static_cast<double>(part) / parts;
        const Cell on{static_cast<std::int32_t>(std::lround(share * x)),
                      static_cast<std::int32_t>(std::lround(share * y))};
        if (on != Cell{} && on != step.by && (step.between.empty() || on != step.between.back()))
          step.between.push_back(on);
      }
      found.push_back(step);
    }
  }
  return found;
}

}  // namespace

GridOptimum::GridOptimum(const OccupancyGrid& grid, const Footprint& footprint)
    : low_{static_cast<std::int32_t>(std::lround(grid.origin_x_m / ground_cell_m)),
           static_cast<std::int32_t>(std::lround(grid.origin_y_m / ground_cell_m))},
      width_(grid.width),
      height_(grid.height) {
  std::vector<std::uint8_t> unseen(grid.pixels.size());
  occupied_.resize(grid.pixels.size());
  for (int row = 0; row < height_; ++row) {
    for (int column = 0; column < width_; ++column) {
      const std::uint8_t pixel =
          grid.pixels[static_cast<std::size_t>(height_ - 1 - row) * static_cast<std::size_t>(width_) +
                      static_cast<std::size_t>(column)];
      const std::size_t i = index({low_.x + column, low_.y + row});
      occupied_[i] = pixel == OccupancyGrid::occupied;
      unseen[i] = pixel == OccupancyGrid::unknown;
    }
  }
  wall_cells_ = distances(occupied_, width_, height_);
  const std::vector<float> unseen_cells = distances(unseen, width_, height_);
  const double from_wall =
      (footprint.radius_m + footprint.clearance_m) / ground_cell_m + 2 * half_diagonal_cells;
  const double from_unseen = footprint.radius_m / ground_cell_m + half_diagonal_cells;
  has_room_.resize(occupied_.size());
  for (std::int32_t y = low_.y; y < low_.y + height_; ++y) {
    for (std::int32_t x = low_.x; x < low_.x + width_; ++x) {
      const std::size_t i = index({x, y});
      has_room_[i] = wall_cells_[i] >= from_wall && unseen_cells[i] >= from_unseen;
      if (has_room_[i]) room_.push_back({x, y});
    }
  }
}

bool GridOptimum::has(const Cell& cell) const {
  return cell.x >= low_.x && cell.x < low_.x + width_ && cell.y >= low_.y && cell.y < low_.y + height_;
}

std::size_t GridOptimum::index(const Cell& cell) const {
  return static_cast<std::size_t>(cell.y - low_.y) * static_cast<std::size_t>(width_) +
         static_cast<std::size_t>(cell.x - low_.x);
}

bool GridOptimum::has_room(const Cell& cell) const { return has(cell) && has_room_[index(cell)]; }

bool GridOptimum::is_occupied(const Cell& cell) const { return has(cell) && occupied_[index(cell)]; }

bool GridOptimum::is_near_wall(const Eigen::Vector2d& point, double distance_m) const {
  const Cell cell = cell_of(point);
  if (has(cell) && wall_cells_[index(cell)] * ground_cell_m > distance_m + 2 * ground_cell_m) return false;
  const int reach = static_cast<int>(std::ceil(distance_m / ground_cell_m));
  for (int dy = -reach; dy <= reach; ++dy) {
    for (int dx = -reach; dx <= reach; ++dx) {
      const Cell at{cell.x + dx, cell.y + dy};
      if (!is_occupied(at)) continue;
      const Eigen::Array2d aside = (point - centre_of(at)).array().abs() - 0.5 * ground_cell_m;
      if (aside.max(0).matrix().norm() < distance_m) return true;
    }
  }
  return false;
}

void GridOptimum::start_from(const Cell& cell) {
  using Entry = std::pair<float, Cell>;
  static const std::vector<Step> all_steps = steps();
  length_m_.assign(occupied_.size(), unreached);
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> waiting;
  length_m_[index(cell)] = 0;
  waiting.emplace(0.F, cell);
  while (!waiting.empty()) {
    const auto [length, at] = waiting.top();
    waiting.pop();
    if (length > length_m_[index(at)]) continue;
    for (const auto& [by, between] : all_steps) {
      const Cell next{at.x + by.x, at.y + by.y};
      const auto room = [&, from = at](const Cell& on) { return has_room({from.x + on.x, from.y + on.y}); };
      if (!has_room(next) || !std::all_of(between.begin(), between.end(), room)) continue;
      const auto longer = length + static_cast<float>(std::hypot(by.x, by.y) * ground_cell_m);
      if (!(longer < length_m_[index(next)])) continue;
      length_m_[index(next)] = longer;
      waiting.emplace(longer, next);
    }
  }
}

double GridOptimum::length_m(const Cell& to) const { return has(to) ? length_m_[index(to)] : unreached; }

}  // namespace isthmus
