#include "server/wire/page/texts/asked.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <numbers>

#include "server/wire/page/texts/drawn_points.hpp"
#include "tests/unit/wire/page/page_maps.hpp"

namespace isthmus {
namespace {

using Json = nlohmann::json;
using testing::map_of_islands;
using testing::shown_of;

path_pose_t on_patch(int patch, double x) {
  path_pose_t pose{};
  pose.patch = patch;
  pose.patch_from_robot[0] = x;
  return pose;
}

reply_t path_of(const std::string& asker, std::vector<path_pose_t> poses, std::int64_t utime = 1) {
  reply_t reply{};
  reply.done = 1;
  reply.asker = asker;
  reply.kind = "path";
  reply.utime = utime;
  reply.poses = std::move(poses);
  return reply;
}

/// Patch 1 looks along y.
MapCopy two_islands() { return map_of_islands({{{0, 0, 0}}, {{2, 3, std::numbers::pi / 2}}}); }

TEST(Asked, APathIsDrawnWhereTheMapHasItsPatchesNow) {
  Asked asked;
  asked.add(path_of("R1", {on_patch(1, 0), on_patch(1, 1.234567)}));
  EXPECT_EQ(
      Json::parse(asked.text(shown_of(two_islands()), 2)),
      Json::parse(R"([{"asker": "R1", "kind": "path", "island": 1, "points": [[2.0, 3.0], [2.0, 4.23]]}])"));
  MapCopy refitted = two_islands();
  refitted.poses[1].x = 5;
  EXPECT_EQ(Json::parse(asked.text(shown_of(refitted), 2))[0].at("points")[0], Json({5.0, 3.0}));
}

TEST(Asked, WhatLiesOnAnotherIslandOrIsNotOnTheMapYetIsLeftOut) {
  Asked asked;
  asked.add(path_of("R1", {on_patch(9, 0), on_patch(0, 1), on_patch(1, 0), on_patch(-1, 0), on_patch(0, 2)}));
  const Json path = Json::parse(asked.text(shown_of(two_islands()), 2))[0];
  EXPECT_EQ(path.at("island"), 0);
  EXPECT_EQ(path.at("points"), Json({{1.0, 0.0}, {2.0, 0.0}}));
}

TEST(Asked, FrontiersComeWithTheirGain) {
  reply_t reply = path_of("R1", {});
  reply.kind = "frontiers";
  frontier_t frontier{};
  frontier.viewpoint = on_patch(0, 3);
  frontier.gain_m2 = 12.5;
  reply.frontiers = {frontier};
  Asked asked;
  asked.add(reply);
  EXPECT_EQ(Json::parse(asked.text(shown_of(two_islands()), 2))[0].at("points"), Json({{3.0, 0.0, 12.5}}));
}

TEST(Asked, RefusalsAndAnswersOfOtherKindsAreNotShown) {
  Asked asked;
  reply_t refused = path_of("R1", {on_patch(0, 1)});
  refused.done = 0;
  asked.add(refused);
  asked.add(path_of("R2", {}));
  EXPECT_EQ(asked.text(shown_of(two_islands()), 2), "[]");
}

TEST(Asked, AnAnswerIsShownForAMinuteAndOnlyTheNewestOfAnAsker) {
  Asked asked;
  asked.add(path_of("R1", {on_patch(0, 1)}, 1));
  asked.add(path_of("R1", {on_patch(0, 2)}, 5));
  const auto shown = shown_of(two_islands());
  const Json paths = Json::parse(asked.text(shown, 5 + Asked::shown_us));
  ASSERT_EQ(paths.size(), 1U);
  EXPECT_EQ(paths[0].at("points"), Json({{2.0, 0.0}}));
  EXPECT_EQ(asked.text(shown, 6 + Asked::shown_us), "[]");
}

TEST(Asked, OfManyAskersTheNewestAreShown) {
  Asked asked;
  for (std::size_t i = 0; i <= Asked::max_askers; ++i)
    asked.add(path_of("R" + std::to_string(i), {on_patch(0, 1)}, 100 - static_cast<std::int64_t>(i)));
  const Json paths = Json::parse(asked.text(shown_of(two_islands()), 100));
  EXPECT_EQ(paths.size(), Asked::max_askers);
  for (const Json& path : paths) EXPECT_NE(path.at("asker"), "R" + std::to_string(Asked::max_askers));
}

TEST(DrawnPoints, ALongPathIsThinnedAndKeepsItsEnds) {
  std::vector<path_pose_t> path;
  for (int i = 0; i < 10'000; ++i) path.push_back(on_patch(0, i));
  const std::vector<ManifoldPose> thin = thinned(path);
  EXPECT_LE(thin.size(), max_drawn_poses + 1);
  EXPECT_EQ(thin.front().patch_from_object.x, 0);
  EXPECT_EQ(thin.back().patch_from_object.x, 9'999);
  EXPECT_TRUE(thinned({}).empty());
}

}  // namespace
}  // namespace isthmus
