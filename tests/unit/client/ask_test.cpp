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

TEST(Ask, GivesUpWhereNobodyAnswers) {
  lcm::LCM lcm("memq://");
  request_t request = question("map_version", "R1", "");
  request.timeout_s = 0.05;
  EXPECT_FALSE(ask(lcm, request));
}

}  // namespace
}  // namespace isthmus
