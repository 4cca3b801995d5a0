#include "server/output/grid/grid_files.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/unit/output/room.hpp"

namespace isthmus {
namespace {

using testing::TemporaryDirectory;

OccupancyGrid small_grid() {
  OccupancyGrid grid{0.1, -1.25, 2.5, 3, 2, {0, 205, 254, 10, 32, 0}};
  return grid;
}

TEST(ReadGrid, GivesWhatWasWritten) {
  const TemporaryDirectory directory;
  write_grid(small_grid(), directory.file("island-0"));
  const OccupancyGrid grid = read_grid(directory.file("island-0"));
  EXPECT_EQ(grid.width, 3);
  EXPECT_EQ(grid.height, 2);
  EXPECT_EQ(grid.pixels, small_grid().pixels);
  EXPECT_DOUBLE_EQ(grid.resolution_m, 0.1);
  EXPECT_DOUBLE_EQ(grid.origin_x_m, -1.25);
  EXPECT_DOUBLE_EQ(grid.origin_y_m, 2.5);
}

TEST(ReadGrid, OtherFilesAreErrorsThatNameThem) {
  const TemporaryDirectory directory;
  const std::string stem = directory.file("island-0");
  const auto error = [&] {
    try {
      read_grid(stem);
    } catch (const std::runtime_error& one) {
      return std::string(one.what());
    }
    return std::string();
  };
  EXPECT_NE(error().find("island-0.yaml"), std::string::npos);
  const auto expect_error = [&](const std::string& extension, const std::string& text) {
    write_grid(small_grid(), stem);
    std::ofstream(stem + extension, std::ios::binary) << text;
    EXPECT_NE(error().find("island-0" + extension), std::string::npos) << text;
  };
  for (const char* text : {"", "P5\n3 2\n255\nab", "P5\n3 2\n255\nabcdefg", "P2\n3 2\n255\nabcdef",
                           "P5\n-3 2\n255\nabcdef", "P5\n999999999 999999999\n255\n", "P5\n3 2\n9\nabcdef"})
    expect_error(".pgm", text);
  for (const char* text : {"", "resolution: 0.05\n", "resolution: 0\norigin: [0, 0, 0]\n",
                           "resolution: 0.05\norigin: 0, 0\n", "resolution: x\norigin: [0, 0, 0]\n"})
    expect_error(".yaml", text);
}

}  // namespace
}  // namespace isthmus
