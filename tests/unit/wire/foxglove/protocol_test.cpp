#include "server/wire/foxglove/protocol.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace isthmus::foxglove {
namespace {

using Json = nlohmann::json;

TEST(FoxgloveProtocol, DataBeginWithTheSubscriptionAndTheTime) {
  const std::string head = data_head(0x01020304, 5);
  EXPECT_EQ(head, std::string("\x01\x04\x03\x02\x01\x88\x13\0\0\0\0\0\0", 13));  // 5000 ns
  EXPECT_EQ(data_head(1, -7).substr(5), std::string(8, '\0'));
}

TEST(FoxgloveProtocol, ChannelsAreAdvertisedWithTheirSchemas) {
  const Json message = Json::parse(advertisement({{7, "/tf", Kind::frame_transforms}}));
  EXPECT_EQ(message.at("op"), "advertise");
  const Json& channel = message.at("channels").at(0);
  EXPECT_EQ(channel.at("id"), 7);
  EXPECT_EQ(channel.at("encoding"), "json");
  EXPECT_EQ(channel.at("schemaName"), "foxglove.FrameTransforms");
  EXPECT_EQ(Json::parse(channel.at("schema").get<std::string>()).at("type"), "object");
  EXPECT_EQ(Json::parse(withdrawal({7})).at("channelIds"), Json::parse("[7]"));
}

TEST(FoxgloveProtocol, SubscriptionsAreRead) {
  const auto request =
      parse_viewer_request(R"({"op": "subscribe", "subscriptions": [{"id": 0, "channelId": 3}]})");
  EXPECT_EQ(request.wrong, "");
  ASSERT_EQ(request.subscribe.size(), 1U);
  EXPECT_EQ(request.subscribe[0].id, 0U);
  EXPECT_EQ(request.subscribe[0].channel, 3U);
  EXPECT_EQ(parse_viewer_request(R"({"op": "unsubscribe", "subscriptionIds": [4]})").unsubscribe.at(0), 4U);
}

TEST(FoxgloveProtocol, WhatIsNoneOfItIsWrong) {
  for (const char* text : {"", "[]", "{", "{}", R"({"op": 3})", R"({"op": "subscribe"})",
                           R"({"op": "subscribe", "subscriptions": [3]})",
                           R"({"op": "subscribe", "subscriptions": [{"id": -1, "channelId": 3}]})",
                           R"({"op": "subscribe", "subscriptions": [{"id": 1, "channelId": 4294967296}]})",
                           R"({"op": "subscribe", "subscriptions": [{"id": 1.5, "channelId": 3}]})",
                           R"({"op": "unsubscribe", "subscriptionIds": ["a"]})"})
    EXPECT_NE(parse_viewer_request(text).wrong, "") << text;
}

TEST(FoxgloveProtocol, WhatThisServerDoesNotDoIsOverlooked) {
  EXPECT_EQ(parse_viewer_request(R"({"op": "getParameters", "parameterNames": []})").wrong, "");
}

}  // namespace
}  // namespace isthmus::foxglove
