#include "server/wire/journal.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>

#include <algorithm>
#include <filesystem>

#include "tests/support/log_files.hpp"
#include "tests/support/temporary_directory.hpp"

namespace isthmus {
namespace {

namespace fs = std::filesystem;

Message message(std::int64_t utime, std::size_t size = 50) {
  return {utime, "R1_SCAN", std::vector<std::uint8_t>(size, static_cast<std::uint8_t>(utime))};
}

Message configuration() { return encode({1, ConfigurationEvent{"tags = \"any\""}}); }

JournalOptions small_segments() {
  JournalOptions options;
  options.segment_bytes = 1000;
  return options;
}

/// While it lives, this process can write no file beyond `bytes`: a full disk, as far as writing goes.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : previous_handler_(signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &previous_);
    const rlimit limited{bytes, previous_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limited);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &previous_);
    signal(SIGXFSZ, previous_handler_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit previous_{};
  void (*previous_handler_)(int);
};

TEST(Journal, BeginsWithTheConfigurationAndKeepsTheOrder) {
  TemporaryDirectory directory;
  {
    Journal journal(directory / "j");
    EXPECT_TRUE(journal.append(configuration()));
    for (int i = 2; i < 10; ++i) EXPECT_TRUE(journal.append(message(i)));
  }
  const LogContent content = read_log(directory / "j");
  ASSERT_EQ(content.messages.size(), 9U);
  EXPECT_TRUE(same(content.messages[0], configuration()));
  for (int i = 2; i < 10; ++i)
    EXPECT_TRUE(same(content.messages[static_cast<std::size_t>(i - 1)], message(i)));
}

// A process that is killed leaves what the kernel has: everything.
TEST(Journal, HandsEachEventToTheKernelAtOnce) {
  TemporaryDirectory directory;
  Journal journal(directory / "j");
  journal.append(configuration());
  EXPECT_EQ(read_log(directory / "j").messages.size(), 1U);
  journal.append(message(2));
  EXPECT_EQ(read_log(directory / "j").messages.size(), 2U);
}

TEST(Journal, RotatesSegmentsWhoseNamesSortByTime) {
  TemporaryDirectory directory;
  {
    Journal journal(directory / "j", small_segments());
    EXPECT_TRUE(journal.append(configuration()));
    for (int i = 2; i < 200; ++i) EXPECT_TRUE(journal.append(message(i)));
  }
  std::size_t segments = 0;
  for (const auto& entry : fs::directory_iterator(directory / "j")) {
    EXPECT_LE(entry.file_size(), 1000U);
    ++segments;
  }
  EXPECT_GT(segments, 10U);
  const LogContent content = read_log(directory / "j");
  ASSERT_EQ(content.messages.size(), 199U);
  for (int i = 2; i < 200; ++i) EXPECT_EQ(content.messages[static_cast<std::size_t>(i - 1)].utime, i);
  EXPECT_EQ(content.skipped, 0);
}

/// The configuration and three events.
void write_small_journal(const std::string& directory) {
  Journal journal(directory);
  journal.append(configuration());
  for (int i = 2; i < 5; ++i) journal.append(message(i));
}

TEST(Journal, IsReadUpToATornTail) {
  TemporaryDirectory directory;
  write_small_journal(directory / "j");
  const std::string segment = directory / "j/journal-000001.lcm";
  fs::resize_file(segment, fs::file_size(segment) - 10);
  const LogContent content = read_log(directory / "j");
  EXPECT_EQ(content.messages.size(), 3U);
  EXPECT_EQ(content.skipped, 28 + 7 + 50 - 10);
}

//   segment 1                         segment 2
//   | configuration | 2 | 3 | 4 |     | 9 |
//                         ^ cut at every byte: what is torn goes, what is whole stays
TEST(Journal, GoesOnInANewSegmentAfterATornTailCutAtAnyByte) {
  TemporaryDirectory directory;
  write_small_journal(directory / "whole");
  const std::vector<std::uint8_t> bytes = read_bytes(directory / "whole/journal-000001.lcm");
  const std::vector<std::size_t> ends = frame_ends(read_log(directory / "whole").messages);
  for (std::size_t size = 0; size <= bytes.size(); ++size) {
    const std::string damaged = directory / std::to_string(size);
    fs::create_directory(damaged);
    write_bytes(damaged + "/journal-000001.lcm", std::span(bytes).first(size));
    const auto whole = std::count_if(ends.begin(), ends.end(), [&](std::size_t end) { return end <= size; });
    const std::size_t kept = whole == 0 ? 0 : ends[static_cast<std::size_t>(whole) - 1];
    {
      Journal journal(damaged);
      EXPECT_EQ(journal.torn_bytes(), static_cast<std::int64_t>(size - kept));
      EXPECT_EQ(journal.earlier_segments().size(), 1U);
      EXPECT_TRUE(journal.append(message(9)));
    }
    const LogContent content = read_log(damaged);
    ASSERT_EQ(content.messages.size(), static_cast<std::size_t>(whole) + 1) << "cut at " << size;
    EXPECT_TRUE(same(content.messages.back(), message(9)));
    EXPECT_EQ(content.skipped, 0);
    EXPECT_TRUE(fs::exists(damaged + "/journal-000002.lcm"));
  }
}

TEST(Journal, KeepsWhatFollowsDamageInTheMiddle) {
  TemporaryDirectory directory;
  write_small_journal(directory / "j");
  const std::string segment = directory / "j/journal-000001.lcm";
  std::vector<std::uint8_t> bytes = read_bytes(segment);
  bytes[frame_ends(read_log(segment).messages)[0]] ^= 1;
  write_bytes(segment, bytes);
  EXPECT_EQ(Journal(directory / "j").torn_bytes(), 0);
  const LogContent content = read_log(directory / "j");
  EXPECT_EQ(content.messages.size(), 3U);
  EXPECT_EQ(content.skipped, 28 + 7 + 50);
}

TEST(Journal, IsWrittenByOneServerAtATime) {
  TemporaryDirectory directory;
  const Journal journal(directory / "j");
  EXPECT_EQ(error_of([&] { Journal again(directory / "j"); }),
            directory / "j" + ": another server writes this journal");
}

TEST(Journal, LeavesADirectoryOfOtherLogsAlone) {
  TemporaryDirectory directory;
  const std::string log = directory.write("j/intel.lcm", "not a whole event");
  EXPECT_EQ(error_of([&] { Journal journal(directory / "j"); }),
            directory / "j" + ": holds intel.lcm, which is no segment of a journal; give another directory");
  EXPECT_EQ(fs::file_size(log), 17U);
}

TEST(Journal, NamesTheDirectoryThatCannotBeMade) {
  TemporaryDirectory directory;
  const std::string file = directory.write("file", "");
  EXPECT_EQ(error_of([&] { Journal journal(file + "/j"); }), file + "/j: Not a directory");
}

TEST(Journal, SurvivesADiskThatRefusesAndTakesEventsAgainAfterwards) {
  TemporaryDirectory directory;
  std::vector<std::string> reports;
  JournalOptions options;
  options.report = [&](const std::string& text) { reports.push_back(text); };
  Journal journal(directory / "j", options);
  EXPECT_TRUE(journal.append(configuration()));
  EXPECT_TRUE(journal.append(message(2)));
  {
    const FileSizeLimit full(fs::file_size(directory / "j/journal-000001.lcm") + 20);
    for (int i = 3; i < 6; ++i) EXPECT_FALSE(journal.append(message(i)));
  }
  EXPECT_TRUE(journal.append(message(6)));
  EXPECT_EQ(journal.failures(), 3);
  EXPECT_EQ(reports.size(), 2U) << "once when it begins, once when it ends";
  const LogContent content = read_log(directory / "j");
  ASSERT_EQ(content.messages.size(), 3U);
  EXPECT_TRUE(same(content.messages.back(), message(6)));
  EXPECT_EQ(content.skipped, 0) << "no torn event in the middle";
}

}  // namespace
}  // namespace isthmus
