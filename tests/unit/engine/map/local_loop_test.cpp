#include "server/engine/map/local_loop.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/support/ways.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

constexpr PatchId new_patch{2};

// A robot that has come back to where patch 0 was made. It stands on patch 1, which lies there too, by
// odometry that errs by `sigma`; its scan was in truth taken at `off` from there.
struct CameBack {
  CameBack(const Walls& of_patch, const Eigen::Vector3d& sigma) {
    map.add(patch_from(of_patch, PatchId{0}, {}), {});
    auto blind = std::make_shared<Patch>();
    blind->id = PatchId{1};
    map.add(blind, {});
    map.relate(odometry_relation(PatchId{0}, PatchId{1}, {}, sigma.array().pow(-2).matrix()));
  }
  LocalLoop found(const Walls& walls, const Pose& off, const std::vector<PatchId>& unpaired = {}) const {
    Surroundings surroundings;
    surroundings.update(map, PatchId{1}, options, Surroundings::By::scans);
    return find_local_loop(map, surroundings, {}, to_points(scan_from(walls, off), laser_of(), {}), unpaired,
                           new_patch, options);
  }
  LocalLoop found(const Pose& off) const { return found(furnished_room(), off); }

  EngineOptions options;
  Map map;
};

const Eigen::Vector3d loose_sigma(0.3, 0.3, 0.05);
const Eigen::Vector3d well_known_sigma(0.05, 0.05, 0.02);

TEST(FindLocalLoop, RelatesAScanToTheLooselyKnownPatchThatItCameBackTo) {
  const Pose truth{0.5, -0.4, 0.08};
  const LocalLoop found = CameBack(furnished_room(), loose_sigma).found(truth);
  ASSERT_EQ(found.relations.size(), 1U);
  const Relation& relation = found.relations.front();
  EXPECT_EQ(relation.a, PatchId{0});
  EXPECT_EQ(relation.b, new_patch);
  EXPECT_EQ(relation.origin.kind, OriginKind::match);
  const Pose error = ominus(minimiser(relation.measurement, truth), truth);
  EXPECT_LT(std::hypot(error.x, error.y), 0.02);
  EXPECT_LT(std::abs(error.yaw), 0.006);
  EXPECT_TRUE(found.compared);
  EXPECT_FALSE(found.unambiguous) << "the window is wider than 0.6 m";
  // How the loop moves the robot's patch: from where the map has it to where it is.
  EXPECT_LT((found.map_from_map * found.position - Eigen::Vector2d(truth.x, truth.y)).norm(), 0.02);
  EXPECT_NEAR(found.map_from_map.yaw, truth.yaw, 0.006);
}

TEST(FindLocalLoop, TellsWhetherThePlaceWouldShowWhatTheScanSees) {
  const LocalLoop in_free_space = CameBack(box(4), loose_sigma).found(box(2), {});
  EXPECT_TRUE(in_free_space.relations.empty());
  EXPECT_TRUE(in_free_space.compared);
  EXPECT_TRUE(in_free_space.would_show);
  const LocalLoop hidden = CameBack(box(2), loose_sigma).found(box(4), {});
  EXPECT_TRUE(hidden.relations.empty());
  EXPECT_TRUE(hidden.compared);
  EXPECT_FALSE(hidden.would_show) << "behind its walls";
}

// Firm patches are the local map's, with which every scan is matched; here, only where it was not found.
TEST(FindLocalLoop, LooksForWellDeterminedPatchesOnlyWhereTheScanWasNotPairedWithThem) {
  const CameBack back(furnished_room(), well_known_sigma);
  const Pose truth{0.2, -0.1, 0.02};
  const LocalLoop paired = back.found(truth);
  EXPECT_TRUE(paired.relations.empty());
  EXPECT_FALSE(paired.compared);
  const LocalLoop unpaired = back.found(furnished_room(), truth, {PatchId{0}});
  EXPECT_EQ(unpaired.relations.size(), 1U);
  EXPECT_TRUE(unpaired.unambiguous);
}

TEST(FindLocalLoop, FindsNothingAmongOtherWalls) {
  Walls others;
  add_box(others, -0.7, -1.2, 1.9, 0.8);
  const LocalLoop found = CameBack(others, loose_sigma).found({0.1, 0, 0});
  EXPECT_TRUE(found.compared);
  EXPECT_TRUE(found.relations.empty());
}

// Along a corridor a scan fits anywhere.
TEST(FindLocalLoop, TakesNoneOfManyAnswers) {
  const LocalLoop found = CameBack(corridor(), loose_sigma).found(corridor(), {0.1, 0, 0});
  EXPECT_TRUE(found.compared);
  EXPECT_TRUE(found.relations.empty());
}

// Where the map is off by more than a window can hold, what is found in it might be an alias.
TEST(FindLocalLoop, LeavesWideWindowsToHypotheses) {
  const Pose truth{0.5, -0.4, 0.08};
  EXPECT_EQ(CameBack(furnished_room(), {2.3, 0.3, 0.05}).found(truth).relations.size(), 1U);
  for (const Eigen::Vector3d& wide :
       {Eigen::Vector3d(2.5, 0.3, 0.05), Eigen::Vector3d(0.3, 2.5, 0.05), Eigen::Vector3d(0.3, 0.3, 0.29)}) {
    const LocalLoop found = CameBack(furnished_room(), wide).found(truth);
    EXPECT_FALSE(found.compared) << wide.transpose();
    EXPECT_TRUE(found.relations.empty()) << wide.transpose();
  }
}

// Each within its window, but χ² of all three is 3 · 2.4² > 16. Covariances count with 0.2 m and 0.03 rad
// for slips of the past.
TEST(FindLocalLoop, DoubtsWhatIsFarInAllThreeAtOnce) {
  const Pose sigma{std::hypot(0.3, 0.2), std::hypot(0.3, 0.2), std::hypot(0.05, 0.0316)};
  const CameBack back(furnished_room(), loose_sigma);
  const auto sigmas_off = [&](double n) {
    return back.found({n * sigma.x, n * sigma.y, n * sigma.yaw}).relations.size();
  };
  EXPECT_EQ(sigmas_off(2.2), 1U);
  EXPECT_EQ(sigmas_off(2.4), 0U);
}

// Another find on the way: it would move the map so, seen at `x` on the way.
LocalLoop find_at(double x, const Pose& map_from_map, bool unambiguous = false) {
  LocalLoop found;
  found.patch = new_patch;
  found.relations.push_back(odometry_relation(PatchId{0}, new_patch, {x, 0, 0}));
  found.map_from_map = map_from_map;
  found.position = {x, 0};
  found.unambiguous = unambiguous;
  found.compared = true;
  return found;
}

const Pose moved{1, 0.5, 0.1};

TEST(WaitingLoops, GiveWhatIsCertainAtOnce) {
  WaitingLoops waiting;
  EXPECT_EQ(waiting.take(find_at(0, moved, true), {}).size(), 1U);
}

TEST(WaitingLoops, WaitForThreeThatAgree) {
  WaitingLoops waiting;
  EXPECT_TRUE(waiting.take(find_at(0, moved), {}).empty());
  EXPECT_TRUE(waiting.take(find_at(1, moved), {}).empty());
  EXPECT_EQ(waiting.take(find_at(2.1, moved), {}).size(), 3U);
  EXPECT_TRUE(waiting.take(find_at(3, moved), {}).empty()) << "what was given waits no more";
}

TEST(WaitingLoops, CountOnlyThoseThatMoveTheMapAlike) {
  WaitingLoops waiting;
  EXPECT_TRUE(waiting.take(find_at(0, moved), {}).empty());
  EXPECT_TRUE(waiting.take(find_at(1, {1.5, 0.5, 0.1}), {}).empty()) << "half a metre aside";
  EXPECT_TRUE(waiting.take(find_at(2, {1, 0.5, 0.2}), {}).empty()) << "another yaw";
  EXPECT_TRUE(waiting.take(find_at(2.5, moved), {}).empty()) << "two of its kind";
  EXPECT_EQ(waiting.take(find_at(3, moved), {}).size(), 3U);
}

// Seen thrice from one place, an alias is still an alias.
TEST(WaitingLoops, AskForTwoMetresOfWay) {
  WaitingLoops waiting;
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(waiting.take(find_at(0.1 * i, moved), {}).empty());
  EXPECT_EQ(waiting.take(find_at(2.1, moved), {}).size(), 6U);
}

TEST(WaitingLoops, ForgetTheOldestOfMoreThanMayWait) {
  WaitingLoops waiting;
  EXPECT_TRUE(waiting.take(find_at(0, moved), {}).empty());
  EXPECT_TRUE(waiting.take(find_at(1, moved), {}).empty());
  for (std::size_t i = 1; i < CommonOptions{}.max_finds; ++i)
    EXPECT_TRUE(waiting.take(find_at(0, {10 + static_cast<double>(i), 0, 0}), {}).empty());
  EXPECT_TRUE(waiting.take(find_at(2.1, moved), {}).empty());
}

TEST(WaitingLoops, HearNothingOfAFindWithoutRelations) {
  WaitingLoops waiting;
  LocalLoop nothing = find_at(0, moved, true);
  nothing.relations.clear();
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(waiting.take(nothing, {}).empty());
  EXPECT_TRUE(waiting.take(find_at(3, moved), {}).empty());
}

}  // namespace
}  // namespace isthmus
