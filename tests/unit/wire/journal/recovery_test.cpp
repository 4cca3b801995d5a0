#include "server/wire/journal/recovery/recovery.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "server/wire/live/live_server.hpp"
#include "tests/support/box_room.hpp"
#include "tests/support/log_files.hpp"
#include "tests/support/published.hpp"
#include "tests/support/replayed.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/unit/wire/live/live_inputs.hpp"

namespace isthmus {
namespace {

namespace fs = std::filesystem;

/// A server's life: it recovers, hears rounds [from, to) of both robots, and stops in order.
std::string serve(const LiveOptions& options, int from, int to, bool introduced) {
  Published published;
  Inbox inbox;
  LiveServer server(options, inbox, published.sink());
  for (const std::string name : {"R1", "R2"}) {
    const BoxRoomRobot robot(name);
    if (introduced) push(inbox, name, robot.introduction());
    for (int i = from; i < to; ++i)
      for (const Message& message : robot.round(i)) push(inbox, name, message);
  }
  inbox.close();
  server.run();
  return map_sha256(server.engine().copy());
}

void tear(const std::string& journal, int bytes) {
  const std::string segment = journal + "/journal-000001.lcm";
  fs::resize_file(segment, fs::file_size(segment) - static_cast<std::uintmax_t>(bytes));
}

TEST(Recovery, GoesOnToTheMapThatAReplayOfTheWholeJournalMakes) {
  for (const int torn : {0, 1, 100, 5000}) {
    TemporaryDirectory directory;
    const std::string journal = directory / "journal";
    serve(journalled(journal), 0, 100, true);
    tear(journal, torn);
    const std::size_t before = read_log(journal).messages.size();
    const std::string map = serve(journalled(journal), 100, 160, false);
    const Replayed replayed = replay_of(journal);
    EXPECT_EQ(replayed.sha256, map) << torn << " bytes torn off";
    EXPECT_GE(replayed.events, before + 2 * 2 * 60);
    EXPECT_EQ(read_log(journal).skipped, 0);
  }
}

TEST(Recovery, EndsWithTheMapThatWasWhereNothingMoreComes) {
  TemporaryDirectory directory;
  const std::string journal = directory / "journal";
  const std::string map = serve(journalled(journal), 0, 80, true);
  EXPECT_EQ(serve(journalled(journal), 0, 0, false), map);
  EXPECT_EQ(serve(journalled(journal), 0, 0, false), map);
}

TEST(Recovery, NeverGivesAReceiveTimeBeforeTheJournals) {
  TemporaryDirectory directory;
  LiveOptions options = journalled(directory / "journal");
  serve(options, 50, 60, true);
  serve(options, 0, 10, false);
  const LogContent content = read_log(directory / "journal");
  EXPECT_TRUE(std::is_sorted(content.messages.begin(), content.messages.end(),
                             [](const Message& a, const Message& b) { return a.utime < b.utime; }));
}

TEST(Recovery, KeepsTheJournalsConfigurationAndRefusesAnother) {
  TemporaryDirectory directory;
  LiveOptions options = journalled(directory / "journal");
  options.toml = "tags = \"any\"\n";
  serve(options, 0, 5, true);
  Inbox inbox;
  const auto nobody = [](const auto&, const auto&) {};
  options.toml = "tags = \"declared\"\n";
  EXPECT_EQ(
      error_of([&] { LiveServer server(options, inbox, nobody); }),
      directory / "journal" +
          ": this journal was begun with another configuration; give that or none, or another directory");
  options.toml.clear();
  EXPECT_TRUE(LiveServer(options, inbox, nobody).engine().configuration().any_tag);
}

TEST(Recovery, BeginsAnewInAJournalThatHoldsNothing) {
  TemporaryDirectory directory;
  directory.write("journal/journal-000001.lcm", "");
  serve(journalled(directory / "journal"), 0, 5, true);
  EXPECT_EQ(read_log(directory / "journal").messages.front().channel, "ISTHMUS_CONFIGURATION");
}

TEST(Recovery, TellsWhatItDid) {
  TemporaryDirectory directory;
  LiveOptions options = journalled(directory / "journal");
  serve(options, 0, 5, true);
  tear(options.journal_directory, 1);
  std::string told;
  options.log = [&](LogLevel level, std::string_view message, const LogFields& fields) {
    told += log_line(0, level, message, fields) + "\n";
  };
  serve(options, 0, 0, false);
  EXPECT_NE(told.find("torn_bytes_cut="), std::string::npos) << told;
  EXPECT_NE(told.find("msg=recovered events="), std::string::npos) << told;
}

/// However the journal was damaged, it is recovered to the map that its replay makes.
TEST(Recovery, AgreesWithAReplayOfADamagedJournal) {
  TemporaryDirectory directory;
  serve(journalled(directory / "journal"), 0, 60, true);
  const std::vector<std::uint8_t> whole = read_bytes(directory / "journal/journal-000001.lcm");
  std::uint32_t random = 1;
  for (int run = 0; run < 20; ++run) {
    std::vector<std::uint8_t> bytes = whole;
    for (int i = 0; i < 20; ++i) {
      random = random * 1664525 + 1013904223;
      bytes[600 + random % (bytes.size() - 600)] ^= static_cast<std::uint8_t>(1U << (random >> 28) % 8);
    }
    const std::string journal = directory / std::to_string(run);
    fs::create_directory(journal);
    write_bytes(journal + "/journal-000001.lcm", bytes);
    const std::string map = serve(journalled(journal), 60, 70, false);
    Engine engine;
    for (const Message& message : read_log(journal).messages) {
      const Decoded decoded =
          decode(channels_of(engine.configuration()), message.channel, message.bytes, message.utime);
      if (decoded.event) engine.handle(*decoded.event);
    }
    engine.finish();
    EXPECT_EQ(map_sha256(engine.copy()), map) << "run " << run;
  }
}

}  // namespace
}  // namespace isthmus
