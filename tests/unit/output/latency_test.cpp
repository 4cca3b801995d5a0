#include "server/output/latency.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace isthmus {
namespace {

TEST(Latency, NothingMeasuredIsZero) {
  const LatencyHistogram latency;
  EXPECT_EQ(latency.count(), 0);
  EXPECT_EQ(latency.quantile_s(0.5), 0);
  EXPECT_EQ(latency.max_s(), 0);
}

TEST(Latency, QuantilesAreRightToTwoPercent) {
  LatencyHistogram latency;
  for (int i = 1; i <= 10'000; ++i) latency.add(1e-6 * i);
  EXPECT_EQ(latency.count(), 10'000);
  EXPECT_NEAR(latency.quantile_s(0.5), 5000e-6, 0.02 * 5000e-6);
  EXPECT_NEAR(latency.quantile_s(0.99), 9900e-6, 0.02 * 9900e-6);
  EXPECT_EQ(latency.max_s(), 10'000e-6);
}

TEST(Latency, ARareSlowEventShowsInTheMaximumAndNotInTheMedian) {
  LatencyHistogram latency;
  for (int i = 0; i < 999; ++i) latency.add(1e-3);
  latency.add(2.5);
  EXPECT_NEAR(latency.quantile_s(0.5), 1e-3, 2e-5);
  EXPECT_NEAR(latency.quantile_s(0.99), 1e-3, 2e-5);
  EXPECT_NEAR(latency.quantile_s(1), 2.5, 0.05);
  EXPECT_EQ(latency.max_s(), 2.5);
}

TEST(Latency, ValuesBeyondTheBucketsCountAtTheEnds) {
  LatencyHistogram latency;
  latency.add(0);
  latency.add(-1);
  latency.add(1e9);
  latency.add(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(latency.count(), 3);
  EXPECT_LE(latency.quantile_s(0.5), 1.02e-6);
  EXPECT_EQ(latency.max_s(), 1e9);
}

}  // namespace
}  // namespace isthmus
