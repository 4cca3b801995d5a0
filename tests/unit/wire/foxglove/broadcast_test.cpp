#include "server/wire/foxglove/broadcast.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace isthmus::foxglove {
namespace {

using Json = nlohmann::json;
using Keep = Broadcast::Keep;

Text message(const std::string& text) { return std::make_shared<const std::string>(text); }

/// All that waits, the data as their text.
std::vector<std::string> taken(Outbox& outbox) {
  std::vector<std::string> all;
  while (const auto item = outbox.next()) all.push_back(*item->body);
  return all;
}

TEST(FoxgloveOutbox, OnlyTheNewestWaitsWhereItAloneCounts) {
  Outbox outbox({});
  outbox.add_newest(1, "", message("old"));
  outbox.add_newest(2, "", message("other"));
  outbox.add_newest(1, "", message("new"));
  EXPECT_EQ(taken(outbox), (std::vector<std::string>{"new", "other"}));
  EXPECT_EQ(outbox.left_out(), 1);
}

TEST(FoxgloveOutbox, TheOldestOfAStreamGoes) {
  Outbox outbox({.stream_messages = 2});
  outbox.add_to_stream(9, "", message("of another"));
  for (const char* text : {"a", "b", "c"}) outbox.add_to_stream(1, "", message(text));
  EXPECT_EQ(taken(outbox), (std::vector<std::string>{"of another", "b", "c"}));
}

TEST(FoxgloveOutbox, HoldsNoMoreThanItMay) {
  Outbox outbox({.stream_messages = 100, .data_bytes = 10, .control_bytes = 10});
  for (std::uint32_t channel = 0; channel < 5; ++channel) outbox.add_newest(channel, "", message("1234"));
  EXPECT_EQ(outbox.left_out(), 3);
  EXPECT_TRUE(outbox.add_control("12345678"));
  EXPECT_FALSE(outbox.add_control("123"));
  EXPECT_EQ(taken(outbox).size(), 4U);
  outbox.add_to_stream(1, "", message("1234567890"));  // what was taken counts no more
  EXPECT_EQ(taken(outbox).size(), 1U);
}

/// A viewer, and what it was told.
class FoxgloveBroadcast : public ::testing::Test {
 protected:
  FoxgloveBroadcast() {
    broadcast_.open("/tf", Kind::frame_transforms, Keep::all);
    broadcast_.open("/scene", Kind::scene_update, Keep::newest);
    viewer_ = &broadcast_.join([this] { ++wakes_; });
    for (const std::string& text : taken(viewer_->outbox())) hear(text);
  }

  void hear(const std::string& text) {
    const Json told = Json::parse(text);
    if (told.at("op") != "advertise") return;
    for (const Json& channel : told.at("channels")) ids_[channel.at("topic")] = channel.at("id");
  }
  void subscribe(const std::string& topic, int id) {
    const Json one = {{"id", id}, {"channelId", ids_.at(topic)}};
    broadcast_.hear(*viewer_, Json{{"op", "subscribe"}, {"subscriptions", {one}}}.dump());
  }
  std::vector<std::string> told() { return taken(viewer_->outbox()); }

  Broadcast broadcast_{"now", {}};
  Viewer* viewer_ = nullptr;
  std::map<std::string, int> ids_;
  int wakes_ = 0;
};

TEST_F(FoxgloveBroadcast, WhoHasSubscribedIsSentMessages) {
  broadcast_.send("/tf", 1, "unheard");
  subscribe("/tf", 5);
  EXPECT_TRUE(broadcast_.is_heard("/tf"));
  EXPECT_FALSE(broadcast_.is_heard("/scene"));
  const int before = wakes_;
  broadcast_.send("/tf", 2, "heard");
  EXPECT_GT(wakes_, before);
  const auto item = viewer_->outbox().next();
  ASSERT_TRUE(item);
  EXPECT_TRUE(item->is_data);
  EXPECT_EQ(item->head, data_head(5, 2));
  EXPECT_EQ(*item->body, "heard");
  EXPECT_TRUE(told().empty());
}

TEST_F(FoxgloveBroadcast, WhoComesLateIsSentTheNewest) {
  broadcast_.send("/scene", 1, "old");
  broadcast_.send("/scene", 2, "new");
  subscribe("/scene", 1);
  EXPECT_EQ(told(), std::vector<std::string>{"new"});
}

TEST_F(FoxgloveBroadcast, WhoLeavesOrEndsASubscriptionIsNoListener) {
  subscribe("/tf", 1);
  broadcast_.send("/tf", 1, "waits");
  broadcast_.hear(*viewer_, R"({"op": "unsubscribe", "subscriptionIds": [1]})");
  EXPECT_FALSE(broadcast_.is_heard("/tf"));
  EXPECT_TRUE(told().empty());
  subscribe("/tf", 1);
  EXPECT_TRUE(broadcast_.is_heard("/tf"));
  broadcast_.leave(*viewer_);
  EXPECT_FALSE(broadcast_.is_heard("/tf"));
  EXPECT_EQ(broadcast_.viewers(), 0U);
}

TEST_F(FoxgloveBroadcast, ChannelsThatCloseAreWithdrawnAndTheirIdsNotUsedAgain) {
  subscribe("/scene", 1);
  broadcast_.send("/scene", 1, "waits");
  broadcast_.close("/scene");
  const auto withdrawn = told();
  ASSERT_EQ(withdrawn.size(), 1U);
  EXPECT_EQ(Json::parse(withdrawn[0]).at("channelIds").at(0), ids_.at("/scene"));
  broadcast_.open("/scene", Kind::scene_update, Keep::newest);
  const int before = ids_.at("/scene");
  for (const std::string& text : told()) hear(text);
  EXPECT_NE(ids_.at("/scene"), before);
  subscribe("/scene", 1);
  EXPECT_TRUE(told().empty());  // no complaint, and nothing of the old channel
}

TEST_F(FoxgloveBroadcast, WhoAsksForAChannelThatHasJustClosedIsToldNothingMore) {
  broadcast_.close("/scene");
  told();
  subscribe("/scene", 1);
  EXPECT_TRUE(told().empty());
  EXPECT_FALSE(broadcast_.is_heard("/scene"));
}

TEST_F(FoxgloveBroadcast, WrongSubscriptionsAreComplainedOf) {
  subscribe("/tf", 1);
  subscribe("/tf", 2);     // the channel has one
  subscribe("/scene", 1);  // the id has one
  broadcast_.hear(*viewer_, R"({"op": "subscribe", "subscriptions": [{"id": 3, "channelId": 999}]})");
  broadcast_.hear(*viewer_, R"({"op": "unsubscribe", "subscriptionIds": [77]})");
  const auto all = told();
  EXPECT_EQ(all.size(), 4U);
  for (const std::string& text : all) EXPECT_EQ(Json::parse(text).at("op"), "status");
}

TEST_F(FoxgloveBroadcast, AViewerThatComplaintsPileUpForIsLost) {
  for (int i = 0; i < 200'000 && !viewer_->is_lost(); ++i) broadcast_.hear(*viewer_, "nonsense");
  EXPECT_TRUE(viewer_->is_lost());
}

}  // namespace
}  // namespace isthmus::foxglove
