#include "server/engine/places/place_survey.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "server/engine/sightings/evidence.hpp"
#include "tests/support/walls.hpp"
#include "tests/support/ways.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

/// R1 has driven along a hall of which no two views are alike, and R2 through a part of it.
struct TwoInAHall {
  TwoInAHall() {
    std::vector<Pose> ways[2];
    for (int i = 0; i <= 24; ++i) ways[0].push_back({1.0 * i, 0.1, 0});
    for (int i = 10; i <= 14; ++i) ways[1].push_back({1.0 * i, 0.3, 0});
    first = add_way(map, niched_hall(), ways[0]);
    second = add_way(map, niched_hall(), ways[1], {40, 3, 2}, "R2");
    piece = piece_of_way(map, std::vector<PatchId>(second.rbegin(), second.rend()), options.place_search);
  }
  /// Which of the places are left.
  std::vector<PlaceCandidate> left(const std::vector<PlaceCandidate>& places, double min_score) const {
    std::vector<std::vector<PlaceCandidate>> of_pieces = {{}, places};
    leave_possible(of_pieces, std::vector<RigidPiece>{{}, piece}, map, min_score, options);
    EXPECT_TRUE(of_pieces[0].empty());
    return of_pieces[1];
  }
  static PlaceCandidate at(PatchId anchor) {
    PlaceCandidate place;
    place.anchor = anchor;
    place.window = {Pose{}, 2, 2, std::numbers::pi};
    return place;
  }

  Map map;
  EngineOptions options;
  std::vector<PatchId> first;
  std::vector<PatchId> second;
  RigidPiece piece;
};

TEST(PlaceSurvey, LeavesPlacesWhereThePieceMayLie) {
  const TwoInAHall hall;
  const std::vector<PlaceCandidate> places = hall.left(
      {TwoInAHall::at(hall.first[2]), TwoInAHall::at(hall.first[14]), TwoInAHall::at(hall.first[22])},
      0.9);  // its long walls fit everywhere
  ASSERT_EQ(places.size(), 1U);
  EXPECT_EQ(places[0].anchor, hall.first[14]) << "beside it";
}

TEST(PlaceSurvey, LeavesPlacesThatTheMapNames) {
  const TwoInAHall hall;
  PlaceCandidate on_own_island = TwoInAHall::at(hall.first[2]);
  on_own_island.way_m = 20;
  const std::vector<PlaceCandidate> places = hall.left({TwoInAHall::at(hall.first[2]), on_own_island}, 0.9);
  ASSERT_EQ(places.size(), 1U);
  EXPECT_EQ(places[0].way_m, 20);
}

TEST(PlaceSurvey, LeavesAllPlacesOfAnIslandThatIsTooWideForAGrid) {
  TwoInAHall hall;
  const PatchId far = hall.map.manifold().next_id();
  hall.map.add(make_tag_patch(far, 50, 0), {3'000, 3'000, 0});
  hall.map.relate(odometry_relation(hall.first[24], far, hall.map.relative_pose(hall.first[24], far)));
  EXPECT_EQ(hall.left({TwoInAHall::at(hall.first[2]), TwoInAHall::at(hall.first[14])}, 1).size(), 2U);
}

}  // namespace
}  // namespace isthmus
