#include "server/engine/input/words.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>

#include "server/engine/closures/closure_record.hpp"
#include "server/engine/input/drop_reason.hpp"
#include "server/engine/input/verb.hpp"
#include "server/engine/localise/unmatched.hpp"
#include "server/engine/map/reason.hpp"
#include "server/engine/sightings/verdict.hpp"

namespace isthmus {
namespace {

template <class Enum>
class Words : public ::testing::Test {};

using Worded = ::testing::Types<Verb, Reason, Verdict, ClosureKind, ClosureState, DropReason, Unmatched>;
TYPED_TEST_SUITE(Words, Worded);

TYPED_TEST(Words, EachIsThatOfOneValue) {
  std::set<std::string_view> seen;
  for (std::size_t i = 0; i < words_of<TypeParam>.size(); ++i) {
    const auto value = static_cast<TypeParam>(i);
    EXPECT_TRUE(has_word(value));
    EXPECT_EQ(value_of<TypeParam>(word(value)), value);
    EXPECT_TRUE(seen.insert(word(value)).second) << word(value);
  }
}

TYPED_TEST(Words, OthersAndOtherValuesThereAreNot) {
  EXPECT_EQ(value_of<TypeParam>("maybe"), std::nullopt);
  EXPECT_FALSE(has_word(static_cast<TypeParam>(words_of<TypeParam>.size())));
}

// One of each table's ends: a word that is left out or put elsewhere moves them.
TEST(WordsOf, StandWhereTheirValuesDo) {
  EXPECT_EQ(word(Verb::withdraw), "withdraw");
  EXPECT_EQ(word(Verb::send_map), "send_map");
  EXPECT_EQ(word(Reason::none), "");
  EXPECT_EQ(word(Reason::agrees_with_map), "agrees_with_map");
  EXPECT_EQ(word(Reason::allowed_again), "allowed_again");
  EXPECT_EQ(word(Reason::nothing_beyond_the_seam), "nothing_beyond_the_seam");
  EXPECT_EQ(word(Verdict::accepted), "accepted");
  EXPECT_EQ(word(Verdict::waiting), "waiting");
  EXPECT_EQ(word(ClosureKind::merge), "merge");
  EXPECT_EQ(word(ClosureState::waiting), "waiting");
  EXPECT_EQ(word(ClosureState::withdrawn), "withdrawn");
  EXPECT_EQ(word(DropReason::none), "");
  EXPECT_EQ(word(DropReason::not_accepted), "not_accepted");
  EXPECT_EQ(word(DropReason::not_signed), "unsigned");
  EXPECT_EQ(word(DropReason::zero_beams), "zero_beams");
  EXPECT_EQ(word(Unmatched::no), "");
  EXPECT_EQ(word(Unmatched::few_returns), "few_returns");
  EXPECT_EQ(word(Unmatched::not_found_yet), "not_found_yet");
}

TEST(WordsOf, TakeTheirCountsAlong) {
  const std::map<Verb, int> counts = {{Verb::withdraw, 3}, {Verb::drop, 1}};
  EXPECT_EQ(by_word(counts), (std::map<std::string, int>{{"drop", 1}, {"withdraw", 3}}));
}

TEST(WordsOf, DropsAreAllInTheProtocolsDocument) {
  std::ifstream file("lcmtypes/README.md");
  std::ostringstream text;
  text << file.rdbuf();
  const std::string document = text.str();
  const std::size_t list = document.find("## What is refused, and why");
  ASSERT_NE(list, std::string::npos);
  for (const std::string_view reason : words_of<DropReason>) {
    if (reason.empty()) continue;
    EXPECT_NE(document.find("`" + std::string(reason) + "`", list), std::string::npos) << reason;
  }
}

}  // namespace
}  // namespace isthmus
