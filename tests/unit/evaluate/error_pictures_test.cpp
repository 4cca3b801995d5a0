#include "tools/evaluate/error_pictures.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "server/output/grid/grid_files.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tools/text/lines.hpp"

namespace isthmus {
namespace {

AbsoluteErrors one_robot_off_by(double error_m) {
  AbsoluteErrors errors;
  IslandErrors island;
  island.island = 2;
  island.truth_from_map = {10, 0, 0};
  for (int i = 0; i < 20; ++i)
    island.pairs["R1"].push_back({{10 + 0.1 * i, error_m, 0}, {0.1 * i, 0, 0}, 100'000 * i});
  errors.islands.push_back(island);
  return errors;
}

TEST(ErrorsOfPoses, AreThoseLeftAfterTheIslandWasMoved) {
  const std::vector<ErrorAt> errors = errors_of_poses(one_robot_off_by(0.25));
  ASSERT_EQ(errors.size(), 20U);
  EXPECT_NEAR(errors[7].error_m, 0.25, 1e-12);
  EXPECT_NEAR(errors[7].map_point.x(), 0.7, 1e-12);
  EXPECT_EQ(errors[7].utime, 700'000);
  EXPECT_EQ(errors[7].island, 2);
}

TEST(ReadFloorPlan, GivesWallsAndNamesBadLines) {
  const TemporaryDirectory directory;
  directory.write("floor_plan.csv", "ax_m,ay_m,bx_m,by_m\n0,1,2,3\n");
  const std::vector<TrueWall> walls = read_floor_plan(directory / "floor_plan.csv");
  ASSERT_EQ(walls.size(), 1U);
  EXPECT_EQ(walls[0].b, Eigen::Vector2d(2, 3));
  directory.write("bad.csv", "ax_m,ay_m,bx_m,by_m\n0,1,2,x\n");
  EXPECT_THROW(read_floor_plan(directory / "bad.csv"), FileError);
}

ErrorPictures pictures_of(const TemporaryDirectory& directory) {
  ErrorPictures pictures;
  pictures.output = directory / "map";
  pictures.name = "errors";
  pictures.what = "positions";
  pictures.errors = errors_of_poses(one_robot_off_by(0.25));
  return pictures;
}

/// Width and height of a PNG file.
std::pair<int, int> size_of(const std::string& file) {
  const std::string bytes = content(file);
  const auto number = [&](std::size_t at) {
    int value = 0;
    for (std::size_t i = at; i < at + 4; ++i) value = value * 256 + static_cast<unsigned char>(bytes.at(i));
    return value;
  };
  return {number(16), number(20)};
}

TEST(ErrorPictures, ThereIsOneForEachIslandWithErrors) {
  const TemporaryDirectory directory;
  write_error_pictures(pictures_of(directory), directory / "new/pictures");
  EXPECT_GT(size_of(directory / "new/pictures/island-2-errors.png").first, 300);
  EXPECT_FALSE(std::filesystem::exists(directory / "new/pictures/island-0-errors.png"));
}

TEST(ErrorPictures, TellIslandAndTime) {
  const std::vector<ErrorAt> errors = errors_of_poses(one_robot_off_by(0.25));
  const SheetText text = error_sheet_text("positions", 2, errors);
  EXPECT_EQ(text.title, "Island 2: error of positions");
  EXPECT_TRUE(text.subtitle.ends_with("; from 0.0 s to 1.9 s")) << text.subtitle;
}

TEST(ErrorPictures, AreDrawnOverTheGridAndTheTrueWalls) {
  const TemporaryDirectory directory;
  ErrorPictures pictures = pictures_of(directory);
  write_error_pictures(pictures, directory / "without");
  std::filesystem::create_directory(directory / "map");
  OccupancyGrid grid{0.05, -10, -10, 400, 400, std::vector<std::uint8_t>(160'000, OccupancyGrid::free)};
  write_grid(grid, directory / "map/island-2");
  write_error_pictures(pictures, directory / "grid");
  EXPECT_GT(size_of(directory / "grid/island-2-errors.png").second,
            size_of(directory / "without/island-2-errors.png").second);
  pictures.walls = {{{8, 0}, {12, 0}}};
  pictures.truth_from_map[2] = {10, 0, 0};
  write_error_pictures(pictures, directory / "walls");
  EXPECT_NE(content(directory / "walls/island-2-errors.png"),
            content(directory / "grid/island-2-errors.png"));
}

TEST(ErrorPictures, ARobotHasTheColourOfItsPlaceAmongAll) {
  const TemporaryDirectory directory;
  ErrorPictures pictures = pictures_of(directory);
  for (const auto& [name, robots] : std::map<std::string, std::vector<std::string>>{
           {"alone", {"R1"}}, {"first", {"R1", "R2"}}, {"second", {"R2", "R1"}}}) {
    pictures.robots = robots;
    write_error_pictures(pictures, directory / name);
  }
  const auto picture = [&](const std::string& name) {
    return content(directory / (name + "/island-2-errors.png"));
  };
  EXPECT_EQ(picture("first"), picture("alone"));
  EXPECT_NE(picture("second"), picture("alone"));
}

TEST(ErrorPictures, TheSameErrorsGiveTheSameBytes) {
  const TemporaryDirectory directory;
  for (const char* name : {"a", "b"}) write_error_pictures(pictures_of(directory), directory / name);
  EXPECT_EQ(content(directory / "a/island-2-errors.png"), content(directory / "b/island-2-errors.png"));
}

}  // namespace
}  // namespace isthmus
