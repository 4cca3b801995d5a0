#include "server/wire/questions/question_desk.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "server/wire/intake/reception.hpp"
#include "server/wire/live/live_server.hpp"
#include "server/wire/message/encoded.hpp"
#include "server/wire/trust/envelope.hpp"
#include "tests/support/box_room.hpp"
#include "tests/support/ground_scenes.hpp"
#include "tests/support/published.hpp"
#include "tests/support/questions.hpp"
#include "tests/support/waiting.hpp"

namespace isthmus {
namespace {

using testing::question_of;

class QuestionDeskTest : public ::testing::Test {
 protected:
  void offer_map() {
    Map map;
    testing::add_round_way(map, testing::furnished_room(), {{-1, 0, 0}, {1, 0, 0}});
    desk_->offer(testing::shared_copy(map), 1000);
  }
  void ask(const request_t& request) { desk_->take(encoded(request), ""); }
  std::vector<reply_t> replies() { return published_.of<reply_t>("ISTHMUS_REPLY"); }
  std::int64_t count(const std::string& outcome) {
    const auto counts = desk_->counts();
    const auto found = counts.find(outcome);
    return found == counts.end() ? 0 : found->second;
  }

  Published published_;
  std::shared_ptr<QuestionDesk> desk_ = std::make_shared<QuestionDesk>(published_.sink());
};

TEST_F(QuestionDeskTest, AnswersOnceThereIsAMapAndSaysWhoseQuestionItWas) {
  request_t request = question_of("map_version", "R1");
  request.id = 42;
  ask(request);
  offer_map();
  ASSERT_TRUE(happens([&] { return !replies().empty(); }));
  const reply_t reply = replies().front();
  EXPECT_TRUE(reply.done);
  EXPECT_EQ(reply.request_id, 42);
  EXPECT_EQ(reply.request_utime, 5);
  EXPECT_EQ(reply.asker, "R1");
  EXPECT_EQ(reply.map_version, 1000);
  EXPECT_EQ(count("answered"), 1);
}

TEST_F(QuestionDeskTest, BadQuestionsAreRefusedWithTheReasonAndCounted) {
  const auto bad = [this](const std::string& reason, const auto& spoil) {
    request_t request = question_of("path", "R1");
    request.target = "patch";
    spoil(request);
    ask(request);
    EXPECT_EQ(replies().back().reason, reason);
    EXPECT_GE(count(reason), 1);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  bad("bad_kind", [](request_t& r) { r.kind = "where"; });
  bad("bad_kind", [](request_t& r) { r.target = "moon"; });
  bad("bad_name", [](request_t& r) { r.asker = ""; });
  bad("bad_name", [](request_t& r) { r.robot = "../R1"; });
  bad("bad_value", [](request_t& r) { r.timeout_s = 0; });
  bad("bad_value", [](request_t& r) { r.timeout_s = 61; });
  bad("bad_value", [nan](request_t& r) { r.timeout_s = nan; });
  bad("bad_value", [nan](request_t& r) { r.radius_m = nan; });
  bad("bad_value", [nan](request_t& r) { r.patch_from_target[2] = nan; });
  bad("bad_value", [nan](request_t& r) { r.patch_from_start[0] = nan; });
  bad("bad_value", [](request_t& r) { r.since = -1; });
}

TEST_F(QuestionDeskTest, WhatIsNoQuestionIsCountedAndNotAnswered) {
  std::vector<std::uint8_t> bytes = encoded(question_of("path", "R1"));
  bytes.pop_back();
  desk_->take(bytes, "");
  desk_->take({}, "");
  EXPECT_EQ(count("bad_bytes"), 2);
  EXPECT_TRUE(replies().empty());
}

TEST_F(QuestionDeskTest, AFloodOfOneAskerLeavesRoomForAnother) {
  const QuestionLimits limits;
  for (std::size_t i = 0; i < 3 * limits.waiting; ++i) ask(question_of("map_version", "R1"));
  ask(question_of("map_version", "R2"));
  const auto refused = static_cast<std::int64_t>(3 * limits.waiting - limits.waiting_of_asker);
  EXPECT_EQ(count("queue_full"), refused);
  EXPECT_LE(replies().size(), 2 * limits.refusals_per_s) << "a flood is not answered by a flood";
  offer_map();
  const auto answered = static_cast<std::int64_t>(limits.waiting_of_asker + 1);
  EXPECT_TRUE(happens([&] { return count("answered") == answered; }));
}

TEST_F(QuestionDeskTest, AFloodOfManyNamesIsBounded) {
  const QuestionLimits limits;
  for (std::size_t i = 0; i < limits.waiting + 10; ++i)
    ask(question_of("map_version", "R" + std::to_string(i)));
  EXPECT_EQ(count("queue_full"), 10);
}

TEST_F(QuestionDeskTest, NobodyIsAnsweredWhoDoesNotWaitAnyMore) {
  request_t request = question_of("map_version", "R1");
  request.timeout_s = 1e-3;
  ask(request);
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  offer_map();
  EXPECT_TRUE(happens([&] { return count("timed_out") == 1; }));
}

TEST_F(QuestionDeskTest, WhatWaitsAtTheStopIsRefused) {
  ask(question_of("map_version", "R1"));
  desk_->stop();
  ask(question_of("map_version", "R1"));
  ASSERT_EQ(replies().size(), 2U);
  EXPECT_EQ(replies().back().reason, "stopped");
}

class FollowedPathsTest : public QuestionDeskTest {
 protected:
  FollowedPathsTest() { testing::add_round_way(map_, testing::furnished_room(), {{-1, 0, 0}, {1, 0, 0}}); }

  void offer() { desk_->offer(testing::shared_copy(map_), utime_ += 1000); }
  request_t path(std::int64_t id, double follow_s) {
    request_t request = question_of("path", "");
    request.asker = "R1";
    request.id = id;
    request.follow_s = follow_s;
    request.target = "patch";
    request.target_patch = 1;
    return request;
  }
  /// Waits for so many replies; the last.
  reply_t reply(std::size_t number) {
    EXPECT_TRUE(happens([&] { return replies().size() >= number; }));
    return replies().size() < number ? reply_t{} : replies()[number - 1];
  }

  Map map_;
  std::int64_t utime_ = 0;
};

TEST_F(FollowedPathsTest, WhatTheMapDoesToAPathIsTold) {
  offer();
  ask(path(1, 600));
  EXPECT_TRUE(reply(1).followed);
  EXPECT_EQ(reply(1).update, 0);
  map_.move_island(IslandId{0}, {0.5, 0, 0});
  offer();
  const reply_t moved = reply(2);
  EXPECT_EQ(moved.change, "moved");
  EXPECT_EQ(moved.update, 1);
  EXPECT_EQ(moved.request_id, 1);
  EXPECT_TRUE(moved.followed);
}

TEST_F(FollowedPathsTest, APathIsFollowedUntilItsTimeIsOver) {
  offer();
  ask(path(1, 0.1));
  const reply_t answer = reply(1);
  const reply_t last = reply(2);
  EXPECT_EQ(last.change, "expired");
  EXPECT_EQ(last.update, 1);
  EXPECT_FALSE(last.followed);
  EXPECT_EQ(last.nposes, answer.nposes) << "it holds as it was told";
  map_.move_island(IslandId{0}, {0.5, 0, 0});
  offer();
  ask(question_of("map_version", "R1"));
  EXPECT_EQ(reply(3).kind, "map_version") << "nobody is told any more";
}

TEST_F(FollowedPathsTest, WhoAsksAgainReplacesItAndTheStopEndsIt) {
  offer();
  ask(path(1, 60));
  ask(path(2, 60));
  ask(path(1, 0));
  EXPECT_EQ(reply(3).change, "replaced");
  EXPECT_EQ(reply(3).request_id, 1);
  EXPECT_FALSE(reply(4).followed);
  desk_->stop();
  EXPECT_EQ(reply(5).change, "stopped");
  EXPECT_EQ(reply(5).request_id, 2);
  EXPECT_EQ(replies().size(), 5U);
}

TEST_F(FollowedPathsTest, SoManyAreFollowedAndNoMore) {
  offer();
  const QuestionLimits limits;
  std::size_t asked = 0;
  for (std::size_t i = 0; i <= limits.followed_of_asker; ++i) {
    ask(path(static_cast<std::int64_t>(i + 1), 60));
    EXPECT_EQ(reply(++asked).reason, i < limits.followed_of_asker ? "" : "too_many_followed");
  }
  for (std::size_t i = limits.followed_of_asker; i <= limits.followed; ++i) {
    request_t request = path(1, 60);
    request.asker = "another " + std::to_string(i);
    ask(request);
    EXPECT_EQ(reply(++asked).reason, i < limits.followed ? "" : "too_many_followed");
  }
}

TEST_F(FollowedPathsTest, OnlyPathsAreFollowedAndNotForEver) {
  const auto reason = [this](const request_t& request) {
    ask(request);
    return replies().back().reason;
  };
  request_t other = question_of("map_version", "R1");
  other.follow_s = 1;
  EXPECT_EQ(reason(other), "bad_value");
  EXPECT_EQ(reason(path(1, 3601)), "bad_value");
  EXPECT_EQ(reason(path(1, -1)), "bad_value");
  EXPECT_EQ(reason(path(1, std::numeric_limits<double>::quiet_NaN())), "bad_value");
}

TEST_F(QuestionDeskTest, WithKeysOnlySignedQuestionsAreTaken) {
  Authentication keys;
  keys.robots["R1"] = {1, 2, 3};
  Inbox inbox;
  ReceptionWatch watch;
  watch.questions = desk_;
  Reception reception(inbox, {}, Authenticator(keys), watch);
  const Message plain{1, request_channel, encoded(question_of("map_version", "R1"))};
  EXPECT_EQ(reception.take(1, plain.channel, plain.bytes), DropReason::not_signed);
  EXPECT_EQ(replies().back().reason, "unsigned");
  const Message forged = seal({9}, "R1", 1, plain);
  EXPECT_EQ(reception.take(1, forged.channel, forged.bytes), DropReason::forged);
  EXPECT_EQ(replies().back().reason, "forged");
  const Message sealed = seal(keys.robots["R1"], "R1", 1, plain);
  EXPECT_EQ(reception.take(1, sealed.channel, sealed.bytes), DropReason::none);
  EXPECT_EQ(reception.take(1, sealed.channel, sealed.bytes), DropReason::replayed);
  offer_map();
  EXPECT_TRUE(happens([&] { return count("answered") == 1; }));
  EXPECT_EQ(inbox.size(), 0U) << "none of it is the engine's";
}

/// As isthmus-server joins them: robots drive, and ask on the way.
TEST(QuestionsToALiveServer, AreAnsweredWhileItMapsAndAreNoneOfItsEvents) {
  Published published;
  LiveOptions options = quick_options();
  options.questions = std::make_shared<QuestionDesk>(published.sink());
  Inbox inbox;
  LiveServer server(options, inbox, published.sink());
  std::thread engine([&] { server.run(); });
  Reception reception(inbox, server.channels(), server.authenticator(), {{}, nullptr, options.questions});
  const BoxRoomRobot robot("R1");
  const auto send = [&](const Message& message) { reception.take(0, message.channel, message.bytes); };
  send(robot.introduction());
  for (int i = 0; i < 60; ++i) {
    for (const Message& message : robot.round(i)) send(message);
    EXPECT_TRUE(happens([&] { return inbox.size() == 0; })) << "a full queue would lose scans";
  }
  std::vector<reply_t> replies;
  const auto ask = [&](const request_t& request) {
    const std::size_t before = replies.size();
    send({0, request_channel, encoded(request)});
    EXPECT_TRUE(happens([&] {
      replies = published.of<reply_t>(reply_channel);
      return replies.size() > before;
    }));
    return replies.empty() ? reply_t{} : replies.back();
  };
  EXPECT_TRUE(happens([&] { return ask(question_of("retro_traverse", "R1")).done; }));
  EXPECT_GT(replies.back().nposes, 0);
  request_t request = question_of("path", "R1");
  request.target = "home";
  const reply_t home = ask(request);
  EXPECT_TRUE(home.done) << home.reason;
  inbox.close();
  engine.join();
  EXPECT_EQ(ask(request).reason, "stopped");
  EXPECT_EQ(server.engine().copy().counters.scans, 60);
  EXPECT_TRUE(server.engine().copy().counters.dropped.empty());
}

}  // namespace
}  // namespace isthmus
