#include "server/feature_maps/merging/map_sketch.hpp"

#include <algorithm>

namespace isthmus {
namespace {

/// Of a wall, of which the ends are left out: the share of its length where `is` holds.
template <class Is>
double length_where(const MapWall& wall, const MergingOptions& options, const Is& is) {
  double sum = 0;
  for (double at = options.free_margin_m; at < wall.length_m - options.free_margin_m;
       at += options.free_cell_m)
    if (is(wall.a + at * wall.along)) sum += options.free_cell_m;
  return sum;
}

}  // namespace

WallFate fate_in(const FreeGround& ground, const MapWall& there, const MergingOptions& options) {
  const auto is_free = [&](const Eigen::Vector2d& place) { return ground.is_free(place); };
  if (length_where(there, options, is_free) >= options.min_free_m) return WallFate::contradicted;
  const Eigen::Vector2d before = -options.before_wall_m * there.across();
  const auto is_seen = [&](const Eigen::Vector2d& place) { return ground.is_free(place + before); };
  const double seen = length_where(there, options, is_seen);
  return seen >= options.min_free_m ? WallFate::missed : WallFate::beyond;
}

MapSketch sketch_of(const FeatureState& state, const std::set<int>& robots,
                    const std::vector<const std::vector<FreeView>*>& views, const MergingOptions& options) {
  MapSketch sketch{{}, FreeGround(options), Eigen::Vector2d::Zero(), 0};
  std::vector<MapWall>& walls = sketch.walls;
  for (std::size_t i = 0; i < state.features.size(); ++i) {
    const Feature& f = state.features[i].feature;
    if (f.kind == FeatureKind::segment && robots.contains(state.features[i].robot))
      walls.push_back({f.a, f.b, along(f), length_m(f), i});
  }
  const auto is_longer = [](const MapWall& x, const MapWall& y) {
    return std::pair(-x.length_m, x.feature) < std::pair(-y.length_m, y.feature);
  };
  std::sort(walls.begin(), walls.end(), is_longer);
  if (walls.size() > options.max_walls) walls.resize(options.max_walls);
  for (const MapWall& wall : walls)
    sketch.middle += 0.5 * (wall.a + wall.b) / static_cast<double>(walls.size());
  for (const std::vector<FreeView>* of_journey : views)
    for (const FreeView& view : *of_journey) sketch.free.add(view);
  for (const MapWall& wall : walls)
    if (fate_in(sketch.free, wall, options) == WallFate::contradicted)
      sketch.own_share += 1 / static_cast<double>(walls.size());
  return sketch;
}

MapWall operator*(const Pose& a_from_b, const MapWall& wall_b) {
  MapWall wall = wall_b;
  wall.a = a_from_b * wall_b.a;
  wall.b = a_from_b * wall_b.b;
  wall.along = rotate(a_from_b.yaw, wall_b.along);
  return wall;
}

}  // namespace isthmus
