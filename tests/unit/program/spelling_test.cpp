#include "server/program/spelling.hpp"

#include <gtest/gtest.h>

namespace isthmus {
namespace {

TEST(Spelling, CountsWhatMustBeChanged) {
  EXPECT_EQ(letters_apart("office", "office"), 0U);
  EXPECT_EQ(letters_apart("ofice", "office"), 1U);    // one put in
  EXPECT_EQ(letters_apart("offfice", "office"), 1U);  // one taken out
  EXPECT_EQ(letters_apart("effice", "office"), 1U);   // one replaced
  EXPECT_EQ(letters_apart("fofice", "office"), 1U);   // two exchanged
  EXPECT_EQ(letters_apart("", "abc"), 3U);
  EXPECT_EQ(letters_apart("abc", ""), 3U);
}

TEST(Spelling, FindsTheNearestWordAndNoneThatIsFar) {
  const std::vector<std::string> words = {"withdraw", "forbid", "allow"};
  EXPECT_EQ(nearest_word("withdrw", words), "withdraw");
  EXPECT_EQ(nearest_word("alow", words), "allow");
  EXPECT_EQ(nearest_word("refine", words), std::nullopt);
  EXPECT_EQ(nearest_word("withdraw", {}), std::nullopt);
}

TEST(Spelling, AsksOnlyWhereSomethingIsNear) {
  EXPECT_EQ(did_you_mean("ofice", {"office"}), "; did you mean 'office'?");
  EXPECT_EQ(did_you_mean("house", {"office"}), "");
}

}  // namespace
}  // namespace isthmus
