#include "server/wire/network/udp_receiver.hpp"

#include <gtest/gtest.h>

#include <lcm/lcm-cpp.hpp>
#include <map>
#include <memory>
#include <random>

#include "tests/support/lcm_datagrams.hpp"
#include "tests/support/temporary_directory.hpp"

namespace isthmus {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

TEST(UdpUrl, IsReadAsLiblcmReadsIt) {
  EXPECT_EQ(parse_udp_url("udpm://").group, "239.255.76.67");
  EXPECT_EQ(parse_udp_url("udpm://").port, 7667);
  EXPECT_EQ(parse_udp_url("udpm://?ttl=1&recv_buf_size=0x1000").receive_buffer_bytes, 4096);
  EXPECT_EQ(parse_udp_url("udpm://239.1.2.3").group, "239.1.2.3");
  EXPECT_EQ(parse_udp_url("udpm://239.1.2.3?ttl=0").port, 7667);
  for (const char* url : {"udpm://239.1.2.3:7700", "udpm://239.1.2.3:0x1e14", "udpm://239.1.2.3: 7700x",
                          "udpm://239.1.2.3:7700/?ttl=0", "udpm://239.1.2.3:7700?recv_buf_size=x&ttl"}) {
    const UdpAddress address = parse_udp_url(url);
    EXPECT_EQ(address.group, "239.1.2.3") << url;
    EXPECT_EQ(address.port, 7700) << url;
    EXPECT_EQ(address.receive_buffer_bytes, 0) << url;
  }
}

TEST(UdpUrl, IsRefusedWithTheReason) {
  EXPECT_EQ(error_of([] { parse_udp_url("udpm://not-an-address"); }), "'not-an-address' is no IPv4 address");
  EXPECT_EQ(error_of([] { parse_udp_url("udpm://:7700"); }), "'' is no IPv4 address");
  for (const std::string port : {"", "x", "-1", "65536"})
    EXPECT_EQ(error_of([&] { parse_udp_url("udpm://239.1.2.3:" + port); }), "'" + port + "' is no port");
  const std::string error = error_of([] { UdpReceiver receiver(parse_udp_url("udpm://127.0.0.1:7700")); });
  EXPECT_TRUE(error.starts_with("cannot join the multicast group: ")) << error;
}

using HeardChannels = std::map<std::string, std::vector<Bytes>>;  ///< by channel, in order

/// All channels of the test's network by our own receiver, until a message on `last` comes.
class OwnEars {
 public:
  OwnEars() : receiver_(parse_udp_url(test_udp_url())) {}

  const HeardChannels& hear_until(const std::string& last) {
    const auto deadline = Clock::now() + 20s;
    while (!heard_.contains(last) && Clock::now() < deadline)
      EXPECT_EQ(receiver_.receive(100ms, messages_), 0);
    return heard_;
  }
  std::int64_t last_utime() const { return last_utime_; }

 private:
  HeardChannels heard_;
  std::int64_t last_utime_ = 0;
  Reassembly messages_{{[](std::string_view) { return true; },
                        [this](std::int64_t utime, std::string_view channel, auto bytes) {
                          heard_[std::string(channel)].emplace_back(bytes.begin(), bytes.end());
                          last_utime_ = utime;
                        },
                        [](std::string_view, DropReason) {}}};
  UdpReceiver receiver_;
};

/// The same by liblcm, through its C functions: UBSAN's vptr check misreads its C++ subscriptions.
class LiblcmEars {
 public:
  LiblcmEars() : lcm_(lcm_create(test_udp_url().c_str()), &lcm_destroy) {
    if (lcm_) lcm_subscription_set_queue_capacity(lcm_subscribe(lcm_.get(), ".*", &take, this), 100'000);
  }
  bool good() const { return lcm_ != nullptr; }
  const HeardChannels& hear_until(const std::string& last) {
    const auto deadline = Clock::now() + 20s;
    while (!heard_.contains(last) && Clock::now() < deadline) lcm_handle_timeout(lcm_.get(), 100);
    return heard_;
  }

 private:
  static void take(const lcm_recv_buf_t* buffer, const char* channel, void* ears) {
    const auto* bytes = static_cast<const std::uint8_t*>(buffer->data);
    static_cast<LiblcmEars*>(ears)->heard_[channel].emplace_back(bytes, bytes + buffer->data_size);
  }

  std::unique_ptr<lcm_t, decltype(&lcm_destroy)> lcm_;
  HeardChannels heard_;
};

std::int64_t wall_utime() {
  return std::chrono::duration_cast<std::chrono::microseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

TEST(UdpReceiver, HearsWhatLiblcmPublishes) {
  lcm::LCM sender(test_udp_url());
  if (!sender.good()) GTEST_SKIP() << "no multicast route on this machine";
  OwnEars ears;
  const std::int64_t begin = wall_utime();
  HeardChannels expected;
  for (const std::size_t size : {0U, 1U, 60'000U, 65'500U, 70'000U, 1'000'000U}) {
    expected["R1_SCAN"].push_back(Bytes(size, static_cast<std::uint8_t>(size / 7)));
    sender.publish("R1_SCAN", expected["R1_SCAN"].back().data(), static_cast<unsigned>(size));
  }
  expected["LAST"].push_back({1});
  sender.publish("LAST", expected["LAST"].back().data(), 1);
  EXPECT_EQ(ears.hear_until("LAST"), expected);
  EXPECT_GE(ears.last_utime(), begin);
  EXPECT_LE(ears.last_utime(), wall_utime());
}

/// Ten messages of each of three senders, short and fragmented. The network loses some datagrams and changes
/// the order of others: of messages of different senders, and of the fragments behind a message's first.
/// (Ours takes a first fragment that is late, and one that comes twice; liblcm does not.)
std::vector<std::pair<std::size_t, Bytes>> disturbed_traffic(std::uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<std::vector<Bytes>> by_sender(3);
  for (std::uint32_t i = 0; i < 30; ++i) {
    const std::size_t sender = i % 3;
    const std::string channel = "R" + std::to_string(sender) + (random() % 2 == 0 ? "_SCAN" : "_ODOMETRY");
    Bytes bytes(random() % 5 == 0 ? random() % 200'000 : random() % 3000);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
    const std::size_t fragment_bytes = random() % 2 == 0 ? 1400 : 60'000;
    std::vector<Bytes> datagrams = {short_datagram(i, channel, bytes)};
    if (bytes.size() > fragment_bytes) datagrams = fragment_datagrams(i, channel, bytes, fragment_bytes);
    std::shuffle(datagrams.begin() + 1, datagrams.end(), random);
    std::erase_if(datagrams, [&](const Bytes&) { return random() % 60 == 0; });
    by_sender[sender].insert(by_sender[sender].end(), datagrams.begin(), datagrams.end());
  }
  std::vector<std::pair<std::size_t, Bytes>> traffic;
  std::array<std::size_t, 3> next{};
  while (true) {
    std::vector<std::size_t> left;
    for (std::size_t sender = 0; sender < 3; ++sender)
      if (next[sender] < by_sender[sender].size()) left.push_back(sender);
    if (left.empty()) return traffic;
    const std::size_t sender = left[random() % left.size()];
    traffic.emplace_back(sender, by_sender[sender][next[sender]++]);
  }
}

TEST(UdpReceiver, HearsTheSameAsLiblcmWithLossAndReordering) {
  LiblcmEars theirs;
  if (!theirs.good()) GTEST_SKIP() << "no multicast route on this machine";
  OwnEars ours;
  const std::array<DatagramSender, 3> senders;
  std::size_t messages = 0, datagrams = 0;
  for (std::uint32_t seed = 1; seed <= 40; ++seed) {
    for (const auto& [sender, datagram] : disturbed_traffic(seed)) {
      ASSERT_TRUE(senders[sender].send(datagram));
      ++datagrams;
    }
    const std::string last = "LAST" + std::to_string(seed);
    ASSERT_TRUE(senders[0].send(short_datagram(1000 * seed, last, Bytes{1})));
    const HeardChannels& expected = theirs.hear_until(last);
    ASSERT_TRUE(expected.contains(last)) << "the network lost what no loss was made for";
    ASSERT_EQ(ours.hear_until(last), expected) << "seed " << seed;
    messages = 0;
    for (const auto& [channel, heard] : expected) messages += heard.size();
  }
  EXPECT_GT(messages, 800U);
  EXPECT_LT(messages, 40U * 31U) << "some were lost";
  RecordProperty("messages", static_cast<int>(messages));
  RecordProperty("datagrams", static_cast<int>(datagrams));
}

}  // namespace
}  // namespace isthmus
