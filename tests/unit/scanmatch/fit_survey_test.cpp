#include "scanmatch/fit_survey.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "tests/support/walls.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

constexpr double all_around = std::numbers::pi;

/// A furnished room as points, and scans of it.
struct ARoom {
  static std::vector<ScanPoint> seen_from(const Pose& pose) {
    return patch_from(furnished_room(), PatchId{0}, pose)->points;
  }
  static std::vector<Eigen::Vector2d> points() {
    std::vector<Eigen::Vector2d> points;
    for (const Pose& pose : {Pose{-2, -1.5, 0}, Pose{1, 1, 2}, Pose{2, -1, 4}})
      for (const ScanPoint& point : seen_from(pose)) points.push_back(pose * point.position);
    return points;
  }
  SurveyedScan scan_from(const Pose& pose, double min_score) const {
    return {survey, seen_from(pose), min_score, options};
  }

  CorrelativeOptions options;
  FitSurvey survey{points(), {-8, -8}, {8, 8}, options};
};

SearchWindow window_at(const Pose& centre, double half_m, double half_yaw_rad) {
  return {centre, half_m, half_m, half_yaw_rad};
}

TEST(FitSurvey, SaysWhereAScanMayLie) {
  const ARoom room;
  const Pose truth{0.6, -0.4, 1.1};
  SurveyedScan scan = room.scan_from(truth, 0.7);
  EXPECT_TRUE(scan.may_fit({}, window_at(truth, 0.3, 0.1)));
  EXPECT_TRUE(scan.may_fit({}, window_at({0, 0, 0}, 1, all_around)));
  EXPECT_FALSE(scan.may_fit({}, window_at({6, 6, 1.1}, 1, all_around)));
  EXPECT_FALSE(scan.may_fit({}, window_at({0.6, -0.4, 1.1 + 2}, 0.3, 0.1))) << "turned";
}

// A place's frame lies anyhow in the map, and its window in that.
TEST(FitSurvey, TakesWindowsInTheFrameOfAPlace) {
  const ARoom room;
  const Pose truth{0.6, -0.4, 1.1};
  SurveyedScan scan = room.scan_from(truth, 0.7);
  const Pose map_from_place{-4, 3, -2.5};
  EXPECT_TRUE(scan.may_fit(map_from_place, window_at(inverse(map_from_place) * truth, 0.3, 0.1)));
  EXPECT_FALSE(scan.may_fit(map_from_place, window_at(truth, 0.3, 0.1)));
  // Turned by a right angle, what is wide along x is wide along y of the map.
  const Pose turned{truth.x, truth.y + 4, std::numbers::pi / 2};
  EXPECT_TRUE(scan.may_fit(turned, {Pose{0, 0, truth.yaw - turned.yaw}, 4.2, 0.2, 0.1}));
  EXPECT_FALSE(scan.may_fit(turned, {Pose{0, 0, truth.yaw - turned.yaw}, 0.2, 0.2, 0.1}));
}

// Where a search finds the scan with the score that is asked for, so does the survey; and it leaves out most
// of what a search would look through in vain.
TEST(FitSurvey, LeavesOutNothingThatASearchFinds) {
  const ARoom room;
  const std::vector<Eigen::Vector2d> points = ARoom::points();
  constexpr double min_score = 0.6;
  int found = 0, left_out = 0;
  for (const Pose& truth : {Pose{0.6, -0.4, 1.1}, Pose{-1.2, 0.7, 3}, Pose{1.7, 1.3, -2}}) {
    SurveyedScan scan = room.scan_from(truth, min_score);
    const std::vector<ScanPoint> seen = ARoom::seen_from(truth);
    for (double x = -6; x <= 6; x += 1.5) {
      for (double y = -6; y <= 6; y += 1.5) {
        const SearchWindow window = window_at({x, y, 0}, 0.8, all_around);
        CorrelativeOptions search = room.options;
        search.max_evaluations = 10'000'000;
        const bool fits = search_window(points, seen, window, search, min_score).score >= min_score;
        const bool may_fit = scan.may_fit({}, window);
        found += fits ? 1 : 0;
        left_out += may_fit ? 0 : 1;
        EXPECT_TRUE(may_fit || !fits) << x << ' ' << y;
      }
    }
  }
  EXPECT_GE(found, 3);
  EXPECT_GE(left_out, 200) << "of 243";
}

}  // namespace
}  // namespace isthmus
