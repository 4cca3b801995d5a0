#include "server/wire/journal/drop_record.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "isthmus/dropped_t.hpp"
#include "server/engine/engine.hpp"
#include "server/wire/message/encoded.hpp"

namespace isthmus {
namespace {

Message record_of(const std::string& reason, std::int64_t count = 2) {
  dropped_t record{};
  record.ndrops = 1;
  record.drops.resize(1);
  record.drops[0].robot = "R1";
  record.drops[0].reason = reason;
  record.drops[0].count = count;
  return {5, "ISTHMUS_DROPPED", encoded(record)};
}

TEST(DropRecord, TellsWhoseMessagesWereDroppedAndWhy) {
  const Drops drops = {{"R1", {{DropReason::queue_full, {2, {7, 9}}}, {DropReason::not_signed, {1, {}}}}},
                       {"", {{DropReason::malformed_packet, {3, {}}}}}};
  const Message record = encode_drops(5, drops);
  EXPECT_EQ(record.utime, 5);
  const std::optional<Drops> read = read_drops(record);
  ASSERT_TRUE(read);
  ASSERT_EQ(read->size(), 2U);
  EXPECT_EQ(read->at("").at(DropReason::malformed_packet).count, 3);
  ASSERT_EQ(read->at("R1").size(), 2U);
  EXPECT_EQ(read->at("R1").at(DropReason::not_signed).count, 1);
  EXPECT_EQ(read->at("R1").at(DropReason::queue_full).count, 2);
  EXPECT_EQ(read->at("R1").at(DropReason::queue_full).received, (std::vector<std::int64_t>{7, 9}));
}

TEST(DropRecord, HoldsTheWordOfAReason) {
  const std::optional<Drops> read = read_drops(record_of("unsigned"));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->at("R1").at(DropReason::not_signed).count, 2);
}

TEST(DropRecord, IsRefusedWithAReasonThatThereIsNot) {
  EXPECT_FALSE(read_drops(record_of("not_signed")));
  EXPECT_FALSE(read_drops(record_of("")));
}

TEST(DropRecord, IsRefusedWithACountThatCannotBe) {
  EXPECT_TRUE(read_drops(record_of("queue_full", 0)));
  EXPECT_FALSE(read_drops(record_of("queue_full", -1)));
  EXPECT_FALSE(read_drops(record_of("queue_full", std::numeric_limits<std::int64_t>::max())));
}

TEST(DropRecord, IsRefusedOnAnotherChannelAndDamaged) {
  Message record = record_of("unsigned");
  record.channel = "ISTHMUS_COUNTERS";
  EXPECT_FALSE(read_drops(record));
  record = record_of("unsigned");
  record.bytes.pop_back();
  EXPECT_FALSE(read_drops(record));
}

TEST(DropRecord, IsCountedByTheEngine) {
  Engine engine;
  count_drops(engine,
              {{"R1", {{DropReason::queue_full, {2, {}}}}}, {"", {{DropReason::queue_full, {1, {}}}}}});
  const Counters counters = engine.copy().counters;
  EXPECT_EQ(counters.dropped, (std::map<DropReason, std::int64_t>{{DropReason::queue_full, 3}}));
  EXPECT_EQ(counters.dropped_by_robot.at("R1").at(DropReason::queue_full), 2);
  EXPECT_EQ(counters.dropped_by_robot.size(), 1U);
}

// In a log that anybody may have sent into.
TEST(DropRecord, OfAnyNumberIsCountedAtOnce) {
  Engine engine;
  count_drops(engine, {{"R1", {{DropReason::queue_full, {1'000'000'000'000, {}}}}}});
  EXPECT_EQ(engine.copy().counters.dropped.at(DropReason::queue_full), 1'000'000'000'000);
}

// Messages on channels that are not the server's are settled, and not counted.
TEST(DropRecord, OfNoMessagesCountsNoReason) {
  Engine engine;
  count_drops(engine, {{"", {{DropReason::bad_channel, {0, {4}}}}}});
  EXPECT_TRUE(engine.copy().counters.dropped.empty());
}

}  // namespace
}  // namespace isthmus
