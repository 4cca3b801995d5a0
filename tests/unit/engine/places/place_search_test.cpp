#include "server/engine/places/place_search.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "server/engine/propagation/shared_part.hpp"
#include "tests/support/ways.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

// A map of two ways through the same walls that nothing joins: the first of patches 0, 1, ..., the second,
// whose frame is another, of those after.
struct SeparateWays {
  Map map;
  std::vector<PatchId> second_newest_first;
};

SeparateWays separate_ways(const Walls& walls, const std::vector<Pose>& first,
                           const std::vector<Pose>& second) {
  SeparateWays ways;
  add_way(ways.map, walls, first, Pose{});
  const auto count = static_cast<std::int32_t>(first.size());
  add_way(ways.map, walls, second, Pose{20, 5, 1});
  for (std::int32_t i = count + static_cast<std::int32_t>(second.size()); i-- > count;)
    ways.second_newest_first.push_back(PatchId{i});
  return ways;
}

const std::vector<Pose> way_there = {
    {-2.5, -1.5, 0.1}, {-1, -1.5, 0}, {0.5, -1.4, 0.1}, {1.8, -1, 1.2}, {1.8, -0.8, 2.8}};
const std::vector<Pose> way_back = {{2, 0.2, 3}, {0.8, 0.1, 3.1}, {-0.5, 0, -3.1}, {-1.2, -0.6, -2.6}};

TEST(SearchPlace, FindsWhereAWayLiesWhateverItsYaw) {
  const SeparateWays ways = separate_ways(crooked_room(), way_there, way_back);
  const RigidPiece place = place_around(ways.map, PatchId{1}, {}, {});
  const RigidPiece piece = piece_of_way(ways.map, ways.second_newest_first, {});
  const PlaceSearch search = search_place(place, piece, {Pose{}, 4, 4, std::numbers::pi}, 0.5, {});
  ASSERT_FALSE(search.answers.empty());
  EXPECT_FALSE(search.exhausted);
  const Pose truth = ominus(way_back.back(), way_there[1]);
  const Pose off = ominus(search.answers.front().anchor_from_piece, truth);
  EXPECT_LT(std::hypot(off.x, off.y), 0.15);
  EXPECT_LT(std::abs(off.yaw), 0.04);

  const auto find = refine(place, piece, search.answers.front(), 0, {});
  ASSERT_TRUE(find);
  EXPECT_FALSE(find->relations.empty());
  const auto query = static_cast<std::size_t>(find->query.value) - way_there.size();
  const Pose refined_off = ominus(find->anchor_from_query, ominus(way_back[query], way_there[1]));
  EXPECT_LT(std::hypot(refined_off.x, refined_off.y), 0.03);
  EXPECT_LT(std::abs(refined_off.yaw), 0.01);
}

RigidPiece seen_at_once(const Walls& walls) {
  RigidPiece piece;
  piece.local.patches.push_back({patch_from(walls, PatchId{0}, {}), {}});
  piece.points = piece.local.patches.front().patch->points;
  return piece;
}

TEST(SeenAgain, IsAllThatOnePieceShowsTheOtherHoweverLittle) {
  EXPECT_EQ(seen_again(seen_at_once(furnished_room()), seen_at_once(furnished_room()), {}, {}), 1);
  // A room with a wall across: what is beyond it is hidden from the piece, and shown to it by nothing.
  Walls half = box(4);
  half.push_back({{-4, -1}, {4, -1}});
  EXPECT_GT(seen_again(seen_at_once(half), seen_at_once(half), {}, {}), 0.99);
}

TEST(SeenAgain, IsNothingWhereOneLooksThroughAllThatTheOtherSees) {
  EXPECT_EQ(seen_again(seen_at_once(box(2)), seen_at_once(box(4)), {}, {}), 0);
  EXPECT_EQ(seen_again(seen_at_once(box(4)), seen_at_once(box(2)), {}, {}), 0) << "whichever of the two";
}

TEST(SeenAgain, IsLessWhereEitherLooksThroughAPart) {
  Walls wall_across = box(4);
  wall_across.push_back({{-1, 2}, {1, 2}});
  const double less = seen_again(seen_at_once(box(4)), seen_at_once(wall_across), {}, {});
  EXPECT_GT(less, 0.5);
  EXPECT_LT(less, 0.95);
  EXPECT_LT(seen_again(seen_at_once(wall_across), seen_at_once(box(4)), {}, {}), 0.95);
}

TEST(Refine, IsSurerOfWhatFitsBetterAndOfWhatTheMapSaysSomethingOf) {
  const SeparateWays ways = separate_ways(crooked_room(), way_there, way_back);
  const RigidPiece place = place_around(ways.map, PatchId{1}, {}, {});
  const RigidPiece piece = piece_of_way(ways.map, ways.second_newest_first, {});
  PlaceAnswer answer = search_place(place, piece, {Pose{}, 4, 4, std::numbers::pi}, 0.5, {}).answers.front();
  const double elsewhere = refine(place, piece, answer, 0, {})->log_odds;
  EXPECT_GT(elsewhere, 3) << "it is the very place";
  EXPECT_GT(refine(place, piece, answer, 0, {})->seen_again, 0.9);
  answer.way_m = 30;
  EXPECT_NEAR(refine(place, piece, answer, 0, {})->log_odds, elsewhere + 1.3, 1e-9);
  answer.score -= 0.1;
  EXPECT_NEAR(refine(place, piece, answer, 0, {})->log_odds, elsewhere + 1.3 - 0.76, 1e-9);
}

TEST(Refine, FindsNothingByScansThatFitWorseThanIsAsked) {
  const SeparateWays ways = separate_ways(crooked_room(), way_there, way_back);
  const RigidPiece place = place_around(ways.map, PatchId{1}, {}, {});
  const RigidPiece piece = piece_of_way(ways.map, ways.second_newest_first, {});
  const PlaceAnswer answer =
      search_place(place, piece, {Pose{}, 4, 4, std::numbers::pi}, 0.5, {}).answers.front();
  const double score = refine(place, piece, answer, 0, {})->carrier_score;
  EXPECT_TRUE(refine(place, piece, answer, score - 1e-9, {}));
  EXPECT_FALSE(refine(place, piece, answer, score + 1e-9, {}));
}

TEST(ThinnedPoints, TurnWithTheirPatch) {
  auto patch = std::make_shared<Patch>();
  patch->points.push_back({{2, 0}, {-1, 0}, 7});
  const LocalMap local{PatchId{0}, {{patch, Pose{1, 0, std::numbers::pi / 2}}}};
  const std::vector<ScanPoint> points = thinned_points(local, 0.1);
  ASSERT_EQ(points.size(), 1U);
  EXPECT_NEAR((points[0].position - Eigen::Vector2d(1, 2)).norm(), 0, 1e-12);
  EXPECT_NEAR((points[0].normal - Eigen::Vector2d(0, -1)).norm(), 0, 1e-12);
  EXPECT_EQ(points[0].beam, 7);
}

TEST(SearchPlace, FindsNothingElsewhere) {
  Walls other;
  add_box(other, -1.5, -9, 1.5, 9);
  add_box(other, -1.5, -3, -0.5, -2);
  SeparateWays ways = separate_ways(furnished_room(), way_there, {});
  const auto first_other = static_cast<std::int32_t>(way_there.size());
  add_way(ways.map, other, {{0, -7, 1.5}, {0.3, -5, 1.6}, {0.6, -2, 1.5}, {0, 2, 1.7}}, Pose{});
  std::vector<PatchId> newest_first;
  for (std::int32_t i = first_other + 4; i-- > first_other;) newest_first.push_back(PatchId{i});
  const PlaceSearch search =
      search_place(place_around(ways.map, PatchId{1}, {}, {}), piece_of_way(ways.map, newest_first, {}),
                   {Pose{}, 4, 4, std::numbers::pi}, 0.7, {});
  EXPECT_TRUE(search.answers.empty());
}

// 0 to 4 there and 5 to 8 back; 8, the newest, was matched with 1.
TEST(OwnPart, IsThePieceAndWhatWasMatchedWithIt) {
  SeparateWays ways = separate_ways(crooked_room(), way_there, way_back);
  ways.map.relate(
      odometry_relation(PatchId{1}, PatchId{8}, ominus(way_back.back(), way_there[1]), {100, 100, 100}));
  const std::vector<PatchId> newest = {PatchId{8}, PatchId{7}};
  EXPECT_EQ(own_part(ways.map, piece_of_way(ways.map, newest, {})),
            (std::vector<PatchId>{PatchId{1}, PatchId{6}, PatchId{7}, PatchId{8}}))
      << "6 is beside 7";
}

TEST(PlaceAround, LeavesOutWhatItIsTold) {
  const SeparateWays ways = separate_ways(crooked_room(), way_there, {});
  const auto patches = [&](const std::vector<PatchId>& without) {
    std::vector<PatchId> ids;
    for (const LocalPatch& local : place_around(ways.map, PatchId{1}, without, {}).local.patches)
      ids.push_back(local.patch->id);
    std::ranges::sort(ids);
    return ids;
  };
  EXPECT_EQ(patches({}).size(), way_there.size());
  EXPECT_EQ(patches({PatchId{1}, PatchId{3}}), (std::vector<PatchId>{PatchId{0}, PatchId{2}, PatchId{4}}));
  EXPECT_TRUE(patches({PatchId{0}, PatchId{1}, PatchId{2}, PatchId{3}, PatchId{4}}).empty());
}

TEST(Refine, ACorridorTellsNotHowFarAlong) {
  const SeparateWays ways =
      separate_ways(corridor(), {{0, 0, 0}, {2, 0, 0}, {4, 0, 0}}, {{1, 0.1, 0}, {3, 0, 0}});
  const PlaceAnswer answer{PatchId{1}, Pose{1, 0, 0}, 1, 0, 0};
  EXPECT_FALSE(refine(place_around(ways.map, PatchId{1}, {}, {}),
                      piece_of_way(ways.map, ways.second_newest_first, {}), answer, 0, {}));
}

// One door frame: few beams hold the direction along the corridor, but there is no other such place near.
TEST(Refine, ADoorFrameTellsHowFarAlongACorridor) {
  Walls walls = corridor();
  for (const double side : {-1.0, 1.0}) add_box(walls, 6, side - 0.3, 6.2, side + 0.3);
  const SeparateWays ways = separate_ways(walls, {{0, 0, 0}, {2, 0, 0}, {4, 0, 0}}, {{1, 0.1, 0}, {3, 0, 0}});
  const PlaceAnswer answer{PatchId{1}, Pose{1.05, 0, 0}, 1, 0, 0};
  const auto find = refine(place_around(ways.map, PatchId{1}, {}, {}),
                           piece_of_way(ways.map, ways.second_newest_first, {}), answer, 0, {});
  ASSERT_TRUE(find);
  const double truth_m = find->query == PatchId{4} ? 1 : -1;
  EXPECT_NEAR(find->anchor_from_query.x, truth_m, 0.06);
}

TEST(SharedPart, OneCorridorHasNoWidth) {
  const SeparateWays ways = separate_ways(corridor(), {{0, 0, 0}, {4, 0.1, 0}, {8, -0.1, 0}, {12, 0, 0}}, {});
  const std::vector<PatchId> all = {PatchId{0}, PatchId{1}, PatchId{2}, PatchId{3}};
  EXPECT_LT(width_m(ways.map, all), 0.5);
  const SeparateWays room =
      separate_ways(furnished_room(), {{-3, -2, 0}, {3, -2, 0}, {3, 2, 0}, {-3, 2, 0}}, {});
  EXPECT_GT(width_m(room.map, all), 2);
}

}  // namespace
}  // namespace isthmus
