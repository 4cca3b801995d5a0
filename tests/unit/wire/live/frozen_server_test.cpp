#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <map>

#include "isthmus/manifold_pose_t.hpp"
#include "server/wire/journal/journal_directory.hpp"
#include "server/wire/live/live_server.hpp"
#include "tests/support/box_room.hpp"
#include "tests/support/log_files.hpp"
#include "tests/support/published.hpp"
#include "tests/support/replayed.hpp"
#include "tests/support/temporary_directory.hpp"

namespace isthmus {
namespace {

namespace fs = std::filesystem;

/// What a server with these options, that hears rounds [from, to) of R1, sends, and the map it ends with.
std::string serve(const LiveOptions& options, Published& published, int from, int to) {
  Inbox inbox;
  LiveServer server(options, inbox, published.sink());
  const BoxRoomRobot robot("R1");
  std::vector<Message> messages;
  if (from == 0) messages.push_back(robot.introduction());
  for (int i = from; i < to; ++i) std::ranges::copy(robot.round(i), std::back_inserter(messages));
  for (const Message& message : messages)
    inbox.push("R1", message.channel.ends_with("_SCAN"), message.utime, message.channel, message.bytes);
  inbox.close();
  server.run();
  return map_sha256(server.engine().copy());
}

LiveOptions with_journal(const std::string& directory, bool frozen) {
  LiveOptions options = quick_options();
  options.journal_directory = directory;
  options.frozen = frozen;
  return options;
}

TEST(FrozenServer, TellsPosesInTheJournalsMapAndLeavesBothAsTheyWere) {
  TemporaryDirectory directory;
  const std::string journal = directory / "journal";
  Published before;
  serve(with_journal(journal, false), before, 0, 100);
  const std::string map = replay_of(journal).sha256;
  const auto files = files_of(journal);
  Published published;
  EXPECT_EQ(serve(with_journal(journal, true), published, 100, 160), map);
  EXPECT_EQ(files_of(journal), files);
  EXPECT_EQ(published.of<manifold_pose_t>("R1_POSE").size(), 60U);
}

TEST(FrozenServer, NeedsNoJournalOfItsOwn) {
  TemporaryDirectory directory;
  const std::string journal = directory / "journal";
  Published published;
  serve(with_journal(journal, false), published, 0, 100);
  const JournalDirectory held_by_another(journal);
  EXPECT_EQ(serve(with_journal(journal, true), published, 100, 110), replay_of(journal).sha256);
}

TEST(FrozenServer, WantsAMap) {
  TemporaryDirectory directory;
  directory.write("journal/journal-000001.lcm", "");
  Published published;
  EXPECT_EQ(error_of([&] { serve(with_journal(directory / "journal", true), published, 0, 1); }),
            directory / "journal" + ": holds no event of a journal to make a map of");
  EXPECT_NE(error_of([&] { serve(with_journal(directory / "nothing", true), published, 0, 1); }), "");
  EXPECT_FALSE(fs::exists(directory / "nothing"));
}

}  // namespace
}  // namespace isthmus
