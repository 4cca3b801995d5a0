#include "server/engine/sightings/sighting_log.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace isthmus {
namespace {

std::vector<std::uint64_t> bits(const SightingEvent& sighting) {
  std::vector<std::uint64_t> bits;
  for (const double value :
       {sighting.range_m, sighting.range_sigma_m, sighting.bearing_rad, sighting.bearing_sigma_rad})
    bits.push_back(std::bit_cast<std::uint64_t>(value));
  return bits;
}

/// Numbers of every kind: now and then one that was not measured, is none, or is a zero below zero.
SightingRecord record(int i) {
  const double odd[] = {0.02,
                        0.02 + 1e-3 * i,
                        std::numeric_limits<double>::infinity(),
                        -0.0,
                        std::numeric_limits<double>::quiet_NaN(),
                        0.0};
  const Verdict verdicts[] = {Verdict::waiting, Verdict::accepted, Verdict::refused};
  return {{"R" + std::to_string(i % 14), 1'700'000'000'000'000 + 7 * i, i % 200, 0.1 * i, odd[i % 6],
           std::sin(i), odd[(i / 6) % 6]},
          verdicts[i % 3],
          i % 3 == 2 ? Reason::contradicts_map : Reason::none,
          ClosureId{i % 40 - 1}};
}

SightingLog log_of(int count) {
  SightingLog log;
  for (int i = 0; i < count; ++i) log.append(record(i));
  return log;
}

TEST(SightingLog, GivesBackTheVeryNumbersThatCame) {
  constexpr int count = 2'500;
  const SightingLog log = log_of(count);
  ASSERT_EQ(log.size(), static_cast<std::size_t>(count));
  EXPECT_TRUE(log.is_sound());
  int i = 0;
  for (const auto& [sighting, verdict, reason, closure] : log) {
    const SightingRecord expected = record(i++);
    EXPECT_EQ(sighting.robot, expected.sighting.robot);
    EXPECT_EQ(sighting.utime, expected.sighting.utime);
    EXPECT_EQ(sighting.barcode, expected.sighting.barcode);
    EXPECT_EQ(bits(sighting), bits(expected.sighting)) << i;
    EXPECT_EQ(verdict, expected.verdict);
    EXPECT_EQ(reason, expected.reason);
    EXPECT_EQ(closure, expected.closure);
  }
  EXPECT_EQ(i, count);
}

TEST(SightingLog, CopiesKeepTheVerdictsOfTheirTime) {
  constexpr int count = 700;  // the last ones are in no full chunk
  SightingLog log = log_of(count);
  const SightingLog before = log;
  for (const std::size_t i : {0U, 255U, 256U, 511U, 699U})
    log.set_verdict(i, Verdict::accepted, Reason::closed_loop, {7});
  log.append(record(count));
  EXPECT_EQ(before.size(), static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    const auto at = static_cast<std::size_t>(i);
    EXPECT_EQ(before.verdict(at), record(i).verdict);
    EXPECT_EQ(before[at].reason, record(i).reason);
    const bool changed = log[at].reason == Reason::closed_loop;
    EXPECT_EQ(changed, i == 0 || i == 255 || i == 256 || i == 511 || i == 699) << i;
    EXPECT_EQ(log[at].closure, changed ? ClosureId{7} : record(i).closure);
    EXPECT_EQ(bits(log[at].sighting), bits(record(i).sighting));
  }
}

TEST(SightingLog, CountsByVerdict) {
  SightingLog log = log_of(900);
  EXPECT_EQ(log.count(Verdict::waiting), 300);
  EXPECT_EQ(log.count(Verdict::accepted), 300);
  log.set_verdict(3, Verdict::accepted, Reason::none, {});
  log.set_verdict(899, Verdict::accepted, Reason::none, {});
  EXPECT_EQ(log.count(Verdict::waiting), 299);
  EXPECT_EQ(log.count(Verdict::accepted), 302);
  EXPECT_EQ(log.count(Verdict::refused), 299);
  EXPECT_EQ(SightingLog().count(Verdict::waiting), 0);
}

}  // namespace
}  // namespace isthmus
