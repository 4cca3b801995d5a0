#include "server/wire/journal/journal.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <filesystem>
#include <future>
#include <thread>

#include "tests/support/descriptor_limit.hpp"
#include "tests/support/failing_disk.hpp"
#include "tests/support/log_files.hpp"
#include "tests/support/temporary_directory.hpp"

namespace isthmus {
namespace {

namespace fs = std::filesystem;

Message scan_message(std::int64_t utime, std::size_t size = 50) {
  return {utime, "R1_SCAN", std::vector<std::uint8_t>(size, static_cast<std::uint8_t>(utime))};
}

Message configuration() { return encode({1, ConfigurationEvent{"tags = \"any\""}}); }

JournalOptions small_segments() {
  JournalOptions options;
  options.segment_bytes = 1000;
  return options;
}

TEST(Journal, BeginsWithTheConfigurationAndKeepsTheOrder) {
  TemporaryDirectory directory;
  {
    Journal journal(directory / "j");
    EXPECT_TRUE(journal.append(configuration()));
    for (int i = 2; i < 10; ++i) EXPECT_TRUE(journal.append(scan_message(i)));
  }
  const LogContent content = read_log(directory / "j");
  ASSERT_EQ(content.messages.size(), 9U);
  EXPECT_TRUE(same(content.messages[0], configuration()));
  for (int i = 2; i < 10; ++i)
    EXPECT_TRUE(same(content.messages[static_cast<std::size_t>(i - 1)], scan_message(i)));
}

// A process that is killed leaves what the kernel has: everything.
TEST(Journal, HandsEachEventToTheKernelAtOnce) {
  TemporaryDirectory directory;
  Journal journal(directory / "j");
  journal.append(configuration());
  EXPECT_EQ(read_log(directory / "j").messages.size(), 1U);
  journal.append(scan_message(2));
  EXPECT_EQ(read_log(directory / "j").messages.size(), 2U);
}

TEST(Journal, RotatesSegmentsWhoseNamesSortByTime) {
  TemporaryDirectory directory;
  {
    Journal journal(directory / "j", small_segments());
    EXPECT_TRUE(journal.append(configuration()));
    for (int i = 2; i < 200; ++i) EXPECT_TRUE(journal.append(scan_message(i)));
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
  for (int i = 2; i < 5; ++i) journal.append(scan_message(i));
}

TEST(Journal, IsReadUpToATornTail) {
  TemporaryDirectory directory;
  write_small_journal(directory / "j");
  const std::string segment = directory / "j/journal-000001.lcm";
  fs::resize_file(segment, fs::file_size(segment) - 10);
  const LogContent content = read_log(directory / "j");
  EXPECT_EQ(content.messages.size(), 3U);
  EXPECT_EQ(content.skipped, entry_frame_bytes + 28 + 7 + 50 - 10);
}

//   segment 1                         segment 2
//   | header | configuration | 2 | 3 | 4 |     | header | 9 |
//                                  ^ cut at every byte: what is torn goes, what is whole stays
TEST(Journal, GoesOnInANewSegmentAfterATornTailCutAtAnyByte) {
  TemporaryDirectory directory;
  write_small_journal(directory / "whole");
  const std::vector<std::uint8_t> bytes = read_bytes(directory / "whole/journal-000001.lcm");
  std::vector<std::size_t> ends = entry_ends(read_log(directory / "whole").messages);
  ASSERT_EQ(ends.back(), bytes.size());
  for (std::size_t size = 0; size <= bytes.size(); ++size) {
    const std::string damaged = directory / std::to_string(size);
    fs::create_directory(damaged);
    write_bytes(damaged + "/journal-000001.lcm", std::span(bytes).first(size));
    const auto whole = std::count_if(ends.begin(), ends.end(), [&](std::size_t end) { return end <= size; });
    const bool has_header = size >= header_copy_bytes;
    std::size_t kept =
        has_header ? size >= segment_header_bytes ? segment_header_bytes : header_copy_bytes : 0;
    if (whole > 0) kept = ends[static_cast<std::size_t>(whole) - 1];
    {
      Journal journal(damaged);
      EXPECT_EQ(journal.torn_bytes(), static_cast<std::int64_t>(size - kept));
      EXPECT_EQ(journal.earlier_segments().size(), has_header ? 1U : 0U);
      EXPECT_TRUE(journal.append(scan_message(9)));
    }
    const LogContent content = read_log(damaged);
    ASSERT_EQ(content.messages.size(), static_cast<std::size_t>(whole) + 1) << "cut at " << size;
    EXPECT_TRUE(same(content.messages.back(), scan_message(9)));
    EXPECT_EQ(content.skipped, 0);
    EXPECT_EQ(content.warnings, std::vector<std::string>());
    EXPECT_EQ(fs::exists(damaged + "/journal-000002.lcm"), has_header);
  }
}

TEST(Journal, KeepsWhatFollowsDamageInTheMiddle) {
  TemporaryDirectory directory;
  write_small_journal(directory / "j");
  const std::string segment = directory / "j/journal-000001.lcm";
  std::vector<std::uint8_t> bytes = read_bytes(segment);
  bytes[entry_ends(read_log(segment).messages)[0]] ^= 1;
  write_bytes(segment, bytes);
  EXPECT_EQ(Journal(directory / "j").torn_bytes(), 0);
  const LogContent content = read_log(directory / "j");
  EXPECT_EQ(content.messages.size(), 3U);
  EXPECT_EQ(content.skipped, entry_frame_bytes + 28 + 7 + 50);
  EXPECT_EQ(content.missing, 1);
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

/// A journal on a disk that can be made to refuse, and what it reports.
struct OnFailingDisk {
  explicit OnFailingDisk(JournalOptions options = {})
      : journal(directory / "j", with_disk(std::move(options))) {}

  JournalOptions with_disk(JournalOptions options) {
    options.disk = disk.operations();
    options.report = [this](const std::string& text) { reports.push_back(text); };
    return options;
  }
  std::vector<std::int64_t> utimes() const {
    const LogContent content = read_log(directory / "j");
    EXPECT_EQ(content.skipped, 0) << "no torn event in the middle";
    std::vector<std::int64_t> utimes;
    for (const Message& message : content.messages) utimes.push_back(message.utime);
    return utimes;
  }

  TemporaryDirectory directory;
  FailingDisk disk;
  std::vector<std::string> reports;
  Journal journal;
};

//   written: 1 2           3 4 5 6
//   disk:    takes  full   takes
TEST(Journal, WritesWhatWaitedForTheDiskInOrder) {
  OnFailingDisk on;
  EXPECT_TRUE(on.journal.append(configuration()));
  EXPECT_TRUE(on.journal.append(scan_message(2)));
  on.disk.refuse_with(ENOSPC);
  for (int i = 3; i < 6; ++i) EXPECT_TRUE(on.journal.append(scan_message(i)));
  EXPECT_EQ(on.journal.waiting(), 3U);
  EXPECT_EQ(on.utimes(), (std::vector<std::int64_t>{1, 2}));
  on.disk.refuse_with(0);
  EXPECT_TRUE(on.journal.append(scan_message(6)));
  EXPECT_EQ(on.utimes(), (std::vector<std::int64_t>{1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(on.journal.waiting(), 0U);
  EXPECT_EQ(on.journal.failures(), 3);
  ASSERT_EQ(on.reports.size(), 2U) << "once when it begins, once when it ends";
  EXPECT_NE(on.reports[0].find("No space left on device"), std::string::npos) << on.reports[0];
}

TEST(Journal, WritesWhatWaitedWhenNothingNewComes) {
  OnFailingDisk on;
  on.disk.refuse_with(EROFS);
  EXPECT_TRUE(on.journal.append(configuration()));
  on.disk.refuse_with(0);
  on.journal.write_waiting();
  EXPECT_EQ(on.utimes(), (std::vector<std::int64_t>{1}));
}

// A disk that fills up within an event has the first part of it.
TEST(Journal, LeavesNoTornEventWhereTheDiskFillsUpWithinOne) {
  OnFailingDisk on;
  on.journal.append(configuration());
  for (std::size_t bytes = 0; bytes < 90; bytes += 7) {
    on.disk.refuse_with(ENOSPC, bytes);
    on.journal.append(scan_message(2));
    on.disk.refuse_with(0);
    on.journal.write_waiting();
  }
  EXPECT_EQ(on.utimes().size(), 1U + 13U);
}

TEST(Journal, RefusesWhatCannotWaitAndTakesTheNextOnceThereIsRoom) {
  JournalOptions options;
  options.waiting_bytes = 10'000;
  OnFailingDisk on(options);
  on.disk.refuse_with(ENOSPC);
  int taken = 0;
  while (on.journal.append(scan_message(taken + 1, 1000))) ++taken;
  EXPECT_GE(taken, 5);
  EXPECT_LE(taken, 10);
  EXPECT_FALSE(on.journal.append(scan_message(99, 1000)));
  EXPECT_EQ(on.journal.waiting(), static_cast<std::size_t>(taken));
  on.disk.refuse_with(0);
  EXPECT_TRUE(on.journal.append(scan_message(100, 1000)));
  std::vector<std::int64_t> expected;
  for (int i = 1; i <= taken; ++i) expected.push_back(i);
  expected.push_back(100);
  EXPECT_EQ(on.utimes(), expected);
  EXPECT_EQ(on.reports.size(), 3U) << "waiting, full, taking again";
}

TEST(Journal, SaysOnceThatItRefusesWhereNothingMayWait) {
  JournalOptions options;
  options.waiting_bytes = 0;
  OnFailingDisk on(options);
  on.disk.refuse_with(ENOSPC);
  for (int i = 1; i < 4; ++i) EXPECT_FALSE(on.journal.append(scan_message(i)));
  EXPECT_EQ(on.reports.size(), 1U);
  on.disk.refuse_with(0);
  EXPECT_TRUE(on.journal.append(scan_message(4)));
  EXPECT_EQ(on.reports.size(), 2U);
  EXPECT_EQ(on.utimes(), (std::vector<std::int64_t>{4}));
}

TEST(Journal, TellsOfWhatTheDiskRefusedToTheEnd) {
  OnFailingDisk on;
  on.journal.append(configuration());
  on.disk.refuse_with(ENOSPC);
  on.journal.append(scan_message(2));
  on.journal.append(scan_message(3));
  EXPECT_EQ(on.journal.finish(), 2U);
  on.disk.refuse_with(0);
  EXPECT_EQ(on.journal.finish(), 0U);
}

// The name of the next segment is taken, as by a directory that lets nobody write.
TEST(Journal, GoesOnInTheLastSegmentWhereNoneCanBeBegun) {
  OnFailingDisk on(small_segments());
  on.directory.write("j/journal-000002.lcm", "");
  for (int i = 1; i < 50; ++i) EXPECT_TRUE(on.journal.append(scan_message(i)));
  EXPECT_GT(fs::file_size(on.directory / "j/journal-000001.lcm"), 1000U);
  EXPECT_EQ(on.reports.size(), 1U);
  fs::remove(on.directory / "j/journal-000002.lcm");
  EXPECT_TRUE(on.journal.append(scan_message(50)));
  EXPECT_TRUE(fs::exists(on.directory / "j/journal-000002.lcm"));
  EXPECT_EQ(on.utimes().size(), 50U);
}

TEST(Journal, IsNotHeldUpByASlowDisk) {
  using namespace std::chrono_literals;
  TemporaryDirectory directory;
  std::atomic<int> syncs = 0;
  std::atomic<bool> slow = true;
  JournalOptions options = small_segments();
  options.sync_interval = 1ms;
  options.disk.sync = [&](int) {
    ++syncs;
    if (slow) std::this_thread::sleep_for(300ms);
    return 0;
  };
  Journal journal(directory / "j", options);
  const auto start = std::chrono::steady_clock::now();
  for (int i = 1; i < 200; ++i) {  // ten segments and more
    EXPECT_TRUE(journal.append(scan_message(i)));
    std::this_thread::sleep_for(1ms);
  }
  EXPECT_LT(std::chrono::steady_clock::now() - start, 2s);
  slow = false;
  EXPECT_GE(syncs, 1);
  EXPECT_EQ(read_log(directory / "j").messages.size(), 199U);
}

TEST(Journal, IsSyncedThoughThereIsNoDescriptorLeft) {
#ifdef __has_feature  // clang's, which builds for that sanitizer
#if __has_feature(address_sanitizer)
  GTEST_SKIP() << "UBSAN's vptr check reads memory through a pipe, and reports an error where it gets none";
#endif
#endif
  using namespace std::chrono_literals;
  TemporaryDirectory directory;
  std::promise<int> synced;
  std::atomic<bool> limited = false, told = false;
  std::atomic<int> reports = 0;
  JournalOptions options;
  options.sync_interval = 1ms;
  options.report = [&](const std::string&) { ++reports; };
  options.disk.sync = [&](int descriptor) {
    const int error = sync_data(descriptor);
    if (limited && !told.exchange(true)) synced.set_value(error);
    return error;
  };
  Journal journal(directory / "j", options);
  {
    const DescriptorLimit limit(next_descriptor());
    limited = true;
    EXPECT_TRUE(journal.append(scan_message(1)));
    std::future<int> error = synced.get_future();
    ASSERT_EQ(error.wait_for(10s), std::future_status::ready);
    EXPECT_EQ(error.get(), 0);
  }
  EXPECT_EQ(reports, 0);
}

}  // namespace
}  // namespace isthmus
