#include "server/wire/journal/snapshot.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <future>

#include "server/wire/file/file_bytes.hpp"
#include "server/wire/journal/journal.hpp"
#include "server/wire/journal/journal_files.hpp"
#include "server/wire/journal/recovery/recovery.hpp"
#include "server/wire/journal/recovery/snapshots.hpp"
#include "tests/support/replayed.hpp"
#include "tests/support/team_journal.hpp"
#include "tests/support/temporary_directory.hpp"

namespace isthmus {
namespace {

namespace fs = std::filesystem;

struct RecoveredMap {
  std::string sha256;
  std::size_t rows = 0;
  std::int64_t events_read = 0;
  std::vector<std::string> warnings;
};

RecoveredMap recover(const std::string& journal) {
  RecoveredMap recovered;
  RecoveryOptions options;
  options.warn = [&](const std::string& warning) { recovered.warnings.push_back(warning); };
  Recovery recovery(journal, options);
  ServedMap map = recovery.begin();
  while (recovery.step(map)) {
  }
  map.engine.finish();
  const MapCopy copy = map.engine.copy();
  recovered.sha256 = map_sha256(copy);
  recovered.rows = copy.trajectory->read(0, copy.trajectory_rows).size();
  recovered.events_read = recovery.events();
  return recovered;
}

std::string why_unreadable(const std::string& path) {
  try {
    read_snapshot(path);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(Snapshots, MakeTheMapThatTheWholeJournalMakes) {
  const TemporaryDirectory directory;
  const std::string journal = write_team_journal(directory);
  const RecoveredMap whole = recover(journal);
  const SnapshotsMade made = update_snapshots(journal);
  EXPECT_GE(made.written, 5);
  EXPECT_EQ(made.last_segment, list_journal(journal).segments.rbegin()->first - 1);
  const RecoveredMap recovered = recover(journal);
  EXPECT_EQ(recovered.sha256, whole.sha256);
  EXPECT_EQ(recovered.sha256, replay_of(journal).sha256);
  EXPECT_EQ(recovered.rows, whole.rows);
  EXPECT_LT(recovered.events_read, whole.events_read / 4);
  EXPECT_EQ(recovered.warnings, std::vector<std::string>());
  EXPECT_EQ(update_snapshots(journal).written, 0);
}

TEST(Snapshots, GiveWayToOlderOnesWhereTheyAreDamaged) {
  const TemporaryDirectory directory;
  const std::string journal = write_team_journal(directory);
  const std::string whole = recover(journal).sha256;
  update_snapshots(journal);
  const auto snapshots = list_journal(journal).snapshots;
  flip_a_bit(snapshots.rbegin()->second);
  RecoveredMap recovered = recover(journal);
  EXPECT_EQ(recovered.sha256, whole);
  ASSERT_EQ(recovered.warnings.size(), 1U);
  EXPECT_NE(recovered.warnings.front().find("is damaged: its checksum is another"), std::string::npos);
  for (const auto& [segment, path] : snapshots) fs::resize_file(path, 100);
  recovered = recover(journal);
  EXPECT_EQ(recovered.sha256, whole);
  EXPECT_EQ(recovered.warnings.size(), snapshots.size());
}

TEST(Snapshots, AreNotTakenWithoutTheRowsOfTheTrajectory) {
  const TemporaryDirectory directory;
  const std::string journal = write_team_journal(directory);
  update_snapshots(journal);
  const std::string newest = list_journal(journal).snapshots.rbegin()->second;
  EXPECT_EQ(why_unreadable(newest), "");
  flip_a_bit(trajectory_path(journal, 1));
  EXPECT_NE(why_unreadable(newest).find(trajectory_path(journal, 1) + ": is damaged"), std::string::npos);
}

TEST(Snapshots, StandForSegmentsThatWerePruned) {
  const TemporaryDirectory directory;
  const std::string journal = write_team_journal(directory);
  const std::string whole = recover(journal).sha256;
  SnapshotPolicy policy;
  policy.keep_segments = 0;
  policy.keep_snapshots = 3;
  const SnapshotsMade made = update_snapshots(journal, policy);
  EXPECT_GE(made.pruned_segments, 3);
  EXPECT_GT(list_journal(journal).segments.begin()->first, 1);
  EXPECT_EQ(recover(journal).sha256, whole);
  // The snapshot before the newest still has all that follows it; those before that have not.
  std::map<int, std::string> snapshots = list_journal(journal).snapshots;
  flip_a_bit(snapshots.rbegin()->second);
  EXPECT_EQ(recover(journal).sha256, whole);
  flip_a_bit(std::prev(snapshots.end(), 2)->second);
  try {
    recover(journal);
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find(".lcm: is gone, and no snapshot stands for it"),
              std::string::npos)
        << error.what();
  }
}

TEST(Snapshots, AreMadeBesideAServerAtWorkAndAfterOneThatWasKilled) {
  const TemporaryDirectory directory;
  const std::string journal = write_team_journal(directory, 40);
  std::ofstream(journal + "/snapshot-000001.isthmus.tmp-99") << "what a killed process left";
  update_snapshots(journal);
  EXPECT_FALSE(fs::exists(journal + "/snapshot-000001.isthmus.tmp-99"));
  Journal held(journal);
  EXPECT_EQ(update_snapshots(journal).written, 1);
}

TEST(Snapshots, AreLeftToTheProcessThatMakesThemOrWaitForIt) {
  const TemporaryDirectory directory;
  const std::string journal = write_team_journal(directory, 60);
  FileHandle other(::open((journal + "/snapshots.lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666));
  ASSERT_EQ(::flock(other.get(), LOCK_EX), 0);
  const SnapshotsMade left = update_snapshots(journal);
  EXPECT_TRUE(left.busy);
  EXPECT_EQ(left.written, 0);
  SnapshotPolicy policy;
  policy.wait = true;
  auto waiting = std::async(std::launch::async, [&] { return update_snapshots(journal, policy); });
  EXPECT_EQ(waiting.wait_for(std::chrono::milliseconds(20)), std::future_status::timeout);
  other.close();
  const SnapshotsMade made = waiting.get();
  EXPECT_FALSE(made.busy);
  EXPECT_GT(made.written, 0);
}

TEST(Snapshots, LeaveNoLockBehindWhateverComesOfThem) {
  const TemporaryDirectory directory;
  const std::string journal = write_team_journal(directory, 60);
  update_snapshots(journal);
  EXPECT_FALSE(fs::exists(journal + "/snapshots.lock"));
  fs::remove(segment_path(journal, 2));
  EXPECT_NE(error_of([&] { update_snapshots(journal); }), "");
  EXPECT_FALSE(fs::exists(journal + "/snapshots.lock"));
}

TEST(Snapshots, OfNoJournalAreRefusedAndNothingIsTouched) {
  const TemporaryDirectory directory;
  const std::string file = directory.write("notes/snapshot-000001.isthmus.tmp-99", "of somebody else");
  EXPECT_EQ(error_of([&] { update_snapshots(directory / "notes"); }),
            directory / "notes: holds no segment of a journal");
  EXPECT_TRUE(fs::exists(file));
  EXPECT_EQ(std::distance(fs::directory_iterator(directory / "notes"), fs::directory_iterator()), 1);
}

TEST(Snapshots, TellOfThemselvesWithoutTheirMap) {
  const TemporaryDirectory directory;
  const std::string journal = write_team_journal(directory, 60);
  update_snapshots(journal);
  for (const auto& [segment, path] : list_journal(journal).snapshots) {
    const SnapshotSummary summary = read_snapshot_summary(path);
    const Snapshot snapshot = read_snapshot(path);
    const MapCopy map = snapshot.map.engine.copy();
    EXPECT_EQ(summary.place.segment, segment);
    EXPECT_EQ(summary.events, snapshot.map.events);
    EXPECT_EQ(summary.last_utime, snapshot.map.last_utime);
    ASSERT_GT(map.trajectory_rows, 0U);
    ASSERT_EQ(summary.scan_utime.size(), map.sessions.size());
    for (const auto& [session, utime] : summary.scan_utime)
      EXPECT_EQ(utime, map.sessions[static_cast<std::size_t>(session)].to_utime);
  }
}

/// What is left of snapshots that come one by one.
std::vector<int> kept_of(int count, int keep) {
  std::vector<int> kept;
  for (int segment = 1; segment <= count; ++segment) {
    kept.push_back(segment);
    while (const auto without = dispensable_snapshot(kept, keep)) std::erase(kept, *without);
  }
  return kept;
}

TEST(Snapshots, ThatStayCoverAllThereWasTheCloserTheNewer) {
  for (const int count : {3, 10, 11, 37, 400, 5000}) {
    const std::vector<int> kept = kept_of(count, 10);
    ASSERT_EQ(kept.size(), static_cast<std::size_t>(std::min(count, 10)));
    EXPECT_EQ(kept.front(), 1) << "the oldest";
    EXPECT_EQ(kept[kept.size() - 2], count - 1) << "should the newest not be readable";
    EXPECT_EQ(kept.back(), count);
    for (std::size_t i = 1; i < kept.size(); ++i)
      EXPECT_LE(kept[i] - kept[i - 1], std::max(2, 2 * count / 5)) << "a gap in " << count;
    const auto is_old = [&](int segment) { return segment <= count / 2; };
    EXPECT_LE(std::ranges::count_if(kept, is_old), count > 11 ? 4 : 5) << "the newer ones are more";
  }
  EXPECT_EQ(kept_of(400, 2), (std::vector<int>{399, 400}));
  EXPECT_EQ(kept_of(400, 0), (std::vector<int>{399, 400})) << "never fewer";
}

TEST(Snapshots, AreAsManyAsThePolicySays) {
  const TemporaryDirectory directory;
  const std::string journal = write_team_journal(directory);
  SnapshotPolicy policy;
  policy.keep_snapshots = 4;
  const SnapshotsMade made = update_snapshots(journal, policy);
  ASSERT_GE(made.written, 5);
  EXPECT_EQ(list_journal(journal).snapshots.size(), 4U);
  EXPECT_TRUE(list_journal(journal).snapshots.contains(1));
  const std::string whole = recover(journal).sha256;
  policy.keep_snapshots = 2;
  EXPECT_EQ(update_snapshots(journal, policy).written, 0);
  EXPECT_EQ(list_journal(journal).snapshots.size(), 2U) << "also where none is new";
  EXPECT_EQ(recover(journal).sha256, whole);
}

TEST(Snapshots, OfAnotherVersionAreRefusedByWord) {
  const TemporaryDirectory directory;
  const std::string journal = write_team_journal(directory, 60);
  update_snapshots(journal);
  const std::string newest = list_journal(journal).snapshots.rbegin()->second;
  std::fstream(newest, std::ios::binary | std::ios::in | std::ios::out).seekp(16).put(20);
  EXPECT_EQ(why_unreadable(newest), newest + ": is of version 20; this program reads version 19");
  EXPECT_TRUE(is_snapshot(newest));
  EXPECT_FALSE(is_snapshot(segment_path(journal, 1)));
}

/// Of each version that there ever was there is a file. A change of what is written needs a new version
/// (server/wire/journal/snapshot.cpp), and the old file must then be refused by word, or migrated.
TEST(Snapshots, OfEveryEarlierVersionAreRefusedByWord) {
  for (int version = 1; version < 19; ++version) {
    const std::string name = "version " + std::to_string(version);
    const std::string directory = "tests/unit/wire/snapshots/version-" + std::to_string(version);
    const JournalFiles files = list_journal(directory);
    ASSERT_EQ(files.snapshots.size(), 1U) << name;
    const std::string why = why_unreadable(files.snapshots.begin()->second);
    EXPECT_NE(why.find("is of " + name + "; this program reads version 19"), std::string::npos) << why;
  }
}

TEST(Snapshots, OfVersion19AreRead) {
  const std::string path = "tests/unit/wire/snapshots/version-19/snapshot-000001.isthmus";
  const Snapshot snapshot = read_snapshot(path);
  const MapCopy map = snapshot.map.engine.copy();
  EXPECT_EQ(snapshot.map.events, 1351);
  EXPECT_EQ(map.patches.size(), 34U);
  EXPECT_EQ(map.trajectory_rows, 216U);
  EXPECT_EQ(map.sightings.size(), 44U);
  EXPECT_EQ(map.closures.size(), 2U);
  EXPECT_EQ(map_sha256(map), "c0c91c64f568ba58fa090b44f7528a3effa15de63ba6d3846c28c761f3692053");
}

}  // namespace
}  // namespace isthmus
