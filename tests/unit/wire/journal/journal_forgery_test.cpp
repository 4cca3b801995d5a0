// A robot may send any bytes in its scans: none of them may become an event of their own.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "server/wire/journal/journal.hpp"
#include "server/wire/journal/journal_files.hpp"
#include "tests/support/forged_scan.hpp"
#include "tests/support/log_files.hpp"
#include "tests/support/temporary_directory.hpp"

namespace isthmus {
namespace {

namespace fs = std::filesystem;

Message forging_scan(std::int64_t utime) {
  return scan_of_bytes("R1", utime, spelled_frames(drop_command("R2", utime), 20, 0));
}

Message plain_scan(std::int64_t utime) { return scan_of_bytes("R2", utime, {1, 2, 3, 4}); }

std::vector<Message> with_forgery() {
  return {encode({1, ConfigurationEvent{}}), plain_scan(2), forging_scan(3), plain_scan(4), plain_scan(5)};
}

/// Whether there is an event that nobody sent.
bool holds_forged(const std::vector<Message>& messages) {
  const std::vector<Message> sent = with_forgery();
  return std::any_of(messages.begin(), messages.end(), [&](const Message& message) {
    return std::none_of(sent.begin(), sent.end(), [&](const Message& one) { return same(one, message); });
  });
}

std::string write_journal(const std::string& directory, std::size_t count,
                          std::int64_t segment_bytes = 1'000'000) {
  JournalOptions options;
  options.segment_bytes = segment_bytes;
  Journal journal(directory, options);
  const std::vector<Message> all = with_forgery();
  for (std::size_t i = 0; i < count; ++i) journal.append(all[i]);
  return segment_path(directory, 1);
}

TEST(ForgedJournal, KeepsAScanThatSpellsEventsAsTheLastOfACleanStop) {
  const TemporaryDirectory directory;
  write_journal(directory / "j", 3);
  EXPECT_FALSE(holds_forged(read_log(directory / "j").messages));
  EXPECT_EQ(read_log(directory / "j").messages.size(), 3U);
  Journal(directory / "j").append(plain_scan(9));
  EXPECT_EQ(read_log(directory / "j").messages.size(), 4U);
}

TEST(ForgedJournal, KeepsAScanThatSpellsEventsAsTheLastOfASegment) {
  const TemporaryDirectory directory;
  write_journal(directory / "j", 5, 1000);
  EXPECT_GT(list_journal(directory / "j").segments.size(), 2U);
  EXPECT_FALSE(holds_forged(read_log(directory / "j").messages));
  EXPECT_EQ(read_log(directory / "j").messages.size(), 5U);
}

TEST(ForgedJournal, TakesNothingOutOfAScanThatACrashCutOff) {
  const TemporaryDirectory directory;
  const std::string segment = write_journal(directory / "j", 3);
  const std::vector<std::uint8_t> bytes = read_bytes(segment);
  const std::size_t begin = entry_ends(with_forgery())[1];
  for (std::size_t size = begin; size < bytes.size(); size += 13) {
    write_bytes(segment, std::span(bytes).first(size));
    EXPECT_FALSE(holds_forged(read_log(directory / "j").messages)) << "cut at " << size;
  }
  {
    Journal journal(directory / "j");
    EXPECT_GT(journal.torn_bytes(), 1000);
    journal.append(plain_scan(4));
  }
  EXPECT_FALSE(holds_forged(read_log(directory / "j").messages));
  EXPECT_EQ(read_log(directory / "j").messages.size(), 3U);
}

TEST(ForgedJournal, TakesNothingOutOfAScanWhereItsFramesOrItsNeighboursAreDamaged) {
  const TemporaryDirectory directory;
  const std::string segment = write_journal(directory / "j", 5);
  const std::vector<std::uint8_t> bytes = read_bytes(segment);
  const std::vector<std::size_t> ends = entry_ends(with_forgery());
  // The scan's entry and header, the entry and header of what follows it, and that of what follows then.
  for (const std::size_t begin : {ends[1], ends[2], ends[3]}) {
    for (std::size_t at = begin; at < begin + entry_frame_bytes + 28 + 7; ++at) {
      for (const int bit : {0, 3, 7}) {
        std::vector<std::uint8_t> damaged = bytes;
        damaged[at] ^= static_cast<std::uint8_t>(1U << bit);
        write_bytes(segment, damaged);
        const LogContent content = read_log(directory / "j");
        EXPECT_FALSE(holds_forged(content.messages)) << at << " " << bit;
        EXPECT_GE(content.messages.size(), 4U) << at << " " << bit;
        EXPECT_TRUE(content.messages.size() == 5 || content.missing == 1 || at >= ends[3]) << at;
      }
    }
  }
}

TEST(ForgedJournal, TakesNoEntryWithAWrongCheck) {
  const TemporaryDirectory directory;
  const std::string segment = write_journal(directory / "j", 2);
  std::vector<std::uint8_t> bytes = read_bytes(segment);
  const std::vector<std::uint8_t> spelled = spelled_frames(drop_command("R2", 3), 3, 2);
  bytes.insert(bytes.end(), spelled.begin(), spelled.end());
  write_bytes(segment, bytes);
  const LogContent content = read_log(directory / "j");
  EXPECT_EQ(content.messages.size(), 2U);
  EXPECT_EQ(content.skipped, static_cast<std::int64_t>(spelled.size()));
  // Nor does the server; and it leaves them where they are, for they are no write that was cut off.
  EXPECT_EQ(Journal(directory / "j").torn_bytes(), 0);
  EXPECT_EQ(fs::file_size(segment), bytes.size());
}

/// The same of an ordinary log, such as journals were before they had entries.
TEST(ForgedLog, KeepsAScanThatSpellsEventsWhereverItIsCutOff) {
  const TemporaryDirectory directory;
  std::vector<Message> messages = with_forgery();
  messages.resize(3);
  write_log(directory / "a.lcm", messages);
  EXPECT_EQ(read_log(directory / "a.lcm").messages.size(), 3U);
  const std::vector<std::uint8_t> bytes = read_bytes(directory / "a.lcm");
  for (std::size_t size = frame_ends(messages)[1]; size <= bytes.size(); size += 13) {
    write_bytes(directory / "b.lcm", std::span(bytes).first(size));
    EXPECT_FALSE(holds_forged(read_log(directory / "b.lcm").messages)) << "cut at " << size;
  }
}

TEST(ForgedLog, KeepsAScanThatSpellsEventsWhereItsNeighbourIsDamaged) {
  const TemporaryDirectory directory;
  write_log(directory / "a.lcm", with_forgery());
  const std::vector<std::uint8_t> bytes = read_bytes(directory / "a.lcm");
  const std::size_t end = frame_ends(with_forgery())[2];
  for (std::size_t at = end; at < end + 28; ++at) {
    std::vector<std::uint8_t> damaged = bytes;
    damaged[at] ^= 0x40;
    write_bytes(directory / "b.lcm", damaged);
    const LogContent content = read_log(directory / "b.lcm");
    EXPECT_TRUE(same(content.messages[2], with_forgery()[2])) << at;
    EXPECT_TRUE(std::none_of(content.messages.begin(), content.messages.end(), [](const Message& message) {
      return message.channel == "ISTHMUS_COMMAND";
    })) << at;
  }
}

}  // namespace
}  // namespace isthmus
