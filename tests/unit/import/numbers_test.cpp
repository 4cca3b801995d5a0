#include "tools/text/numbers.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace isthmus {
namespace {

TEST(Numbers, SecondsBecomeMicrosecondsExactly) {
  EXPECT_EQ(parse_seconds_as_us("976052857.337284"), 976052857337284);
  EXPECT_EQ(parse_seconds_as_us("1000000000.000246"), 1000000000000246);
  EXPECT_EQ(parse_seconds_as_us("70.1"), 70100000);
  EXPECT_EQ(parse_seconds_as_us("70"), 70000000);
  EXPECT_EQ(parse_seconds_as_us(".5"), 500000);
  EXPECT_EQ(parse_seconds_as_us("-0.25"), -250000);
}

TEST(Numbers, SecondsBeyondSixDecimalsAreRounded) {
  EXPECT_EQ(parse_seconds_as_us("1.0000004"), 1000000);
  EXPECT_EQ(parse_seconds_as_us("1.0000005"), 1000001);
  EXPECT_EQ(parse_seconds_as_us("1.9999999"), 2000000);
}

TEST(Numbers, SecondsMayHaveAnExponent) { EXPECT_EQ(parse_seconds_as_us("1.5e3"), 1500000000); }

TEST(Numbers, WhatIsNoTimeIsRefused) {
  for (const char* text :
       {"", ".", "-", "1.5s", "nan", "inf", "99999999999999999999", "1e300", "--1", "1.-5"}) {
    EXPECT_FALSE(parse_seconds_as_us(text)) << text;
  }
}

TEST(Numbers, OnlyAWholeWordIsANumber) {
  EXPECT_EQ(parse_double("-1.25e2"), -125.0);
  EXPECT_EQ(parse_double("+2"), 2.0);
  EXPECT_EQ(parse_integer("-17"), -17);
  for (const char* text : {"", "1.5m", "0x10", "1,5", " 1", "+-1"}) EXPECT_FALSE(parse_double(text)) << text;
  EXPECT_FALSE(parse_integer("1.0"));
  EXPECT_FALSE(parse_integer("99999999999999999999"));
  EXPECT_TRUE(std::isinf(*parse_float("inf")));
}

TEST(Numbers, WordsAreSplitAtBlanksAndTabs) {
  std::vector<std::string_view> words;
  split_words("  ODOM\t1  2 ", words);
  EXPECT_EQ(words, (std::vector<std::string_view>{"ODOM", "1", "2"}));
  split_words("   ", words);
  EXPECT_TRUE(words.empty());
}

}  // namespace
}  // namespace isthmus
