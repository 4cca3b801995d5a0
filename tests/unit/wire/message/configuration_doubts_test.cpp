#include "server/wire/message/configuration_doubts.hpp"

#include <gtest/gtest.h>

#include <variant>

namespace isthmus {
namespace {

std::vector<std::string> doubts(const std::string& toml) {
  return configuration_doubts(std::get<Configuration>(parse_configuration(toml, "robots.toml")));
}

TEST(ConfigurationDoubts, AStartFromARobotThatIsNotNamed) {
  const auto found =
      doubts("[robots.KURT]\n[robots.R2]\nstart = { with = \"KUTR\", x = 0, y = 1, yaw = 0 }\n");
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NE(found[0].find("R2 is measured from KUTR"), std::string::npos) << found[0];
  EXPECT_NE(found[0].find("did you mean 'KURT'?"), std::string::npos) << found[0];
}

TEST(ConfigurationDoubts, NoneOfAStartFromANamedRobot) {
  EXPECT_TRUE(doubts("[robots.R1]\n[robots.R2]\nstart = { with = \"R1\", x = 0, y = 1, yaw = 0 }\n").empty());
}

}  // namespace
}  // namespace isthmus
