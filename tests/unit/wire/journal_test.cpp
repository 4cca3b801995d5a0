#include "server/wire/journal.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>

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
    Journal journal(directory / "j", configuration());
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
  Journal journal(directory / "j", configuration());
  EXPECT_EQ(read_log(directory / "j").messages.size(), 1U);
  journal.append(message(2));
  EXPECT_EQ(read_log(directory / "j").messages.size(), 2U);
}

TEST(Journal, RotatesSegmentsWhoseNamesSortByTime) {
  TemporaryDirectory directory;
  {
    Journal journal(directory / "j", configuration(), small_segments());
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

TEST(Journal, IsReadUpToATornTail) {
  TemporaryDirectory directory;
  {
    Journal journal(directory / "j", configuration());
    for (int i = 2; i < 5; ++i) journal.append(message(i));
  }
  const std::string segment = directory / "j/journal-000001.lcm";
  fs::resize_file(segment, fs::file_size(segment) - 10);
  const LogContent content = read_log(directory / "j");
  EXPECT_EQ(content.messages.size(), 3U);
  EXPECT_EQ(content.skipped, 28 + 7 + 50 - 10);
}

TEST(Journal, RefusesADirectoryThatHoldsAJournal) {
  TemporaryDirectory directory;
  { Journal journal(directory / "j", configuration()); }
  EXPECT_EQ(error_of([&] { Journal again(directory / "j", configuration()); }),
            directory / "j" + ": holds a journal already; give a new directory");
}

TEST(Journal, NamesTheDirectoryThatCannotBeMade) {
  TemporaryDirectory directory;
  const std::string file = directory.write("file", "");
  EXPECT_EQ(error_of([&] { Journal journal(file + "/j", configuration()); }), file + "/j: Not a directory");
}

TEST(Journal, SurvivesADiskThatRefusesAndTakesEventsAgainAfterwards) {
  TemporaryDirectory directory;
  std::vector<std::string> reports;
  JournalOptions options;
  options.report = [&](const std::string& text) { reports.push_back(text); };
  Journal journal(directory / "j", configuration(), options);
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
