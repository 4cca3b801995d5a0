#include "server/client/ask.hpp"

#include <gtest/gtest.h>

#include <lcm/lcm-cpp.hpp>

#include "server/wire/message/channel.hpp"
#include "server/wire/message/encoded.hpp"
#include "server/wire/questions/answerer.hpp"

namespace isthmus {
namespace {

/// Answers what it hears with so many poses, after a reply to somebody else.
struct Server {
  lcm::LCM& lcm;
  std::int32_t poses = 2;

  static void handle(const lcm_recv_buf_t* buffer, const char*, void* self) {
    const auto request = read_request({static_cast<const std::uint8_t*>(buffer->data), buffer->data_size});
    ASSERT_TRUE(request && read_question(*request).question);
    static_cast<Server*>(self)->reply(*request);
  }
  void publish(const reply_t& reply) {
    const auto bytes = encoded(reply);
    lcm.publish(reply_channel, bytes.data(), static_cast<unsigned>(bytes.size()));
  }
  void reply(const request_t& request) {
    reply_t reply = reply_to(request);
    reply.request_id += 1;
    publish(reply);
    reply.request_id -= 1;
    reply.nposes = poses;
    reply.poses.resize(static_cast<std::size_t>(poses));
    reply.frontiers.resize(1);
    reply.nfrontiers = 1;
    publish(reply);
  }
};

TEST(Ask, HearsTheReplyToItsOwnQuestion) {
  lcm::LCM lcm("memq://");
  Server server{lcm};
  lcm_subscribe(lcm.getUnderlyingLCM(), request_channel, Server::handle, &server);
  const auto reply = ask(lcm, question("frontiers", "R1", "R1"));
  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->nposes, 2);
  EXPECT_EQ(reply->nfrontiers, 1);
}

/// Tells of a path until it is asked again without `follow_s`.
struct FollowingServer {
  lcm::LCM& lcm;
  std::vector<request_t> asked;

  static void handle(const lcm_recv_buf_t* buffer, const char*, void* self) {
    const auto request = read_request({static_cast<const std::uint8_t*>(buffer->data), buffer->data_size});
    ASSERT_TRUE(request && read_question(*request).question);
    static_cast<FollowingServer*>(self)->tell(*request);
  }
  void tell(const request_t& request) {
    asked.push_back(request);
    if (request.follow_s == 0) return;
    reply_t reply = reply_to(request);
    for (const char* change : {"", "moved", "arrived"}) {
      reply.change = change;
      reply.followed = reply.change != "arrived" ? 1 : 0;
      const auto bytes = encoded(reply);
      lcm.publish(reply_channel, bytes.data(), static_cast<unsigned>(bytes.size()));
      ++reply.update;
    }
  }
};

class Follow : public ::testing::Test {
 protected:
  Follow() { lcm_subscribe(lcm_.getUnderlyingLCM(), request_channel, FollowingServer::handle, &server_); }

  /// The changes that are told before one is enough.
  std::vector<std::string> changes(std::size_t enough) {
    request_t request = question("path", "R1", "R1");
    request.target = "home";
    request.follow_s = 10;
    std::vector<std::string> told;
    EXPECT_TRUE(follow(lcm_, request, [&](const reply_t& reply) {
      told.push_back(reply.change);
      return told.size() < enough;
    }));
    while (lcm_.handleTimeout(0) > 0) {
    }
    return told;
  }

  lcm::LCM lcm_{"memq://"};
  FollowingServer server_{lcm_, {}};
};

TEST_F(Follow, TellsEachUpdateInOrderAndEndsWithTheLast) {
  EXPECT_EQ(changes(9), (std::vector<std::string>{"", "moved", "arrived"}));
  EXPECT_EQ(server_.asked.size(), 1U);
}

TEST_F(Follow, WhoHasEnoughAsksNotToBeToldAnyMore) {
  EXPECT_EQ(changes(1).size(), 1U);
  ASSERT_EQ(server_.asked.size(), 2U);
  EXPECT_EQ(server_.asked[1].id, server_.asked[0].id);
  EXPECT_EQ(server_.asked[1].follow_s, 0);
}

TEST(Ask, AFollowerGivesUpWhereNobodyAnswers) {
  lcm::LCM lcm("memq://");
  request_t request = question("path", "R1", "R1");
  request.timeout_s = 0.05;
  request.follow_s = 60;
  EXPECT_FALSE(follow(lcm, request, [](const reply_t&) { return true; }));
}

TEST(Ask, GivesUpWhereNobodyAnswers) {
  lcm::LCM lcm("memq://");
  request_t request = question("map_version", "R1", "");
  request.timeout_s = 0.05;
  EXPECT_FALSE(ask(lcm, request));
}

}  // namespace
}  // namespace isthmus
