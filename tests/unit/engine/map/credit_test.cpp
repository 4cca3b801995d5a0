#include "server/engine/map/credit.hpp"

#include <gtest/gtest.h>

namespace isthmus {
namespace {

constexpr CreditRate rate = {0.5, 10'000};

/// One that has heard of the time before.
Credit credit_at(std::int64_t utime) {
  Credit credit;
  credit.earn(utime, {0, 0});
  return credit;
}

TEST(Credit, IsTheShareOfTheTimeThatPasses) {
  Credit credit = credit_at(1'000'000);
  credit.earn(1'006'000, rate);
  EXPECT_EQ(credit.left_us(), 3'000);
  credit.earn(1'007'001, rate);
  EXPECT_EQ(credit.left_us(), 3'500) << "in whole microseconds";
}

TEST(Credit, GrowsNoFurtherThanItsLimit) {
  Credit credit = credit_at(1'000'000);
  credit.earn(1'900'000, rate);
  EXPECT_EQ(credit.left_us(), 10'000);
}

TEST(Credit, StaysWhereTimeGoesBack) {
  Credit credit = credit_at(1'000'000);
  credit.earn(400'000, rate);
  EXPECT_EQ(credit.left_us(), 0);
  credit.earn(402'000, rate);
  EXPECT_EQ(credit.left_us(), 1'000) << "from then on time counts from there";
}

TEST(Credit, OfALongSilenceIsThatOfASecond) {
  Credit credit = credit_at(1'000'000);
  credit.earn(3'600'000'000, {0.001, 10'000});
  EXPECT_EQ(credit.left_us(), 1'000);
}

TEST(Credit, ThatAStepHasOverdrawnIsEarnedBackFirst) {
  Credit credit = credit_at(1'000'000);
  credit.spend(4'000);
  credit.earn(1'006'000, rate);
  EXPECT_EQ(credit.left_us(), -1'000);
}

}  // namespace
}  // namespace isthmus
