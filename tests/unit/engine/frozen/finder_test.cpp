#include "server/engine/frozen/finder.hpp"

#include <gtest/gtest.h>

#include "server/engine/frozen/lost_robot.hpp"
#include "tests/support/ways.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

// A map of a hall, a metre a patch.
std::vector<Pose> along_the_hall() {
  std::vector<Pose> poses;
  for (int i = 0; i < 16; ++i) poses.push_back({1.0 * i, 0, 0});
  return poses;
}

// A robot whose odometry begins where it begins itself.
struct Lost {
  explicit Lost(const Map& on) : map(on), places(all_places(on, options)) {
    robot.declaration.robot = "R9";
    robot.declaration.laser = laser_of();
  }
  void scan(const Pose& world_from_robot) {
    utime += 100'000;
    finder.take_scan(robot, observe(scan_from(niched_hall(), world_from_robot, utime), laser_of(), {}),
                     ominus(world_from_robot, start), options);
  }
  // Drives along the hall and is looked for meanwhile, until it is found.
  std::optional<ManifoldPose> found_between(double from_x, double to_x) {
    start = {from_x, 0.4, 0};
    for (here = start; here.x < to_x; here.x += 0.1) {
      scan(here);
      while (finder.has_work()) finder.step(map, places, options, counts);
      if (auto found = finder.take_found()) return found;
    }
    return std::nullopt;
  }

  const Map& map;
  EngineOptions options;
  std::vector<RigidPiece> places;
  Robot robot;
  Finder finder;
  FinderCounts counts;
  std::int64_t utime = 0;
  Pose start;
  Pose here;
};

// Until it is found: a way that is too short, then a search, then one find that another must bear out.
TEST(Finder, SaysWhyARobotIsNotFoundYet) {
  Map map;
  add_way(map, niched_hall(), along_the_hall());
  Lost lost(map);
  lost.start = {5, 0.4, 0};
  std::vector<NotFound> reasons = {lost.finder.why(lost.options.finder)};
  const auto note = [&] {
    const NotFound why = lost.finder.why(lost.options.finder);
    if (why != reasons.back()) reasons.push_back(why);
  };
  std::optional<ManifoldPose> found;
  for (double x = 5; x < 14 && !found; x += 0.1) {
    lost.scan({x, 0.4, 0});
    note();
    while (lost.finder.has_work()) lost.finder.step(map, lost.places, lost.options, lost.counts);
    note();
    found = lost.finder.take_found();
  }
  ASSERT_TRUE(found);
  EXPECT_EQ(reasons.front(), NotFound::way_too_short);
  EXPECT_EQ(reasons[1], NotFound::searching);
  EXPECT_EQ(reasons.back(), NotFound::found_once);
}

TEST(Finder, FindsARobotThatIsSomewhereOnTheMap) {
  Map map;
  add_way(map, niched_hall(), along_the_hall());
  Lost lost(map);
  const std::optional<ManifoldPose> found = lost.found_between(5, 14);
  ASSERT_TRUE(found);
  const Pose error = ominus(map.manifold().project(*found), lost.here);
  EXPECT_LT(std::hypot(error.x, error.y), 0.1);
  EXPECT_LT(std::abs(error.yaw), 0.03);
  EXPECT_GE(lost.here.x - lost.start.x, 2) << "two pieces of way of 2 m that say the same";
  EXPECT_GE(lost.counts.finds, 2);
  EXPECT_EQ(lost.finder.since_utime(), 100'000);
  EXPECT_FALSE(lost.finder.take_found()) << "it is told once";
}

// Two halls that look alike: nothing tells in which of them it is.
TEST(Finder, TakesNoneOfTwoPlacesThatLookAlike) {
  Map map;
  add_way(map, niched_hall(), along_the_hall());
  add_way(map, niched_hall(), along_the_hall());
  Lost lost(map);
  EXPECT_FALSE(lost.found_between(5, 14));
  EXPECT_EQ(lost.counts.finds, 0);
  EXPECT_GE(lost.counts.ambiguous, 1);
}

TEST(Finder, FindsNothingInAnotherBuilding) {
  Map map;
  Walls other;
  add_box(other, -2, -5, 20, 7);
  add_way(map, other, along_the_hall());
  Lost lost(map);
  EXPECT_FALSE(lost.found_between(5, 10));
  EXPECT_GT(lost.counts.places_searched, 0);
}

TEST(AllPlaces, CoverEveryIslandThatIsLargeEnough) {
  Map map;
  add_way(map, niched_hall(), along_the_hall());
  const auto small = add_way(map, niched_hall(), {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}});
  const std::vector<RigidPiece> places = all_places(map, {});
  EXPECT_EQ(places.size(), 4U) << "at 0 m, 4 m, 8 m and 12 m";
  for (const RigidPiece& place : places) EXPECT_LT(place.local.reference, small.front());
}

}  // namespace
}  // namespace isthmus
