#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "server/paths/ground/zones.hpp"
#include "server/paths/questions/planner.hpp"
#include "tests/support/ground_scenes.hpp"
#include "tests/support/zones.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

double number(int low, int high) { return 0.01 * *rc::gen::inRange(100 * low, 100 * high); }

/// Corners anywhere: a fit may have bent it so that it crosses itself.
Zone any_zone(double size_m) {
  Zone zone;
  const int corners = *rc::gen::inRange(3, 9);
  for (int i = 0; i < corners; ++i) {
    zone.ring.emplace_back(size_m * number(-1, 1), size_m * number(-1, 1));
    zone.box.extend(zone.ring.back());
  }
  return zone;
}

// Row by row, they are the cells that a robot of that radius comes into the zone at.
RC_GTEST_PROP(ZonesProperty, KeptOutCellsAreThoseThatADiscComesIntoTheZoneAt, ()) {
  const Zone zone = any_zone(2);
  const double within_m = number(0, 1);
  const KeptOutCells cells(std::span(&zone, 1), within_m);
  for (int i = 0; i < 100; ++i) {
    const Cell cell{*rc::gen::inRange(-70, 70), *rc::gen::inRange(-70, 70)};
    const Eigen::Vector2d centre = centre_of(cell);
    // At the rim the last digits decide.
    const bool surely_in = comes_into(zone, centre, centre, within_m - 1e-9);
    const bool surely_out = !comes_into(zone, centre, centre, within_m + 1e-9);
    if (surely_in) RC_ASSERT(cells.contains(cell));
    if (surely_out) RC_ASSERT(!cells.contains(cell));
  }
}

/// A hall 20 m long and 6 m wide, and a planner that knows its ground.
struct MappedHall {
  Map map;
  Planner planner;
  MappedHall() {
    Walls walls;
    add_box(walls, -2, -3, 18, 3);
    std::vector<Pose> poses;
    for (int i = 0; i <= 8; ++i) poses.push_back({2.0 * i, 0, 0});
    add_round_way(map, walls, poses);
  }
};

// Whatever is drawn in a hall, and from wherever to wherever: a robot whose way begins outside stays outside.
RC_GTEST_PROP(ZonesProperty, NoPathComesIntoAKeepOutZone, ()) {
  static MappedHall hall;
  constexpr Footprint footprint{0.2, 0.1};
  std::vector<Eigen::Vector2d> ring;
  const Eigen::Vector2d middle(number(2, 14), number(-2, 2));
  const int corners = *rc::gen::inRange(3, 9);
  for (int i = 0; i < corners; ++i) {
    const double angle = 6.2831853 * i / corners;
    ring.emplace_back(middle + 0.5 * number(1, 5) * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
  }
  Annotations annotations;
  RC_ASSERT(annotations.take(annotation(AnnotationKind::keep_out, "z", PatchId{0}, ring), hall.map,
                             on_any_map) == DropReason::none);
  MapCopy copy = copy_of(hall.map);
  copy.annotations = annotations.records(hall.map, on_any_map);
  const Zones zones(copy);
  Planner& planner = hall.planner;
  planner.update(std::make_shared<const MapCopy>(std::move(copy)));
  const Pose from{number(-1, 17), number(-2, 2), 0}, to{number(-1, 17), number(-2, 2), 0};
  const PathQuestion question{{PatchId{0}, from}, {PatchId{0}, to}, footprint};
  const Path path = planner.path(question);
  const double leaves_m = footprint.radius_m + question.start_tolerance_m;
  if (path.refusal != Refusal::none || zones.bars(PatchId{0}, position(from), position(from), leaves_m))
    return;
  for (std::size_t i = 1; i < path.poses.size(); ++i) {
    const Pose a = planner.project(path.poses[i - 1]), b = planner.project(path.poses[i]);
    RC_ASSERT(!zones.bars(PatchId{0}, position(a), position(b), footprint.radius_m));
  }
}

}  // namespace
}  // namespace isthmus
