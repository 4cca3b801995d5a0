#include "server/engine/input/words.hpp"

#include <gtest/gtest.h>

#include <set>

#include "server/engine/closures/closure_record.hpp"
#include "server/engine/input/verb.hpp"
#include "server/engine/map/reason.hpp"
#include "server/engine/sightings/verdict.hpp"

namespace isthmus {
namespace {

template <class Enum>
class Words : public testing::Test {};

using Worded = testing::Types<Verb, Reason, Verdict, ClosureKind, ClosureState>;
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
}

}  // namespace
}  // namespace isthmus
