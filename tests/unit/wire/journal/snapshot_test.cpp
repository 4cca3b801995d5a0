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
#include "tests/support/box_room.hpp"
#include "tests/support/replayed.hpp"
#include "tests/support/temporary_directory.hpp"

namespace isthmus {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t small_segment_bytes = 30'000;

/// A journal of two robots, in some ten segments.
std::string write_journal(const TemporaryDirectory& directory, int rounds = 150) {
  std::string path = directory / "journal";
  JournalOptions options;
  options.segment_bytes = small_segment_bytes;
  Journal journal(path, options);
  const BoxRoomRobot robots[] = {BoxRoomRobot("R1"), BoxRoomRobot("R2")};
  journal.append(encode({1, ConfigurationEvent{}}));
  for (const BoxRoomRobot& robot : robots) journal.append(robot.introduction());
  for (int round = 0; round < rounds; ++round) {
    for (const BoxRoomRobot& robot : robots)
      for (const Message& message : robot.round(round)) journal.append(message);
  }
  return path;
}

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

void flip_a_bit(const std::string& path) {
  std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
  const auto middle = static_cast<std::streamoff>(fs::file_size(path) / 2);
  file.seekg(middle);
  const char byte = static_cast<char>(file.get() ^ 1);
  file.seekp(middle);
  file.put(byte);
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
  const std::string journal = write_journal(directory);
  const RecoveredMap whole = recover(journal);
  const SnapshotsMade made = update_snapshots(journal);
  EXPECT_GE(made.written, 5);
  EXPECT_EQ(list_journal(journal).snapshots.size(), 2U);
  EXPECT_EQ(made.last_segment, list_journal(journal).segments.rbegin()->first - 1);
  const RecoveredMap recovered = recover(journal);
  EXPECT_EQ(recovered.sha256, whole.sha256);
  EXPECT_EQ(recovered.sha256, replay(journal).sha256);
  EXPECT_EQ(recovered.rows, whole.rows);
  EXPECT_LT(recovered.events_read, whole.events_read / 4);
  EXPECT_EQ(recovered.warnings, std::vector<std::string>());
  EXPECT_EQ(update_snapshots(journal).written, 0);
}

TEST(Snapshots, GiveWayToOlderOnesWhereTheyAreDamaged) {
  const TemporaryDirectory directory;
  const std::string journal = write_journal(directory);
  const std::string whole = recover(journal).sha256;
  update_snapshots(journal);
  const auto snapshots = list_journal(journal).snapshots;
  flip_a_bit(snapshots.rbegin()->second);
  RecoveredMap recovered = recover(journal);
  EXPECT_EQ(recovered.sha256, whole);
  ASSERT_EQ(recovered.warnings.size(), 1U);
  EXPECT_NE(recovered.warnings.front().find("is damaged: its checksum is another"), std::string::npos);
  fs::resize_file(snapshots.begin()->second, 100);
  recovered = recover(journal);
  EXPECT_EQ(recovered.sha256, whole);
  EXPECT_EQ(recovered.warnings.size(), 2U);
}

TEST(Snapshots, AreNotTakenWithoutTheRowsOfTheTrajectory) {
  const TemporaryDirectory directory;
  const std::string journal = write_journal(directory);
  update_snapshots(journal);
  const std::string newest = list_journal(journal).snapshots.rbegin()->second;
  EXPECT_EQ(why_unreadable(newest), "");
  flip_a_bit(trajectory_path(journal, 1));
  EXPECT_NE(why_unreadable(newest).find(trajectory_path(journal, 1) + ": is damaged"), std::string::npos);
}

TEST(Snapshots, StandForSegmentsThatWerePruned) {
  const TemporaryDirectory directory;
  const std::string journal = write_journal(directory);
  const std::string whole = recover(journal).sha256;
  SnapshotPolicy policy;
  policy.keep_segments = 1;
  const SnapshotsMade made = update_snapshots(journal, policy);
  EXPECT_GE(made.pruned_segments, 3);
  EXPECT_GT(list_journal(journal).segments.begin()->first, 1);
  EXPECT_EQ(recover(journal).sha256, whole);
  // The oldest snapshot that stays still has all that follows it.
  flip_a_bit(list_journal(journal).snapshots.rbegin()->second);
  EXPECT_EQ(recover(journal).sha256, whole);
  flip_a_bit(list_journal(journal).snapshots.begin()->second);
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
  const std::string journal = write_journal(directory, 40);
  std::ofstream(journal + "/snapshot-000001.isthmus.tmp-99") << "what a killed process left";
  update_snapshots(journal);
  EXPECT_FALSE(fs::exists(journal + "/snapshot-000001.isthmus.tmp-99"));
  Journal held(journal);
  EXPECT_EQ(update_snapshots(journal).written, 1);
}

TEST(Snapshots, AreLeftToTheProcessThatMakesThemOrWaitForIt) {
  const TemporaryDirectory directory;
  const std::string journal = write_journal(directory, 60);
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

TEST(Snapshots, OfAnotherVersionAreRefusedByWord) {
  const TemporaryDirectory directory;
  const std::string journal = write_journal(directory, 60);
  update_snapshots(journal);
  const std::string newest = list_journal(journal).snapshots.rbegin()->second;
  std::fstream(newest, std::ios::binary | std::ios::in | std::ios::out).seekp(16).put(9);
  EXPECT_EQ(why_unreadable(newest), newest + ": is of version 9; this program reads version 3");
  EXPECT_TRUE(is_snapshot(newest));
  EXPECT_FALSE(is_snapshot(segment_path(journal, 1)));
}

/// A file of each version that there ever was: what this program makes of it. A change of what is written
/// needs a new version (server/wire/journal/snapshot.cpp), and the old file must then be refused by word, or
/// migrated.
TEST(Snapshots, OfVersion1AreRefusedByWord) {
  const std::string why = why_unreadable("tests/unit/wire/snapshots/version-1/snapshot-000002.isthmus");
  EXPECT_NE(why.find("is of version 1; this program reads version 3"), std::string::npos) << why;
}

TEST(Snapshots, OfVersion2AreRefusedByWord) {
  const std::string why = why_unreadable("tests/unit/wire/snapshots/version-2/snapshot-000002.isthmus");
  EXPECT_NE(why.find("is of version 2; this program reads version 3"), std::string::npos) << why;
}

TEST(Snapshots, OfVersion3AreRead) {
  const std::string path = "tests/unit/wire/snapshots/version-3/snapshot-000001.isthmus";
  const Snapshot snapshot = read_snapshot(path);
  const MapCopy map = snapshot.map.engine.copy();
  EXPECT_EQ(snapshot.map.events, 760);
  EXPECT_EQ(map.patches.size(), 18U);
  EXPECT_EQ(map.trajectory_rows, 124U);
  EXPECT_EQ(map.sightings.size(), 12U);
  EXPECT_EQ(map.closures.size(), 1U);
  EXPECT_EQ(map_sha256(map), "19ae48462be1f2c8d71786bbb318acb988e0b70b2e5d5561a0ad5a21cf290ebe");
}

}  // namespace
}  // namespace isthmus
