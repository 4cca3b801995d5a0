#include "server/engine/places/answers_along_way.hpp"

#include <gtest/gtest.h>

#include "tests/support/ways.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

// A way of 60 m, a patch a metre, whose last twenty metres may be its first ones once more.
struct WaySearched {
  WaySearched() {
    std::vector<Pose> poses;
    for (int i = 0; i < 60; ++i) poses.push_back({static_cast<double>(i), 0, 0});
    add_way(map, furnished_room(), poses);
  }

  // The piece that ends at a patch was found so far back along the way, so well.
  struct Found {
    int back;
    double score;
  };
  void search(int newest, const std::vector<Found>& found) {
    SearchedPiece piece{PatchId{newest}, static_cast<double>(newest), {}};
    for (const auto& [back, score] : found)
      piece.best_first.push_back({PatchId{newest - back}, {}, score, 0, 0});
    answers.add(std::move(piece), options.answers_along_way);
  }
  // Where the newest piece lies; below zero: nobody knows.
  int place() const {
    const auto answer = answers.all_but_certain(map, options);
    return answer ? answer->anchor.value : -1;
  }

  Map map;
  EngineOptions options;
  AnswersAlongWay answers;
};

// At the true place they fit all along, elsewhere now here and now there.
TEST(AnswersAlongWay, TellTheTruePlaceFromThoseThatLookAlike) {
  WaySearched way;
  int piece = 0;
  for (int newest = 41; newest < 59; newest += 2)
    way.search(newest, {{40, 0.74}, {20 + 3 * (++piece % 3), 0.72}, {31 - piece, 0.69}});
  EXPECT_EQ(way.place(), 57 - 40);
}

TEST(AnswersAlongWay, DoNotTellPlacesThatFitAsWellAllAlong) {
  WaySearched way;
  for (int newest = 41; newest < 59; newest += 2) way.search(newest, {{40, 0.72}, {30, 0.7}});
  EXPECT_EQ(way.place(), -1);
}

TEST(AnswersAlongWay, SayNothingAfterOnePiece) {
  WaySearched way;
  way.search(57, {{40, 0.72}, {30, 0.5}});
  EXPECT_EQ(way.place(), -1);
}

// Ground that is new and looks alike: what fits now did not fit before.
TEST(AnswersAlongWay, SayNothingWhereTheWayBeforeWasElsewhere) {
  WaySearched way;
  for (int newest = 41; newest < 59; newest += 2) way.search(newest, {{newest % 4 == 1 ? 40 : 25, 0.72}});
  EXPECT_EQ(way.place(), -1);
}

TEST(AnswersAlongWay, ForgetsWhatWasFoundLongAgo) {
  WaySearched way;
  way.options.answers_along_way.max_way_m = 4;
  int piece = 0;
  for (int newest = 41; newest < 59; newest += 2)
    way.search(newest, {{40, 0.74}, {20 + 3 * (++piece % 3), 0.72}, {31 - piece, 0.69}});
  EXPECT_EQ(way.place(), -1) << "three pieces are not enough";
}

TEST(AnswersAlongWay, HaveNoPlaceOnTheMapOfARobotThatIsTakenOut) {
  WaySearched way;
  for (int newest = 41; newest < 59; newest += 2) way.search(newest, {{40, 0.7}});
  ASSERT_EQ(way.place(), 57 - 40);
  way.answers.forget_robot(way.map, "R1");
  EXPECT_EQ(way.place(), -1);
}

}  // namespace
}  // namespace isthmus
