#include "server/paths/ground/zones.hpp"

#include <gtest/gtest.h>

#include <array>

#include "server/paths/questions/driven_ways.hpp"
#include "server/paths/questions/planner.hpp"
#include "tests/support/ground_scenes.hpp"
#include "tests/support/zones.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

// A hall 20 m long and 6 m wide, on which zones are drawn.
struct Hall {
  Hall() {
    Walls walls;
    add_box(walls, -2, -3, 18, 3);
    std::vector<Pose> poses;
    for (int i = 0; i <= 8; ++i) poses.push_back({2.0 * i, 0, 0});
    add_round_way(map, walls, poses);
  }
  void draw(AnnotationKind kind, const std::string& name, const std::vector<Eigen::Vector2d>& points) {
    ASSERT_EQ(annotations.take(annotation(kind, name, PatchId{0}, points), map, on_any_map),
              DropReason::none);
  }
  void update() {
    MapCopy copy = copy_of(map);
    copy.annotations = annotations.records(map, on_any_map);
    planner.update(std::make_shared<const MapCopy>(std::move(copy)));
  }
  Path path(const Pose& from, const Pose& to) {
    update();
    return planner.path({{PatchId{0}, from}, {PatchId{0}, to}, slim});
  }
  // The nearest that the robot's centre comes to a box.
  double nearest_m(const Path& path, const Eigen::AlignedBox2d& box) const {
    double least = 1e9;
    for (std::size_t i = 1; i < path.poses.size(); ++i) {
      const Eigen::Vector2d a = position(planner.project(path.poses[i - 1]));
      const Eigen::Vector2d b = position(planner.project(path.poses[i]));
      for (int part = 0; part <= 50; ++part)
        least = std::min(least, box.exteriorDistance(Eigen::Vector2d(a + (b - a) * (part / 50.0))));
    }
    return least;
  }

  Map map;
  Annotations annotations;
  Planner planner;
};

TEST(Zones, NoPathLeadsThroughAKeepOutZone) {
  Hall hall;
  const Path straight = hall.path({0, 0, 0}, {16, 0, 0});
  ASSERT_EQ(straight.refusal, Refusal::none);
  EXPECT_LT(straight.length_m, 16.1);
  hall.draw(AnnotationKind::keep_out, "z", rectangle(7, -2, 9, 1));
  const Path around = hall.path({0, 0, 0}, {16, 0, 0});
  ASSERT_EQ(around.refusal, Refusal::none);
  const double nearest = hall.nearest_m(around, {Eigen::Vector2d(7, -2), Eigen::Vector2d(9, 1)});
  EXPECT_GE(nearest, slim.radius_m);
  EXPECT_LE(nearest, slim.radius_m + 0.15) << "no farther from it than need be";
  for (const double speed : around.max_speeds_m_s) EXPECT_EQ(speed, 0);
  hall.draw(AnnotationKind::erase, "z", {});
  EXPECT_LT(hall.path({0, 0, 0}, {16, 0, 0}).length_m, 16.1) << "it is gone";
}

TEST(Zones, AZoneThatBarsTheWayIsTheReason) {
  Hall hall;
  hall.draw(AnnotationKind::keep_out, "across", rectangle(7, -4, 9, 4));
  EXPECT_EQ(hall.path({0, 0, 0}, {16, 0, 0}).refusal, Refusal::kept_out);
  EXPECT_EQ(hall.path({0, 0, 0}, {8, 0, 0}).refusal, Refusal::kept_out) << "into it";
  EXPECT_EQ(hall.path({8, 0, 0}, {0, 0, 0}).refusal, Refusal::kept_out) << "out of its middle";
  EXPECT_EQ(hall.path({7.1, 0, 0}, {0, 0, 0}).refusal, Refusal::none) << "a robot at its rim leaves it";
  EXPECT_EQ(hall.path({0, 0, 0}, {0, 30, 0}).refusal, Refusal::no_room) << "not for the zone";
}

TEST(Zones, SpeedIsToldOfTheSlowestZoneOnTheWayToEachPose) {
  Hall hall;
  hall.draw(AnnotationKind::speed, "slow", rectangle(5, -3, 10, 3));
  AnnotationEvent slower = annotation(AnnotationKind::speed, "slower", PatchId{0}, rectangle(8, -3, 9, 3));
  slower.max_speed_m_s = 0.2;
  ASSERT_EQ(hall.annotations.take(slower, hall.map, on_any_map), DropReason::none);
  const Path path = hall.path({0, 0, 0}, {16, 0, 0});
  ASSERT_EQ(path.refusal, Refusal::none);
  ASSERT_EQ(path.max_speeds_m_s.size(), path.poses.size());
  EXPECT_LT(path.length_m, 16.1) << "it is no obstacle";
  for (std::size_t i = 1; i < path.poses.size(); ++i) {
    const double from = hall.planner.project(path.poses[i - 1]).x, to = hall.planner.project(path.poses[i]).x;
    const bool in_slow = to > 5 - 0.19 && from<10 + 0.19, in_slower = to> 8 - 0.19 && from < 9 + 0.19;
    const bool at_a_rim = !in_slow && to >= 4.7 && from <= 10.3;
    if (at_a_rim) continue;
    EXPECT_EQ(path.max_speeds_m_s[i], in_slower ? 0.2 : in_slow ? 0.5 : 0) << from;
  }
}

// The roadmap that was made for the zone where it lay is made again.
TEST(Zones, MoveWithTheMap) {
  Hall hall;
  hall.draw(AnnotationKind::keep_out, "z", rectangle(7, -2, 9, 1));
  hall.path({0, 0, 0}, {16, 0, 0});
  hall.map.move_island(PatchId{0}, {0, 10, 0});
  const Path around = hall.path({0, 0, 0}, {16, 0, 0});
  ASSERT_EQ(around.refusal, Refusal::none);
  EXPECT_GE(hall.nearest_m(around, {Eigen::Vector2d(7, 8), Eigen::Vector2d(9, 11)}), slim.radius_m);
}

TEST(Zones, AreThoseOfTheirIsland) {
  Hall hall;
  hall.draw(AnnotationKind::keep_out, "z", rectangle(7, -2, 9, 1));
  hall.update();
  const Eigen::Vector2d from(0, 0), to(16, 0);
  EXPECT_TRUE(hall.planner.zones().bars(PatchId{0}, from, to, 0));
  EXPECT_FALSE(hall.planner.zones().bars(PatchId{1}, from, to, 0));
}

TEST(Zones, AreNeitherPlacesNorWhatIsLost) {
  Hall hall;
  hall.draw(AnnotationKind::place, "dock", {{8, 0}});
  hall.draw(AnnotationKind::keep_out, "lost", rectangle(7, -2, 9, 1));
  hall.draw(AnnotationKind::keep_out, "there", rectangle(1, -2, 3, 1));
  MapCopy copy = copy_of(hall.map);
  copy.annotations = hall.annotations.records(hall.map, on_any_map);
  copy.annotations[1].lost = true;
  const Zones zones(copy);
  ASSERT_EQ(zones.of(PatchId{0}).size(), 1U);
  EXPECT_NEAR(zones.of(PatchId{0}).front().ring.front().x(), 1, 1e-9);
}

TEST(Zones, OfSpeedBarNoWayAndThoseToKeepOutOfTellNoSpeed) {
  Hall hall;
  const Eigen::Vector2d from(0, 0), to(16, 0);
  hall.draw(AnnotationKind::speed, "slow", rectangle(7, -2, 9, 1));
  hall.update();
  EXPECT_FALSE(hall.planner.zones().bars(PatchId{0}, from, to, 0.2));
  EXPECT_FALSE(hall.planner.zones().any_keep_out(PatchId{0}));
  EXPECT_EQ(hall.planner.zones().max_speed_m_s(PatchId{0}, from, to, 0.2), 0.5);
  AnnotationEvent slower = annotation(AnnotationKind::keep_out, "z", PatchId{0}, rectangle(7, -2, 9, 1));
  slower.max_speed_m_s = 0.1;
  ASSERT_EQ(hall.annotations.take(slower, hall.map, on_any_map), DropReason::none);
  hall.update();
  EXPECT_TRUE(hall.planner.zones().any_keep_out(PatchId{0}));
  EXPECT_EQ(hall.planner.zones().max_speed_m_s(PatchId{0}, from, to, 0.2), 0.5);
}

TEST(Zones, ThatOthersHaveAreTakenOverOrGoWithThem) {
  Hall hall;
  hall.draw(AnnotationKind::keep_out, "z", rectangle(7, -2, 9, 1));
  hall.update();
  Zones zones;
  zones.keep(PatchId{0}, hall.planner.zones());
  ASSERT_EQ(zones.of(PatchId{0}).size(), 1U);
  EXPECT_EQ(zones.of(PatchId{0}).front().ring, hall.planner.zones().of(PatchId{0}).front().ring);
  zones.keep(PatchId{0}, Zones());
  EXPECT_TRUE(zones.of(PatchId{0}).empty());
}

TEST(Zones, AreAlikeUpToHalfACell) {
  Zone zone;
  zone.keep_out = false;
  zone.max_speed_m_s = 0.5;
  zone.ring = rectangle(0, 0, 2, 2);
  const auto is_alike = [&](const auto& change) {
    Zone other = zone;
    change(other);
    return are_alike(std::span(&zone, 1), std::span(&other, 1));
  };
  EXPECT_TRUE(is_alike([](Zone& other) { other.ring[2].x() += 0.49 * ground_cell_m; }));
  EXPECT_FALSE(is_alike([](Zone& other) { other.ring[2].x() += 0.51 * ground_cell_m; }));
  EXPECT_FALSE(is_alike([](Zone& other) { other.ring.pop_back(); }));
  EXPECT_FALSE(is_alike([](Zone& other) { other.keep_out = true; }));
  EXPECT_FALSE(is_alike([](Zone& other) { other.max_speed_m_s = 0.4; }));
  EXPECT_FALSE(are_alike(std::span(&zone, 1), {}));
}

// A zone that has hardly moved stays where roadmaps have it, so that it is noticed once it has come farther.
TEST(Zones, ThatCreepAreFollowed) {
  Hall hall;
  hall.draw(AnnotationKind::keep_out, "z", rectangle(7, -2, 9, 1));
  MapCopy copy = copy_of(hall.map);
  copy.annotations = hall.annotations.records(hall.map, on_any_map);
  const auto creep = [&] {
    for (ManifoldPose& corner : copy.annotations.front().points)
      corner.patch_from_object.y += 0.3 * ground_cell_m;
    hall.planner.update(std::make_shared<const MapCopy>(copy));
    hall.planner.path({{PatchId{0}, {0, 0, 0}}, {PatchId{0}, {16, 0, 0}}, slim});
    return hall.planner.zones().of(PatchId{0}).front().ring.front().y();
  };
  const double first = creep();
  EXPECT_DOUBLE_EQ(creep(), first);
  EXPECT_NEAR(creep(), first + 0.6 * ground_cell_m, 1e-9);
}

TEST(KeptOutCells, AreNoneOfASpeedZone) {
  Zone zone;
  zone.keep_out = false;
  zone.ring = rectangle(0, 0, 2, 2);
  EXPECT_TRUE(KeptOutCells(std::span(&zone, 1), 0.3).empty());
  zone.keep_out = true;
  EXPECT_FALSE(KeptOutCells(std::span(&zone, 1), 0.3).empty());
}

TEST(KeptOutCells, OfSeveralZonesAreThoseOfEach) {
  Zone wide, narrow;
  wide.ring = rectangle(0, 0, 4, 1);
  narrow.ring = rectangle(1, 0, 2, 1);  // in the midst of the other
  const std::array<Zone, 2> zones = {wide, narrow};
  const KeptOutCells cells(zones, 0.01);
  for (const double x : {0.5, 1.5, 2.5, 3.5}) EXPECT_TRUE(cells.contains(cell_of({x, 0.5}))) << x;
  EXPECT_FALSE(cells.contains(cell_of({4.5, 0.5})));
  EXPECT_FALSE(cells.contains(cell_of({-0.5, 0.5})));
}

TEST(KeptOutCells, AreThoseInsideAndAround) {
  Zone zone;
  zone.ring = {{0, 0}, {2, 0}, {2, 2}, {1, 0.5}, {0, 2}};
  for (const Eigen::Vector2d& corner : zone.ring) zone.box.extend(corner);
  constexpr double within_m = 0.3;
  const KeptOutCells cells(std::span(&zone, 1), within_m);
  int in = 0;
  for (int x = -20; x < 60; ++x) {
    for (int y = -20; y < 60; ++y) {
      const Eigen::Vector2d centre = centre_of({x, y});
      const bool kept_out = comes_into(zone, centre, centre, within_m);
      EXPECT_EQ(cells.contains({x, y}), kept_out) << centre.transpose();
      in += kept_out ? 1 : 0;
    }
  }
  EXPECT_GT(in, 100);
}

TEST(KeptOutCells, AZoneThatCrossesItselfKeepsOutOfAllThatItGoesAround) {
  Zone bow;
  bow.ring = {{0, 0}, {2, 2}, {2, 0}, {0, 2}};
  const KeptOutCells cells(std::span(&bow, 1), 0.01);
  EXPECT_TRUE(cells.contains(cell_of({0.3, 1})));
  EXPECT_TRUE(cells.contains(cell_of({1.7, 1})));
  EXPECT_FALSE(cells.contains(cell_of({1, 1.7})));
}

}  // namespace
}  // namespace isthmus
