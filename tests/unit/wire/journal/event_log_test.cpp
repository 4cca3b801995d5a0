#include "server/wire/journal/event_log.hpp"

#include <gtest/gtest.h>
#include <lcm/lcm-cpp.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <random>
#include <stdexcept>

#include "tests/support/log_files.hpp"
#include "tests/support/temporary_directory.hpp"

namespace isthmus {
namespace {

Message counted_message(std::int64_t utime, const std::string& channel, std::size_t size) {
  Message one{utime, channel, std::vector<std::uint8_t>(size)};
  for (std::size_t i = 0; i < size; ++i) one.bytes[i] = static_cast<std::uint8_t>(i * 7 + size);
  return one;
}

const std::vector<Message>& few_messages() {
  static const std::vector<Message> messages = {
      counted_message(10, "R1_ROBOT", 30), counted_message(20, "R1_SCAN", 89), counted_message(15, "X", 0),
      counted_message(30, "R1_ODOMETRY", 12)};
  return messages;
}

std::string reader_error(const std::string& path) {
  return error_of([&] { EventLogReader reader(path); });
}

TEST(EventLog, ReadsWhatLiblcmWrites) {
  TemporaryDirectory directory;
  {
    lcm::LogFile log(directory / "a.lcm", "w");
    for (const Message& one : few_messages()) {
      std::vector<std::uint8_t> bytes = one.bytes;
      lcm::LogEvent event{0, one.utime, one.channel, static_cast<int>(bytes.size()), bytes.data()};
      log.writeEvent(&event);
    }
  }
  const LogContent content = read_log(directory / "a.lcm");
  ASSERT_EQ(content.messages.size(), few_messages().size());
  for (std::size_t i = 0; i < content.messages.size(); ++i)
    EXPECT_TRUE(same(content.messages[i], few_messages()[i]));
  EXPECT_EQ(content.skipped, 0);
}

TEST(EventLog, WritesWhatLiblcmReads) {
  TemporaryDirectory directory;
  write_log(directory / "a.lcm", few_messages());
  lcm::LogFile log(directory / "a.lcm", "r");
  for (std::size_t i = 0; i < few_messages().size(); ++i) {
    const Message& expected = few_messages()[i];
    const lcm::LogEvent* event = log.readNextEvent();
    ASSERT_NE(event, nullptr);
    EXPECT_EQ(event->eventnum, static_cast<std::int64_t>(i));
    EXPECT_EQ(event->timestamp, expected.utime);
    EXPECT_EQ(event->channel, expected.channel);
    const auto* data = static_cast<const std::uint8_t*>(event->data);
    EXPECT_EQ(std::vector<std::uint8_t>(data, data + event->datalen), expected.bytes);
  }
  EXPECT_EQ(log.readNextEvent(), nullptr);
}

TEST(EventLog, TellsEventNumberAndOffset) {
  TemporaryDirectory directory;
  write_log(directory / "a.lcm", few_messages());
  EventLogReader reader(directory / "a.lcm");
  const auto ends = frame_ends(few_messages());
  for (std::size_t i = 0; i < ends.size(); ++i) {
    ASSERT_TRUE(reader.next());
    EXPECT_EQ(reader.event_number(), static_cast<std::int64_t>(i));
    EXPECT_EQ(reader.offset(), static_cast<std::int64_t>(i == 0 ? 0 : ends[i - 1]));
    EXPECT_EQ(reader.file(), directory / "a.lcm");
  }
  EXPECT_EQ(reader.progress(), 1.0);
}

TEST(EventLog, ReadsTheWholePartOfALogCutAtAnyByte) {
  TemporaryDirectory directory;
  write_log(directory / "a.lcm", few_messages());
  const auto ends = frame_ends(few_messages());
  for (std::size_t cut = ends.back() + 1; cut-- > 0;) {
    std::filesystem::resize_file(directory / "a.lcm", cut);
    std::size_t whole = 0;
    while (whole < ends.size() && ends[whole] <= cut) ++whole;
    const LogContent content = read_log(directory / "a.lcm");
    ASSERT_EQ(content.messages.size(), whole) << cut;
    EXPECT_EQ(content.skipped, static_cast<std::int64_t>(cut - (whole == 0 ? 0 : ends[whole - 1]))) << cut;
  }
}

TEST(EventLog, ReadsEveryIntactEventWhicheverBitIsFlipped) {
  TemporaryDirectory directory;
  write_log(directory / "a.lcm", few_messages());
  const std::vector<std::uint8_t> bytes = read_bytes(directory / "a.lcm");
  const auto ends = frame_ends(few_messages());
  std::fstream file(directory / "a.lcm", std::ios::in | std::ios::out | std::ios::binary);
  const auto put = [&](std::size_t at, std::uint8_t byte) {
    file.seekp(static_cast<std::streamoff>(at)).put(static_cast<char>(byte)).flush();
  };
  for (std::size_t bit = 0; bit < bytes.size() * 8; ++bit) {
    put(bit / 8, bytes[bit / 8] ^ static_cast<std::uint8_t>(1 << bit % 8));
    const LogContent content = read_log(directory / "a.lcm");
    put(bit / 8, bytes[bit / 8]);
    std::size_t found = 0;
    for (std::size_t i = 0; i < ends.size(); ++i) {
      const bool damaged = bit / 8 >= (i == 0 ? 0 : ends[i - 1]) && bit / 8 < ends[i];
      if (damaged) continue;
      while (found < content.messages.size() && !same(content.messages[found], few_messages()[i])) ++found;
      EXPECT_LT(found, content.messages.size()) << "bit " << bit << " lost event " << i;
    }
  }
}

TEST(EventLog, PassesOverGarbageBetweenEventsAndCountsIt) {
  TemporaryDirectory directory;
  write_log(directory / "a.lcm", few_messages());
  std::vector<std::uint8_t> bytes = read_bytes(directory / "a.lcm");
  const std::vector<std::uint8_t> garbage(100'000, 0xED);
  bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(frame_ends(few_messages())[1]), garbage.begin(),
               garbage.end());
  write_bytes(directory / "a.lcm", bytes);
  const LogContent content = read_log(directory / "a.lcm");
  EXPECT_EQ(content.messages.size(), few_messages().size());
  EXPECT_EQ(content.skipped, 100'000);
}

// A robot may send what looks like a log; in an undamaged log the frame around it counts.
TEST(EventLog, ReadsAnEventThatHoldsALogAsOneEvent) {
  TemporaryDirectory directory;
  write_log(directory / "inner.lcm", few_messages());
  const Message outer{5, "FILE", read_bytes(directory / "inner.lcm")};
  write_log(directory / "outer.lcm", {outer, counted_message(6, "R1_SCAN", 40)});
  const LogContent content = read_log(directory / "outer.lcm");
  ASSERT_EQ(content.messages.size(), 2U);
  EXPECT_TRUE(same(content.messages[0], outer));
}

TEST(EventLog, NamesTheFileThatIsNoLog) {
  TemporaryDirectory directory;
  const std::string text = directory.write("text.lcm", "This is not a log, but a text of some length.");
  const std::string none = directory / "none.lcm";
  const std::string notes = directory.write("empty/notes.txt", "");
  const std::string empty = std::filesystem::path(notes).parent_path().string();
  EXPECT_EQ(reader_error(text), text + ": not an LCM event log (no event found in it)");
  EXPECT_EQ(reader_error(none), none + ": No such file or directory");
  EXPECT_EQ(reader_error(empty), empty + ": no journal (no *.lcm in this directory)");
  EXPECT_EQ(reader_error("/dev/null"), "/dev/null: not a regular file");
}

TEST(EventLog, ReadsAnEmptyFileAsAnEmptyLog) {
  TemporaryDirectory directory;
  write_bytes(directory / "a.lcm", {});
  EXPECT_TRUE(read_log(directory / "a.lcm").messages.empty());
}

TEST(EventLog, ReadsAJournalWithoutChecksInOrderOfNameAndSaysSo) {
  TemporaryDirectory directory;
  const auto& all = few_messages();
  write_log(directory / "journal-000002.lcm", {all[2], all[3]});
  write_log(directory / "journal-000001.lcm", {all[0], all[1]});
  directory.write("notes.txt", "xxxxx");
  const LogContent content = read_log(directory / "");
  ASSERT_EQ(content.messages.size(), all.size());
  for (std::size_t i = 0; i < all.size(); ++i) EXPECT_TRUE(same(content.messages[i], all[i]));
  ASSERT_EQ(content.warnings.size(), 1U);
  EXPECT_NE(content.warnings[0].find("was written before journals had checks"), std::string::npos);
}

TEST(EventLogWriter, LeavesNothingUnderTheFinalNameUnlessFinished) {
  TemporaryDirectory directory;
  {
    EventLogWriter writer(directory / "a.lcm");
    writer.write(few_messages()[0]);
    EXPECT_FALSE(std::filesystem::exists(directory / "a.lcm"));
  }
  EXPECT_TRUE(std::filesystem::is_empty(directory / ""));
}

TEST(EventLogWriter, NamesTheFileThatCannotBeWritten) {
  TemporaryDirectory directory;
  const std::string path = directory / "no/such/place.lcm";
  EXPECT_EQ(error_of([&] { EventLogWriter writer(path); }), path + ": No such file or directory");
}

// 16 MB with 10,000 bits flipped: what no flip touched is read, and every byte is accounted for.
TEST(EventLog, ReadsWhatTenThousandBitFlipsLeftIntact) {
  TemporaryDirectory directory;
  std::vector<Message> messages;
  for (int i = 0; i < 32'000; ++i)
    messages.push_back(counted_message(i, "R1_SCAN", 300 + static_cast<std::size_t>(i % 400)));
  write_log(directory / "a.lcm", messages);
  std::vector<std::uint8_t> bytes = read_bytes(directory / "a.lcm");
  const std::vector<std::size_t> ends = frame_ends(messages);
  std::vector<bool> touched(messages.size());
  std::mt19937 random(1);
  for (int flip = 0; flip < 10'000; ++flip) {
    const std::size_t at = random() % bytes.size();
    bytes[at] ^= static_cast<std::uint8_t>(1U << random() % 8);
    touched[static_cast<std::size_t>(std::upper_bound(ends.begin(), ends.end(), at) - ends.begin())] = true;
  }
  write_bytes(directory / "b.lcm", bytes);
  const LogContent content = read_log(directory / "b.lcm");

  auto read = content.messages.begin();
  std::size_t missing = 0;
  for (std::size_t i = 0; i < messages.size(); ++i) {
    if (touched[i]) continue;
    const auto found = std::find_if(read, content.messages.end(),
                                    [&](const Message& one) { return same(one, messages[i]); });
    if (found == content.messages.end()) {
      ++missing;
    } else {
      read = found + 1;
    }
  }
  EXPECT_EQ(missing, 0U);
  const std::vector<std::size_t> read_ends = frame_ends(content.messages);
  EXPECT_EQ(read_ends.back() + static_cast<std::size_t>(content.skipped), bytes.size());
}

}  // namespace
}  // namespace isthmus
