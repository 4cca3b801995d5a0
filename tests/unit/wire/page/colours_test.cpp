#include <gtest/gtest.h>

#include <cstdio>
#include <string>

#include "server/output/pictures/colours.hpp"
#include "server/wire/page/http/asset.hpp"

namespace isthmus {
namespace {

TEST(PageColours, RobotsHaveThoseOfPicturesInTheirOrder) {
  const Asset* file = find_asset("/colours.js");
  ASSERT_NE(file, nullptr);
  std::size_t at = file->bytes.find("OF_ROBOTS = [");
  const std::size_t end = file->bytes.find(']', at);
  ASSERT_NE(end, std::string_view::npos);
  for (std::size_t robot = 0; robot < robot_colour_count; ++robot) {
    at = file->bytes.find("\"#", at) + 1;
    ASSERT_LT(at, end) << robot;
    const Rgb colour = way_style(robot).colour;
    char expected[8];
    std::snprintf(expected, sizeof expected, "#%02x%02x%02x", colour.red, colour.green, colour.blue);
    EXPECT_EQ(file->bytes.substr(at, 7), expected) << robot;
  }
  EXPECT_GE(file->bytes.find("\"#", at), end);
}

}  // namespace
}  // namespace isthmus
