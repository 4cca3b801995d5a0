// A journal that is taken from under the server.

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <mutex>
#include <thread>

#include "server/wire/journal/journal.hpp"
#include "server/wire/journal/journal_files.hpp"
#include "server/wire/live/live_server.hpp"
#include "tests/support/box_room.hpp"
#include "tests/support/log_files.hpp"
#include "tests/support/published.hpp"
#include "tests/support/temporary_directory.hpp"

namespace isthmus {
namespace {

namespace fs = std::filesystem;

Message tick(std::int64_t utime) { return encode({utime, TickEvent{}}); }

class DeletedJournal : public ::testing::Test {
 protected:
  DeletedJournal() {
    options_.sync_interval = std::chrono::milliseconds(1);
    options_.segment_bytes = 1000;
    options_.report = [this](const std::string& text) {
      const std::lock_guard lock(mutex_);
      reports_ += text + "\n";
    };
    journal_ = std::make_unique<Journal>(path_, options_);
  }

  void append(int count) {
    for (int i = 0; i < count; ++i) EXPECT_TRUE(journal_->append(tick(++last_)));
  }
  bool has_said(const std::string& text) {
    const std::lock_guard lock(mutex_);
    return reports_.find(text) != std::string::npos;
  }
  void wait_until_said(const std::string& text) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    while (!has_said(text) && std::chrono::steady_clock::now() < end)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    EXPECT_TRUE(has_said(text)) << reports_;
  }
  std::string segment() const { return segment_path(path_, journal_->segment()); }

  TemporaryDirectory directory_;
  std::string path_ = directory_ / "j";
  JournalOptions options_;
  std::mutex mutex_;
  std::string reports_;
  std::unique_ptr<Journal> journal_;
  std::int64_t last_ = 0;
};

TEST_F(DeletedJournal, WritesTheSegmentAgain) {
  append(22);
  EXPECT_GE(journal_->segment(), 3);
  fs::remove(segment());
  wait_until_said("the segment that is written was deleted");
  append(2);
  EXPECT_TRUE(has_said("was deleted while it was written, and is written again"));
  EXPECT_EQ(journal_->failures(), 1);
  EXPECT_EQ(journal_->finish(), 0U);
  EXPECT_EQ(journal_->why_incomplete(), "");
  EXPECT_EQ(read_log(path_).messages.size(), 24U);
  EXPECT_EQ(read_log(path_).skipped, 0);
}

TEST_F(DeletedJournal, WritesTheDirectoryAgain) {
  append(3);
  EXPECT_EQ(journal_->segment(), 1);
  fs::remove_all(path_);
  wait_until_said("the segment that is written was deleted");
  journal_->write_waiting();
  append(2);
  EXPECT_EQ(journal_->finish(), 0U);
  EXPECT_EQ(journal_->why_incomplete(), "");
  EXPECT_EQ(read_log(path_).messages.size(), 5U);
  EXPECT_EQ(error_of([&] { Journal again(path_); }), path_ + ": another server writes this journal");
}

TEST_F(DeletedJournal, TellsOfTheSegmentsThatWentWithTheDirectory) {
  append(22);
  const int last = journal_->segment();
  fs::remove_all(path_);
  append(1);
  EXPECT_EQ(journal_->finish(), 0U);
  EXPECT_EQ(journal_->why_incomplete(),
            segment_path(path_, last - 1) + ": is gone, and no snapshot stands for it and those before it");
  EXPECT_GT(read_log(segment_path(path_, last)).messages.size(), 0U) << "what was left is kept";
  EXPECT_TRUE(has_said("is not whole any more")) << "before the end, too: " << reports_;
}

TEST_F(DeletedJournal, NoticesAtTheEndWhatItHadNoTimeToNotice) {
  append(3);
  fs::remove(segment());
  EXPECT_EQ(journal_->finish(), 0U);
  EXPECT_EQ(journal_->why_incomplete(), "");
  EXPECT_EQ(read_log(path_).messages.size(), 3U);
}

// Deleted, and full before anybody has looked: what is closed without a name would be lost.
TEST_F(DeletedJournal, WritesTheSegmentAgainBeforeItIsClosed) {
  journal_.reset();
  options_.sync_interval = std::chrono::hours(1);
  journal_ = std::make_unique<Journal>(path_, options_);
  append(3);
  fs::remove(segment());
  append(20);
  EXPECT_GT(journal_->segment(), 2);
  EXPECT_EQ(journal_->finish(), 0U);
  EXPECT_EQ(journal_->why_incomplete(), "");
  EXPECT_EQ(read_log(path_).messages.size(), 23U);
}

TEST_F(DeletedJournal, TellsOfAnEarlierSegmentThatIsGone) {
  append(22);
  fs::remove(segment_path(path_, 2));
  EXPECT_EQ(journal_->finish(), 0U);
  EXPECT_EQ(journal_->why_incomplete(),
            segment_path(path_, 2) + ": is missing, but journal-000003.lcm follows it");
}

TEST_F(DeletedJournal, BeginsTheNextSegmentWhereAnotherFileHasTheName) {
  append(3);
  fs::remove(segment());
  write_bytes(segment_path(path_, 1), {});
  wait_until_said("the segment that is written was deleted or replaced");
  append(2);
  EXPECT_TRUE(has_said("was replaced while it was written: its events are lost"));
  EXPECT_EQ(journal_->segment(), 2);
  EXPECT_EQ(journal_->finish(), 0U);
  EXPECT_EQ(journal_->why_incomplete(), segment_path(path_, 1) + ": is empty, but segments follow it");
  EXPECT_EQ(read_log(segment_path(path_, 2)).messages.size(), 2U);
}

/// The server ends with an error that says what is lost.
TEST(DeletedJournalOfAServer, IsSaidAtTheEnd) {
  const TemporaryDirectory directory;
  LiveOptions options = quick_options();
  options.journal_directory = directory / "journal";
  options.journal.segment_bytes = 5000;
  Published published;
  Inbox inbox;
  LiveServer server(options, inbox, published.sink());
  const BoxRoomRobot robot("R1");
  std::vector<Message> messages = {robot.introduction()};
  for (int i = 0; i < 30; ++i)
    for (const Message& message : robot.round(i)) messages.push_back(message);
  for (const Message& message : messages)
    inbox.push("R1", message.channel.ends_with("_SCAN"), message.utime, message.channel, message.bytes);
  inbox.close();
  fs::remove_all(directory / "journal");
  EXPECT_EQ(error_of([&] { server.run(); }), "");
  EXPECT_EQ(read_log(directory / "journal").messages.size(), 62U) << "the first segment was still open";

  Inbox second_inbox;
  LiveServer second(options, second_inbox, published.sink());
  for (int i = 30; i < 60; ++i)
    for (const Message& message : robot.round(i))
      second_inbox.push("R1", message.channel.ends_with("_SCAN"), message.utime, message.channel,
                        message.bytes);
  second_inbox.close();
  fs::remove(segment_path(directory / "journal", 1));
  const std::string error = error_of([&] { second.run(); });
  EXPECT_NE(error.find("the journal is not whole any more"), std::string::npos) << error;
}

}  // namespace
}  // namespace isthmus
