// A server whose estimator makes maps of features.

#include <gtest/gtest.h>

#include <filesystem>
#include <thread>

#include "isthmus/manifold_pose_t.hpp"
#include "isthmus/status_t.hpp"
#include "server/feature_maps/output/feature_files.hpp"
#include "server/wire/journal/drop_record.hpp"
#include "server/wire/journal/recovery/recovery.hpp"
#include "server/wire/journal/recovery/snapshots.hpp"
#include "server/wire/live/live_server.hpp"
#include "tests/support/box_room.hpp"
#include "tests/support/log_files.hpp"
#include "tests/support/published.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/support/waiting.hpp"
#include "tests/unit/wire/live/live_inputs.hpp"

namespace isthmus {
namespace {

namespace fs = std::filesystem;

LiveOptions by_segments(const std::string& journal) {
  LiveOptions options = quick_options();
  options.journal_directory = journal;
  options.toml = with_estimator("", EstimatorKind::segments);
  return options;
}

std::string features_sha256(const LiveServer& server) {
  return map_sha256(dynamic_cast<const FeatureEstimator&>(server.engine()).maps());
}

/// What isthmus-replay does.
std::string replayed_sha256(const std::string& journal) {
  FeatureEstimator estimator(feature_map_options(FeatureMapKind::segments));
  for (const Message& message : read_log(journal).messages) {
    const Decoded decoded = decode({}, message.channel, message.bytes, message.utime);
    if (decoded.event) estimator.handle(*decoded.event);
  }
  Outcome outcome;
  estimator.finish_step(outcome);
  return map_sha256(estimator.maps());
}

/// A server's life: it recovers, hears rounds [from, to) of two robots, and stops in order.
std::string live(const LiveOptions& options, int from, int to, Published& published) {
  Inbox inbox;
  LiveServer server(options, inbox, published.sink());
  for (const std::string name : {"R1", "R2"}) {
    const BoxRoomRobot robot(name);
    if (from == 0) push(inbox, name, robot.introduction());
    for (int i = from; i < to; ++i)
      for (const Message& message : robot.round(i)) push(inbox, name, message);
  }
  inbox.close();
  server.run();
  return features_sha256(server);
}

TEST(FeatureServer, MakesTheMapThatAReplayOfItsJournalMakes) {
  TemporaryDirectory directory;
  LiveOptions options = by_segments(directory / "journal");
  options.output_directory = directory / "out";
  Published published;
  const std::string map = live(options, 0, 100, published);
  EXPECT_EQ(map, replayed_sha256(directory / "journal"));
  EXPECT_EQ(published.of<manifold_pose_t>("R1_POSE").size(), 100u);
  EXPECT_EQ(published.of<manifold_pose_t>("R2_POSE").back().patch, -1);
  EXPECT_TRUE(fs::exists(directory / "out/features.csv"));
  EXPECT_TRUE(fs::exists(directory / "out/trajectories/R2.tum"));
}

TEST(FeatureServer, GoesOnAfterAStopOrATornJournalToTheMapOfAReplay) {
  for (const int torn : {0, 1, 5000}) {
    TemporaryDirectory directory;
    const std::string journal = directory / "journal";
    Published published;
    live(by_segments(journal), 0, 60, published);
    const std::string segment = journal + "/journal-000001.lcm";
    fs::resize_file(segment, fs::file_size(segment) - static_cast<std::uintmax_t>(torn));
    LiveOptions as_the_journal_says = by_segments(journal);
    as_the_journal_says.toml.clear();
    const std::string map = live(as_the_journal_says, 60, 100, published);
    EXPECT_EQ(map, replayed_sha256(journal)) << torn;
  }
}

TEST(FeatureServer, TellsOfRobotsAndIslandsInItsStatus) {
  TemporaryDirectory directory;
  Published published;
  Inbox inbox;
  LiveServer server(by_segments(directory / "journal"), inbox, published.sink());
  std::thread running([&] { server.run(); });
  for (const std::string name : {"R1", "R2"}) {
    const BoxRoomRobot robot(name);
    push(inbox, name, robot.introduction());
    for (int i = 0; i < 30; ++i)
      for (const Message& message : robot.round(i)) push(inbox, name, message);
  }
  const auto last_status = [&] {
    const auto statuses = published.of<status_t>("ISTHMUS_STATUS");
    return statuses.empty() ? status_t{} : statuses.back();
  };
  EXPECT_TRUE(happens([&] { return last_status().scans == 60; }));
  inbox.close();
  running.join();
  const status_t status = last_status();
  EXPECT_EQ(status.islands, 2);
  EXPECT_EQ(status.patches, 0);
  EXPECT_EQ(status.nrobots, 2);
}

TEST(FeatureServer, GoesOnFromASnapshot) {
  TemporaryDirectory directory;
  const std::string journal = directory / "journal";
  Published published;
  live(by_segments(journal), 0, 40, published);
  live(by_segments(journal), 40, 60, published);  // closes the first segment
  EXPECT_EQ(update_snapshots(journal).written, 1);
  Recovery recovery(journal);
  ServedMap map = recovery.begin();
  ASSERT_TRUE(map.features);
  EXPECT_GT(map.events, 100) << "of the first segment";
  while (recovery.step(map)) {
  }
  EXPECT_LT(recovery.events(), map.events);
  const std::string went_on = live(by_segments(journal), 60, 100, published);
  EXPECT_EQ(went_on, replayed_sha256(journal));
}

TEST(FeatureServer, ItsJournalIsNotGoneOnWithByAnotherEstimatorNorFrozen) {
  TemporaryDirectory directory;
  const std::string journal = directory / "journal";
  Published published;
  live(by_segments(journal), 0, 20, published);
  Inbox inbox;
  LiveOptions other = by_segments(journal);
  other.toml = with_estimator("", EstimatorKind::points);
  EXPECT_THROW(LiveServer(other, inbox, published.sink()), std::runtime_error);
  LiveOptions frozen = by_segments(journal);
  frozen.frozen = true;
  EXPECT_THROW(LiveServer(frozen, inbox, published.sink()), std::runtime_error);
}

TEST(FeatureServer, AConfigurationNamesItsEstimator) {
  EXPECT_EQ(parse_server_configuration("", "c").estimator, EstimatorKind::manifold);
  EXPECT_EQ(parse_server_configuration("estimator = \"points\"", "c").estimator, EstimatorKind::points);
  EXPECT_THROW(parse_server_configuration("estimator = \"lines\"", "c"), std::runtime_error);
  EXPECT_THROW(parse_server_configuration("estimator = \"points\"\n[exploration]\nenabled = true", "c"),
               std::runtime_error)
      << "goals are frontiers of patches";
  EXPECT_THROW(with_estimator("estimator = \"points\"", EstimatorKind::segments), std::runtime_error);
}

}  // namespace
}  // namespace isthmus
