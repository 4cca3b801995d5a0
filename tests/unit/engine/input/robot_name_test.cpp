#include "server/engine/input/robot_name.hpp"

#include <gtest/gtest.h>

namespace isthmus {
namespace {

TEST(RobotName, IsUpperCaseInAsciiAlone) {
  EXPECT_EQ(upper_case("r2-d2_azAZ"), "R2-D2_AZAZ");
  EXPECT_EQ(upper_case("`{\xc3\xa4"), "`{\xc3\xa4");
}

TEST(RobotName, FitsChannelsAndFiles) {
  for (const char* name : {"R1", "7", "A-B_C"}) EXPECT_TRUE(is_robot_name(name)) << name;
  for (const char* name : {"", "r1", "-R1", "_R1", "R 1", "R/1", "R.1", "\xc3\x84"})
    EXPECT_FALSE(is_robot_name(name)) << name;
}

TEST(RobotName, IsAtMost48CharactersLong) {
  EXPECT_TRUE(is_robot_name(std::string(48, 'R')));
  EXPECT_FALSE(is_robot_name(std::string(49, 'R')));
}

TEST(RobotName, IsNotTheServers) {
  EXPECT_FALSE(is_robot_name("ISTHMUS"));
  EXPECT_TRUE(is_robot_name("ISTHMUS2"));
}

}  // namespace
}  // namespace isthmus
