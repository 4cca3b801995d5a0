#include "server/wire/page/page_server.hpp"

#include <gtest/gtest.h>
#include <httplib.h>

#include <nlohmann/json.hpp>
#include <stdexcept>
#include <thread>

#include "server/exploration/expedition.hpp"
#include "server/output/grid/grid.hpp"
#include "server/output/grid/grid_files.hpp"
#include "server/wire/journal/journal_files.hpp"
#include "server/wire/journal/recovery/snapshots.hpp"
#include "server/wire/message/message.hpp"
#include "tests/support/team_journal.hpp"
#include "tests/support/waiting.hpp"
#include "tests/unit/wire/page/page_maps.hpp"

namespace isthmus {
namespace {

using std::chrono::milliseconds;
using Json = nlohmann::json;

DropReason takes_nothing(const std::string&, std::span<const std::uint8_t>) { return DropReason::stopped; }

httplib::Client client_of(const PageServer& page) {
  httplib::Client client("127.0.0.1", page.port());
  client.set_read_timeout(std::chrono::seconds(30));
  return client;
}

/// A map with one island, as the live server shows it; waits until the page does.
void show(PageServer& page, const MapCopy& map) {
  const auto before = page.model().shown();
  page.model().show({std::make_shared<const MapCopy>(map), {}, 0, false});
  ASSERT_TRUE(happens([&] { return page.model().shown() != before; })) << "nothing is shown";
}

/// Reads a stream of events until something is in it, or it ends; what came.
std::string read_events(httplib::Client& client, const std::string& until) {
  std::string text;
  client.Get("/events", [&](const char* data, std::size_t size) {
    text.append(data, size);
    return text.find(until) == std::string::npos;
  });
  return text;
}

/// Of the answer's head, where a body would not end.
int status_of_stream(httplib::Client& client) {
  int status = 0;
  client.Get(
      "/events",
      [&](const httplib::Response& response) {
        status = response.status;
        return false;
      },
      [](const char*, std::size_t) { return false; });
  return status;
}

TEST(PageServer, ServesThePageAndNothingThatIsNotThere) {
  const PageServer page({}, takes_nothing);
  httplib::Client client = client_of(page);
  const auto index = client.Get("/");
  ASSERT_TRUE(index);
  EXPECT_EQ(index->status, 200);
  EXPECT_NE(index->body.find("Isthmus"), std::string::npos);
  EXPECT_NE(index->get_header_value("Content-Security-Policy").find("default-src 'none'"), std::string::npos);
  EXPECT_EQ(client.Get("/leaflet.js")->get_header_value("Content-Type"), "text/javascript");
  const std::string words = client.Get("/words.js")->body;
  for (const std::string_view reason : words_of<OrderReason>)
    EXPECT_NE(words.find(std::string(reason) + ": \""), std::string::npos)
        << "why a robot is sent somewhere: " << reason;
  for (const char* path : {"/nothing", "/../etc/passwd", "/tile/x", "/tiles/", "/patches/x",
                           "/preview?closure=0", "/preview", "/download/island-0.png"})
    EXPECT_EQ(client.Get(path)->status, 404) << path;
  EXPECT_EQ(client.Put("/", "", "text/plain")->status, 405);
  EXPECT_EQ(client.Post("/events", "", "text/plain")->status, 405);
}

TEST(PageServer, ATileOfItsVersionStaysAndOneOfAnotherIsNotKept) {
  PageServer page({}, takes_nothing);
  show(page, testing::map_of_islands({{{0.3, 0.2, 0}}}));
  httplib::Client client = client_of(page);
  ASSERT_TRUE(happens([&] { return !page.model().tiles().islands().empty(); }));
  const Json tiles = Json::parse(client.Get("/tiles/0?since=0")->body);
  ASSERT_GE(tiles.size(), 7U) << "one of each zoom";
  const auto version = tiles[0][3].get<std::int64_t>();
  EXPECT_GT(version, page.model().run());
  EXPECT_EQ(Json::parse(client.Get("/tiles/0?since=" + std::to_string(version))->body), Json::array());
  const std::string path = "/tile/0/0/0/0?v=";
  const auto tile = client.Get(path + std::to_string(version));
  EXPECT_EQ(tile->get_header_value("Content-Type"), "image/png");
  EXPECT_EQ(tile->body.substr(1, 3), "PNG");
  EXPECT_NE(tile->get_header_value("Cache-Control").find("immutable"), std::string::npos);
  EXPECT_EQ(client.Get(path + std::to_string(version - 1))->get_header_value("Cache-Control"), "no-store");
}

/// Islands merge between a viewer's list of them and what it asks for: browsers tell of a 404 as an error.
TEST(PageServer, WhatBelongsToAnIslandThatIsGoneIsNoError) {
  PageServer page({}, takes_nothing);
  show(page, testing::map_of_islands({{{0.3, 0.2, 0}}, {{1, 0, 0}}}));
  httplib::Client client = client_of(page);
  EXPECT_EQ(client.Get("/patches/1")->status, 200);
  show(page, testing::map_of_islands({{{0.3, 0.2, 0}, {1, 0, 0}}}));
  for (const char* path : {"/tile/1/0/0/0?v=1", "/patches/1?v=1", "/tile/0/0/99/0?v=1"}) {
    const auto answer = client.Get(path);
    EXPECT_EQ(answer->status, 204) << path;
    EXPECT_TRUE(answer->body.empty()) << path;
    EXPECT_EQ(answer->get_header_value("Cache-Control"), "no-store") << path;
  }
}

/// The second island is the larger, and so the first in files of results.
TEST(PageServer, DownloadsAreTheIslandsOfTheirIds) {
  PageServer page({}, takes_nothing);
  MapCopy map = testing::map_of_islands({{{0.3, 0.2, 0}}, {{5, 0, 0}, {6, 0, 0}}});
  AnnotationRecord dock;
  dock.name = "Dock";
  dock.island = PatchId{1};
  dock.points = {{PatchId{1}, {0.5, 0, 0}}};
  map.annotations = {dock};
  show(page, map);
  httplib::Client client = client_of(page);
  const auto yaml = client.Get("/download/island-1.yaml");
  EXPECT_NE(yaml->get_header_value("Content-Disposition").find("island-1.yaml"), std::string::npos);
  EXPECT_EQ(yaml->body, grid_yaml(render_island(map, {PatchId{1}, PatchId{2}}), "island-1.png"));
  EXPECT_EQ(client.Get("/download/island-0.yaml")->body,
            grid_yaml(render_island(map, {PatchId{0}}), "island-0.png"));
  const Json places = Json::parse(client.Get("/download/places.geojson")->body);
  EXPECT_EQ(places.at("features")[0].at("properties").at("island"), 1);
  for (const char* name : {"island-2.png", "island--1.png", "island-1.gif", "island-9.png", "island-.png"})
    EXPECT_EQ(client.Get(std::string("/download/") + name)->status, 404) << name;
}

/// A map from a journal: its robots are not heard again yet.
TEST(PageServer, AfterARestartRobotsAreShownWhereTheMapHasThem) {
  PageServer page({}, takes_nothing);
  show(page, testing::map_of_a_drive({{0.3, 0.2, 0}, {1, 0.2, 0}}));
  httplib::Client client = client_of(page);
  const std::string text = read_events(client, "event: robots\ndata: [{");
  EXPECT_NE(text.find(R"("heard":false,"matched":true,"name":"R1")"), std::string::npos) << text;
}

TEST(PageServer, ADroppedRobotIsGoneUntilItIsAllowedAgain) {
  PageServer page({}, takes_nothing);
  MapCopy map = testing::map_of_a_drive({{0.3, 0.2, 0}, {1, 0.2, 0}});
  const auto robots = [&](const std::vector<PatchId>& left_out) {
    map.left_out = left_out;
    show(page, map);
    httplib::Client client = client_of(page);
    return read_events(client, left_out.empty() ? "event: robots\ndata: [{" : "event: robots\ndata: []");
  };
  EXPECT_NE(robots({}).find(R"("name":"R1")"), std::string::npos);
  EXPECT_NE(robots({PatchId{0}}).find("event: robots\ndata: []"), std::string::npos);
  EXPECT_NE(robots({}).find(R"("name":"R1")"), std::string::npos);
}

TEST(PageServer, PatchesAreTheSameDeflatedOrNot) {
  PageServer page({}, takes_nothing);
  show(page, testing::map_of_islands({{{0.3, 0.2, 0}, {1, 0.2, 0}}}));
  httplib::Client client = client_of(page);
  const std::string path = "/patches/0?v=" + std::to_string(page.model().shown()->version.at(PatchId{0}));
  const auto plain = client.Get(path, {{"Accept-Encoding", "identity"}});
  const auto packed = client.Get(path, {{"Accept-Encoding", "gzip, deflate"}});
  EXPECT_EQ(plain->body, patch_arrays(*page.model().shown(), PatchId{0}));
  EXPECT_EQ(packed->get_header_value("Content-Encoding"), "deflate");
  EXPECT_EQ(packed->body, plain->body);  // the client has inflated it
  EXPECT_NE(packed->get_header_value("Cache-Control").find("immutable"), std::string::npos);
}

TEST(PageServer, ShowsTheMapAsItWasFromTheJournalsSnapshots) {
  const TemporaryDirectory directory;
  PageOptions options;
  options.journal_directory = write_team_journal(directory);
  update_snapshots(options.journal_directory);
  PageServer page(options, takes_nothing);
  show(page, testing::map_of_islands({{{0.3, 0.2, 0}}}));
  httplib::Client client = client_of(page);
  EXPECT_NE(read_events(client, "event: past\n").find("event: past\ndata: [1,2,"), std::string::npos);
  const Json list = Json::parse(client.Get("/past")->body);
  ASSERT_GE(list.size(), 5U);
  EXPECT_EQ(list[1].at("snapshot"), 2);
  const Json map = Json::parse(client.Get("/past/2")->body);
  EXPECT_EQ(map.at("snapshot"), 2);
  const std::string island = std::to_string(map.at("islands")[0].at("id").get<int>());
  const Json tile = Json::parse(client.Get("/past/2/tiles/" + island)->body)[0];
  const auto image = client.Get("/past/2/tile/" + island + "/" + tile[0].dump() + "/" + tile[1].dump() + "/" +
                                tile[2].dump() + "?v=" + tile[3].dump());
  EXPECT_EQ(image->body.substr(1, 3), "PNG");
  EXPECT_NE(image->get_header_value("Cache-Control").find("immutable"), std::string::npos);
  EXPECT_GT(client.Get("/past/2/patches/" + island)->body.size(), 40U);
  for (const char* path : {"/past/99", "/past/", "/past/x", "/past/2/", "/past/2/nothing", "/past/-1",
                           "/pasta", "/past/99999999999999999999"})
    EXPECT_EQ(client.Get(path)->status, 404) << path;
  EXPECT_EQ(client.Get("/past/2/patches/99")->status, 204) << "an island that is no more";
  flip_a_bit(snapshot_path(options.journal_directory, 3));
  const auto damaged = client.Get("/past/3");
  EXPECT_EQ(damaged->status, 500);
  EXPECT_EQ(Json::parse(damaged->body).at("error"),
            "snapshot-000003.isthmus: is damaged: its checksum is another");
}

TEST(PageServer, WithoutAJournalThereIsNoPast) {
  const PageServer page({}, takes_nothing);
  httplib::Client client = client_of(page);
  EXPECT_EQ(client.Get("/past")->body, "[]");
  EXPECT_EQ(client.Get("/past/1")->status, 404);
}

TEST(PageServer, StreamsTellOfTheMapAndOfPoses) {
  PageServer page({}, takes_nothing);
  show(page, testing::map_of_islands({{{0.3, 0.2, 0}}}));
  RobotPose pose;
  pose.robot = "R1";
  pose.island = PatchId{0};
  pose.pose = {PatchId{0}, {1, 0, 0}};
  page.model().show(pose);
  httplib::Client client = client_of(page);
  const std::string text = read_events(client, "\"R1\"");
  EXPECT_NE(text.find("event: about\ndata: {"), std::string::npos) << text;
  EXPECT_NE(text.find("event: islands\ndata: [{"), std::string::npos) << text;
  EXPECT_NE(text.find(R"("at":[0,1.3,0.2,0.0])"), std::string::npos) << text;
}

TEST(PageServer, OneViewerTooManyIsRefusedUntilAnotherLeaves) {
  PageOptions options;
  options.viewers = 2;
  options.silence_time = milliseconds(20);
  const PageServer page(options, takes_nothing);
  std::atomic<int> reading = 0;
  std::atomic<bool> leave = false;
  std::vector<std::jthread> viewers;
  for (int i = 0; i < 2; ++i) {
    viewers.emplace_back([&] {
      httplib::Client client = client_of(page);
      bool is_first = true;
      client.Get("/events", [&](const char*, std::size_t) {
        reading += std::exchange(is_first, false) ? 1 : 0;
        return !leave;
      });
    });
  }
  ASSERT_TRUE(happens([&] { return reading == 2; })) << "no streams";
  httplib::Client third = client_of(page);
  EXPECT_EQ(status_of_stream(third), 503);
  EXPECT_EQ(third.Get("/")->status, 200) << "the page itself is there";
  leave = true;
  EXPECT_TRUE(happens([&] { return status_of_stream(third) == 200; })) << "no seat is free";
}

TEST(PageServer, EndsWhileViewersWatchAndConnectionsIdle) {
  std::vector<std::jthread> viewers;
  std::atomic<int> reading = 0;
  {
    const PageServer page({}, takes_nothing);
    const int port = page.port();
    for (int i = 0; i < 3; ++i) {
      viewers.emplace_back([&, port] {
        httplib::Client client("127.0.0.1", port);
        client.Get("/events", [&](const char*, std::size_t) {
          reading += 1;
          return true;
        });
      });
    }
    ASSERT_TRUE(happens([&] { return reading >= 3; }));
    httplib::Client idle("127.0.0.1", port);
    idle.set_keep_alive(true);
    EXPECT_EQ(idle.Get("/")->status, 200);
  }
  viewers.clear();  // their streams have ended
}

TEST(PageServer, AtAnotherAddressItIsServedToThoseWithTheTokenAlone) {
  PageOptions options;
  options.address = "0.0.0.0";
  EXPECT_THROW(PageServer(options, takes_nothing), std::runtime_error);
  options.token = "0123456789abcdef";
  const PageServer page(options, takes_nothing);
  httplib::Client client = client_of(page);
  const auto stranger = client.Get("/");
  EXPECT_EQ(stranger->status, 401);
  EXPECT_NE(stranger->body.find("token"), std::string::npos);
  for (const char* path : {"/events", "/page.js", "/tiles/0", "/?token=wrong"})
    EXPECT_EQ(client.Get(path)->status, 401) << path;
  EXPECT_EQ(client.Post("/command", R"({"verb": "refine"})", "application/json")->status, 403);
  const auto entered = client.Get("/?token=0123456789abcdef");
  EXPECT_EQ(entered->status, 303);
  const std::string cookie = entered->get_header_value("Set-Cookie");
  EXPECT_NE(cookie.find("HttpOnly"), std::string::npos) << cookie;
  EXPECT_EQ(client.Get("/page.js", {{"Cookie", cookie.substr(0, cookie.find(';'))}})->status, 200);
}

TEST(PageServer, TheFormSendsATokenThatNoAddressHolds) {
  PageOptions options;
  options.token = "0123456789abcdef";
  const PageServer page(options, takes_nothing);
  httplib::Client client = client_of(page);
  const auto asked = client.Get("/");
  EXPECT_NE(asked->body.find("method=\"post\""), std::string::npos);
  EXPECT_EQ(asked->body.find("Wrong token"), std::string::npos);
  const auto wrong = client.Post("/", httplib::Params{{"token", "0123456789abcdeF"}});
  EXPECT_EQ(wrong->status, 401);
  EXPECT_NE(wrong->body.find("Wrong token."), std::string::npos);
  EXPECT_FALSE(wrong->has_header("Set-Cookie"));
  const auto entered = client.Post("/", httplib::Params{{"token", "0123456789abcdef"}});
  EXPECT_EQ(entered->status, 303);
  EXPECT_EQ(entered->get_header_value("Location"), "/");
  EXPECT_NE(entered->get_header_value("Set-Cookie").find("HttpOnly"), std::string::npos);
  EXPECT_EQ(client.Post("/", {{"Content-Encoding", "gzip"}}, "bytes", "text/plain")->status, 411);
}

TEST(PageServer, APortThatIsTakenIsAnError) {
  const PageServer page({}, takes_nothing);
  PageOptions options;
  options.port = page.port();
  EXPECT_THROW(PageServer(options, takes_nothing), std::runtime_error);
}

TEST(PageServer, AnOrderIsAnsweredWithWhatBecameOfIt) {
  PageServer* self = nullptr;
  const auto take = [&](const std::string& channel, std::span<const std::uint8_t> bytes) {
    const CommandEvent order = std::get<CommandEvent>(decode({}, channel, bytes, 0).event->body);
    if (order.verb == Verb::forbid)
      self->orders().answered(order.utime, DropReason::none, "not_proposed_yet");
    else
      self->orders().answered(order.utime, order.closure == 3 ? DropReason::none : DropReason::not_accepted);
    return DropReason::none;
  };
  PageServer page({}, take);
  self = &page;
  httplib::Client client = client_of(page);
  const auto post = [&](const std::string& body, const char* type = "application/json") {
    return client.Post("/command", body, type);
  };
  EXPECT_EQ(post(R"({"verb": "withdraw", "closure": 3})")->status, 200);
  const auto refused = post(R"({"verb": "withdraw", "closure": 4})");
  EXPECT_EQ(refused->status, 409);
  EXPECT_EQ(Json::parse(refused->body).at("error"), "not_accepted");
  EXPECT_EQ(Json::parse(refused->body).at("words"), "it is not accepted (any more)");
  const Json forbidden = Json::parse(post(R"({"verb": "forbid", "closure": 77})")->body);
  EXPECT_EQ(forbidden.at("remark"), "not_proposed_yet");
  EXPECT_EQ(forbidden.at("words"), "nothing like it is known yet; it is forbidden should it be proposed");
  EXPECT_EQ(post("{}")->status, 400);
  EXPECT_EQ(post(R"({"verb": "withdraw", "closure": 3})", "text/plain")->status, 415);
  EXPECT_EQ(client
                .Post("/command", {{"Origin", "http://evil.example"}},
                      R"({"verb": "withdraw", "closure": 3})", "application/json")
                ->status,
            403);
}

// Neither chunks nor what is compressed has an end that is known before it is in memory.
TEST(PageServer, AnOrderWhoseLengthIsNotKnownIsRefusedBeforeItIsRead) {
  const PageServer page({}, takes_nothing);
  httplib::Client client = client_of(page);
  std::size_t sent = 0;
  const auto chunks = client.Post(
      "/command",
      [&](std::size_t, httplib::DataSink& sink) {
        const std::string chunk(65'536, 'a');
        sent += chunk.size();
        const bool goes_on = sink.write(chunk.data(), chunk.size());
        if (sent > 100'000'000) sink.done();
        return goes_on;
      },
      "application/json");
  EXPECT_LT(sent, 100'000'000U) << "the server did not wait for the end";
  EXPECT_TRUE(!chunks || chunks->status == 411);
  httplib::Client other = client_of(page);
  const httplib::Headers deflated = {{"Content-Encoding", "gzip"}};
  EXPECT_EQ(other.Post("/command", deflated, "bytes", "application/json")->status, 411);
  EXPECT_EQ(other
                .Post("/command", {{"Origin", "http://evil.example"}, {"Content-Encoding", "gzip"}}, "bytes",
                      "application/json")
                ->status,
            403);
}

TEST(PageServer, WhereKeysAreConfiguredOrdersMustBeSigned) {
  PageOptions options;
  options.orders_signed = true;
  const PageServer page(options, takes_nothing);
  httplib::Client client = client_of(page);
  const auto refused = client.Post("/command", R"({"verb": "refine"})", "application/json");
  EXPECT_EQ(refused->status, 403);
  EXPECT_EQ(Json::parse(refused->body).at("error"), "unsigned");
  EXPECT_EQ(client.Post("/command", "no envelope", "application/octet-stream")->status, 409);
}

}  // namespace
}  // namespace isthmus
