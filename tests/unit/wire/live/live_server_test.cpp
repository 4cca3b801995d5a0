#include "server/wire/live/live_server.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <thread>

#include "isthmus/answer_t.hpp"
#include "isthmus/grid_t.hpp"
#include "isthmus/manifold_pose_t.hpp"
#include "isthmus/map_t.hpp"
#include "isthmus/status_t.hpp"
#include "server/wire/message/encoded.hpp"
#include "tests/support/box_room.hpp"
#include "tests/support/log_files.hpp"
#include "tests/support/published.hpp"
#include "tests/support/replayed.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/support/waiting.hpp"
#include "tests/unit/wire/live/live_inputs.hpp"

namespace isthmus {
namespace {

using std::chrono::milliseconds;

void drive(Inbox& inbox, const std::string& name, int rounds, milliseconds pause = milliseconds(0)) {
  const BoxRoomRobot robot(name);
  push(inbox, name, robot.introduction());
  for (int i = 0; i < rounds; ++i) {
    for (const Message& message : robot.round(i)) push(inbox, name, message);
    std::this_thread::sleep_for(pause);
  }
}

TEST(LiveServer, MakesTheMapThatAReplayOfItsJournalMakes) {
  TemporaryDirectory directory;
  LiveOptions options = journalled(directory / "journal");
  options.output_directory = directory / "out";
  Published published;
  Inbox inbox;
  LiveServer server(options, inbox, published.sink());
  std::thread engine_thread([&] { server.run(); });
  std::thread first([&] { drive(inbox, "R1", 150, milliseconds(1)); });
  std::thread second([&] { drive(inbox, "R2", 150, milliseconds(1)); });
  first.join();
  second.join();
  inbox.close();
  engine_thread.join();

  const MapCopy map = server.engine().copy();
  EXPECT_GE(map.patches.size(), 4U);
  EXPECT_EQ(map.counters.scans, 300);
  const Replayed replayed = replay_of(directory / "journal");
  EXPECT_EQ(replayed.sha256, map_sha256(map));
  EXPECT_GE(replayed.events, 1U + 2U + 600U);
  EXPECT_TRUE(std::filesystem::exists(directory / "out/report.json"));
  EXPECT_TRUE(std::filesystem::exists(directory / "out/trajectories/R2.tum"));
}

TEST(LiveServer, AnswersEachScanAndTellsOfTheMap) {
  Published published;
  Inbox inbox;
  LiveServer server(quick_options(), inbox, published.sink());
  std::thread engine_thread([&] { server.run(); });
  drive(inbox, "R1", 100, milliseconds(2));
  EXPECT_TRUE(happens([&] { return !published.of<grid_t>("ISTHMUS_GRID").empty(); })) << "no grid";
  inbox.close();
  engine_thread.join();

  const auto poses = published.of<manifold_pose_t>("R1_POSE");
  ASSERT_EQ(poses.size(), 100U);
  EXPECT_EQ(poses.back().robot, "R1");
  EXPECT_EQ(poses.back().utime, 1'000'000'000 + 99 * 100'000);
  const auto maps = published.of<map_t>("ISTHMUS_MAP");
  ASSERT_FALSE(maps.empty());
  EXPECT_TRUE(maps.front().whole);
  const auto statuses = published.of<status_t>("ISTHMUS_STATUS");
  ASSERT_FALSE(statuses.empty());
  EXPECT_GT(statuses.back().scans, 0);
  ASSERT_EQ(statuses.back().nrobots, 1);
  EXPECT_EQ(statuses.back().robots[0].robot, "R1");
  const grid_t grid = published.of<grid_t>("ISTHMUS_GRID").front();
  EXPECT_EQ(grid.npixels, grid.width * grid.height);
  EXPECT_GT(std::count(grid.pixels.begin(), grid.pixels.end(), 254), 100);
}

TEST(LiveServer, SendsTheWholeMapOnRequest) {
  Published published;
  Inbox inbox;
  LiveServer server(quick_options(), inbox, published.sink());
  std::thread engine_thread([&] { server.run(); });
  drive(inbox, "R1", 20);
  const auto whole_maps = [&] {
    const auto maps = published.of<map_t>("ISTHMUS_MAP");
    return std::count_if(maps.begin(), maps.end(),
                         [](const map_t& map) { return map.whole && map.npatches > 0; });
  };
  EXPECT_TRUE(happens([&] { return !published.of<map_t>("ISTHMUS_MAP").empty(); })) << "no map";
  const auto before = whole_maps();
  push(inbox, "", encode({1, CommandEvent{5, Verb::send_map, -1, ""}}));
  EXPECT_TRUE(happens([&] { return whole_maps() > before; })) << "no whole map";
  const std::size_t grids = published.of<grid_t>("ISTHMUS_GRID").size();
  push(inbox, "", encode({1, CommandEvent{6, Verb::send_map, -1, ""}}));
  EXPECT_TRUE(happens([&] { return published.of<grid_t>("ISTHMUS_GRID").size() > grids; }))
      << "no grid with it";
  inbox.close();
  engine_thread.join();
}

TEST(LiveServer, ShowsViewersPosesTheMapAndWhatBecameOfOrders) {
  LiveOptions options = quick_options();
  std::vector<RobotPose> poses;
  std::shared_ptr<const MapCopy> newest;
  std::vector<std::pair<std::int64_t, DropReason>> orders;
  options.viewers.pose = [&](const RobotPose& pose) { poses.push_back(pose); };
  options.viewers.map = [&](auto map, const status_t& status, double) {
    newest = map;
    EXPECT_EQ(status.patches, static_cast<int>(map->patches.size()));
  };
  options.viewers.order = [&](std::int64_t order_utime, DropReason reason, const std::string&) {
    orders.emplace_back(order_utime, reason);
  };
  Published published;
  Inbox inbox;
  LiveServer server(options, inbox, published.sink());
  std::thread engine_thread([&] { server.run(); });
  drive(inbox, "R1", 50, milliseconds(2));
  push(inbox, "", encode({1, CommandEvent{5, Verb::withdraw, 3, ""}}));
  push(inbox, "", encode({1, CommandEvent{6, Verb::refine, -1, ""}}));
  AnnotationEvent place;
  place.utime = 7;
  place.name = "Dock";
  place.island = IslandId{0};
  place.points = {{PatchId{}, {1, 0}}};
  push(inbox, "", encode({1, place}));
  push(inbox, "", encode({1, place}));
  EXPECT_TRUE(happens([&] { return published.of<answer_t>("ISTHMUS_ANSWER").size() == 4; }));
  EXPECT_TRUE(happens([&] { return published.of<status_t>("ISTHMUS_STATUS").size() > 2; }));
  inbox.close();
  engine_thread.join();
  const auto answers = published.of<answer_t>("ISTHMUS_ANSWER");
  EXPECT_EQ(answers.back().verb, "place");
  EXPECT_EQ(answers.back().robot, "Dock");
  EXPECT_EQ(answers.back().reason, "name_taken");
  EXPECT_EQ(server.engine().copy().annotations.size(), 1U);
  EXPECT_EQ(poses.size(), 50U);
  ASSERT_TRUE(newest);
  EXPECT_FALSE(newest->patches.empty());
  EXPECT_EQ(orders, (std::vector<std::pair<std::int64_t, DropReason>>{{5, DropReason::no_such_closure},
                                                                      {6, DropReason::none},
                                                                      {7, DropReason::none},
                                                                      {7, DropReason::name_taken}}));
}

TEST(LiveServer, TellsWhatLooksWrongWhileItDoes) {
  LiveOptions options = quick_options();
  auto now = std::make_shared<std::atomic<std::int64_t>>(0);
  options.mistakes = std::make_shared<Mistakes>(
      [now] { return Mistakes::Clock::time_point(std::chrono::seconds(now->load())); });
  Published published;
  Inbox inbox;
  LiveServer server(options, inbox, published.sink());
  std::thread engine_thread([&] { server.run(); });
  const BoxRoomRobot robot("R1");
  push(inbox, "R1", robot.introduction());
  for (int i = 0; i < 5; ++i)
    push(inbox, "R1", encode({1, SightingEvent{"R1", 1'000'000'000 + i, 77, 2, 0.1, 0, 0.1}}));
  const auto newest = [&] {
    const auto statuses = published.of<status_t>("ISTHMUS_STATUS");
    return statuses.empty() ? status_t{} : statuses.back();
  };
  EXPECT_TRUE(happens([&] { return newest().nwarnings == 1; }));
  EXPECT_EQ(newest().warnings.at(0).kind, "barcode_of_nobody");
  EXPECT_GT(newest().warnings.at(0).begin_utime, 0);
  *now += 11;
  EXPECT_TRUE(happens([&] { return newest().nwarnings == 0; }));
  inbox.close();
  engine_thread.join();
}

TEST(LiveServer, AnswersAndLogsEachOrder) {
  LiveOptions options = quick_options();
  std::vector<std::string> lines;
  options.log = [&](LogLevel level, std::string_view text, const LogFields& fields) {
    if (text.starts_with("an order")) lines.push_back(log_line(0, level, text, fields).substr(30));
  };
  Published published;
  Inbox inbox;
  LiveServer server(options, inbox, published.sink());
  push(inbox, "", encode({1, CommandEvent{5, Verb::withdraw, 3, ""}}));
  Message refine = encode({1, CommandEvent{6, Verb::refine, -1, ""}});
  refine.signature = Signature{"ALICE@0123456789ab", "ISTHMUS_COMMAND", 1};
  inbox.push("", false, 1, refine.channel, refine.bytes, refine.signature);
  command_t nonsense{};
  nonsense.utime = 7;
  nonsense.verb = "explode";
  push(inbox, "", {1, "ISTHMUS_COMMAND", encoded(nonsense)});
  AnnotationEvent erase;
  erase.utime = 8;
  erase.kind = AnnotationKind::erase;
  erase.name = "Dock 1";
  push(inbox, "", encode({1, erase}));
  push(inbox, "", encode({1, CommandEvent{9, Verb::forbid, 99, ""}}));
  inbox.close();
  server.run();

  const auto answers = published.of<answer_t>("ISTHMUS_ANSWER");
  ASSERT_EQ(answers.size(), 5U);
  EXPECT_TRUE(answers[4].done);
  EXPECT_EQ(answers[4].reason, "not_proposed_yet");
  EXPECT_EQ(answers[0].order_utime, 5);
  EXPECT_EQ(answers[0].verb, "withdraw");
  EXPECT_EQ(answers[0].closure, 3);
  EXPECT_FALSE(answers[0].done);
  EXPECT_EQ(answers[0].reason, "no_such_closure");
  EXPECT_EQ(answers[1].order_utime, 6);
  EXPECT_TRUE(answers[1].done);
  EXPECT_EQ(answers[1].sender, "ALICE");
  EXPECT_EQ(answers[2].order_utime, 7);
  EXPECT_EQ(answers[2].reason, "unknown_command");
  ASSERT_EQ(lines.size(), 5U);
  EXPECT_EQ(lines[0],
            "level=warning msg=\"an order is refused\" order=withdraw closure=3 by=(unsigned) "
            "reason=no_such_closure");
  EXPECT_EQ(lines[1], "level=info msg=\"an order is carried out\" order=refine by=ALICE");
  EXPECT_EQ(lines[3],
            "level=warning msg=\"an order is refused\" order=erase name=\"Dock 1\" by=(unsigned) "
            "reason=no_such_name");
}

TEST(LiveServer, GivesReceiveTimesThatNeverGoBack) {
  TemporaryDirectory directory;
  LiveOptions options = journalled(directory / "journal");
  Published published;
  Inbox inbox;
  LiveServer server(options, inbox, published.sink());
  const BoxRoomRobot robot("R1");
  push(inbox, "R1", robot.introduction());
  for (const int round : {5, 2, 9, 1}) {
    for (const Message& message : robot.round(round)) push(inbox, "R1", message);
  }
  inbox.close();
  server.run();
  const LogContent content = read_log(directory / "journal");
  EXPECT_TRUE(std::is_sorted(content.messages.begin(), content.messages.end(),
                             [](const Message& a, const Message& b) { return a.utime < b.utime; }));
}

}  // namespace
}  // namespace isthmus
