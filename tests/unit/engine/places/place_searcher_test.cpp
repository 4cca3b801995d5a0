#include "server/engine/places/place_searcher.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/ways.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

// Along a hall of which no two views are alike, a metre a patch.
std::vector<Pose> along_the_hall(double from_x, int patches) {
  std::vector<Pose> poses;
  for (int i = 0; i < patches; ++i) poses.push_back({from_x + i, 0, 0});
  return poses;
}

SearchTerms terms() {
  SearchTerms terms;
  terms.min_score = terms.min_score_anywhere = 0.6;
  return terms;
}

PlaceCandidate anywhere_around(PatchId anchor, double half_yaw_rad = 0.3) {
  return {anchor, {Pose{}, 4, 4, half_yaw_rad}};
}

// What a robot saw on 5 m of the hall is searched for on maps of it.
struct Searched {
  explicit Searched(int halls) {
    for (int hall = 0; hall < halls; ++hall)
      add_way(map, niched_hall(), along_the_hall(0, 16), Pose{0, 40.0 * hall, 0});
    const std::vector<PatchId> way = add_way(sketch, niched_hall(), along_the_hall(4, 6));
    searcher.look_for(piece_of_way(sketch, std::vector<PatchId>(way.rbegin(), way.rend()), {}));
  }
  PlaceDecision decide() {
    while (const PlaceCandidate* next = searcher.next())
      searcher.search_next(
          place_around(map, next->anchor,
                       its.on_the_map ? own_part(map, searcher.piece()) : std::vector<PatchId>{}, options),
          its, options);
    return searcher.decide(map, its, options);
  }

  Map map;
  Map sketch;
  EngineOptions options;
  SearchTerms its = terms();
  PlaceSearcher searcher;
};

TEST(PlaceSearcher, FindsTheOnePlaceAmongThoseItSearches) {
  Searched searched(1);
  searched.searcher.add({anywhere_around(PatchId{1}), anywhere_around(PatchId{9})});
  const PlaceDecision decision = searched.decide();
  ASSERT_TRUE(decision.find);
  EXPECT_FALSE(decision.ambiguous);
  EXPECT_EQ(decision.find->anchor, PatchId{9}) << "the way ends at 9 m";
  EXPECT_EQ(decision.price_us, 5'000);
}

TEST(PlaceSearcher, FindsNothingWhereTwoPlacesFitAboutAsWell) {
  Searched searched(2);
  searched.searcher.add({anywhere_around(PatchId{9}), anywhere_around(PatchId{16 + 9})});
  const PlaceDecision decision = searched.decide();
  EXPECT_TRUE(decision.ambiguous);
  EXPECT_FALSE(decision.find);
  EXPECT_EQ(decision.price_us, 0) << "nothing was matched";
}

// Three halls that are alike, searched at two anchors each: the best answers lie at three places.
TEST(PlaceSearcher, TellsHowManyPlacesLookAlike) {
  for (const int halls : {1, 2, 3}) {
    Searched searched(halls);
    for (int hall = 0; hall < halls; ++hall)
      searched.searcher.add(
          {anywhere_around(PatchId{16 * hall + 9}), anywhere_around(PatchId{16 * hall + 8})});
    searched.decide();
    const std::vector<PlaceAnswer>& answers = searched.searcher.best_first();
    EXPECT_GT(answers.size(), static_cast<std::size_t>(halls));
    EXPECT_EQ(look_alikes(searched.map, answers, searched.options), halls);
  }
}

TEST(PlaceSearcher, CountsNoPlaceThatFitsClearlyWorseAsOneThatLooksAlike) {
  Searched searched(2);
  const PlaceAnswer best{PatchId{9}, Pose{}, 0.9, 0, 0};
  PlaceAnswer worse{PatchId{16 + 9}, Pose{}, 0, 0, 0};
  for (const double share : {0.99, 1.01}) {
    worse.score = share * searched.options.ambiguity.share * best.score;
    EXPECT_EQ(look_alikes(searched.map, {best, worse}, searched.options), share < 1 ? 1 : 2);
  }
}

TEST(PlaceSearcher, PaysForEachEvaluationOfASearch) {
  const auto price_us = [](double of_an_evaluation) {
    Searched searched(1);
    searched.options.place_search.evaluation_price_us = of_an_evaluation;
    searched.searcher.add({anywhere_around(PatchId{9})});
    return searched.searcher.search_next(place_around(searched.map, PatchId{9}, {}, searched.options),
                                         searched.its, searched.options);
  };
  EXPECT_EQ(price_us(0), 1'000) << "a step";
  const std::int64_t of_all = price_us(1) - 1'000;
  EXPECT_GT(of_all, 100) << "an evaluation has a microsecond";
  EXPECT_NEAR(static_cast<double>(price_us(0.1) - 1'000), 0.1 * static_cast<double>(of_all), 1);
}

TEST(PlaceSearcher, HasNothingToDecideWithoutPlaces) {
  Searched searched(1);
  EXPECT_FALSE(searched.searcher.has_places());
  EXPECT_EQ(searched.searcher.next(), nullptr);
  const PlaceDecision decision = searched.decide();
  EXPECT_FALSE(decision.ambiguous);
  EXPECT_FALSE(decision.find);
}

// A score that is an answer on the robot's own island is none where nothing says where to look.
TEST(PlaceSearcher, AsksForMoreWhereTheMapSaysNothing) {
  Searched searched(1);
  searched.its.min_score = 0.6;
  searched.its.min_score_anywhere = 1.1;
  PlaceCandidate near = anywhere_around(PatchId{9});
  searched.searcher.add({near});
  EXPECT_FALSE(searched.decide().find);
  Searched told(1);
  told.its = searched.its;
  near.way_m = 30;
  near.sigma_m = 2;
  told.searcher.add({near});
  const PlaceDecision decision = told.decide();
  ASSERT_TRUE(decision.find);
  EXPECT_EQ(decision.find->way_m, 30);
  EXPECT_EQ(decision.find->sigma_m, 2);
}

// Where its own patches lie is what is asked.
TEST(PlaceSearcher, FindsNoPieceInItself) {
  for (const bool on_the_map : {false, true}) {
    Searched searched(0);
    std::vector<PatchId> way = add_way(searched.map, niched_hall(), along_the_hall(4, 6));
    std::ranges::reverse(way);
    searched.its.on_the_map = on_the_map;
    searched.searcher.look_for(piece_of_way(searched.map, way, {}));
    searched.searcher.add({anywhere_around(way.front())});
    EXPECT_EQ(searched.decide().find.has_value(), !on_the_map);
  }
}

// Two layers of one hall, 1.5 m apart: the map is sure of both, and the piece is of the second.
TEST(PlaceSearcher, FindsAPieceInAnotherLayerOfItsPlace) {
  Searched searched(1);
  std::vector<PatchId> way = add_way(searched.map, niched_hall(), along_the_hall(4, 6), Pose{0, 1.5, 0});
  searched.map.relate(odometry_relation(
      PatchId{0}, way.front(), searched.map.relative_pose(PatchId{0}, way.front()), {1e4, 1e4, 1e5}));
  std::ranges::reverse(way);
  searched.its.on_the_map = true;
  searched.searcher.look_for(piece_of_way(searched.map, way, {}));
  searched.searcher.add({anywhere_around(PatchId{9})});
  const PlaceDecision decision = searched.decide();
  ASSERT_TRUE(decision.find);
  const Pose query_at = along_the_hall(4, 6)[static_cast<std::size_t>(decision.find->query.value - 16)];
  EXPECT_NEAR(decision.find->anchor_from_query.x, query_at.x - 9, 0.05);
  EXPECT_NEAR(decision.find->anchor_from_query.y, 0, 0.05) << "not where the map has it";
}

// What was not searched to its end might have fitted better.
TEST(PlaceSearcher, FindsNothingWhereTheSearchGaveUpAtAnotherPlace) {
  Searched searched(1);
  searched.searcher.add({anywhere_around(PatchId{9}), anywhere_around(PatchId{1})});
  searched.searcher.search_next(place_around(searched.map, PatchId{9}, {}, searched.options), searched.its,
                                searched.options);
  searched.options.place_search.coarse_evaluations = 1;
  const PlaceDecision decision = searched.decide();
  EXPECT_TRUE(decision.ambiguous);
  EXPECT_FALSE(decision.find);
}

// Where the search gives up, it takes two of half the yaw, or remains without an answer.
TEST(PlaceSearcher, SearchesInHalvesWhatIsTooMuchForOneStep) {
  for (const bool halves : {false, true}) {
    Searched searched(1);
    searched.options.place_search.coarse_evaluations = 1;
    if (halves) searched.its.min_half_window_rad = 0.2;
    searched.searcher.add({anywhere_around(PatchId{9}, 0.8)});
    int steps = 0;
    for (; const PlaceCandidate* next = searched.searcher.next(); ++steps)
      searched.searcher.search_next(place_around(searched.map, next->anchor, {}, searched.options),
                                    searched.its, searched.options);
    EXPECT_EQ(steps, halves ? 7 : 1) << "0.8, twice 0.4, and four times 0.2";
  }
}

}  // namespace
}  // namespace isthmus
