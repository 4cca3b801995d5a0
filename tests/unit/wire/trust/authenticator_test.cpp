#include "server/wire/trust/authenticator.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <random>
#include <thread>

#include "server/wire/intake/reception.hpp"
#include "server/wire/live/live_server.hpp"
#include "server/wire/trust/envelope.hpp"
#include "tests/support/box_room.hpp"
#include "tests/support/log_files.hpp"
#include "tests/support/published.hpp"
#include "tests/support/replayed.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/support/waiting.hpp"

namespace isthmus {
namespace {

const AuthKey robot_key = {1, 2, 3};
const AuthKey other_key = {4, 5, 6};
const AuthKey operator_key = {7, 8, 9};

Authentication keys() {
  Authentication keys;
  keys.robots = {{"R1", robot_key}, {"R2", other_key}};
  keys.operators = {{"ALICE", operator_key}};
  return keys;
}

Message odometry(const std::string& robot = "R1") { return BoxRoomRobot(robot).round(0)[0]; }
Message command() { return encode({1, CommandEvent{1, Verb::refine, -1, ""}}); }

/// The reason for refusal; none: believed.
DropReason refusal(Authenticator& authenticator, const Message& sealed) {
  EXPECT_EQ(sealed.channel, "ISTHMUS_SIGNED");
  return authenticator.open({}, sealed.utime, sealed.bytes).reason;
}

TEST(Authenticator, OpensWhatARobotSealedToTheVeryMessage) {
  Authenticator authenticator(keys());
  const Message sealed = seal(robot_key, "r1", 5, odometry());
  const Opened opened = authenticator.open({}, 77, sealed.bytes);
  ASSERT_TRUE(opened.message);
  EXPECT_EQ(opened.robot, "R1");
  Message expected = odometry();
  expected.utime = 77;
  EXPECT_TRUE(same(*opened.message, expected));
  ASSERT_TRUE(opened.message->signature);
  EXPECT_EQ(opened.message->signature->sender, "R1@" + key_fingerprint(robot_key));
  EXPECT_EQ(opened.message->signature->counter, 5);
}

// The sum is Python's: hmac.new(key, envelope[:-32], "sha256"); what robots in other languages send is
// believed.
TEST(Authenticator, SumsAsOthersDo) {
  const Message sealed = seal(robot_key, "R1", 1, {0, "X", {9}});
  const std::vector<std::uint8_t> mac(sealed.bytes.end() - 32, sealed.bytes.end());
  const auto expected = parse_auth_key("95020d96fbd87d838f94afe6b64c171200844d195262a9b47b9a62a39839fa6d");
  EXPECT_TRUE(std::equal(mac.begin(), mac.end(), expected->begin()));
  EXPECT_TRUE(is_genuine(robot_key, sealed.bytes));
  EXPECT_FALSE(is_genuine(other_key, sealed.bytes));
}

TEST(Authenticator, RefusesEveryReplay) {
  Authenticator authenticator(keys());
  std::vector<Message> sent;
  for (int counter = 1; counter <= 1000; ++counter) {
    sent.push_back(seal(robot_key, "R1", counter, odometry()));
    EXPECT_EQ(refusal(authenticator, sent.back()), DropReason::none);
  }
  for (const Message& message : sent) EXPECT_EQ(refusal(authenticator, message), DropReason::replayed);
}

TEST(Authenticator, RefusesEveryForgery) {
  Authenticator authenticator(keys());
  const Message genuine = seal(robot_key, "R1", 1000, odometry());
  std::mt19937 random(1);
  int refused = 0;
  for (int i = 0; i < 10'000; ++i) {
    Message forged = genuine;
    forged.bytes[random() % forged.bytes.size()] ^= static_cast<std::uint8_t>(1U << random() % 8);
    refused += refusal(authenticator, forged) == DropReason::none ? 0 : 1;
  }
  EXPECT_EQ(refused, 10'000);
  EXPECT_EQ(refusal(authenticator, seal({}, "R1", 1000, odometry())), DropReason::forged);
  EXPECT_EQ(refusal(authenticator, seal(other_key, "R1", 1000, odometry())), DropReason::forged);
  EXPECT_EQ(refusal(authenticator, genuine), DropReason::none) << "forgeries have not used its counter up";
}

TEST(Authenticator, CountsEachChannelByItself) {
  Authenticator authenticator(keys());
  const std::vector<Message> round = BoxRoomRobot("R1").round(0);
  EXPECT_EQ(refusal(authenticator, seal(robot_key, "R1", 9, round[0])), DropReason::none);
  EXPECT_EQ(refusal(authenticator, seal(robot_key, "R1", 8, round[1])), DropReason::none)
      << "of another process";
  EXPECT_EQ(refusal(authenticator, seal(other_key, "R2", 1, odometry("R2"))), DropReason::none);
}

/// What the journal tells a server that is started again.
SignatureCounters counters_of(const Signature& signature) {
  return {{{signature.sender, signature.channel}, signature.counter}};
}

TEST(Authenticator, CountsFromTheBeginningWithANewKey) {
  constexpr std::int64_t last = std::numeric_limits<std::int64_t>::max();
  const Message ran_out = seal(robot_key, "R1", last, odometry());
  const Opened opened = Authenticator(keys()).open({}, 1, ran_out.bytes);
  ASSERT_TRUE(opened.message);
  const SignatureCounters counters = counters_of(*opened.message->signature);
  Authenticator same_key(keys(), counters);
  EXPECT_EQ(refusal(same_key, ran_out), DropReason::replayed);
  EXPECT_EQ(refusal(same_key, seal(robot_key, "R1", last - 1, odometry())), DropReason::replayed);
  const AuthKey new_key = {1, 2, 4};
  Authentication changed = keys();
  changed.robots["R1"] = new_key;
  Authenticator authenticator(changed, counters);
  EXPECT_EQ(refusal(authenticator, ran_out), DropReason::forged)
      << "what the old key signed is worth nothing";
  EXPECT_EQ(refusal(authenticator, seal(new_key, "R1", 1, odometry())), DropReason::none);
  EXPECT_EQ(refusal(authenticator, seal(new_key, "R1", 1, odometry())), DropReason::replayed);
  EXPECT_EQ(refusal(authenticator, seal(new_key, "R1", 2, odometry())), DropReason::none);
}

TEST(Authenticator, HoldsAnyKeyToTheCountersOfJournalsThatNameNone) {
  Authenticator authenticator(keys(), {{{"R1", "R1_ODOMETRY"}, 100}});
  EXPECT_EQ(refusal(authenticator, seal(robot_key, "R1", 100, odometry())), DropReason::replayed);
  EXPECT_EQ(refusal(authenticator, seal(robot_key, "R1", 101, odometry())), DropReason::none);
}

TEST(KeyFingerprint, TellsKeysApart) {
  EXPECT_EQ(key_fingerprint(robot_key).size(), 12U);
  EXPECT_EQ(key_fingerprint(robot_key), key_fingerprint({1, 2, 3}));
  EXPECT_NE(key_fingerprint(robot_key), key_fingerprint(other_key));
}

TEST(Authenticator, KnowsWhoMaySayWhat) {
  Authenticator authenticator(keys());
  const Message tag = encode({1, TagEvent{1, 7}});
  EXPECT_EQ(refusal(authenticator, seal(robot_key, "R1", 1, odometry("R2"))), DropReason::foreign_channel);
  EXPECT_EQ(refusal(authenticator, seal(robot_key, "R1", 1, command())), DropReason::foreign_channel);
  EXPECT_EQ(refusal(authenticator, seal(operator_key, "alice", 1, odometry())), DropReason::foreign_channel);
  EXPECT_EQ(refusal(authenticator, seal(operator_key, "alice", 1, encode({1, TickEvent{}}))),
            DropReason::foreign_channel);
  EXPECT_EQ(refusal(authenticator, seal(operator_key, "BOB", 1, command())), DropReason::unknown_sender);
  EXPECT_EQ(refusal(authenticator, seal(operator_key, "alice", 1, command())), DropReason::none);
  EXPECT_EQ(refusal(authenticator, seal(operator_key, "alice", 1, tag)), DropReason::none);
  EXPECT_EQ(refusal(authenticator, seal(robot_key, "R1", 1, tag)), DropReason::none);
}

TEST(Authenticator, OnlyOperatorsDrawAndARobotMaySayWhereItIsItself) {
  Authenticator authenticator(keys());
  AnnotationEvent erase;
  erase.kind = AnnotationKind::erase;
  erase.name = "z";
  const Message drawn = encode({1, erase});
  EXPECT_EQ(refusal(authenticator, seal(robot_key, "R1", 1, drawn)), DropReason::foreign_channel);
  EXPECT_EQ(refusal(authenticator, seal(operator_key, "alice", 1, drawn)), DropReason::none);
  EXPECT_EQ(refusal(authenticator, seal(operator_key, "alice", 1, drawn)), DropReason::replayed);
  InitialPoseEvent pose;
  pose.sigma_m = pose.sigma_rad = 1;
  pose.robot = "R1";
  const Message own = encode({1, pose});
  pose.robot = "R2";
  const Message of_another = encode({1, pose});
  EXPECT_EQ(refusal(authenticator, seal(robot_key, "R1", 1, own)), DropReason::none);
  EXPECT_EQ(refusal(authenticator, seal(robot_key, "R1", 1, of_another)), DropReason::foreign_channel);
  EXPECT_EQ(refusal(authenticator, seal(operator_key, "alice", 1, of_another)), DropReason::none);
}

TEST(Authenticator, SaysThatThereAreNoKeys) {
  Authenticator none;
  EXPECT_EQ(refusal(none, seal(robot_key, "R1", 1, odometry())), DropReason::no_keys);
}

/// A server with keys, and what receives for it.
class SigningTeam {
 public:
  explicit SigningTeam(const std::string& journal) {
    LiveOptions options = quick_options();
    options.journal_directory = journal;
    options.toml = "[auth.robots]\nR1 = \"01020300" + std::string(56, '0') +
                   "\"\n[auth.operators]\nalice = \"070809" + std::string(58, '0') + "\"\n";
    server_.emplace(options, inbox_, published_.sink());
    reception_.emplace(inbox_, server_->channels(), server_->authenticator());
  }

  void send(const Message& message) { reception_->take(message.utime, message.channel, message.bytes); }

  /// Handles all that was sent, of which so many messages are `believed`.
  MapCopy stop(std::size_t believed) {
    EXPECT_EQ(inbox_.size(), believed);
    inbox_.close();
    server_->run();
    return server_->engine().copy();
  }

 private:
  Inbox inbox_;
  Published published_;
  std::optional<LiveServer> server_;
  std::optional<Reception> reception_;
};

std::vector<Message> sealed_rounds(int from, int to) {
  std::vector<Message> sealed;
  const BoxRoomRobot robot("R1");
  if (from == 0) sealed.push_back(seal(robot_key, "R1", 1, robot.introduction()));
  for (int i = from; i < to; ++i)
    for (const Message& message : robot.round(i)) sealed.push_back(seal(robot_key, "R1", i + 1, message));
  return sealed;
}

TEST(SignedServer, MapsWhatIsSignedAndRefusesTheRest) {
  TemporaryDirectory directory;
  SigningTeam team(directory / "journal");
  for (const Message& message : sealed_rounds(0, 20)) team.send(message);
  for (const Message& message : sealed_rounds(0, 20)) team.send(message);
  for (int i = 20; i < 25; ++i)
    for (const Message& message : BoxRoomRobot("R1").round(i)) team.send(message);
  team.send(command());
  team.send(seal(other_key, "R1", 100, odometry()));
  team.send(seal(operator_key, "ALICE", 1, command()));
  const MapCopy map = team.stop(42);
  EXPECT_EQ(map.counters.scans, 20);
  const std::map<DropReason, std::int64_t> expected = {
      {DropReason::forged, 1}, {DropReason::replayed, 41}, {DropReason::not_signed, 11}};
  EXPECT_EQ(map.counters.dropped, expected);
}

TEST(SignedServer, RefusesAReplayAfterARestartAndJournalsNoKeyAndNoEnvelope) {
  TemporaryDirectory directory;
  const std::string journal = directory / "journal";
  const std::vector<Message> first = sealed_rounds(0, 20);
  {
    SigningTeam team(journal);
    for (const Message& message : first) team.send(message);
    EXPECT_EQ(team.stop(41).counters.scans, 20);
  }
  for (int restart = 0; restart < 3; ++restart) {
    SigningTeam team(journal);
    for (const Message& message : first) team.send(message);
    for (const Message& message : sealed_rounds(20 + restart, 21 + restart)) team.send(message);
    const MapCopy map = team.stop(2);
    EXPECT_EQ(map.counters.scans, 21 + restart);
    EXPECT_EQ(map.counters.dropped.at(DropReason::replayed), 41 * (restart + 1)) << "counted on";
  }
  for (const Message& message : read_log(journal).messages) EXPECT_NE(message.channel, "ISTHMUS_SIGNED");
  for (const auto& entry : std::filesystem::directory_iterator(journal)) {
    const std::vector<std::uint8_t> bytes = read_bytes(entry.path().string());
    EXPECT_EQ(std::string(bytes.begin(), bytes.end()).find("010203"), std::string::npos);
  }
}

TEST(SignedServer, KeepsCountersThroughRotationsAndTornSegments) {
  TemporaryDirectory directory;
  JournalOptions small;
  small.segment_bytes = 2000;
  const auto signed_message = [](std::int64_t counter) {
    Message message{counter, "R1_SCAN", std::vector<std::uint8_t>(100)};
    message.signature = Signature{"R1", "R1_SCAN", counter};
    return message;
  };
  {
    Journal journal(directory / "j", small);
    EXPECT_TRUE(journal.count_signatures().empty());
    Message once{1, "R2_SCAN", {1}};
    once.signature = Signature{"R2", "R2_SCAN", 42};
    EXPECT_TRUE(journal.append(once));
    for (int i = 1; i <= 100; ++i) EXPECT_TRUE(journal.append(signed_message(i)));
  }
  std::string last;
  for (const auto& entry : std::filesystem::directory_iterator(directory / "j"))
    last = std::max(last, entry.path().string());
  std::filesystem::resize_file(last, 3);
  Journal journal(directory / "j", small);
  const SignatureCounters counters = journal.count_signatures();
  EXPECT_EQ(counters.at({"R2", "R2_SCAN"}), 42);
  EXPECT_GE(counters.at({"R1", "R1_SCAN"}), 80);
}

/// Why a server does not go on with a journal.
std::string refusal_of(const std::string& journal, const std::string& toml, bool frozen = false) {
  LiveOptions options = quick_options();
  options.journal_directory = journal;
  options.toml = toml;
  options.frozen = frozen;
  Inbox inbox;
  return error_of([&] { LiveServer server(options, inbox, [](const auto&, const auto&) {}); });
}

TEST(SignedServer, AsksForTheKeysOfAJournalWhoseSendersSign) {
  TemporaryDirectory directory;
  const std::string journal = directory / "journal";
  SigningTeam(journal).stop(0);
  for (const std::string toml : {"", "# no [auth]\n"}) {
    for (const bool frozen : {false, true}) {
      EXPECT_EQ(refusal_of(journal, toml, frozen),
                journal +
                    ": this journal's senders sign; give the configuration with their keys ([auth]), or "
                    "begin another journal");
    }
  }
}

// The journal's first configuration has no keys; its second server's has.
TEST(SignedServer, AsksForKeysThatCameWithALaterStart) {
  TemporaryDirectory directory;
  const std::string journal = directory / "journal";
  LiveOptions options = quick_options();
  options.journal_directory = journal;
  {
    Inbox inbox;
    LiveServer server(options, inbox, [](const auto&, const auto&) {});
  }
  EXPECT_EQ(refusal_of(journal, ""), "");
  {
    SigningTeam team(journal);
    for (const Message& message : sealed_rounds(0, 3)) team.send(message);
    team.stop(7);
  }
  EXPECT_NE(refusal_of(journal, "").find("senders sign"), std::string::npos);
}

}  // namespace
}  // namespace isthmus
