#include <gtest/gtest.h>

#include <lcm/lcm-cpp.hpp>

#include "isthmus/status_t.hpp"
#include "server/wire/message/encoded.hpp"
#include "server/wire/message/message.hpp"
#include "tests/support/temporary_directory.hpp"
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
  EXPECT_EQ(to_text({0, Verb::forbid, 3, ""}), "forbid closure 3");
  EXPECT_EQ(to_text({0, Verb::drop, -1, "R1"}), "drop robot R1");
  EXPECT_EQ(to_text({0, Verb::send_map, -1, ""}), "send_map");
}

/// Decodes what is published on ISTHMUS_COMMAND as the server does, and answers with a status.
struct Server {
  lcm::LCM& lcm;
  std::vector<CommandEvent> orders;

  static void handle(const lcm_recv_buf_t* buffer, const char* channel, void* self) {
    static_cast<Server*>(self)->take(channel,
                                     {static_cast<const std::uint8_t*>(buffer->data), buffer->data_size});
  }

  void take(const std::string& channel, std::span<const std::uint8_t> bytes_of_order) {
    const Decoded decoded = decode(ChannelNames{}, channel, bytes_of_order, 1);
    ASSERT_TRUE(decoded.event) << word(decoded.reason);
    orders.push_back(std::get<CommandEvent>(decoded.event->body));
    const auto bytes = encoded(status_t{});
    lcm.publish("ISTHMUS_STATUS", bytes.data(), static_cast<unsigned>(bytes.size()));
  }
};

TEST(SendOrder, ReachesTheServerAndHearsItsStatus) {
  lcm::LCM lcm("memq://");
  Server server{lcm, {}};
  lcm_subscribe(lcm.getUnderlyingLCM(), "ISTHMUS_COMMAND", &Server::handle, &server);
  EXPECT_TRUE(send_order(lcm, {7, Verb::forbid, 3, ""}, std::nullopt, milliseconds(2000)));
  ASSERT_EQ(server.orders.size(), 1U);
  EXPECT_EQ(server.orders[0].utime, 7);
  EXPECT_EQ(server.orders[0].verb, Verb::forbid);
  EXPECT_EQ(server.orders[0].closure, 3);
}

TEST(SendOrder, SaysWhereNoServerIsHeard) {
  lcm::LCM lcm("memq://");
  EXPECT_FALSE(send_order(lcm, {7, Verb::refine, -1, ""}, std::nullopt, milliseconds(20)));
  const std::vector<std::uint8_t> other(30, 0);  // not a status_t
  lcm.publish("ISTHMUS_STATUS", other.data(), 30);
  EXPECT_FALSE(send_order(lcm, {7, Verb::refine, -1, ""}, std::nullopt, milliseconds(20)));
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
