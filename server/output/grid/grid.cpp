#include "server/output/grid/grid.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <tuple>

#include "server/output/grid/coverage.hpp"
#include "server/output/grid/hits.hpp"
#include "server/output/grid/lattice.hpp"

namespace isthmus {
namespace {

/// Cells around everything seen, so that a picture does not end at a wall.
constexpr double margin_cells = 4;

/// A cell with hits stays occupied until more than so many times as many patches see free space there: a wall
/// is hit by many and grazed by some, a passer-by is hit once and seen through ever after.
constexpr int contradiction = 4;

/// Cells grow by at least so much at a time until there are few enough.
constexpr double min_coarser = 1.01;

/// Poses farther out than this are no places.
constexpr double farthest_m = 1e7;

std::vector<PlacedPatch> place(const MapCopy& map, const std::vector<PatchId>& ids) {
  std::vector<PlacedPatch> placed;
  for (const PatchId id : ids) {
    const auto i = static_cast<std::size_t>(id.value);
    const PlacedPatch one{*map.patches[i], map.poses[i]};
    if (is_on_grid(one)) placed.push_back(one);
  }
  return placed;
}

MapBox bounds_of(std::span<const PlacedPatch> placed) {
  MapBox bounds;
  for (const PlacedPatch& one : placed) {
    const MapBox box = box_on_grid(one);
    bounds.include(box.low);
    bounds.include(box.high);
  }
  if (placed.empty()) bounds.include(Eigen::Vector2d::Zero());
  return bounds;
}

Lattice lattice_over(const MapBox& bounds, double resolution_m, std::size_t max_pixels) {
  const auto cut = [&bounds](double cell_m) {
    const Eigen::Vector2d low = (bounds.low / cell_m).array().floor() - margin_cells;
    const Eigen::Vector2d high = (bounds.high / cell_m).array().floor() + (margin_cells + 1);
    return std::tuple<Eigen::Vector2d, Eigen::Vector2d>(low, high - low);
  };
  const auto most = static_cast<double>(max_pixels);
  auto [low, size] = cut(resolution_m);
  while (size.x() * size.y() > most) {
    resolution_m *= std::max(min_coarser, std::sqrt(size.x() * size.y() / most));
    std::tie(low, size) = cut(resolution_m);
  }
  return {resolution_m, low.x(), low.y(), static_cast<int>(size.x()), static_cast<int>(size.y())};
}

std::uint8_t pixel(int hits, int covering) {
  if (hits > 0 && contradiction * hits >= covering) return OccupancyGrid::occupied;
  return covering > 0 ? OccupancyGrid::free : OccupancyGrid::unknown;
}

}  // namespace

bool is_on_grid(const PlacedPatch& placed) {
  const Pose& pose = placed.map_from_patch;
  return placed.patch.tag < 0 && is_finite(pose) && std::hypot(pose.x, pose.y) <= farthest_m;
}

MapBox box_on_grid(const PlacedPatch& placed) {
  const auto& [patch, map_from_patch] = placed;
  MapBox box;
  box.include(position(map_from_patch));
  for (const PolygonWithHoles& polygon : patch.free_space.polygons()) {
    for (const Eigen::Vector2d& corner : polygon.outer) box.include(map_from_patch * corner);
  }
  for (const ScanPoint& point : patch.points) {
    if (within_free_space_range(patch, point)) box.include(map_from_patch * point.position);
  }
  return box;
}

std::vector<std::uint8_t> render_cells(std::span<const PlacedPatch> placed, const Lattice& lattice) {
  Coverage coverage(lattice);
  Hits hits(lattice);
  for (const auto& [patch, map_from_patch] : placed) {
    coverage.add(patch.free_space, map_from_patch);
    hits.add(patch, map_from_patch);
  }
  std::vector<std::uint8_t> pixels;
  pixels.reserve(lattice.size());
  for (int row = lattice.height - 1; row >= 0; --row) {
    const std::span<const std::int32_t> steps = coverage.steps_of_row(row);
    int covering = 0;
    for (int column = 0; column < lattice.width; ++column) {
      covering += steps[static_cast<std::size_t>(column)];
      pixels.push_back(pixel(hits.count(column, row), covering));
    }
  }
  return pixels;
}

MapBox island_box(const MapCopy& map, const std::vector<PatchId>& island_patches) {
  return bounds_of(place(map, island_patches));
}

OccupancyGrid render_island(const MapCopy& map, const std::vector<PatchId>& island_patches,
                            double resolution_m, std::size_t max_pixels) {
  const std::vector<PlacedPatch> placed = place(map, island_patches);
  const Lattice lattice =
      lattice_over(bounds_of(placed), resolution_m, std::max<std::size_t>(max_pixels, 400));
  return {lattice.resolution_m,
          lattice.column0 * lattice.resolution_m,
          lattice.row0 * lattice.resolution_m,
          lattice.width,
          lattice.height,
          render_cells(placed, lattice)};
}

}  // namespace isthmus
