#include "server/paths/ground/ground_tile.hpp"

#include <algorithm>
#include <limits>

namespace isthmus {
namespace {

constexpr int side_cells = ground_tile_cells;

/// A cell with hits stays occupied until more than so many times as many patches see free space there, as on
/// the grids that are written.
constexpr int contradiction = 4;

enum Kind : std::uint32_t { covers, hits, presumes };

/// What patches see of the cells of a tile: by cell, the place of a patch among the tile's, and how.
class Views {
 public:
  Views(const Cell& low, std::span<const TilePatch> patches) : low_(low) {
    first_.assign(side_cells * side_cells + 1, 0);
    visit(patches, [this](std::size_t cell, std::uint32_t) { ++first_[cell + 1]; });
    for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
    views_.resize(first_.back());
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    visit(patches, [&](std::size_t cell, std::uint32_t view) { views_[next[cell]++] = view; });
  }

  std::span<std::uint32_t> of(std::size_t cell) {
    return {views_.data() + first_[cell], first_[cell + 1] - first_[cell]};
  }
  static std::size_t patch(std::uint32_t view) { return view / 3; }
  static Kind kind(std::uint32_t view) { return static_cast<Kind>(view % 3); }

 private:
  template <class Visit>
  void visit(std::span<const TilePatch> patches, const Visit& visit) const {
    for (std::size_t i = 0; i < patches.size(); ++i) {
      const auto view = static_cast<std::uint32_t>(3 * i);
      for (int y = 0; y < side_cells; ++y) {
        for (const PatchRaster::Run& run : patches[i].raster->runs(low_.y + y)) {
          const int end = std::min(run.end - low_.x, side_cells);
          for (int x = std::max(run.begin - low_.x, 0); x < end; ++x)
            visit(GroundTile::index(x, y), view + covers);
        }
        visit_columns(y, patches[i].raster->hits(low_.y + y), view + hits, visit);
        visit_columns(y, patches[i].raster->presumed(low_.y + y), view + presumes, visit);
      }
    }
  }

  template <class Visit>
  void visit_columns(int y, std::span<const std::int32_t> columns, std::uint32_t view,
                     const Visit& visit) const {
    for (const std::int32_t column : columns) {
      const int x = column - low_.x;
      if (x >= 0 && x < side_cells) visit(GroundTile::index(x, y), view);
    }
  }

  Cell low_;
  std::vector<std::uint32_t> first_;
  std::vector<std::uint32_t> views_;
};

class Layering {
 public:
  Layering(std::span<const TilePatch> patches, std::span<const std::uint8_t> near)
      : patches_(patches), near_(near) {}

  void add_layers(std::span<std::uint32_t> views, const Eigen::Vector2d& centre, std::vector<Layer>& layers) {
    while (!views.empty()) {
      const std::size_t leader = nearest(views, centre);
      const auto rest = std::stable_partition(views.begin(), views.end(), [&](std::uint32_t view) {
        return near_[leader * patches_.size() + Views::patch(view)] != 0;
      });
      const auto own = views.first(static_cast<std::size_t>(rest - views.begin()));
      layers.push_back({patches_[leader].id, is_occupied(own, patches_[leader].part), false});
      views = views.subspan(own.size());
    }
  }

 private:
  std::size_t nearest(std::span<const std::uint32_t> views, const Eigen::Vector2d& centre) const {
    std::size_t best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (const std::uint32_t view : views) {
      const std::size_t patch = Views::patch(view);
      const double distance = (position(patches_[patch].raster->map_from_patch()) - centre).squaredNorm();
      if (distance < least) {
        least = distance;
        best = patch;
      }
    }
    return best;
  }

  /// Of another part a wall may lie some decimetres off: it bars nothing that this one has seen.
  bool is_occupied(std::span<const std::uint32_t> views, PatchId part) const {
    int hit = 0, covering = 0;
    for (const std::uint32_t view : views) {
      if (patches_[Views::patch(view)].part != part) continue;
      hit += Views::kind(view) == hits;
      covering += Views::kind(view) == covers;
    }
    return hit > 0 && contradiction * hit >= covering;
  }

  std::span<const TilePatch> patches_;
  std::span<const std::uint8_t> near_;
};

}  // namespace

std::optional<CellBox> difference(const GroundTile& one, const GroundTile& other) {
  CellBox box{{side_cells, side_cells}, {0, 0}};  // within the tile
  const auto of = [](const GroundTile& tile, std::size_t cell) {
    return std::span(tile.layers).subspan(tile.first[cell], tile.first[cell + 1] - tile.first[cell]);
  };
  for (int y = 0; y < side_cells; ++y) {
    for (int x = 0; x < side_cells; ++x) {
      const std::size_t cell = GroundTile::index(x, y);
      if (std::ranges::equal(of(one, cell), of(other, cell))) continue;
      box.low = {std::min(box.low.x, x), std::min(box.low.y, y)};
      box.high = {std::max(box.high.x, x + 1), std::max(box.high.y, y + 1)};
    }
  }
  if (box.high.x == 0) return std::nullopt;
  const Cell& at = one.low;
  return CellBox{{at.x + box.low.x, at.y + box.low.y}, {at.x + box.high.x, at.y + box.high.y}};
}

std::vector<std::uint8_t> near_pairs(std::span<const TilePatch> patches, const NearPatches& near) {
  std::vector<std::uint8_t> pairs(patches.size() * patches.size());
  for (std::size_t i = 0; i < patches.size(); ++i)
    for (std::size_t j = 0; j < patches.size(); ++j)
      pairs[i * patches.size() + j] = near.near(patches[i].id, patches[j].id);
  return pairs;
}

GroundTile make_ground_tile(const Cell& low, std::span<const TilePatch> patches,
                            std::span<const std::uint8_t> near) {
  GroundTile tile{low, {0}, {}};
  tile.first.reserve(side_cells * side_cells + 1);
  Views views(low, patches);
  Layering layering(patches, near);
  for (int y = 0; y < side_cells; ++y) {
    for (int x = 0; x < side_cells; ++x) {
      layering.add_layers(views.of(GroundTile::index(x, y)), centre_of({low.x + x, low.y + y}), tile.layers);
      tile.first.push_back(static_cast<std::uint32_t>(tile.layers.size()));
    }
  }
  return tile;
}

}  // namespace isthmus
