#include "server/paths/ground/patch_raster.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "server/output/grid/coverage.hpp"
#include "server/output/grid/hits.hpp"
#include "server/paths/ground/beam_gaps.hpp"

namespace isthmus {
namespace {

/// Free cells of a row of a lattice, from the steps of their count.
void add_runs(std::span<const std::int32_t> steps, std::int32_t column0,
              std::vector<PatchRaster::Run>& runs) {
  std::int32_t covering = 0;
  std::int32_t begin = 0;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (steps[i] == 0) continue;
    const auto column = column0 + static_cast<std::int32_t>(i);
    const std::int32_t before = covering;
    covering += steps[i];
    if (before <= 0 && covering > 0) begin = column;
    if (before > 0 && covering <= 0) runs.push_back({begin, column});
  }
  if (covering > 0) runs.push_back({begin, column0 + static_cast<std::int32_t>(steps.size())});
}

template <class Has>
void add_within(const MapBox& box, const Has& has, std::vector<Cell>& cells) {
  const Cell first = cell_of(box.low), last = cell_of(box.high);
  for (std::int32_t y = first.y; y <= last.y; ++y)
    for (std::int32_t x = first.x; x <= last.x; ++x)
      if (has(centre_of({x, y}))) cells.push_back({x, y});
}

void add_around(const Eigen::Vector2d& point, double radius_m, std::vector<Cell>& cells) {
  MapBox box;
  box.include(point.array() - radius_m);
  box.include(point.array() + radius_m);
  add_within(
      box, [&](const Eigen::Vector2d& centre) { return (centre - point).norm() <= radius_m; }, cells);
}

void add_beam_gaps(const PlacedPatch& placed, std::vector<Cell>& cells) {
  const Pose map_from_laser = placed.map_from_patch * placed.patch.laser.robot_from_laser;
  const Pose patch_from_map = inverse(placed.map_from_patch);
  for (const BeamGap& gap : find_beam_gaps(placed.patch)) {
    // No wider than `max_gap_m`: what bulges out beyond the chord is less than a cell.
    MapBox box;
    box.include(position(map_from_laser));
    for (const double bearing : {gap.from_rad, gap.to_rad})
      box.include(map_from_laser *
                  Eigen::Vector2d(gap.range_m * std::cos(bearing), gap.range_m * std::sin(bearing)));
    const auto has = [&](const Eigen::Vector2d& centre) {
      return lies_in(gap, placed.patch.laser, patch_from_map * centre);
    };
    add_within(box, has, cells);
  }
}

}  // namespace

PatchRaster::PatchRaster(const PlacedPatch& placed, std::span<const Eigen::Vector2d> stood)
    : map_from_patch_(placed.map_from_patch) {
  std::vector<Eigen::Vector2d> map_points{position(map_from_patch_)};
  for (const Eigen::Vector2d& point : stood) map_points.push_back(map_from_patch_ * point);
  MapBox box = box_on_grid(placed);
  for (const Eigen::Vector2d& point : map_points) {
    box.include(point.array() - stood_m);
    box.include(point.array() + stood_m);
  }
  low_ = cell_of(box.low);
  const Cell last = cell_of(box.high);
  high_ = {last.x + 1, last.y + 1};
  const Lattice lattice{ground_cell_m, static_cast<double>(low_.x), static_cast<double>(low_.y),
                        high_.x - low_.x, high_.y - low_.y};
  Coverage coverage(lattice);
  Hits hits(lattice);
  coverage.add(placed.patch.free_space, map_from_patch_);
  hits.add(placed.patch, map_from_patch_);
  for (int row = 0; row < lattice.height; ++row) {
    add_runs(coverage.steps_of_row(row), low_.x, runs_);
    first_run_.push_back(static_cast<std::uint32_t>(runs_.size()));
    for (int column = 0; column < lattice.width; ++column)
      if (hits.count(column, row) > 0) hits_.columns.push_back(low_.x + column);
    hits_.end_row();
  }
  std::vector<Cell> cells;
  for (const Eigen::Vector2d& point : map_points) add_around(point, stood_m, cells);
  add_beam_gaps(placed, cells);
  presume(std::move(cells));
}

void PatchRaster::presume(std::vector<Cell> cells) {
  const auto by_row = [](const Cell& a, const Cell& b) { return std::pair(a.y, a.x) < std::pair(b.y, b.x); };
  std::erase_if(cells, [&](const Cell& cell) {
    return cell.x < low_.x || cell.x >= high_.x || cell.y < low_.y || cell.y >= high_.y;
  });
  std::sort(cells.begin(), cells.end(), by_row);
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  auto cell = cells.begin();
  for (std::int32_t y = low_.y; y < high_.y; ++y) {
    for (; cell != cells.end() && cell->y == y; ++cell) presumed_.columns.push_back(cell->x);
    presumed_.end_row();
  }
}

std::span<const std::int32_t> PatchRaster::Rows::row(std::int32_t number) const {
  if (number < 0 || static_cast<std::size_t>(number) + 1 >= first.size()) return {};
  const auto i = static_cast<std::size_t>(number);
  return {columns.data() + first[i], first[i + 1] - first[i]};
}

std::span<const PatchRaster::Run> PatchRaster::runs(std::int32_t row) const {
  if (row < low_.y || row >= high_.y) return {};
  const auto i = static_cast<std::size_t>(row - low_.y);
  return {runs_.data() + first_run_[i], first_run_[i + 1] - first_run_[i]};
}

}  // namespace isthmus
