#include "server/wire/foxglove/foxglove_server.hpp"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <nlohmann/json.hpp>
#include <optional>

#include "tests/support/waiting.hpp"
#include "tests/unit/wire/page/page_maps.hpp"

namespace isthmus {
namespace {

using std::chrono::milliseconds;
using Json = nlohmann::json;

/// A client of WebSockets (RFC 6455) by bytes: no library but that of sockets.
class WebSocketClient {
 public:
  struct Frame {
    int opcode = 0;  ///< 1 text, 2 binary, 8 closed, 9 ping
    std::string bytes;
  };

  explicit WebSocketClient(int port, int receive_buffer = 0) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    if (receive_buffer > 0)
      ::setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &receive_buffer, sizeof receive_buffer);
    const timeval limit{20, 0};
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    connected_ = ::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  }
  ~WebSocketClient() { ::close(socket_); }
  WebSocketClient(const WebSocketClient&) = delete;
  WebSocketClient& operator=(const WebSocketClient&) = delete;

  /// The answer's head; empty where there is none.
  std::string shake(const std::string& target = "/", const std::string& more = "") {
    send("GET " + target + " HTTP/1.1\r\nHost: 127.0.0.1\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n" +
         "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n" +
         "Sec-WebSocket-Protocol: foxglove.websocket.v1\r\n" + more + "\r\n");
    std::string head;
    while (!head.ends_with("\r\n\r\n")) {
      const std::string one = receive(1);
      if (one.empty()) return "";
      head += one;
    }
    return head;
  }

  void send(const std::string& bytes) const { ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL); }

  /// A text of less than 64 KiB, under a mask of zeros.
  void say(const std::string& text) const {
    std::string frame = "\x81";
    if (text.size() < 126) {
      frame += static_cast<char>(0x80 | text.size());
    } else {
      frame += static_cast<char>(0x80 | 126);
      frame += static_cast<char>(text.size() >> 8);
      frame += static_cast<char>(text.size() & 0xFF);
    }
    send(frame + std::string(4, '\0') + text);
  }

  /// The next message whole; nothing where the connection is at its end.
  std::optional<Frame> hear() {
    Frame whole;
    while (true) {
      const std::string head = receive(2);
      if (head.size() < 2) return std::nullopt;
      const int opcode = head[0] & 0x0F;
      if (opcode != 0) whole.opcode = opcode;
      whole.bytes += receive(length_of(head[1] & 0x7F));
      if ((head[0] & 0x80) != 0) return whole;
    }
  }

  /// Messages until one of the op comes.
  Json hear_op(const std::string& op) {
    while (const auto frame = hear()) {
      if (frame->opcode != 1) continue;
      Json told = Json::parse(frame->bytes);
      if (told.at("op") == op) return told;
    }
    return {};
  }

  bool is_connected() const { return connected_; }

 private:
  std::size_t length_of(int first) {
    if (first < 126) return static_cast<std::size_t>(first);
    std::size_t length = 0;
    for (const char byte : receive(first == 126 ? 2 : 8))
      length = length << 8 | static_cast<unsigned char>(byte);
    return length;
  }

  /// So many bytes; fewer at the end.
  std::string receive(std::size_t size) const {
    std::string bytes(size, '\0');
    std::size_t got = 0;
    while (got < size) {
      const ssize_t more = ::recv(socket_, bytes.data() + got, size - got, 0);
      if (more <= 0) break;
      got += static_cast<std::size_t>(more);
    }
    bytes.resize(got);
    return bytes;
  }

  int socket_;
  bool connected_ = false;
};

constexpr const char* switching = "HTTP/1.1 101";

RobotEvent robot_r1() {
  RobotEvent one;
  one.robot = "R1";
  one.laser.range_max_m = 30;
  return one;
}

Event scan_of(std::size_t beams, std::int64_t utime) {
  return {utime, ScanEvent{"R1", {utime, 0, 0.001, std::vector<float>(beams, 1.5F)}}};
}

/// The channels that a viewer is told of, until the topic is among them.
std::uint32_t channel_of(WebSocketClient& client, const std::string& topic) {
  while (true) {
    const Json told = client.hear_op("advertise");
    if (told.is_null()) throw std::runtime_error("no channel " + topic);
    for (const Json& channel : told.at("channels"))
      if (channel.at("topic") == topic) return channel.at("id");
  }
}

void subscribe(const WebSocketClient& client, std::uint32_t id, std::uint32_t channel) {
  const Json one = {{"id", id}, {"channelId", channel}};
  client.say(Json{{"op", "subscribe"}, {"subscriptions", {one}}}.dump());
}

TEST(FoxgloveServer, AViewerIsSentWhatItSubscribesTo) {
  FoxgloveServer server({});
  WebSocketClient client(server.port());
  const std::string head = client.shake();
  ASSERT_TRUE(head.starts_with(switching)) << head;
  EXPECT_NE(head.find("foxglove.websocket.v1"), std::string::npos);
  EXPECT_NE(head.find("s3pPLMBiTxaQ9kYGzzhZRbK+xOo="), std::string::npos);  // RFC 6455, section 1.3
  EXPECT_EQ(client.hear_op("serverInfo").at("name"), "isthmus");
  const auto map = std::make_shared<const MapCopy>(testing::map_of_islands({{{0, 0, 0}}}));
  server.show(map, {});
  subscribe(client, 3, channel_of(client, "/island-0/grid"));
  std::optional<WebSocketClient::Frame> data;
  for (int i = 0; i < 100 && !data; ++i) {
    server.show(map, {});
    client.say(R"({"op": "unknown"})");
    client.say("{");  // is answered by a status: what is heard comes to an end
    const auto frame = client.hear();
    ASSERT_TRUE(frame);
    if (frame->opcode == 2) data = frame;
  }
  ASSERT_TRUE(data);
  EXPECT_EQ(data->bytes.substr(0, 5), std::string("\x01\x03\0\0\0", 5));
  EXPECT_EQ(Json::parse(data->bytes.substr(13)).at("frame_id"), "island-0");
}

TEST(FoxgloveServer, StrangersAreTurnedAway) {
  FoxgloveOptions options;
  options.token = "0123456789abcdef";
  FoxgloveServer server(options);
  EXPECT_TRUE(WebSocketClient(server.port()).shake().starts_with("HTTP/1.1 401"));
  EXPECT_TRUE(WebSocketClient(server.port()).shake("/?token=0123456789abcdef").starts_with(switching));
  FoxgloveServer open({});
  EXPECT_TRUE(WebSocketClient(open.port())
                  .shake("/", "Origin: https://evil.example\r\n")
                  .starts_with("HTTP/1.1 403"));
  options.token = "";
  options.address = "0.0.0.0";
  EXPECT_THROW(FoxgloveServer{options}, std::runtime_error);
  options.address = "127.0.0.1";
  options.port = open.port();
  EXPECT_THROW(FoxgloveServer{options}, std::runtime_error);  // another has it
}

TEST(FoxgloveServer, ThereAreNoMoreViewersThanThereMayBe) {
  FoxgloveOptions options;
  options.viewers = 1;
  FoxgloveServer server(options);
  {
    WebSocketClient first(server.port());
    ASSERT_TRUE(first.shake().starts_with(switching));
    EXPECT_TRUE(WebSocketClient(server.port()).shake().starts_with("HTTP/1.1 503"));
  }
  EXPECT_TRUE(happens([&] { return WebSocketClient(server.port()).shake().starts_with(switching); }));
}

TEST(FoxgloveServer, ConnectionsThatSayNothingOrNonsenseEnd) {
  FoxgloveOptions options;
  options.handshake_time = milliseconds(100);
  options.connections = 2;
  FoxgloveServer server(options);
  WebSocketClient silent(server.port()), silent_too(server.port()), nonsense(server.port());
  nonsense.send("\x16\x03\x01 no HTTP\r\n\r\n");
  WebSocketClient good(server.port());  // waits until they are gone
  EXPECT_TRUE(good.shake().starts_with(switching));
  good.say(std::string(65'000, 'x') + "\n");
  EXPECT_EQ(good.hear_op("status").at("level"), 1);
}

/// It reads nothing of scans of 16 kB, however much it says itself; another viewer, and who gives the scans,
/// notice nothing, and it is dropped.
TEST(FoxgloveServer, ASlowViewerHoldsUpNobodyAndIsDropped) {
  FoxgloveOptions options;
  options.message_time = milliseconds(2000);
  options.viewers = 2;
  FoxgloveServer server(options);
  server.show(Event{0, robot_r1()});
  WebSocketClient slow(server.port(), 4096), good(server.port());
  ASSERT_TRUE(slow.shake().starts_with(switching));
  subscribe(slow, 1, channel_of(slow, "/R1/scan"));
  ASSERT_TRUE(good.shake().starts_with(switching));
  subscribe(good, 1, channel_of(good, "/R1/scan"));
  std::int64_t utime = 0;
  int heard = 0;
  bool seat_is_free = false;
  const auto give = [&] {
    const auto start = std::chrono::steady_clock::now();
    for (int i = 0; i < 20; ++i) server.show(scan_of(4'000, ++utime));
    EXPECT_LT(std::chrono::steady_clock::now() - start, milliseconds(1000));
    slow.say(R"({"op": "unknown"})");
    good.say("{");
    while (const auto frame = good.hear()) {  // to the answer of what it said
      heard += frame->opcode == 2 ? 1 : 0;
      if (frame->opcode == 1) break;
    }
  };
  EXPECT_TRUE(happens(
      [&] {
        give();
        seat_is_free = WebSocketClient(server.port()).shake().starts_with(switching);
        return seat_is_free;
      },
      std::chrono::seconds(120)));
  EXPECT_GE(heard, 20);
}

}  // namespace
}  // namespace isthmus
