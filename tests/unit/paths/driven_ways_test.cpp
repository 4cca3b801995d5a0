#include "server/paths/questions/driven_ways.hpp"

#include <gtest/gtest.h>

#include "tests/support/ground_scenes.hpp"

namespace isthmus {
namespace {

/// R1 drove along these points of a room, in one patch; one row every 10 cm, the stamp in seconds.
struct Drive {
  MapCopy map;
  std::shared_ptr<TrajectoryStore> rows = std::make_shared<TrajectoryStore>();
  std::int64_t utime = 0;

  Drive() {
    Map made;
    made.add(testing::round_patch(testing::furnished_room(), PatchId{0}, {}), {2, 1, 0.5});
    map = testing::copy_of(made);
    Session session;
    session.robot = "R1";
    session.first_patch = PatchId{0};
    map.sessions = {session};
    map.trajectory = rows;
  }

  void along(const std::vector<Eigen::Vector2d>& points, PatchId patch = {0}) {
    for (std::size_t i = 1; i < points.size(); ++i) {
      const Eigen::Vector2d by = points[i] - points[i - 1];
      const int parts = static_cast<int>(std::lround(by.norm() / 0.1));
      for (int part = 0; part < parts; ++part) {
        const Eigen::Vector2d at = points[i - 1] + by * part / parts;
        rows->append({utime++, 0, patch, {at.x(), at.y(), 0}});
      }
    }
    rows->flush();
    map.trajectory_rows = rows->size();
  }

  Path back(std::int64_t to_utime = 0, const std::string& robot = "R1") const {
    DrivenWays ways;
    ways.update(map);
    return ways.back(map, NearPatches(map, 30), Zones(map), robot, to_utime, 0.25);
  }
};

TEST(DrivenWays, TheWayBackIsTheWayDriven) {
  Drive drive;
  drive.along({{-3, -2}, {3, -2}, {3, 1}});
  const Path path = drive.back();
  ASSERT_EQ(path.refusal, Refusal::none);
  EXPECT_NEAR(path.length_m, 8.9, 0.15);
  EXPECT_NEAR(path.poses.back().patch_from_object.x, -3, 1e-9);
  EXPECT_NEAR(path.poses.back().patch_from_object.y, -2, 1e-9);
  for (std::size_t i = 1; i < path.poses.size(); ++i) {
    const Pose &a = path.poses[i - 1].patch_from_object, &b = path.poses[i].patch_from_object;
    EXPECT_LE(std::hypot(b.x - a.x, b.y - a.y), 0.42);
  }
}

TEST(DrivenWays, ItFacesTheWayThatItGoes) {
  Drive drive;
  drive.along({{-3, -2}, {3, -2}});
  EXPECT_NEAR(std::abs(drive.back().poses[3].patch_from_object.yaw), std::numbers::pi, 1e-6);
}

// A zone that was drawn on the shorter of two ways driven: back by the other.
TEST(DrivenWays, KeepOutOfZones) {
  Drive drive;
  drive.along({{-3, -2}, {3, -2}, {3, 2}, {-3, 2}, {-3, -2}, {0, -2}});
  AnnotationRecord zone;
  zone.kind = AnnotationKind::keep_out;
  zone.island = PatchId{0};
  zone.points = {{PatchId{0}, {-2, -3, 0}},
                 {PatchId{0}, {-1, -3, 0}},
                 {PatchId{0}, {-1, -1, 0}},
                 {PatchId{0}, {-2, -1, 0}}};
  drive.map.annotations = {zone};
  const Path path = drive.back();
  ASSERT_EQ(path.refusal, Refusal::none);
  EXPECT_NEAR(path.length_m, 17, 0.6);
  zone.points = {{PatchId{0}, {-4, -3, 0}},
                 {PatchId{0}, {-2, -3, 0}},
                 {PatchId{0}, {-2, -1, 0}},
                 {PatchId{0}, {-4, -1, 0}}};
  drive.map.annotations = {zone};
  EXPECT_EQ(drive.back().refusal, Refusal::kept_out) << "where it began is in it";
}

TEST(DrivenWays, RoundsThatWereDrivenAreNotDrivenAgain) {
  Drive drive;
  drive.along({{-3, -2}, {3, -2}, {3, 2}, {-3, 2}, {-3, -2}, {0, -2}});
  EXPECT_NEAR(drive.back().length_m, 3, 0.3);
}

TEST(DrivenWays, BackToATimeIsBackToWhereTheRobotWasThen) {
  Drive drive;
  drive.along({{-3, -2}, {3, -2}});
  const Path path = drive.back(30);
  ASSERT_EQ(path.refusal, Refusal::none);
  EXPECT_NEAR(path.poses.back().patch_from_object.x, 0, 0.2);
  EXPECT_EQ(drive.back(1'000'000).refusal, Refusal::bad_value);
}

TEST(DrivenWays, AWayDoesNotChangeOverWherePatchesAreFarApartAlongRelations) {
  testing::Spiral spiral;
  Drive drive;
  drive.map = testing::copy_of(spiral.map);
  drive.map.sessions = {Session{"R1", 0, 0, 0, PatchId{0}}};
  drive.map.trajectory = drive.rows;
  for (int i = 0; i <= 100; ++i) drive.rows->append({i, 0, PatchId{i}, {}});
  drive.rows->flush();
  drive.map.trajectory_rows = drive.rows->size();
  EXPECT_NEAR(drive.back().length_m, 100, 1);
  for (int patch = 5; patch <= 20; ++patch) spiral.close(patch);
  drive.map.graph = spiral.map.graph();
  EXPECT_NEAR(drive.back().length_m, 20, 1);
}

TEST(DrivenWays, AJumpIsNoWay) {
  Drive drive;
  drive.along({{-3, -2}, {-1, -2}});
  drive.along({{2, -2}, {3, -2}});
  EXPECT_EQ(drive.back().refusal, Refusal::unreachable);
}

TEST(DrivenWays, RobotsThatNeverDroveAreUnknown) {
  Drive drive;
  EXPECT_EQ(drive.back().refusal, Refusal::unknown_robot);
  drive.along({{-3, -2}, {-1, -2}});
  EXPECT_EQ(drive.back(0, "R2").refusal, Refusal::unknown_robot);
  drive.map.left_out = {PatchId{0}};
  EXPECT_EQ(drive.back().refusal, Refusal::unknown_robot);
}

}  // namespace
}  // namespace isthmus
