#include "server/wire/page/orders.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "server/wire/message/message.hpp"
#include "server/wire/trust/envelope.hpp"

namespace isthmus {
namespace {

using std::chrono::milliseconds;

CommandEvent command_of(const std::string& channel, std::span<const std::uint8_t> bytes) {
  const Decoded decoded = decode({}, channel, bytes, 0);
  return std::get<CommandEvent>(decoded.event->body);
}

TEST(Orders, AreReadStrictly) {
  const ParsedOrder withdraw = parse_order(R"({"verb": "withdraw", "closure": 3})");
  ASSERT_TRUE(withdraw.order) << withdraw.error;
  const auto command = [](const char* text) { return std::get<CommandEvent>(*parse_order(text).order); };
  EXPECT_EQ(command(R"({"verb": "withdraw", "closure": 3})").verb, Verb::withdraw);
  EXPECT_EQ(command(R"({"verb": "withdraw", "closure": 3})").closure, 3);
  EXPECT_EQ(command(R"({"verb": "drop", "robot": "r2"})").robot, "R2");
  EXPECT_EQ(command(R"({"verb": "allow", "robot": "R2"})").closure, -1);
  EXPECT_EQ(command(R"({"verb": "allow", "closure": 0})").closure, 0);
  EXPECT_EQ(command(R"({"verb": "refine"})").verb, Verb::refine);
  for (
      const char* text :
      {"", "{", "[]", "3", R"({"verb": "explode"})", R"({"verb": 3})", R"({"verb": "withdraw"})",
       R"({"verb": "withdraw", "closure": -1})", R"({"verb": "withdraw", "closure": 1.5})",
       R"({"verb": "withdraw", "closure": 99999999999})", R"({"verb": "drop", "robot": "a/b"})",
       R"({"verb": "drop", "closure": 3})", R"({"verb": "send_map"})", R"({"verb": "place"})",
       R"({"verb": "keep_out", "name": 3})", R"({"verb": "keep_out", "name": "a", "points": [[1, 2]]})",
       R"({"verb": "keep_out", "name": "a", "points": [[1, 2, "x"]]})", R"({"verb": "initial_pose"})",
       R"({"verb": "initial_pose", "robot": "R1", "pose": [1, 2], "patch": 3, "sigma_m": 1, "sigma_rad": 1})"}) {
    EXPECT_FALSE(parse_order(text).order) << text;
    EXPECT_NE(parse_order(text).error, "") << text;
  }
}

TEST(Orders, SayWhatIsDrawnAndWhereARobotIs) {
  const auto zone = std::get<AnnotationEvent>(
      *parse_order(R"({"verb": "speed", "name": "Ramp", "max_speed": 0.5, "replace": true,
                       "points": [[4, 0, 1], [4, 2, 1.5], [5, 0, -1]]})")
           .order);
  EXPECT_EQ(zone.kind, AnnotationKind::speed);
  EXPECT_EQ(zone.name, "Ramp");
  EXPECT_TRUE(zone.replace);
  EXPECT_EQ(zone.max_speed_m_s, 0.5);
  ASSERT_EQ(zone.points.size(), 3U);
  EXPECT_EQ(zone.points[1].patch, PatchId{4});
  EXPECT_EQ(zone.points[1].position, Eigen::Vector2d(2, 1.5));
  EXPECT_FALSE(zone.island.valid());
  const auto pose = std::get<InitialPoseEvent>(
      *parse_order(R"({"verb": "initial_pose", "robot": "r1", "patch": 3, "pose": [1, 2, 0.5], "sigma_m": 1,
                       "sigma_rad": 0.3})")
           .order);
  EXPECT_EQ(pose.robot, "R1");
  EXPECT_EQ(pose.patch, PatchId{3});
  EXPECT_EQ(pose.pose, (Pose{1, 2, 0.5}));
  EXPECT_EQ(pose.sigma_rad, 0.3);
}

// What the server would refuse as it is read never gets on its way.
TEST(Orders, OneThatCannotBeIsAnsweredAtOnce) {
  Orders orders([](const auto&, auto) { return DropReason::none; }, std::chrono::hours(1));
  AnnotationEvent zone;
  zone.kind = AnnotationKind::keep_out;
  zone.name = "z";
  EXPECT_EQ(orders.send(zone).reason, DropReason::bad_polygon);
  zone.name = "<script>";
  EXPECT_EQ(orders.send(zone).reason, DropReason::bad_name);
}

TEST(Orders, EachIsToldWhatBecameOfIt) {
  Orders* self = nullptr;
  Orders orders([&](const std::string& channel, std::span<const std::uint8_t> bytes) {
    const CommandEvent order = command_of(channel, bytes);
    self->answered(order.utime, order.closure == 3 ? DropReason::none : DropReason::no_such_closure);
    return DropReason::none;
  });
  self = &orders;
  const OrderAnswer done = orders.send(CommandEvent{0, Verb::withdraw, 3, ""});
  EXPECT_TRUE(done.answered);
  EXPECT_EQ(done.reason, DropReason::none);
  const OrderAnswer refused = orders.send(CommandEvent{0, Verb::withdraw, 4, ""});
  EXPECT_TRUE(refused.answered);
  EXPECT_EQ(refused.reason, DropReason::no_such_closure);
}

TEST(Orders, OneThatIsNotTakenIsAnsweredAtOnceAndOneThatWaitsWhenTimeIsOver) {
  Orders refusing([](const auto&, auto) { return DropReason::not_signed; }, std::chrono::hours(1));
  EXPECT_EQ(refusing.send(CommandEvent{0, Verb::refine, -1, ""}).reason, DropReason::not_signed);
  Orders silent([](const auto&, auto) { return DropReason::none; }, milliseconds(5));
  EXPECT_FALSE(silent.send(CommandEvent{0, Verb::refine, -1, ""}).answered);
}

TEST(Orders, NobodyWaitsOnceTheyAreStopped) {
  std::atomic<bool> taken = false;
  Orders orders(
      [&](const auto&, auto) {
        taken = true;
        return DropReason::none;
      },
      std::chrono::hours(1));
  std::jthread operator_thread([&] {
    EXPECT_FALSE(orders.send(CommandEvent{0, Verb::refine, -1, ""}).answered);
  });
  while (!taken) std::this_thread::yield();
  orders.stop();
}

TEST(Orders, AnEnvelopeGoesOnAsItCameAndHoldsAnOrder) {
  const AuthKey key{1, 2, 3};
  const Message order = encode({7, CommandEvent{7, Verb::withdraw, 3, ""}});
  const Message sealed = seal(key, "ALICE", 7, order);
  std::vector<std::uint8_t> sent;
  Orders* self = nullptr;
  Orders orders([&](const std::string& channel, std::span<const std::uint8_t> bytes) {
    EXPECT_EQ(channel, signed_channel);
    sent.assign(bytes.begin(), bytes.end());
    self->answered(7, DropReason::none);
    return DropReason::none;
  });
  self = &orders;
  EXPECT_TRUE(orders.send_signed(sealed.bytes).answered);
  EXPECT_EQ(sent, sealed.bytes);
  sent.clear();
  const Message tag = seal(key, "ALICE", 8, encode({7, TagEvent{7, 3}}));
  EXPECT_NE(orders.send_signed(tag.bytes).reason, DropReason::none);
  EXPECT_NE(orders.send_signed(order.bytes).reason, DropReason::none);
  EXPECT_TRUE(sent.empty());
}

}  // namespace
}  // namespace isthmus
