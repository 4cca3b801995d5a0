#include "server/engine/places/place_candidates.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "tests/support/ways.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

// Once round a block of 10 m by 10 m, a metre a patch, by odometry that errs by `sigma_m` and `sigma_rad` a
// metre: the last of 40 patches lies a metre beside the first, and 39 m from it over the map.
Map round_a_block(double sigma_m = 0.05, double sigma_rad = 0.016) {
  const Eigen::Vector3d information(1 / (sigma_m * sigma_m), 1 / (sigma_m * sigma_m),
                                    1 / (sigma_rad * sigma_rad));
  Map map;
  for (int i = 0; i < 40; ++i) {
    const double along = i % 10;
    const Pose corners[] = {{along, 0, 0}, {10, along, 1.57}, {10 - along, 10, 3.14}, {0, 10 - along, -1.57}};
    const PatchId id{i};
    map.add(patch_from(furnished_room(), id, {}), corners[i / 10]);
    if (i == 0) continue;
    const PatchId before{i - 1};
    map.relate(odometry_relation(before, id, map.relative_pose(before, id), information));
  }
  return map;
}

constexpr PatchId last_of_block{39};

std::vector<PlaceCandidate> of_last_patch(const Map& map, std::vector<PlaceHint> hints = {}) {
  PlaceQuestion question;
  question.newest_first = {last_of_block};
  question.hints = std::move(hints);
  return places_on_own_island(map, question, WayNetwork(map),
                              IslandCovariances(map.graph(), map.manifold().poses(), PatchId{0}), {});
}

TEST(PlacesOnOwnIsland, AreFarOverTheMapAndNearInProjection) {
  const Map map = round_a_block();
  const std::vector<PlaceCandidate> places = of_last_patch(map);
  ASSERT_FALSE(places.empty());
  for (const PlaceCandidate& place : places) {
    const Pose r = map.relative_pose(place.anchor, last_of_block);
    EXPECT_EQ(place.way_m, last_of_block.value - place.anchor.value) << "a metre a patch";
    EXPECT_GE(place.way_m, 10);
    EXPECT_LT(std::hypot(r.x, r.y), 5 + 1 + 0.3 * place.way_m);
  }
  EXPECT_EQ(places.front().anchor, PatchId{0}) << "the likeliest first";
}

// About where the map has the patch, as wide as 2.5 standard deviations of what map and sensors err by.
TEST(PlacesOnOwnIsland, AreSearchedAsFarAsTheMapCanBeOff) {
  const Map map = round_a_block();
  const PlaceCandidate place = of_last_patch(map).front();
  const Pose truth = map.relative_pose(place.anchor, last_of_block);
  EXPECT_LE(std::abs(place.window.centre.x - truth.x), place.window.half_x_m);
  EXPECT_LE(std::abs(place.window.centre.y - truth.y), place.window.half_y_m);
  const double yaw_sigma = std::sqrt(39 * 0.016 * 0.016 + drift_variance(39, {}).z());
  EXPECT_NEAR(place.window.half_yaw_rad, CommonOptions{}.window_sigmas * yaw_sigma, 0.01);
  EXPECT_NEAR(place.window.half_x_m, 5, 1e-9) << "4 m and a margin: the next anchor has the rest";
  EXPECT_LT(place.sigma_m, of_last_patch(round_a_block(0.2)).front().sigma_m) << "worse odometry says less";
  for (const PlaceCandidate& wide : of_last_patch(round_a_block(1, 0.2))) {
    EXPECT_LE(wide.window.half_x_m, 5);
    EXPECT_LE(wide.window.half_yaw_rad, std::numbers::pi);
  }
}

// A slip leaves a relation as narrow as any other.
TEST(PlacesOnOwnIsland, AreSearchedHoweverSureTheMapIs) {
  const std::vector<PlaceCandidate> places = of_last_patch(round_a_block(0.001, 0.0001));
  ASSERT_FALSE(places.empty());
  EXPECT_GT(places.front().window.half_x_m, 2);
  EXPECT_GT(places.front().window.half_yaw_rad, 0.3);
}

TEST(PlacesOnOwnIsland, LeaveOutWhatSawNoWalls) {
  Map map;
  for (int i = 0; i < 40; ++i) {
    auto blind = std::make_shared<Patch>();
    blind->id = PatchId{i};
    map.add(blind, round_a_block().manifold().pose(PatchId{i}));
    if (i > 0) map.relate(odometry_relation(PatchId{i - 1}, PatchId{i}, {1, 0, 0}, {400, 400, 4000}));
  }
  EXPECT_TRUE(of_last_patch(map).empty());
}

// Of `count` patches, a metre apart.
std::vector<PatchId> add_row(Map& map, int count) {
  std::vector<Pose> poses;
  for (int i = 0; i < count; ++i) poses.push_back({1.0 * i, 0, 0});
  return add_way(map, niched_hall(), poses, {100, 0, 1});
}

TEST(PlacesOnOtherIslands, CoverThemInEveryDirection) {
  Map map;
  const PatchId own = add_row(map, 10).back();
  const std::vector<PatchId> other = add_row(map, 10);
  const std::vector<PlaceCandidate> places = places_on_other_islands(map, own, {}, {});
  EXPECT_EQ(places.size(), 3U) << "at 0 m, 4 m and 8 m";
  for (const PatchId id : other) {
    const bool near = std::ranges::any_of(
        places, [&](const PlaceCandidate& place) { return std::abs(place.anchor.value - id.value) < 4; });
    EXPECT_TRUE(near) << id.value;
  }
  for (const PlaceCandidate& place : places) {
    EXPECT_GE(place.anchor, other.front());
    EXPECT_EQ(place.window.half_yaw_rad, std::numbers::pi);
    EXPECT_GE(place.window.half_x_m, 4);
    EXPECT_TRUE(std::isinf(place.sigma_m)) << "nothing says where on it the patch lies";
  }
}

// Of rooms that look the same, a metre apart.
std::vector<PatchId> add_rooms(Map& map, int count) {
  std::vector<PatchId> rooms;
  for (int i = 0; i < count; ++i) {
    const PatchId id{static_cast<std::int32_t>(map.manifold().size())};
    map.add(patch_from(furnished_room(), id, {}), {1.0 * i, 0, 0});
    if (i > 0) map.relate(odometry_relation(rooms.back(), id, {1, 0, 0}, {400, 400, 4000}));
    rooms.push_back(id);
  }
  return rooms;
}

// A row of 400 m has 100 places, of which 40 are searched at once.
TEST(PlacesOnOtherIslands, OfALargeIslandTakeTurns) {
  Map map;
  std::vector<PatchId> own = add_row(map, 10);
  const std::vector<PatchId> other = add_rooms(map, 400);
  std::set<PatchId> searched;
  for (const PatchId query : own) {
    const std::vector<PlaceCandidate> places = places_on_other_islands(map, query, {}, {});
    EXPECT_EQ(places.size(), 40U);
    for (const PlaceCandidate& place : places) searched.insert(place.anchor);
  }
  EXPECT_EQ(searched.size(), 100U) << "ten patches later, all have been";
}

// Three islands with 25 places each: one fits into 40, two into 60.
TEST(PlacesOnIslandsInTurn, AreAllOfSomeIslands) {
  Map map;
  const std::vector<PatchId> own = add_row(map, 10);
  for (int i = 0; i < 3; ++i) add_rooms(map, 100);
  const auto taken = [&](PatchId query, std::size_t most) {
    PlaceCandidateOptions options;
    options.max_places = most;
    std::map<IslandId, int> places;
    for (const PlaceCandidate& place :
         places_on_islands_in_turn(map, query, places_on_other_islands(map, query, {}, options), options))
      ++places[map.graph().island(place.anchor)];
    return places;
  };
  std::set<IslandId> first;
  for (const PatchId query : own) {
    const std::map<IslandId, int> one = taken(query, 40);
    ASSERT_EQ(one.size(), 1U);
    EXPECT_EQ(one.begin()->second, 25);
    first.insert(one.begin()->first);
    EXPECT_EQ(taken(query, 60).size(), 2U);
    EXPECT_EQ(taken(query, 75).size(), 3U);
  }
  EXPECT_EQ(first.size(), 3U) << "from patch to patch another is first";
  EXPECT_TRUE(places_on_islands_in_turn(map, own.front(), {}, {}).empty());
}

TEST(PlacesOnOtherIslands, AreFirstThoseThatHintsName) {
  Map map;
  const PatchId own = add_row(map, 10).back();
  const std::vector<PatchId> other = add_rooms(map, 400);
  const Pose there = map.manifold().pose(other[300]);
  const PlaceHint hint{map.graph().island(other[0]), there, 2};
  const std::vector<PlaceCandidate> places = places_on_other_islands(map, own, {&hint, 1}, {});
  EXPECT_EQ(places.front().anchor, other[300]);
  const PlaceHint elsewhere{map.graph().island(own), there, 2};
  EXPECT_EQ(places_on_other_islands(map, own, {&elsewhere, 1}, {}).front().anchor, other[0])
      << "a hint is of one island";
}

// They do not take the turns of others: of three places that are searched none is one of theirs.
TEST(PlacesOnOwnIsland, AreNoneOfRobotsOnWhosePatchesItDoesNotLie) {
  Map map;
  const Map block = round_a_block();
  for (const PatchPtr& patch : block.manifold().patches()) {
    Patch named = *patch;
    named.robot = named.id.value < 20 ? "R1" : "R2";
    map.add(std::make_shared<const Patch>(std::move(named)), block.manifold().pose(patch->id));
  }
  for (const auto& [id, relation] : block.graph().relations()) map.relate(relation);
  PlaceCandidateOptions options;
  options.max_places = 3;
  options.min_way_m = 5;
  const auto anchors_without = [&](std::vector<std::string> not_of) {
    PlaceQuestion question;
    question.newest_first = {last_of_block};
    question.not_of = std::move(not_of);
    std::set<PatchId> anchors;
    for (const PlaceCandidate& place :
         places_on_own_island(map, question, WayNetwork(map),
                              IslandCovariances(map.graph(), map.manifold().poses(), PatchId{0}), options))
      anchors.insert(place.anchor);
    return anchors;
  };
  EXPECT_EQ(*anchors_without({}).begin(), PatchId{0});
  const std::set<PatchId> of_others = anchors_without({"R1"});
  ASSERT_FALSE(of_others.empty());
  EXPECT_GE(of_others.begin()->value, 20);
}

TEST(PlacesOnOwnIsland, AreFirstThoseThatHintsName) {
  const Map map = round_a_block();
  const PlaceHint hint{map.graph().island(last_of_block), map.manifold().pose(PatchId{4}), 1};
  const std::vector<PlaceCandidate> hinted = of_last_patch(map, {hint});
  EXPECT_EQ(hinted.front().anchor, PatchId{4});
  std::set<PatchId> anchors;
  for (const PlaceCandidate& place : hinted) anchors.insert(place.anchor);
  EXPECT_TRUE(anchors.contains(PatchId{0})) << "the likeliest after them";
}

TEST(PlacesOnOtherIslands, LeaveOutIslandsOfLessThanSixPatches) {
  Map map;
  const PatchId own = add_row(map, 10).back();
  add_row(map, 5);
  EXPECT_TRUE(places_on_other_islands(map, own, {}, {}).empty());
  add_row(map, 6);
  EXPECT_FALSE(places_on_other_islands(map, own, {}, {}).empty());
}

}  // namespace
}  // namespace isthmus
