#include "server/feature_maps/meeting/twins.hpp"

#include <gtest/gtest.h>

namespace isthmus {
namespace {

TEST(Twins, MoreThanByChanceSpeakForAPlacingAndFewerAgainst) {
  const ByChance chance{1, 1};
  EXPECT_GT(twins_log_odds(8, chance), 5);
  EXPECT_LT(twins_log_odds(0, chance), 0);
  EXPECT_EQ(twins_log_odds(1, chance), 0);
  EXPECT_GT(twins_log_odds(8, chance), twins_log_odds(5, chance));
}

TEST(Twins, WhereEveryPlacingHasManyTheyTellNothing) {
  EXPECT_LT(twins_log_odds(9, {8, 1}), 0.5);
  EXPECT_LT(twins_log_odds(8, {1, 5}), 2) << "they come in groups";
}

}  // namespace
}  // namespace isthmus
