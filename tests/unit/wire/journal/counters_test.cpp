// Counters of signed messages in the journal: each segment begins with all of them, so that those before may
// go.

#include <gtest/gtest.h>

#include <filesystem>

#include "server/wire/journal/event_log.hpp"
#include "server/wire/journal/journal.hpp"
#include "server/wire/journal/signature.hpp"
#include "tests/support/temporary_directory.hpp"

namespace isthmus {
namespace {

Message signed_by(const std::string& sender, std::int64_t counter) {
  Message message{counter, sender + "_SCAN", std::vector<std::uint8_t>(100)};
  message.signature = Signature{sender, message.channel, counter};
  return message;
}

std::vector<std::string> segments_of(const std::string& directory) {
  std::vector<std::string> segments;
  for (const auto& entry : std::filesystem::directory_iterator(directory))
    if (entry.path().extension() == ".lcm") segments.push_back(entry.path().string());
  std::ranges::sort(segments);
  return segments;
}

/// What one segment says by itself, before and with all that follows its first signed message.
struct Counted {
  SignatureCounters at_first;
  SignatureCounters at_end;
  bool complete = false;  ///< the first record was one of all counters
};

Counted counted(const std::string& segment) {
  Counted found;
  EventLogReader reader(segment);
  while (const auto message = reader.next()) {
    bool complete = false;
    if (raise_counters(*message, found.at_end, complete)) {
      found.complete = found.complete || complete;
    } else if (message->channel.ends_with("_SCAN") && found.at_first.empty()) {
      found.at_first = found.at_end;
    }
  }
  return found;
}

// R2 signed once, at the very beginning; R1 fills segment after segment.
TEST(SegmentCounters, OfAllSendersBeginEverySegment) {
  const TemporaryDirectory directory;
  JournalOptions small;
  small.segment_bytes = 2000;
  {
    Journal journal(directory / "j", small);
    journal.count_signatures();
    ASSERT_TRUE(journal.append(signed_by("R2", 42)));
    for (int i = 1; i <= 60; ++i) ASSERT_TRUE(journal.append(signed_by("R1", i)));
  }
  const std::vector<std::string> segments = segments_of(directory / "j");
  ASSERT_GE(segments.size(), 4U);
  std::int64_t before = 0;
  for (const std::string& segment : segments) {
    const Counted its = counted(segment);
    EXPECT_TRUE(its.complete) << segment;
    ASSERT_TRUE(its.at_first.contains({"R2", "R2_SCAN"})) << segment;
    EXPECT_EQ(its.at_first.at({"R2", "R2_SCAN"}), 42) << segment;
    if (before > 0) {
      EXPECT_EQ(its.at_first.at({"R1", "R1_SCAN"}), before + 1) << "of the message that it begins with";
    }
    before = its.at_end.at({"R1", "R1_SCAN"});
  }
  EXPECT_EQ(before, 60);
}

TEST(SegmentCounters, GoOnInTheSegmentOfTheNextStart) {
  const TemporaryDirectory directory;
  for (int start = 0; start < 3; ++start) {
    Journal journal(directory / "j");
    const SignatureCounters known = journal.count_signatures();
    EXPECT_EQ(known.size(), start == 0 ? 0U : 2U);
    if (start == 0) {
      ASSERT_TRUE(journal.append(signed_by("R2", 42)));
    } else {
      EXPECT_EQ(known.at({"R1", "R1_SCAN"}), start);
      EXPECT_EQ(known.at({"R2", "R2_SCAN"}), 42);
    }
    ASSERT_TRUE(journal.append(signed_by("R1", start + 1)));
  }
  for (const std::string& segment : segments_of(directory / "j"))
    EXPECT_EQ(counted(segment).at_end.at({"R2", "R2_SCAN"}), 42) << segment;
}

}  // namespace
}  // namespace isthmus
