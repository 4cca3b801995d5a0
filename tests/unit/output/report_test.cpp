#include "server/output/report.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/driven_twice.hpp"

namespace isthmus {
namespace {

nlohmann::json report_of(const MapCopy& map) {
  return nlohmann::json::parse(report_json(map, rank_islands(map), {}));
}

TEST(Report, TellsWhereTheMapContradictsItself) {
  EXPECT_TRUE(report_of(testing::hall_driven_twice({})).at("contradictions").empty());
  const auto found = report_of(testing::hall_driven_twice({9, -9, 1.57}, "R2")).at("contradictions");
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].at("island"), 0);
  EXPECT_NEAR(found[0].at("x_m"), 9, 2);
  EXPECT_NEAR(found[0].at("y_m"), 0, 2);
  EXPECT_GE(found[0].at("pairs"), 10);
  EXPECT_EQ(found[0].at("robots"), nlohmann::json({"R1", "R2"}));
  EXPECT_GE(found[0].at("patches").size(), 4U);
}

}  // namespace
}  // namespace isthmus
