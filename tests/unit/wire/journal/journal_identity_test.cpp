// Segments and snapshots that do not belong together are refused, by the server and all tools with the same
// word.

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <map>
#include <random>

#include "server/wire/journal/journal.hpp"
#include "server/wire/journal/journal_files.hpp"
#include "server/wire/journal/log_file.hpp"
#include "server/wire/journal/recovery/recovery.hpp"
#include "server/wire/journal/recovery/snapshots.hpp"
#include "tests/support/box_room.hpp"
#include "tests/support/log_files.hpp"
#include "tests/support/temporary_directory.hpp"

namespace isthmus {
namespace {

namespace fs = std::filesystem;

/// A journal of one robot in some segments.
std::string write_journal(const std::string& path, int rounds = 60) {
  JournalOptions options;
  options.segment_bytes = 12'000;
  Journal journal(path, options);
  const BoxRoomRobot robot("R1");
  journal.append(encode({1, ConfigurationEvent{}}));
  journal.append(robot.introduction());
  for (int round = 0; round < rounds; ++round)
    for (const Message& message : robot.round(round)) journal.append(message);
  return path;
}

/// Why the journal is refused, by all that read journals alike; nothing of it may be changed.
std::string why_refused(const std::string& journal) {
  const auto before = files_of(journal);
  std::string server = error_of([&] { Journal again(journal); });
  EXPECT_EQ(error_of([&] { Recovery recovery(journal); }), server);
  EXPECT_EQ(error_of([&] { EventLogReader reader(journal); }), server);
  EXPECT_EQ(error_of([&] { update_snapshots(journal); }), server);
  EXPECT_TRUE(files_of(journal) == before);
  return server;
}

class MixedUpJournal : public ::testing::Test {
 protected:
  MixedUpJournal() {
    EXPECT_GE(list_journal(journal_).segments.size(), 4U);
    EXPECT_GE(list_journal(other_).segments.size(), 4U);
  }
  std::string segment(int number) const { return segment_path(journal_, number); }

  TemporaryDirectory directory_;
  std::string journal_ = write_journal(directory_ / "journal");
  std::string other_ = write_journal(directory_ / "other");
};

TEST_F(MixedUpJournal, IsRefusedWhereSegmentsAreSwapped) {
  fs::rename(segment(2), directory_ / "two");
  fs::rename(segment(3), segment(2));
  fs::rename(directory_ / "two", segment(3));
  EXPECT_EQ(why_refused(journal_), segment(2) + ": is segment 3 of a journal, not 2 as its name says");
}

TEST_F(MixedUpJournal, IsRefusedWhereASegmentIsThereTwice) {
  const int last = list_journal(journal_).segments.rbegin()->first;
  fs::copy_file(segment(2), segment(last + 1));
  EXPECT_EQ(why_refused(journal_), segment(last + 1) + ": is segment 2 of a journal, not " +
                                       std::to_string(last + 1) + " as its name says");
}

TEST_F(MixedUpJournal, IsRefusedWithASegmentOfAnother) {
  fs::copy_file(segment_path(other_, 3), segment(3), fs::copy_options::overwrite_existing);
  EXPECT_EQ(why_refused(journal_), segment(3) + ": is of another journal than journal-000002.lcm");
}

// Two copies of a journal that were both gone on with: same identity, same number.
TEST_F(MixedUpJournal, IsRefusedWithASegmentOfItsOwnCopy) {
  const int next = list_journal(journal_).segments.rbegin()->first + 1;
  fs::copy(journal_, directory_ / "copy");
  for (const std::string& one : {journal_, directory_ / "copy"}) {
    Journal(one).append(encode({99'000'000'000, TickEvent{}}));
    Journal(one).append(encode({99'000'000'001, TickEvent{}}));
  }
  fs::copy_file(segment_path(directory_ / "copy", next), segment(next), fs::copy_options::overwrite_existing);
  EXPECT_EQ(why_refused(journal_), segment(next + 1) + ": follows another copy of " +
                                       fs::path(segment(next)).filename().string() + " than this one");
}

TEST_F(MixedUpJournal, IsRefusedWhereASegmentIsMissing) {
  fs::remove(segment(2));
  EXPECT_EQ(why_refused(journal_), segment(2) + ": is missing, but journal-000003.lcm follows it");
}

TEST_F(MixedUpJournal, IsRefusedWhereASegmentIsEmptied) {
  fs::resize_file(segment(2), 0);
  EXPECT_EQ(why_refused(journal_), segment(2) + ": is empty, but segments follow it");
}

TEST_F(MixedUpJournal, IsRefusedWhereASegmentIsNoLog) {
  const std::string text =
      "This is no log, but a text that somebody gave the name of one; it is of some length "
      "so that it cannot be the beginning of a header that a crash has cut off.";
  const int last = list_journal(journal_).segments.rbegin()->first;
  for (const int number : {2, last, last + 1}) {
    const std::vector<std::uint8_t> before =
        number <= last ? read_bytes(segment(number)) : std::vector<std::uint8_t>();
    write_bytes(segment(number), std::vector<std::uint8_t>(text.begin(), text.end()));
    EXPECT_EQ(why_refused(journal_),
              segment(number) + ": is no segment of a journal: it has no header of one");
    write_bytes(segment(number), before);
    if (number > last) fs::remove(segment(number));
  }
  EXPECT_EQ(read_log(journal_).warnings, std::vector<std::string>());
}

// A short text cannot be a header that was cut off.
TEST_F(MixedUpJournal, IsRefusedWhereTheLastSegmentIsAShortText) {
  const int last = list_journal(journal_).segments.rbegin()->first;
  write_bytes(segment(last + 1), std::vector<std::uint8_t>{'n', 'o', '\n'});
  EXPECT_EQ(why_refused(journal_),
            segment(last + 1) + ": is no segment of a journal: it has no header of one");
}

TEST_F(MixedUpJournal, IsRefusedWhereASegmentIsAFifo) {
  const int last = list_journal(journal_).segments.rbegin()->first;
  for (const int number : {last + 1, 2}) {
    fs::remove(segment(number));
    ASSERT_EQ(::mkfifo(segment(number).c_str(), 0600), 0);
    for (const auto& read : std::vector<std::function<void()>>{
             [&] { Journal again(journal_); }, [&] { Recovery recovery(journal_); },
             [&] { EventLogReader reader(journal_); }, [&] { EventLogReader reader(segment(number)); }})
      EXPECT_EQ(error_of(read), segment(number) + ": not a regular file");
    fs::remove(segment(number));
  }
}

TEST_F(MixedUpJournal, IsRefusedWhereBothHeadersOfASegmentAreDamaged) {
  std::vector<std::uint8_t> bytes = read_bytes(segment(3));
  bytes[60] ^= 1;
  write_bytes(segment(3), bytes);
  EXPECT_EQ(read_log(journal_).warnings, std::vector<std::string>());
  bytes[header_copy_bytes + 60] ^= 1;
  write_bytes(segment(3), bytes);
  EXPECT_EQ(why_refused(journal_), segment(3) + ": is no segment of a journal: it has no header of one");
}

TEST_F(MixedUpJournal, TellsOfEventsThatItsSegmentsLackAtTheirEnd) {
  const std::size_t all = read_log(journal_).messages.size();
  const std::size_t in_two = read_log(segment(2)).messages.size();
  fs::resize_file(segment(2), segment_header_bytes);
  const LogContent content = read_log(journal_);
  EXPECT_EQ(content.messages.size(), all - in_two);
  EXPECT_EQ(content.missing, static_cast<std::int64_t>(in_two));
  ASSERT_EQ(content.warnings.size(), 1U);
  EXPECT_EQ(content.warnings[0],
            segment(3) + ": something is gone at offset 0; events missing: " + std::to_string(in_two));
}

TEST_F(MixedUpJournal, TellsOfManyDamagesOfASegmentInTwoLines) {
  std::vector<std::uint8_t> bytes = read_bytes(segment(2));
  for (const std::size_t at : {2000U, 5000U, 8000U}) bytes[at] ^= 1;
  write_bytes(segment(2), bytes);
  const LogContent content = read_log(journal_);
  EXPECT_EQ(content.missing, 3);
  ASSERT_EQ(content.warnings.size(), 2U);
  EXPECT_NE(content.warnings[0].find(segment(2) + ": "), std::string::npos);
  EXPECT_NE(content.warnings[0].find("; events missing: 1"), std::string::npos) << content.warnings[0];
  EXPECT_NE(content.warnings[1].find("in 2 other places; events missing: 2"), std::string::npos)
      << content.warnings[1];
}

/// What Recovery says of a journal's snapshots.
std::vector<std::string> warnings_of(const std::string& journal) {
  std::vector<std::string> warnings;
  RecoveryOptions options;
  options.warn = [&](const std::string& warning) { warnings.push_back(warning); };
  Recovery recovery(journal, options);
  ServedMap map = recovery.begin();
  while (recovery.step(map)) {
  }
  return warnings;
}

TEST_F(MixedUpJournal, DoesNotBeginWithASnapshotOfAnother) {
  update_snapshots(journal_);
  update_snapshots(other_);
  EXPECT_EQ(warnings_of(journal_), std::vector<std::string>());
  for (const auto& [number, path] : list_journal(journal_).snapshots)
    fs::copy_file(snapshot_path(other_, number), path, fs::copy_options::overwrite_existing);
  const std::vector<std::string> warnings = warnings_of(journal_);
  ASSERT_EQ(warnings.size(), list_journal(journal_).snapshots.size());
  const std::string newest = list_journal(journal_).snapshots.rbegin()->second;
  EXPECT_EQ(warnings[0], newest + ": is of another journal; an older one, or all events, must do");
}

TEST_F(MixedUpJournal, DoesNotBeginWithASnapshotUnderAnotherName) {
  update_snapshots(journal_);
  const int newest = list_journal(journal_).snapshots.rbegin()->first;
  fs::rename(snapshot_path(journal_, newest), snapshot_path(journal_, newest - 2));
  const std::vector<std::string> warnings = warnings_of(journal_);
  EXPECT_EQ(warnings, std::vector<std::string>());  // an older one serves
  fs::rename(snapshot_path(journal_, newest - 2), snapshot_path(journal_, newest - 1));
  ASSERT_EQ(warnings_of(journal_).size(), 1U);
  EXPECT_EQ(warnings_of(journal_)[0], snapshot_path(journal_, newest - 1) + ": was made of segment " +
                                          std::to_string(newest) + "; an older one, or all events, must do");
}

TEST_F(MixedUpJournal, IsNotPrunedForTheSnapshotsOfAnother) {
  update_snapshots(other_);
  for (const auto& [number, path] : list_journal(other_).snapshots)
    fs::copy_file(path, snapshot_path(journal_, number + 40));
  SnapshotPolicy policy;
  policy.keep_segments = 0;
  const std::size_t segments = list_journal(journal_).segments.size();
  const SnapshotsMade made = update_snapshots(journal_, policy);
  EXPECT_GE(made.written, 3) << "its own are made all the same";
  EXPECT_EQ(made.last_segment, static_cast<int>(segments) - 1);
  EXPECT_TRUE(fs::exists(snapshot_path(journal_, list_journal(other_).snapshots.rbegin()->first + 40)));
  EXPECT_LT(read_log(journal_).messages.size(), read_log(other_).messages.size()) << "pruned, for its own";
}

TEST_F(MixedUpJournal, IsRefusedWhereASnapshotTellsOfSegmentsThatAreGone) {
  update_snapshots(journal_);
  const int newest = list_journal(journal_).snapshots.rbegin()->first;
  for (const auto& [number, path] : list_journal(journal_).segments)
    if (number >= newest) fs::remove(path);
  char name[32];
  std::snprintf(name, sizeof name, "snapshot-%06d.isthmus", newest);
  EXPECT_EQ(why_refused(journal_), segment(newest) + ": is missing, but " + name + " was made of it");
}

TEST_F(MixedUpJournal, IsRefusedWhereItsBeginningIsGoneAndNoSnapshotStandsForIt) {
  fs::remove(segment(1));
  const auto before = files_of(journal_);
  const std::string expected = segment(1) + ": is gone, and no snapshot stands for it and those before it";
  EXPECT_EQ(error_of([&] { Journal again(journal_); }), expected);
  EXPECT_EQ(error_of([&] { Recovery recovery(journal_); }), expected);
  EXPECT_EQ(files_of(journal_), before);
}

TEST_F(MixedUpJournal, IsGoneOnWithBehindALastSegmentThatNothingWasWrittenTo) {
  const int last = list_journal(journal_).segments.rbegin()->first;
  const std::size_t events = read_log(journal_).messages.size();
  write_bytes(segment(last + 1), {});
  const LogContent content = read_log(journal_);
  EXPECT_EQ(content.messages.size(), events);
  ASSERT_EQ(content.warnings.size(), 1U);
  EXPECT_EQ(content.warnings[0],
            segment(last + 1) + ": is empty, as a server leaves it that ends before it has events");
  Journal(journal_).append(encode({99'000'000'000, TickEvent{}}));
  EXPECT_EQ(read_log(journal_).messages.size(), events + 1);
  EXPECT_EQ(read_log(journal_).warnings.size(), 0U);
  Journal nothing(journal_);
  EXPECT_EQ(nothing.segment(), last + 2);
}

TEST_F(MixedUpJournal, WithoutChecksIsReadButNotGoneOnWith) {
  const std::string old = directory_ / "old";
  fs::create_directory(old);
  const std::vector<Message> messages = read_log(journal_).messages;
  write_log(segment_path(old, 1), {messages.begin(), messages.begin() + 50});
  write_bytes(segment_path(old, 2), {});  // a server that was started and stopped
  write_log(segment_path(old, 3), {messages.begin() + 50, messages.end()});
  EXPECT_EQ(read_log(old).messages.size(), messages.size());
  EXPECT_EQ(warnings_of(old),
            (std::vector<std::string>{
                old + ": was written before journals had checks: what it holds cannot be verified"}));
  EXPECT_EQ(
      error_of([&] { Journal again(old); }),
      old +
          ": this journal was written before journals had checks; it can be replayed and exported, but not "
          "gone on with: give another directory");
  EXPECT_EQ(list_journal(old).segments.size(), 3U);
}

TEST_F(MixedUpJournal, ReadsASegmentAloneAndVerifiesIt) {
  std::vector<std::uint8_t> bytes = read_bytes(segment(2));
  const LogContent whole = read_log(segment(2));
  EXPECT_EQ(whole.skipped, 0);
  EXPECT_EQ(whole.warnings.size(), 0U);
  bytes[segment_header_bytes + entry_frame_bytes + 60] ^= 1;
  write_bytes(segment(2), bytes);
  const LogContent damaged = read_log(segment(2));
  EXPECT_EQ(damaged.messages.size(), whole.messages.size() - 1);
  EXPECT_EQ(damaged.missing, 1);
}

/// What was played from a segment and recorded again is an ordinary log, and said to be one.
TEST_F(MixedUpJournal, ReadsARecordingOfASegmentAsAnOrdinaryLog) {
  std::vector<Message> recorded;
  LogFile played(segment(2));
  while (const auto message = played.next()) recorded.push_back(*message);
  for (Message& message : recorded) message.utime += 7;
  write_log(directory_ / "recorded.lcm", recorded);
  const LogContent content = read_log(directory_ / "recorded.lcm");
  EXPECT_EQ(content.messages.size(), recorded.size());
  EXPECT_EQ(content.skipped, 0);
  ASSERT_EQ(content.warnings.size(), 1U);
  EXPECT_NE(content.warnings[0].find("nothing can be verified"), std::string::npos);
}

/// A flipped bit does no harm, or is said: no event changes without a word.
TEST_F(MixedUpJournal, NeverChangesByAFlippedBitWithoutAWord) {
  const std::vector<Message> whole = read_log(journal_).messages;
  std::mt19937 random(1);
  int harmless = 0;
  int told = 0;
  int refused = 0;
  for (int flip = 0; flip < 300; ++flip) {
    const int number = 1 + static_cast<int>(random() % 3);
    const std::vector<std::uint8_t> bytes = read_bytes(segment(number));
    std::vector<std::uint8_t> damaged = bytes;
    // A third of them in the header and the first entries.
    const std::size_t range = flip % 3 == 0 ? 600 : bytes.size();
    damaged[random() % range] ^= static_cast<std::uint8_t>(1U << random() % 8);
    write_bytes(segment(number), damaged);
    LogContent content;
    const std::string error = error_of([&] { content = read_log(journal_); });
    write_bytes(segment(number), bytes);
    const bool unchanged = content.messages.size() == whole.size() &&
                           std::equal(whole.begin(), whole.end(), content.messages.begin(), same);
    const bool is_told = content.skipped > 0 && content.missing > 0 && !content.warnings.empty();
    EXPECT_TRUE(!error.empty() || unchanged || is_told) << "segment " << number;
    ++(error.empty() ? unchanged ? harmless : told : refused);
  }
  EXPECT_GT(told, 150);
  EXPECT_EQ(refused, 0) << "each header is there twice";
  RecordProperty("harmless", harmless);
}

TEST(JournalEntries, TellTheNumberOfTheReceivedMessage) {
  const TemporaryDirectory directory;
  JournalOptions options;
  options.segment_bytes = 1000;
  {
    Journal journal(directory / "j", options);
    EXPECT_EQ(journal.last_received(), -1);
    for (int i = 0; i < 40; ++i) {
      Message message = encode({i, TickEvent{}});
      if (i % 2 == 0 && i < 10) message.received = 100 + i;
      EXPECT_TRUE(journal.append(message));
    }
    EXPECT_EQ(journal.last_received(), 108);
  }
  const std::vector<Message> messages = read_log(directory / "j").messages;
  EXPECT_EQ(messages[4].received, 104);
  EXPECT_EQ(messages[5].received, -1);
  EXPECT_EQ(Journal(directory / "j").last_received(), 108) << "of segments long before the last";
}

}  // namespace
}  // namespace isthmus
