#include "tools/simulate/live/radio.hpp"

#include <gtest/gtest.h>

namespace isthmus {
namespace {

Message said(std::int64_t utime) {
  Message message;
  message.utime = utime;
  return message;
}

TEST(Radio, WhatIsSaidOutOfReachGoesOutInOrderOnceItIsBack) {
  Radio radio({1, 0}, 5);
  EXPECT_EQ(radio.say(said(1), {5, 0}).size(), 1U);
  EXPECT_TRUE(radio.say(said(2), {7, 0}).empty());
  EXPECT_TRUE(radio.say(said(3), {9, 0}).empty());
  const auto out = radio.say(said(4), {6, 0});
  ASSERT_EQ(out.size(), 3U);
  for (std::size_t i = 0; i < out.size(); ++i) EXPECT_EQ(out[i].utime, static_cast<std::int64_t>(i + 2));
  EXPECT_EQ(radio.lost(), 0U);
}

TEST(Radio, TheOldestIsLostOfWhatIsTooMuch) {
  Radio radio({0, 0}, 1);
  for (std::size_t i = 0; i < Radio::max_waiting + 2; ++i)
    radio.say(said(static_cast<std::int64_t>(i)), {2, 0});
  const auto out = radio.say(said(0), {0, 0});
  EXPECT_EQ(out.size(), Radio::max_waiting);
  EXPECT_EQ(out.front().utime, 3);
  EXPECT_EQ(radio.lost(), 3U);
}

TEST(Radio, WithoutARangeItReachesEverywhere) {
  Radio radio({0, 0}, 0);
  EXPECT_TRUE(radio.reaches({1e6, 0}));
}

}  // namespace
}  // namespace isthmus
