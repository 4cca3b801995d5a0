// The recorded UTIAS MRCLAM set 6: what the import makes of it, held against its motion capture.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>

#include "server/feature_maps/feature_estimator.hpp"
#include "server/feature_maps/output/feature_files.hpp"
#include "tests/support/recorded_data.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tools/evaluate/alignment.hpp"
#include "tools/evaluate/tags.hpp"
#include "tools/evaluate/trajectories.hpp"
#include "tools/import/mrclam.hpp"

namespace isthmus {
namespace {

std::string set_directory() { return data_directory() + "/mrclam/MRCLAM_Dataset6"; }

struct TruthOfSet {
  std::map<std::string, Trajectory> robots;
  std::map<std::int32_t, Eigen::Vector2d> tags;
  std::map<std::int32_t, std::string> robot_of_barcode;

  std::optional<Eigen::Vector2d> target(const SightingEvent& sighting) const {
    if (const auto tag = tags.find(sighting.barcode); tag != tags.end()) return tag->second;
    const auto robot = robot_of_barcode.find(sighting.barcode);
    if (robot == robot_of_barcode.end()) return std::nullopt;
    const auto pose = robots.at(robot->second).nearest(sighting.utime, 100'000);
    if (!pose) return std::nullopt;
    return Eigen::Vector2d(pose->map_from_robot.x, pose->map_from_robot.y);
  }
};

class Mrclam : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(set_directory())) GTEST_SKIP() << "no data at " << set_directory();
    what_.directory = set_directory();
    report_ = import_mrclam(what_, [&](const Event& event) { events_.push_back(event); });
    const TemporaryDirectory directory;
    write_mrclam_truth(set_directory(), directory / "truth");
    truth_.robots = read_trajectories(directory / "truth");
    truth_.tags = read_true_tags(directory / "truth/tags.csv");
    for (const RobotEvent& robot : report_.robots) truth_.robot_of_barcode[robot.barcode] = robot.robot;
  }

  MrclamImport what_;
  ImportReport report_;
  std::vector<Event> events_;
  TruthOfSet truth_;
};

TEST_F(Mrclam, MappedByPointsRobotsAndLandmarksAreWithinADecimetre) {
  FeatureEstimator estimator(feature_map_options(FeatureMapKind::points));
  for (const Event& event : events_) estimator.handle(event);
  Outcome outcome;
  estimator.finish_step(outcome);
  const TemporaryDirectory directory;
  write_outputs(estimator.maps(), {}, directory / "map");
  const AbsoluteErrors errors =
      evaluate_absolute(truth_.robots, TeamTrajectories(directory / "map"),
                        {truth_.tags, read_placed_tags(directory / "map/tags.csv")});
  ASSERT_EQ(errors.islands.size(), 1U);
  EXPECT_GT(errors.islands[0].team.count, 35'000U);
  EXPECT_LE(errors.islands[0].team.translation_m.mean, 0.1);
  EXPECT_EQ(errors.islands[0].tags, 15U);
  EXPECT_LE(errors.islands[0].tag_translation_m.mean, 0.1);
}

TEST_F(Mrclam, EveryLineBecomesAnEvent) {
  EXPECT_EQ(report_.robots.size(), 5U);
  EXPECT_EQ(report_.tags, 15);
  EXPECT_EQ(report_.odometry, 301'431);
  EXPECT_EQ(report_.sightings, 19'377);
  EXPECT_EQ(events_.size(), 5U + 15U + 301'431U + 19'377U);
  for (std::size_t i = 1; i < events_.size(); ++i) {
    ASSERT_LE(events_[i - 1].receive_utime, events_[i].receive_utime);
  }
}

TEST_F(Mrclam, SigmasAreThoseOfTheInnovation) {
  int known = 0;
  int gross = 0;
  std::array<int, 2> outside{};  // of the 95 % interval
  std::array<double, 2> squares{};
  for (const Event& event : events_) {
    const auto* sighting = std::get_if<SightingEvent>(&event.body);
    if (sighting == nullptr) continue;
    const auto target = truth_.target(*sighting);
    const auto observer = truth_.robots.at(sighting->robot).nearest(sighting->utime, 100'000);
    if (!target || !observer) continue;
    const Eigen::Vector2d seen = inverse(observer->map_from_robot) * *target;
    const double range_m = sighting->range_m - seen.norm();
    const double bearing_rad = wrap_angle(sighting->bearing_rad - std::atan2(seen.y(), seen.x()));
    ++known;
    if (std::abs(range_m) > 1 || std::abs(bearing_rad) > 0.35) {
      ++gross;
      continue;
    }
    const std::array<double, 2> z = {range_m / sighting->range_sigma_m,
                                     bearing_rad / sighting->bearing_sigma_rad};
    for (std::size_t i = 0; i < z.size(); ++i) {
      squares[i] += z[i] * z[i];
      outside[i] += std::abs(z[i]) > 1.96 ? 1 : 0;
    }
  }
  EXPECT_GT(known, 19'000);
  EXPECT_EQ(gross, 15);
  for (std::size_t i = 0; i < squares.size(); ++i) {
    EXPECT_NEAR(squares[i] / known, 1, 0.1) << (i == 0 ? "range" : "bearing");
    EXPECT_LT(outside[i], 0.1 * known) << (i == 0 ? "range" : "bearing");
  }
}

/// Of the odometry of 10 s, against the motion capture at the same stamps.
double turning_error_rad(const std::vector<Event>& events, const Trajectory& truth) {
  double squares = 0;
  int count = 0;
  std::optional<OdometryEvent> start;
  for (const Event& event : events) {
    const auto* odometry = std::get_if<OdometryEvent>(&event.body);
    if (odometry == nullptr || odometry->robot != "R1") continue;
    if (!start) start = *odometry;
    if (odometry->utime - start->utime < 10'000'000) continue;
    const auto from = truth.nearest(start->utime, 100'000);
    const auto to = truth.nearest(odometry->utime, 100'000);
    if (from && to) {
      const double turned_rad = ominus(odometry->odom_from_robot, start->odom_from_robot).yaw;
      const double error_rad = wrap_angle(turned_rad - ominus(to->map_from_robot, from->map_from_robot).yaw);
      squares += error_rad * error_rad;
      ++count;
    }
    start = *odometry;
  }
  return std::sqrt(squares / count);
}

TEST_F(Mrclam, TheLagOfOdometryMakesItAgreeBetterWithTheTruth) {
  const double with_lag_rad = turning_error_rad(events_, truth_.robots.at("R1"));
  what_.odometry_lag_s = 0;
  const double without_rad = turning_error_rad(import_mrclam(what_), truth_.robots.at("R1"));
  EXPECT_LT(with_lag_rad, 0.9 * without_rad);
  EXPECT_LT(with_lag_rad, 0.12);
}

}  // namespace
}  // namespace isthmus
