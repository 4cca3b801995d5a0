#include "server/wire/page/texts/page_texts.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>

#include "tests/unit/wire/page/page_maps.hpp"

namespace isthmus {
namespace {

using Json = nlohmann::json;
using testing::map_of_islands;
using testing::shown_of;

/// R1, a metre ahead of patch 1.
RobotPose pose_of_r1() {
  RobotPose pose;
  pose.robot = "R1";
  pose.utime = 1'000'000;
  pose.island = PatchId{1};
  pose.pose = {PatchId{1}, {1, 0, 0}};
  pose.map_from_robot = {9, 9, 0};
  return pose;
}

TEST(PageTexts, ARobotIsWhereTheMapHasItsPatchNow) {
  MapCopy map = map_of_islands({{{0, 0, 0}}, {{2, 3, std::numbers::pi / 2}}});
  Trails trails;
  trails.add(pose_of_r1());
  const auto at = [&] { return Json::parse(robots_text(trails, shown_of(map)))[0].at("at"); };
  EXPECT_EQ(at(), Json({1, 2.0, 4.0, 1.571}));
  map.graph.add(testing::odometry_between(0, 1));
  map.poses[1] = {5, 0, 0};
  EXPECT_EQ(at(), Json({0, 6.0, 0.0, 0.0})) << "merged";
  EXPECT_EQ(Json::parse(trails_text(trails, shown_of(map))), Json({{"R1", {{0, 6.0, 0.0}}}}));
  map = map_of_islands({{{0, 0, 0}}});
  EXPECT_EQ(at(), Json({1, 9.0, 9.0, 0.0})) << "on a patch that the map does not have yet";
}

/// R3 was on the map before R2.
TEST(PageTexts, ARobotThatJoinsTakesNoOthersColour) {
  MapCopy map = map_of_islands({{{0, 0, 0}}});
  map.health = {{"R1", {}, {}}, {"R3", {}, {}}};
  const auto colours = [&] { return Json::parse(status_text(shown_of(map))).at("colours"); };
  for (const char* robot : {"R1", "R3", "R1"}) map.sessions.push_back({robot, 0, 0, 0, PatchId{0}});
  EXPECT_EQ(colours(), Json({"R1", "R3"}));
  map.health.push_back({"R2", {}, {}});
  EXPECT_EQ(colours(), Json({"R1", "R3", "R2"}));
  map.sessions.push_back({"R2", 0, 0, 0, PatchId{0}});
  EXPECT_EQ(colours(), Json({"R1", "R3", "R2"}));
}

TEST(PageTexts, ASightingIsDrawnFromWhereItsObserverWas) {
  MapCopy map = map_of_islands({{{0, 0, 0}}, {{2, 3, std::numbers::pi / 2}}});
  map.sightings = {{{"R1", 1'100'000, 7, 2, 0.1, 0, 0.1}, Verdict::accepted, Reason::agrees_with_map, {}},
                   {{"R1", 9'000'000, 8, 2, 0.1, 0, 0.1}, Verdict::waiting, Reason::not_placed_yet, {}}};
  Trails trails;
  trails.add(pose_of_r1());
  const Json sightings = Json::parse(sightings_text(trails, shown_of(map)));
  ASSERT_EQ(sightings.size(), 2U);
  EXPECT_EQ(sightings[0].at("barcode"), 8) << "the newest first";
  EXPECT_TRUE(sightings[0].at("ray").is_null()) << "nobody knows where R1 was then";
  EXPECT_EQ(sightings[1].at("ray"), Json({1, 2.0, 4.0, 2.0, 6.0}));
  EXPECT_EQ(sightings[1].at("reason"), "agrees_with_map");
}

TEST(PageTexts, ASightingIsAsOldAsItIsByTheServersClock) {
  MapCopy map = map_of_islands({{{0, 0, 0}}});
  map.sightings = {{{"R1", 1'100'000, 7, 2, 0.1, 0, 0.1}, Verdict::accepted, Reason::agrees_with_map, {}},
                   {{"R2", 1'100'000, 7, 2, 0.1, 0, 0.1}, Verdict::accepted, Reason::agrees_with_map, {}}};
  map.health = {{"R1", {}, {}}};
  map.health[0].figures.clock_ahead_s = -1000;
  const Json sightings = Json::parse(sightings_text({}, shown_of(map)));
  EXPECT_NEAR(sightings[1].at("time"), 1001.1, 1e-6);
  EXPECT_NEAR(sightings[0].at("time"), 1.1, 1e-6) << "nothing is known of R2's clock";
}

TEST(PageTexts, ClosuresComeNewestFirstWithTheirRelations) {
  MapCopy map = map_of_islands({{{0, 0, 0}, {1, 0, 0}}});
  Relation relation = testing::odometry_between(0, 1);
  relation.origin = {OriginKind::propagation, ClosureId{1}, -1};
  map.graph.add(relation);
  for (int i = 0; i < 2; ++i) {
    ClosureRecord record;
    record.id = ClosureId{i};
    record.state = i == 0 ? ClosureState::waiting : ClosureState::accepted;
    map.closures.push_back(record);
  }
  map.forbidden = {ClosureId{0}};
  const Json closures = Json::parse(closures_text(shown_of(map)));
  ASSERT_EQ(closures.size(), 2U);
  EXPECT_EQ(closures[0].at("id"), 1);
  EXPECT_EQ(closures[0].at("forbidden"), false);
  EXPECT_EQ(closures[1].at("forbidden"), true);
  EXPECT_EQ(closures[0].at("relations"), 1);
  EXPECT_EQ(closures[1].at("state"), "waiting");
}

TEST(PageTexts, AClosureIsDrawnWhereItsFirstRelationIsAndToldWithItsTrial) {
  MapCopy map = map_of_islands({{{0, 0, 0}, {1, 0, 0}, {2, 3, 0}}});
  for (const int end : {2, 1}) {
    Relation relation = testing::odometry_between(0, end);
    relation.origin = {OriginKind::propagation, ClosureId{1}, -1};
    map.graph.add(relation);
  }
  map.closures.resize(2);
  for (int i = 0; i < 2; ++i) map.closures[static_cast<std::size_t>(i)].id = ClosureId{i};
  TrialAccount& trial = map.closures[1].account;
  trial.supporters = 3;
  trial.compared = 40;
  trial.matched = 34;
  trial.contradiction = 0.0123;
  trial.revisit_log_odds = 5;
  trial.fit_log_odds = -1.5;
  const Json closures = Json::parse(closures_text(shown_of(map)));
  EXPECT_EQ(closures[0].at("line"), Json::parse("[0, 0.0, 0.0, 2.0, 3.0]"));
  EXPECT_EQ(closures[0].at("relations"), 2);
  EXPECT_EQ(closures[0].at("trial"), Json::parse(R"({"supporters": 3, "compared": 40, "matched": 34,
      "contradiction": 0.012, "own_contradiction": 0.0, "log_odds": 3.5})"));
  EXPECT_TRUE(closures[1].at("line").is_null());
  EXPECT_TRUE(closures[1].at("trial").is_null()) << "it has had none";
}

TEST(PageTexts, RobotsThatHaveNotBeenHeardAndThoseLeftOutAreToldToo) {
  MapCopy map = map_of_islands({{{0, 0, 0}}});
  map.left_out = {PatchId{0}};
  HealthRecord health;
  health.robot = "R1";
  map.health = {health};
  ShownMap shown = shown_of(map);
  warning_t warning{};
  warning.kind = "clock_ahead";
  warning.text = "R1's clock is ahead";
  warning.begin_utime = 2'500'000;
  shown.view.status.warnings = {warning};
  const Json status = Json::parse(status_text(shown));
  EXPECT_EQ(status.at("left_out"), Json({"R1"}));
  ASSERT_EQ(status.at("robots").size(), 1U);
  EXPECT_EQ(status.at("robots")[0].at("heard"), 0);
  EXPECT_EQ(status.at("warnings")[0].at("text"), "R1's clock is ahead");
  EXPECT_EQ(status.at("warnings")[0].at("kind"), "clock_ahead");
  EXPECT_EQ(status.at("warnings")[0].at("since"), 2.5);
}

TEST(PageTexts, WhatIsNoNumberIsNoBrokenText) {
  MapCopy map = map_of_islands({{{0, 0, 0}}});
  map.poses[0].x = std::numeric_limits<double>::quiet_NaN();
  Trails trails;
  RobotPose pose = pose_of_r1();
  pose.pose.patch = PatchId{0};
  trails.add(pose);
  EXPECT_EQ(Json::parse(robots_text(trails, shown_of(map)))[0].at("at")[1], 0);
}

}  // namespace
}  // namespace isthmus
