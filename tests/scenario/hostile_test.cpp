// What is spoilt on the way, or meant to harm, is counted and dropped; the team's map is as without it.

#include <gtest/gtest.h>

#include "tools/simulate/campaigns/hostile/hostile.hpp"
#include "tools/simulate/scenario/scenario_file.hpp"

namespace isthmus {
namespace {

TEST(HostileMessages, HarmNobodyElse) {
  constexpr std::int64_t messages = 20'000;
  const HostileTrial trial = try_hostile_messages(load_scenario("meeting", {}), 1, messages);
  std::int64_t dropped = 0;
  for (const auto& [reason, count] : trial.dropped) dropped += count;
  EXPECT_GT(dropped, messages / 2);
  EXPECT_GT(trial.dropped.size(), 8U) << "too few reasons: the messages are not hostile in many ways";
  EXPECT_GT(trial.errors.compared, 100U);
  EXPECT_LE(trial.errors.missing, trial.errors.missing_clean);
  EXPECT_LT(trial.errors.mean_m, 1.2 * trial.errors.mean_clean_m + 0.002);
}

// Well formed, and in the name of every robot: nothing is asked of the map but that there is one.
TEST(HostileMessages, InTheNameOfEveryoneLeaveTheServerAlive) {
  for (const char* scenario : {"meeting", "blind", "tags"}) {
    SCOPED_TRACE(scenario);
    const HostileTrial trial =
        try_hostile_messages(load_scenario(scenario, {}), 1, 10'000, HostileNames::everyone);
    EXPECT_GT(trial.dropped.at(DropReason::no_laser), 0) << "no robot's laser went off";
    EXPECT_GT(trial.dropped.at(DropReason::barcode_taken), 0) << "no robot took another's barcode";
    EXPECT_GT(trial.hostile_patches, 10U);
  }
}

}  // namespace
}  // namespace isthmus
