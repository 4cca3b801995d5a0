#include <gtest/gtest.h>

#include <lcm/lcm-cpp.hpp>

#include "isthmus/status_t.hpp"
#include "server/wire/message/encoded.hpp"
#include "server/wire/message/message.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tools/command/heard_server.hpp"
#include "tools/command/order.hpp"
#include "tools/command/send.hpp"

namespace isthmus {
namespace {

using std::chrono::milliseconds;

TEST(Order, AClosuresIdIsAnIntegerThatIsNotNegative) {
  EXPECT_EQ(parse_closure_id("0"), 0);
  EXPECT_EQ(parse_closure_id("2147483647"), 2147483647);
  EXPECT_EQ(error_of([] { parse_closure_id("-1"); }), "a closure's id is not negative: -1");
  EXPECT_EQ(error_of([] { parse_closure_id("2147483648"); }), "too large for a closure's id: 2147483648");
  for (const char* text : {"", "x", "1.5", "3 ", "99999999999999999999"}) {
    EXPECT_EQ(error_of([&] { parse_closure_id(text); }),
              "not a closure's id: '" + std::string(text) + "' (isthmus-inspect lists them)");
  }
}

TEST(Order, ARobotsNameIsUpperCaseAndCanBeOne) {
  EXPECT_EQ(parse_robot_name("r1"), "R1");
  for (const char* text : {"", "../x", "isthmus", "a b"}) {
    EXPECT_EQ(error_of([&] { parse_robot_name(text); }).find("not a robot's name: '"), 0U) << text;
  }
}

TEST(Order, AllowTakesAClosureOrARobotBack) {
  EXPECT_EQ(allow_order("12").closure, 12);
  EXPECT_EQ(allow_order("12").robot, "");
  EXPECT_EQ(allow_order("r2").closure, -1);
  EXPECT_EQ(allow_order("r2").robot, "R2");
  EXPECT_NE(error_of([] { allow_order("-12"); }), "");
}

TEST(Order, SaysWhatItIs) {
  EXPECT_EQ(to_text(CommandEvent{0, Verb::forbid, 3, ""}), "forbid closure 3");
  EXPECT_EQ(to_text(CommandEvent{0, Verb::drop, -1, "R1"}), "drop robot R1");
  EXPECT_EQ(to_text(CommandEvent{0, Verb::send_map, -1, ""}), "send_map");
  AnnotationEvent zone;
  zone.kind = AnnotationKind::keep_out;
  zone.name = "Stairs";
  EXPECT_EQ(to_text(zone), "keep_out Stairs");
  InitialPoseEvent pose;
  pose.robot = "R1";
  EXPECT_EQ(to_text(pose), "initial_pose robot R1");
}

TEST(Order, TakesPointsPosesAndNamesStrictly) {
  const auto points = parse_points("1,2 3,-4.5");
  ASSERT_EQ(points.size(), 2U);
  EXPECT_EQ(points[1], Eigen::Vector2d(3, -4.5));
  EXPECT_TRUE(parse_points("").empty()) << "the server says what a zone needs";
  for (const char* bad : {"1", "1,2,3", "1,2 3", "1,a", "nan,1", "1,inf", "1;2"})
    EXPECT_NE(error_of([&] { parse_points(bad); }), "") << bad;
  EXPECT_EQ(parse_pose("1,2"), (Pose{1, 2, 0}));
  EXPECT_NEAR(parse_pose("1,2,90").yaw, 1.5707963, 1e-6) << "degrees";
  for (const char* bad : {"", "1", "1,2,3,4", "1,2,nan", "x,2"})
    EXPECT_NE(error_of([&] { parse_pose(bad); }), "") << bad;
  EXPECT_EQ(parse_annotation_name("Dock 1"), "Dock 1");
  for (const char* bad : {"", " ", " a", "a ", "<b>", "a/b", "a\nb", "\xc3\xa4"})
    EXPECT_NE(error_of([&] { parse_annotation_name(bad); }), "") << bad;
}

/// Decodes what is published on ISTHMUS_COMMAND as the server does, and answers.
struct Server {
  lcm::LCM& lcm;
  std::vector<CommandEvent> orders;
  std::string reason;  ///< why it refuses; empty: it does not

  static void handle(const lcm_recv_buf_t* buffer, const char* channel, void* self) {
    static_cast<Server*>(self)->take(channel,
                                     {static_cast<const std::uint8_t*>(buffer->data), buffer->data_size});
  }

  void take(const std::string& channel, std::span<const std::uint8_t> bytes_of_order) {
    const Decoded decoded = decode(ChannelNames{}, channel, bytes_of_order, 1);
    ASSERT_TRUE(decoded.event) << word(decoded.reason);
    orders.push_back(std::get<CommandEvent>(decoded.event->body));
    answer(orders.back().utime - 1);  // another's
    answer(orders.back().utime);
  }

  void answer(std::int64_t order_utime) {
    answer_t answer{};
    answer.order_utime = order_utime;
    answer.reason = order_utime == orders.back().utime ? reason : "of_another";
    answer.done = answer.reason.empty() ? 1 : 0;
    const auto bytes = encoded(answer);
    lcm.publish("ISTHMUS_ANSWER", bytes.data(), static_cast<unsigned>(bytes.size()));
  }
};

TEST(SendOrder, ReachesTheServerAndHearsItsAnswer) {
  lcm::LCM lcm("memq://");
  Server server{lcm, {}, ""};
  lcm_subscribe(lcm.getUnderlyingLCM(), "ISTHMUS_COMMAND", &Server::handle, &server);
  const OrderOutcome outcome =
      send_order(lcm, CommandEvent{7, Verb::forbid, 3, ""}, std::nullopt, milliseconds(2000));
  ASSERT_TRUE(outcome.answer);
  EXPECT_TRUE(outcome.answer->done);
  ASSERT_EQ(server.orders.size(), 1U);
  EXPECT_EQ(server.orders[0].utime, 7);
  EXPECT_EQ(server.orders[0].verb, Verb::forbid);
  EXPECT_EQ(server.orders[0].closure, 3);
  server.reason = "no_such_closure";
  const OrderOutcome refused =
      send_order(lcm, CommandEvent{9, Verb::forbid, 4, ""}, std::nullopt, milliseconds(2000));
  ASSERT_TRUE(refused.answer);
  EXPECT_FALSE(refused.answer->done);
  EXPECT_EQ(refused.answer->reason, "no_such_closure");
}

void say_something_else(const lcm_recv_buf_t*, const char*, void* lcm) {
  const std::vector<std::uint8_t> other(30, 0);  // neither status_t nor answer_t
  for (const char* channel : {"ISTHMUS_STATUS", "ISTHMUS_ANSWER"})
    static_cast<lcm::LCM*>(lcm)->publish(channel, other.data(), 30);
}

void say_status(const lcm_recv_buf_t*, const char*, void* lcm) {
  const auto bytes = encoded(status_t{});
  static_cast<lcm::LCM*>(lcm)->publish("ISTHMUS_STATUS", bytes.data(), static_cast<unsigned>(bytes.size()));
}

TEST(SendOrder, SaysWhetherAnyServerIsHeard) {
  lcm::LCM lcm("memq://");
  const auto heard = [&] {
    return send_order(lcm, CommandEvent{7, Verb::refine, -1, ""}, std::nullopt, milliseconds(20));
  };
  EXPECT_FALSE(heard().any_server);
  lcm_subscription_t* first =
      lcm_subscribe(lcm.getUnderlyingLCM(), "ISTHMUS_COMMAND", &say_something_else, &lcm);
  EXPECT_FALSE(heard().any_server);
  lcm_unsubscribe(lcm.getUnderlyingLCM(), first);
  lcm_subscribe(lcm.getUnderlyingLCM(), "ISTHMUS_COMMAND", &say_status, &lcm);
  const OrderOutcome outcome = heard();
  EXPECT_TRUE(outcome.any_server);
  EXPECT_FALSE(outcome.answer);
}

TEST(SendOrder, SilenceIsToldWithItsTimeAndWhatItMayMean) {
  EXPECT_EQ(
      silence_text(2.5, true, "udpm://x"),
      "no answer within 2.5 s: a server runs on udpm://x, but has not answered in time: it is busy, or of "
      "an earlier version (--wait gives it longer)");
  EXPECT_EQ(
      silence_text(5, false, "udpm://x"),
      "no answer within 5 s: either no server runs on udpm://x, or it is too busy to answer in that time "
      "(--wait gives it longer)");
}

TEST(SendOrder, NoServerWouldReadAZoneOfTwoCorners) {
  AnnotationEvent zone;
  zone.kind = AnnotationKind::keep_out;
  zone.name = "Stairs";
  zone.island = IslandId{0};
  zone.points = {{PatchId{}, {1, 1}}, {PatchId{}, {2, 1}}};
  EXPECT_EQ(why_unreadable(zone),
            "no such order can be given: bad_polygon: its sides cross or touch, or it has no area");
  zone.points.push_back({PatchId{}, {2, 2}});
  EXPECT_EQ(why_unreadable(zone), "");
}

TEST(OperatorKey, IsReadFromAFileOfOneLine) {
  TemporaryDirectory directory;
  const std::string digits = "ab" + std::string(62, '0');
  const OperatorKey key = read_operator_key(directory.write("key", "alice " + digits + "\n"));
  EXPECT_EQ(key.name, "ALICE");
  EXPECT_EQ(key.key[0], 0xAB);
  const std::string short_file = directory.write("short", "alice ab");
  EXPECT_EQ(error_of([&] { read_operator_key(short_file); }),
            short_file + ": the key must be 64 hexadecimal digits");
  const std::string long_file = directory.write("long", "alice " + digits + " more");
  EXPECT_EQ(error_of([&] { read_operator_key(long_file); }),
            long_file + ": must hold the operator's name and key, and no more");
}

TEST(OperatorKey, IsNotReadFromAFileThatAnybodyMayWrite) {
  TemporaryDirectory directory;
  const std::string file = directory.write("key", "alice ab" + std::string(62, '0') + "\n");
  std::filesystem::permissions(file, std::filesystem::perms{0646});
  EXPECT_EQ(error_of([&] { read_operator_key(file); }),
            file + ": holds keys, and anybody may write it: chmod 600 " + file);
  EXPECT_EQ(error_of([&] { read_operator_key(directory / "."); }),
            directory / "." + ": is a directory; give the file");
}

}  // namespace
}  // namespace isthmus
