#include "server/engine/places/places_job.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <set>
#include <utility>

#include "tests/support/walls.hpp"
#include "tests/support/ways.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

// Once round a block of 10 m by 10 m, by odometry alone: the end lies beside the beginning, far over the map.
//
//     29 - 28 - ... - 20
//      |               |
//     ...             ...
//      |               |
//      0 -  1 - ... - 10
Map round_a_walled_block() {
  Walls walls;
  add_box(walls, -2, -2, 12, 12);
  add_box(walls, 1.5, 1.5, 8.5, 8.5);
  Map map;
  for (int i = 0; i < 39; ++i) {
    const double along = i % 10;
    const Pose corners[] = {{along, 0, 0}, {10, along, 1.57}, {10 - along, 10, 3.14}, {0, 10 - along, -1.57}};
    const PatchId id = map.manifold().next_id();
    map.add(patch_from(walls, id, corners[i / 10]), corners[i / 10]);
    if (i == 0) continue;
    Relation relation;
    relation.a = PatchId{i - 1};
    relation.b = id;
    relation.kind = RelationKind::odometry;
    relation.measurement =
        RelativePose{map.relative_pose(relation.a, id), Eigen::Vector3d(400, 400, 4e3).asDiagonal()};
    map.relate(relation);
  }
  return map;
}

void expect_same(const std::vector<PlaceCandidate>& given, const std::vector<PlaceCandidate>& expected) {
  ASSERT_EQ(given.size(), expected.size());
  for (std::size_t i = 0; i < given.size(); ++i) {
    EXPECT_EQ(given[i].anchor, expected[i].anchor);
    EXPECT_EQ(given[i].window.centre, expected[i].window.centre);
    EXPECT_EQ(given[i].window.half_x_m, expected[i].window.half_x_m);
    EXPECT_EQ(given[i].window.half_y_m, expected[i].window.half_y_m);
    EXPECT_EQ(given[i].window.half_yaw_rad, expected[i].window.half_yaw_rad);
    EXPECT_EQ(given[i].sigma_m, expected[i].sigma_m);
  }
}

/// What is asked of the newest patch and the four before.
PlaceQuestion question_of(std::int32_t newest) {
  PlaceQuestion question;
  for (std::int32_t i = newest; i > newest - 5; --i) question.newest_first.push_back(PatchId{i});
  return question;
}

constexpr double any_score = 0;

TEST(PlacesJob, SaysWhatTheMapSaidWhenItWasBegunWhateverBecameOfTheMap) {
  Map map = round_a_walled_block();
  const std::vector<PlaceQuestion> asked = {question_of(38), question_of(5), question_of(36)};
  std::vector<std::vector<PlaceCandidate>> expected;
  for (const PlaceQuestion& one : asked)
    expected.push_back(places_on_own_island(
        map, one, WayNetwork(map), IslandCovariances(map.graph(), map.manifold().poses(), PatchId{0}), {}));
  ASSERT_FALSE(expected.at(0).empty());

  const PlacesJob job(map, asked, 0, {}, any_score);
  map.move_island(PatchId{0}, {3, 4, 1});
  map.refit_island(PatchId{0});
  ASSERT_EQ(job.places().size(), asked.size());
  for (std::size_t i = 0; i < asked.size(); ++i) expect_same(job.places()[i], expected[i]);
}

TEST(PlacesJob, LooksOnOtherIslandsWhereThatIsAsked) {
  Map map = round_a_walled_block();
  for (int island = 0; island < 2; ++island) {
    const Map other = round_a_walled_block();
    const int first = map.manifold().next_id().value;
    for (const PatchPtr& patch : other.manifold().patches()) {
      Patch copy = *patch;
      copy.id = map.manifold().next_id();
      const Pose pose = other.manifold().pose(patch->id);
      map.add(std::make_shared<const Patch>(std::move(copy)), pose);
    }
    for (int i = first + 1; i < first + 39; ++i)
      map.relate(
          odometry_relation(PatchId{i - 1}, PatchId{i}, map.relative_pose(PatchId{i - 1}, PatchId{i})));
  }
  const auto islands = [&](const PlaceQuestion& question, double min_score = any_score) {
    EngineOptions options;
    options.place_candidates.max_places = 12;  // of one island as many as there are
    std::set<IslandId> found;
    const PlacesJob job(map, {question}, 0, options, min_score);
    for (const PlaceCandidate& place : job.places()[0]) found.insert(map.graph().island(place.anchor));
    return found;
  };
  PlaceQuestion question = question_of(38);
  EXPECT_EQ(islands(question), (std::set<IslandId>{PatchId{0}, PatchId{39}, PatchId{78}}));
  EXPECT_EQ(islands(question, 0.5).size(), 3U) << "they are the same building";
  EXPECT_EQ(islands(question, 1).size(), 1U) << "where the piece cannot lie with that score";
  question.in_turn = true;
  EXPECT_EQ(islands(question).size(), 2U) << "its own and another";
  question.on_other_islands = false;
  EXPECT_EQ(islands(question), (std::set<IslandId>{PatchId{0}}));
}

TEST(PlacesJob, IsDueByTheTimeThatPassesAndTheSizeOfTheMapAlone) {
  const Map map = round_a_walled_block();
  const PlacesJob job(map, {question_of(38)}, 5'000'000, {}, any_score);
  EXPECT_FALSE(job.is_due(5'000'000));
  EXPECT_FALSE(job.is_due(5'116'999));
  EXPECT_TRUE(job.is_due(5'117'000));
  const PlacesJob later(map, {question_of(38)}, 6'000'000, {}, any_score);
  EXPECT_FALSE(later.is_due(6'116'999));
}

}  // namespace
}  // namespace isthmus
