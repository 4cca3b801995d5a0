#include "server/paths/ground/tile_surface.hpp"

#include <algorithm>
#include <utility>

#include "server/paths/ground/distance_field.hpp"

namespace isthmus {
std::shared_ptr<const GroundTile> with_gaps(const TilesAround& tiles, const NearPatches& near) {
  const GroundTile& tile = tiles.middle();
  const std::vector<GapCell> gaps = find_gaps(GroundWindow(tiles, gap_margin_cells, near));
  const auto is_here = [&](const GapCell& gap) {
    return tile_of(gap.cell.x) == tile_of(tile.low.x) && tile_of(gap.cell.y) == tile_of(tile.low.y);
  };
  if (std::ranges::none_of(gaps, is_here)) return nullptr;
  GroundTile filled{tile.low, {0}, {}};
  filled.first.reserve(tile.first.size());
  filled.layers.reserve(tile.layers.size() + gaps.size());
  auto gap = std::ranges::find_if(gaps, is_here);
  for (std::size_t cell = 0; cell + 1 < tile.first.size(); ++cell) {
    filled.layers.insert(filled.layers.end(), tile.layers.begin() + tile.first[cell],
                         tile.layers.begin() + tile.first[cell + 1]);
    if (gap != gaps.end() && GroundTile::index(gap->cell.x - tile.low.x, gap->cell.y - tile.low.y) == cell) {
      filled.layers.push_back({gap->leader, false, true});
      gap = std::find_if(gap + 1, gaps.end(), is_here);
    }
    filled.first.push_back(static_cast<std::uint32_t>(filled.layers.size()));
  }
  return std::make_shared<const GroundTile>(std::move(filled));
}

TileSurface measure_surface(std::shared_ptr<const GroundTile> tile, const TilesAround& tiles,
                            const NearPatches& near) {
  const GroundWindow window(tiles, measured_margin_cells, near);
  std::vector<Source> walls, unseen;
  std::vector<std::uint8_t> borders(window.size());
  for (NodeId node = 0; node < static_cast<NodeId>(window.size()); ++node) {
    const Cell& own = window.cell(node);
    if (window.occupied(node)) walls.push_back({node, own});
    visit_beside(own, [&](const Cell& beside) {
      if (window.step(node, beside) >= 0) return;
      unseen.push_back({node, beside});
      if (beside.x == own.x || beside.y == own.y) borders[static_cast<std::size_t>(node)] = 1;
    });
  }
  const std::vector<float> wall_m = distances_m(window, walls, measured_reach_m);
  // What one stretch does not show is known to another that is near to both.
  const auto is_unseen = [&window](NodeId node, const Cell& cell) { return window.step(node, cell) < 0; };
  const std::vector<float> unseen_m = distances_m(window, unseen, measured_reach_m, is_unseen);
  TileSurface surface{std::move(tile), {}, {}, {}};
  window.visit_middle([&](NodeId node) {
    const auto i = static_cast<std::size_t>(node);
    surface.wall_m.push_back(wall_m[i]);
    surface.unseen_m.push_back(unseen_m[i]);
    surface.borders_on_unseen.push_back(borders[i]);
  });
  return surface;
}

}  // namespace isthmus
