#include "server/wire/intake/spool.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cerrno>
#include <filesystem>
#include <thread>

#include "server/wire/journal/frames/spool_file.hpp"
#include "tests/support/failing_disk.hpp"
#include "tests/support/log_files.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/support/waiting.hpp"

namespace isthmus {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

Message spooled(std::int64_t utime, std::size_t size = 50, const std::string& channel = "R1_SCAN") {
  return {utime, channel, std::vector<std::uint8_t>(size, static_cast<std::uint8_t>(utime))};
}

std::int64_t append(Spool& spool, Message message) {
  spool.append(message, true);
  return message.received;
}

/// For what does not ask what a power cut leaves.
SpoolOptions without_syncing() {
  SpoolOptions options;
  options.disk.sync = [](int) { return 0; };
  return options;
}

SpoolOptions small_files() {
  SpoolOptions options = without_syncing();
  options.file_bytes = 1000;
  return options;
}

std::vector<std::int64_t> utimes(const std::vector<Message>& messages) {
  std::vector<std::int64_t> all;
  for (const Message& one : messages) all.push_back(one.utime);
  return all;
}

/// What a server that starts on the directory would find.
std::vector<Message> found(const std::string& directory, const std::set<std::int64_t>& settled = {}) {
  return Spool(directory, settled, without_syncing()).take_found();
}

std::int64_t file_bytes(const std::string& directory) {
  std::int64_t bytes = 0;
  for (const auto& [first, path] : list_spool(directory))
    bytes += static_cast<std::int64_t>(fs::file_size(path));
  return bytes;
}

// A process that is killed leaves what the kernel has: the spool is not ended here.
TEST(Spool, HandsEachMessageToTheKernelAtOnce) {
  TemporaryDirectory directory;
  Spool spool(directory / "", {});
  for (int i = 0; i < 5; ++i) EXPECT_EQ(append(spool, spooled(10 + i)), i);
  TemporaryDirectory copy;
  fs::copy(directory / "", copy / "", fs::copy_options::recursive);
  const std::vector<Message> kept = found(copy / "", {1, 3});
  ASSERT_EQ(utimes(kept), (std::vector<std::int64_t>{10, 12, 14}));
  EXPECT_EQ(kept[1].received, 2);
  EXPECT_TRUE(same(kept[1], spooled(12)));
}

TEST(Spool, KeepsWhoSignedAndHowFarTheyHadCounted) {
  TemporaryDirectory directory;
  {
    Spool spool(directory / "", {});
    for (const std::int64_t counter : {7, 9}) {
      Message sealed = spooled(counter);
      sealed.signature = Signature{"R1", "R1_SCAN", counter};
      append(spool, sealed);
    }
    append(spool, spooled(10));
  }
  Spool spool(directory / "", {1});
  const std::vector<Message> kept = spool.take_found();
  ASSERT_EQ(kept.size(), 2U);
  ASSERT_TRUE(kept[0].signature);
  EXPECT_EQ(kept[0].signature->counter, 7);
  EXPECT_FALSE(kept[1].signature);
  EXPECT_EQ(spool.counters(), (SignatureCounters{{{"R1", "R1_SCAN"}, 9}})) << "of settled ones too";
}

TEST(Spool, DeletesAFileWhoseMessagesAreSettled) {
  TemporaryDirectory directory;
  Spool spool(directory / "", {}, small_files());
  for (int i = 0; i < 100; ++i) append(spool, spooled(i));
  EXPECT_GT(list_spool(directory / "").size(), 10U);
  EXPECT_EQ(spool.bytes(), file_bytes(directory / ""));
  for (int i = 0; i < 100; ++i) spool.settle(i);
  EXPECT_EQ(list_spool(directory / "").size(), 1U) << "the one that is written";
  EXPECT_LE(file_bytes(directory / ""), 1000);
  spool.finish();
  EXPECT_LT(file_bytes(directory / ""), 100) << "a header";
}

TEST(Spool, GoesOnCountingWhereAllWasSettled) {
  TemporaryDirectory directory;
  {
    Spool spool(directory / "", {});
    for (int i = 0; i < 3; ++i) spool.settle(append(spool, spooled(i)));
    spool.finish();
  }
  for (int start = 0; start < 2; ++start) {
    Spool spool(directory / "", {});
    EXPECT_TRUE(spool.take_found().empty());
    spool.finish();
  }
  Spool spool(directory / "", {});
  EXPECT_GE(append(spool, spooled(3)), 3);
}

// One message of each file waits for long: what it holds besides must not take the disk.
TEST(Spool, TakesNoMoreOfTheDiskThanTwiceWhatWaitsAndAFewFiles) {
  TemporaryDirectory directory;
  std::vector<std::int64_t> waiting;
  {
    Spool spool(directory / "", {}, small_files());
    for (int i = 0; i < 5000; ++i) {
      const std::int64_t number = append(spool, spooled(i));
      if (i % 50 == 0)
        waiting.push_back(i);
      else
        spool.settle(number);
      const auto least = static_cast<std::int64_t>(waiting.size()) * 150;
      ASSERT_LE(file_bytes(directory / ""), 2 * 2 * least + 6 * 1000) << "after " << i;
    }
    EXPECT_EQ(spool.waiting(), 100);
  }
  std::set<std::int64_t> settled;
  for (int i = 0; i < 5000; ++i) {
    if (i % 50 != 0) settled.insert(i);
  }
  EXPECT_EQ(utimes(found(directory / "", settled)), waiting);
}

TEST(Spool, FindsWhatCameBeforeATornMessage) {
  TemporaryDirectory directory;
  {
    Spool spool(directory / "", {});
    for (int i = 0; i < 3; ++i) append(spool, spooled(i));
  }
  const std::vector<std::uint8_t> whole = read_bytes(spool_path(directory / "", 0));
  std::size_t fewest = 3;
  for (std::size_t bytes = whole.size(); bytes-- > 0;) {
    TemporaryDirectory torn;
    write_bytes(spool_path(torn / "", 0), std::span(whole).first(bytes));
    Spool spool(torn / "", {}, without_syncing());
    const std::size_t kept = spool.take_found().size();
    ASSERT_LE(kept, fewest);
    fewest = kept;
    ASSERT_GE(append(spool, spooled(9)), static_cast<std::int64_t>(kept));
  }
  EXPECT_EQ(fewest, 0U);
}

// Whatever a message's bytes spell, they are never read as messages.
TEST(Spool, DoesNotLookForMessagesWithinMessages) {
  std::vector<std::uint8_t> forged;
  Message command = spooled(66, 20, "ISTHMUS_COMMAND");
  for (std::int64_t number = 0; number < 20; ++number) {
    command.received = number;
    append_spooled(forged, command);
  }
  TemporaryDirectory directory;
  {
    Spool spool(directory / "", {});
    append(spool, spooled(1));
    Message scan = spooled(2);
    scan.bytes = forged;
    append(spool, scan);
    append(spool, spooled(3));
  }
  const std::vector<std::uint8_t> whole = read_bytes(spool_path(directory / "", 0));
  for (std::size_t at = 0; at < whole.size(); at += 11) {
    std::vector<std::uint8_t> damaged = whole;
    damaged[at] ^= 0x11;
    TemporaryDirectory copy;
    write_bytes(spool_path(copy / "", 0), damaged);
    for (const Message& one : found(copy / ""))
      ASSERT_EQ(one.channel, "R1_SCAN") << "with byte " << at << " another";
    write_bytes(spool_path(copy / "", 0), std::span(whole).first(at));
    for (const Message& one : found(copy / "")) ASSERT_EQ(one.channel, "R1_SCAN") << "torn at " << at;
  }
}

TEST(Spool, GoesOnWhereTheDiskRefusesAndSaysWhenThatBeginsAndEnds) {
  TemporaryDirectory directory;
  FailingDisk disk;
  std::vector<std::string> told;
  SpoolOptions options = small_files();
  options.disk = disk.operations();
  options.report = [&](const std::string& text) { told.push_back(text); };
  {
    Spool spool(directory / "", {}, options);
    append(spool, spooled(0));
    disk.refuse_with(ENOSPC, 30);
    for (int i = 1; i < 50; ++i) EXPECT_EQ(append(spool, spooled(i)), -1);
    disk.refuse_with(0);
    for (int i = 50; i < 80; ++i) EXPECT_GE(append(spool, spooled(i)), 0);
    EXPECT_EQ(spool.refused(), 49);
  }
  ASSERT_EQ(told.size(), 2U);
  EXPECT_NE(told[0].find("No space left on device; messages wait in memory only"), std::string::npos);
  EXPECT_NE(told[1].find("takes messages again; 49 waited in memory only so far"), std::string::npos);
  const std::vector<std::int64_t> kept = utimes(found(directory / ""));
  ASSERT_EQ(kept.size(), 31U);
  EXPECT_EQ(kept[1], 50);
}

TEST(Spool, BeginsOnAFullDiskAndSpoolsOnceThereIsRoom) {
  TemporaryDirectory directory;
  FailingDisk disk;
  SpoolOptions options;
  options.disk = disk.operations();
  disk.refuse_with(ENOSPC);
  Spool spool(directory / "", {}, options);
  EXPECT_EQ(append(spool, spooled(0)), -1);
  disk.refuse_with(0);
  EXPECT_EQ(append(spool, spooled(1)), 0);
}

TEST(Spool, RefusesWhatIsMoreThanMayWait) {
  TemporaryDirectory directory;
  SpoolOptions options;
  options.max_bytes = 1000;
  Spool spool(directory / "", {}, options);
  std::int64_t kept = 0;
  for (int i = 0; i < 100; ++i) kept += append(spool, spooled(i)) >= 0 ? 1 : 0;
  EXPECT_LT(kept, 10);
  spool.settle(0);
  EXPECT_GE(append(spool, spooled(100)), 0);
}

TEST(Spool, AcknowledgesWhatIsOnTheDiskAndNothingBefore) {
  TemporaryDirectory directory;
  std::atomic<int> error = EIO;
  std::atomic<int> tries = 0;
  std::atomic<std::int64_t> messages = 0;
  std::atomic<std::int64_t> newest_utime = 0;
  SpoolOptions options;
  options.sync_interval = milliseconds(1);
  options.disk.sync = [&](int) {
    ++tries;
    return error.load();
  };
  options.acknowledge = [&](const Receipts& receipts) {
    const received_t told = receipts.message(2, 1);
    ASSERT_EQ(told.nchannels, 1);
    EXPECT_EQ(told.channels[0].channel, "R1_ODOMETRY");
    newest_utime = told.channels[0].newest_utime;
    messages = told.channels[0].messages;
  };
  Spool spool(directory / "", {}, options);
  OdometryEvent odometry{"R1", 7'000'000, {}};
  for (int i = 0; i < 3; ++i) {
    odometry.utime += 100;
    append(spool, encode({5, odometry}));
  }
  ASSERT_TRUE(happens([&] { return tries > 5; }));
  EXPECT_EQ(messages, 0);
  error = 0;
  ASSERT_TRUE(happens([&] { return messages == 3; }));
  EXPECT_EQ(newest_utime, 7'000'300);
}

TEST(Receipts, RememberThoseWhomTheServerKnowsWhateverNamesOthersMakeUp) {
  Receipts receipts;
  receipts.add(spooled(1, 50, "R1_SCAN"), true);
  for (int i = 0; i < 10'000; ++i) receipts.add(spooled(i, 50, "X" + std::to_string(i) + "_SCAN"), false);
  receipts.add(spooled(1, 50, "r1_scan"), true);
  const received_t told = receipts.message(2, 1);
  EXPECT_LT(told.nchannels, 300);
  ASSERT_FALSE(told.channels.empty());
  EXPECT_EQ(told.channels[0].channel, "R1_SCAN");
  EXPECT_EQ(told.channels[0].messages, 2);
}

}  // namespace
}  // namespace isthmus
