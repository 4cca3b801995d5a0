#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <span>

#include "server/paths/ground/cell_line.hpp"
#include "server/paths/ground/ground_keeper.hpp"
#include "server/paths/ground/island_surface.hpp"
#include "server/paths/questions/relative_pose.hpp"
#include "server/paths/roads/pull.hpp"
#include "server/paths/roads/route.hpp"
#include "tests/property/drawn.hpp"
#include "tests/support/ground_scenes.hpp"

namespace isthmus {
namespace {

using testing::any_pose;
using testing::node_at;
using testing::Seen;

constexpr int side = 40;

/// Open ground with so many blocks of 3 x 3 cells in it.
std::shared_ptr<const Ground> scattered(int blocks) {
  std::vector<Cell> at;
  for (int i = 0; i < blocks; ++i) at.push_back({*rc::gen::inRange(0, side), *rc::gen::inRange(0, side)});
  return testing::ground_of(side, [at](int x, int y) {
    for (const Cell& block : at)
      if (std::abs(x - block.x) <= 1 && std::abs(y - block.y) <= 1) return Seen::occupied;
    return Seen::open;
  });
}

RC_GTEST_PROP(GroundProperty, DistancesAreThoseToTheNearestWall, ()) {
  const auto ground = scattered(*rc::gen::inRange(1, 8));
  for (NodeId node = 0; node < static_cast<NodeId>(ground->size()); node += 7) {
    double least = Ground::reach_m;
    for (NodeId other = 0; other < static_cast<NodeId>(ground->size()); ++other) {
      if (!ground->layer(other).occupied) continue;
      const double apart = (ground->centre(node) - ground->centre(other)).norm();
      least = std::min(least, std::max(0.0, apart - std::sqrt(0.5) * ground_cell_m));
    }
    // A brushfire errs by a fraction of a cell where fires from three sides meet.
    RC_ASSERT(std::abs(ground->wall_m(node) - least) <= 0.2 * ground_cell_m);
  }
}

RC_GTEST_PROP(RouteProperty, IsFoundWhereStepsAloneLeadThereAndKeepsClear, ()) {
  const Roadmap roadmap(scattered(*rc::gen::inRange(0, 12)), {0.1, 0.0});
  const Ground& ground = roadmap.ground();
  const NodeId from = node_at(ground, 5, 5), to = node_at(ground, side - 6, side - 6);
  RC_PRE(roadmap.fits(from) && roadmap.fits(to));
  const auto route = find_route(roadmap, from, to, 100'000);
  std::vector<std::uint8_t> reached(ground.size());
  std::vector<NodeId> open{from};
  while (!open.empty()) {
    const NodeId node = open.back();
    open.pop_back();
    if (std::exchange(reached[static_cast<std::size_t>(node)], 1)) continue;
    visit_beside(ground.cell(node), [&](const Cell& beside) {
      const NodeId next = ground.step(node, beside);
      if (next >= 0 && roadmap.fits(next)) open.push_back(next);
    });
  }
  RC_ASSERT(route.has_value() == (reached[static_cast<std::size_t>(to)] != 0));
  if (!route) return;
  const std::vector<NodeId> taut = pull(roadmap, *route);
  RC_ASSERT(length_m(ground, taut) <= length_m(ground, *route) + 1e-9);
  RC_ASSERT(length_m(ground, taut) >= (ground.centre(to) - ground.centre(from)).norm() - 1e-9);
  for (std::size_t i = 1; i < taut.size(); ++i) RC_ASSERT(roadmap.sees(taut[i - 1], taut[i]));
}

/// Cell by cell, as it is defined.
std::optional<NodeId> stepped(const Roadmap& roadmap, NodeId from, const Cell& to) {
  NodeId node = from;
  for (CellLine line(roadmap.ground().cell(from), to); !line.done();) {
    node = roadmap.ground().step(node, line.step());
    if (node < 0 || !roadmap.fits(node)) return std::nullopt;
  }
  return node;
}

NodeId any_room(const Roadmap& roadmap) {
  const auto node = static_cast<NodeId>(*rc::gen::inRange<std::size_t>(0, roadmap.ground().size()));
  return roadmap.fits(node) ? node : -1;
}

RC_GTEST_PROP(RoadmapProperty, LinesOfSightLeapOverOpenGroundAndComeToWhatStepsComeTo, ()) {
  const Roadmap roadmap(scattered(*rc::gen::inRange(0, 6)), {0.05, 0.0});
  for (int i = 0; i < 20; ++i) {
    const NodeId from = any_room(roadmap);
    if (from < 0) continue;
    const Cell to{*rc::gen::inRange(0, side), *rc::gen::inRange(0, side)};
    RC_ASSERT(roadmap.straight(from, to) == stepped(roadmap, from, to));
  }
}

RC_GTEST_PROP(RoadmapProperty, LinesOfSightStayInTheirLayerAsStepsDo, ()) {
  static const testing::Spiral spiral;
  static const Roadmap roadmap = [] {
    GroundKeeper keeper;
    keeper.update(testing::copy_of(spiral.map));
    return Roadmap(keeper.ground(IslandId{0}), {0.1, 0.05});
  }();
  for (int i = 0; i < 20; ++i) {
    const NodeId from = any_room(roadmap);
    if (from < 0) continue;
    const Cell at = roadmap.ground().cell(from);
    const Cell to{at.x + *rc::gen::inRange(-100, 100), at.y + *rc::gen::inRange(-100, 100)};
    RC_ASSERT(roadmap.straight(from, to) == stepped(roadmap, from, to));
  }
}

/// The same layers at the same cells.
bool same_ground(const Ground& a, const Ground& b) {
  if (a.size() != b.size()) return false;
  for (NodeId node = 0; node < static_cast<NodeId>(a.size()); ++node) {
    if (a.cell(node) != b.cell(node) || a.layer(node).leader != b.layer(node).leader ||
        a.layer(node).occupied != b.layer(node).occupied || a.wall_m(node) != b.wall_m(node) ||
        a.unseen_m(node) != b.unseen_m(node) || a.borders_on_unseen(node) != b.borders_on_unseen(node))
      return false;
  }
  return true;
}

RC_GTEST_PROP(GroundKeeperProperty, KeepingUpGivesWhatStartingAnewGives, ()) {
  Map map;
  testing::add_round_way(map, testing::furnished_room(), {{-1, 0, 0}});
  GroundKeeper kept;
  kept.update(testing::copy_of(map));
  for (int change = 0; change < 3; ++change) {
    if (*rc::gen::arbitrary<bool>()) {
      const double x = 0.1 * *rc::gen::inRange(-30, 30);
      testing::add_round_way(map, testing::furnished_room(), {{x, -0.5, 0.1 * change}});
      const PatchId id{map.manifold().next_id().value - 1};
      if (*rc::gen::arbitrary<bool>())
        map.relate(testing::odometry_relation(PatchId{0}, id, map.relative_pose(PatchId{0}, id)));
    } else {
      map.move_island(IslandId{0}, {0.1 * *rc::gen::inRange(-20, 20), 0.3, 0.2});
    }
    kept.update(testing::copy_of(map));
  }
  GroundKeeper anew;
  anew.update(testing::copy_of(map));
  for (const auto& island : map.graph().islands())
    RC_ASSERT(same_ground(*kept.ground(island.front()), *anew.ground(island.front())));
}

/// Rectangles of a plane of several tiles, each of one kind; the last to cover a cell tells what it is.
struct Rectangle {
  Cell low, high;
  Seen seen = Seen::open;
};

Rectangle any_rectangle(int least, int most) {
  const Cell low{*rc::gen::inRange(0, 2 * ground_tile_cells), *rc::gen::inRange(0, 2 * ground_tile_cells)};
  const auto side_cells = [&] { return *rc::gen::inRange(least, most); };
  return {low,
          {low.x + side_cells(), low.y + side_cells()},
          *rc::gen::element(Seen::nothing, Seen::open, Seen::occupied)};
}

IslandSurface::Tiles tiles_of(const std::vector<Rectangle>& rectangles) {
  IslandSurface::Tiles tiles;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      const Cell low{column * ground_tile_cells, row * ground_tile_cells};
      const GroundTile tile = testing::tile_of(low, [&](int x, int y) {
        Seen seen = Seen::nothing;
        for (const Rectangle& one : rectangles)
          if (x >= one.low.x && x < one.high.x && y >= one.low.y && y < one.high.y) seen = one.seen;
        return seen;
      });
      if (!tile.layers.empty())
        tiles.emplace(TilePlace{row, column}, std::make_shared<const GroundTile>(tile));
    }
  }
  return tiles;
}

RC_GTEST_PROP(IslandSurfaceProperty, AfterChangesAnywhereItIsWhatItIsMadeAnew, ()) {
  const auto near = std::make_shared<const NearPatches>();
  std::vector<Rectangle> rectangles;
  for (int i = 0; i < 6; ++i) rectangles.push_back(any_rectangle(20, 2 * ground_tile_cells));
  IslandSurface kept;
  std::unique_ptr<Roadmap> roads;
  for (int change = 0; change < 4; ++change) {
    const IslandSurface::Tiles tiles = tiles_of(rectangles);
    IslandSurface anew;
    kept.update(tiles, *near);
    anew.update(tiles, *near);
    const auto ground = std::make_shared<const Ground>(kept.surfaces(), near);
    RC_ASSERT(same_ground(*ground, Ground(anew.surfaces(), near)));
    const Roadmap made(ground, testing::slim);
    roads = std::make_unique<Roadmap>(ground, testing::slim, std::span<const Zone>(), roads.get());
    RC_ASSERT(roads->squares() == made.squares());
    for (SquareId square = 0; square < static_cast<SquareId>(made.squares()); ++square)
      RC_ASSERT(std::ranges::equal(roads->beside(square), made.beside(square)));
    for (NodeId node = 0; node < static_cast<NodeId>(ground->size()); ++node)
      RC_ASSERT(roads->square(node) == made.square(node) && roads->open_cells(node) == made.open_cells(node));
    rectangles.push_back(any_rectangle(1, 40));
    if (*rc::gen::arbitrary<bool>()) rectangles.erase(rectangles.begin() + *rc::gen::inRange(0, 6));
  }
}

/// Patches in a plane with relations between them, of which some come and go.
RC_GTEST_PROP(NearPatchesProperty, KeepingUpGivesWhatMeasuringAnewGives, ()) {
  Map map;
  const auto add_patch = [&] {
    const PatchId id = map.manifold().next_id();
    map.add(testing::round_patch(testing::furnished_room(), id, {}, 1), any_pose(20));
    return id;
  };
  const auto relate_any = [&](PatchId id) {
    const PatchId other{*rc::gen::inRange(0, id.value)};
    map.relate(testing::odometry_relation(other, id, map.relative_pose(other, id)));
  };
  for (int i = 0; i < 30; ++i)
    if (const PatchId id = add_patch(); i > 0) relate_any(id);
  constexpr double reach_m = 40;
  NearPatches kept(testing::copy_of(map), reach_m);
  for (int change = 0; change < 6; ++change) {
    if (*rc::gen::inRange(0, 3) > 0)
      relate_any(add_patch());
    else
      relate_any(PatchId{*rc::gen::inRange(1, map.manifold().next_id().value)});
    const MapCopy copy = testing::copy_of(map);
    const NearPatches before = kept;
    kept = before.kept_up(copy);
    const NearPatches anew(copy, reach_m);
    std::vector<std::pair<PatchId, PatchId>> changes;
    for (PatchId a{0}; a < map.manifold().next_id(); ++a.value) {
      for (PatchId b{0}; b < map.manifold().next_id(); ++b.value) {
        RC_ASSERT(kept.near(a, b) == anew.near(a, b));
        if (kept.near(a, b)) RC_ASSERT(std::abs(kept.way_m(a, b) - anew.way_m(a, b)) < 1e-3F);
        const bool was_there = b.value < static_cast<int>(copy.patches.size()) && before.way_m(b, b) == 0 &&
                               b.value < map.manifold().next_id().value - 1;
        if (a < b && was_there && before.near(a, b) != kept.near(a, b)) changes.emplace_back(a, b);
      }
    }
    std::vector<std::pair<PatchId, PatchId>> told = kept.changes(before);
    std::erase_if(told,
                  [&](const auto& pair) { return pair.second.value == map.manifold().next_id().value - 1; });
    RC_ASSERT(told == changes);
  }
}

RC_GTEST_PROP(RelativePoseProperty, TheOtherWayRoundIsTheInverseWithItsCovariance, ()) {
  Map map;
  const int patches = *rc::gen::inRange(1, 6);
  for (int i = 0; i < patches; ++i) {
    map.add(testing::round_patch(testing::furnished_room(), PatchId{i}, {}, 1), any_pose(10));
    for (int other = std::max(0, i - 2); other < i; ++other)
      map.relate(testing::odometry_relation(PatchId{other}, PatchId{i},
                                            map.relative_pose(PatchId{other}, PatchId{i})));
  }
  const MapCopy copy = testing::copy_of(map);
  const auto object = [&] {
    const Eigen::Vector3d sigmas(0.01 * *rc::gen::inRange(1, 20), 0.02, 0.01);
    return PlacedObject{{PatchId{*rc::gen::inRange(0, patches)}, any_pose(5)},
                        sigmas.cwiseAbs2().asDiagonal()};
  };
  const PlacedObject a = object(), b = object();
  const auto there = relative_pose(copy, a, b), back = relative_pose(copy, b, a);
  RC_ASSERT(there.refusal == Refusal::none);
  const Pose inverted = inverse(there.a_from_b);
  RC_ASSERT(wrapped_difference(back.a_from_b, inverted).norm() < 1e-9);
  const Eigen::Matrix3d by = inverse_jacobian(there.a_from_b);
  const Eigen::Matrix3d expected = by * there.covariance * by.transpose();
  RC_ASSERT((back.covariance - expected).norm() < 1e-6 * expected.norm());
}

}  // namespace
}  // namespace isthmus
