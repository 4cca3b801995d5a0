#include "server/engine/record/records.hpp"

#include <gtest/gtest.h>

#include "server/engine/sightings/tag_record.hpp"

namespace isthmus {
namespace {

TEST(HealthRecords, AreOfDeclaredRobotsWithTheirOwnLosses) {
  std::map<std::string, Robot> robots;
  robots["R1"].declared = true;
  robots["R2"].declared = true;
  robots["STRANGER"];
  for (int i = 0; i < 3; ++i) robots["R1"].health.heard_odometry({0.1 * i, 0, 0});
  Counters counters;
  counters.dropped_by_robot["R2"][DropReason::no_odometry] = 100;
  counters.dropped_by_robot["STRANGER"][DropReason::unknown_robot] = 5;
  const std::vector<HealthRecord> records = health_records(robots, counters, {});
  ASSERT_EQ(records.size(), 2U);
  EXPECT_EQ(records[0].robot, "R1");
  EXPECT_EQ(records[0].figures.odometry_messages, 3);
  EXPECT_EQ(records[1].robot, "R2");
  EXPECT_EQ(records[1].figures.odometry_messages, 0);
}

PatchPtr tag_patch(int id) {
  auto patch = std::make_shared<Patch>();
  patch->id = PatchId{id};
  patch->tag = 40 + id;
  return patch;
}

TEST(TagRecords, AreOfDeclaredAndPlacedTagsByBarcode) {
  Map map;
  map.add(tag_patch(0), {1, 2, 3});
  map.add(tag_patch(1), {4, 5, 6});
  const std::vector<TagRecord> records = tag_records(map, {50, 40}, {{40, PatchId{0}}, {41, PatchId{1}}});
  ASSERT_EQ(records.size(), 3U);
  EXPECT_EQ(records[0].barcode, 40);
  EXPECT_TRUE(records[0].placed);
  EXPECT_EQ(records[0].patch, PatchId{0});
  EXPECT_EQ(records[0].position, Eigen::Vector2d(1, 2));
  EXPECT_EQ(records[1].barcode, 41) << "placed without having been declared";
  EXPECT_EQ(records[1].island, PatchId{1});
  EXPECT_EQ(records[2].barcode, 50);
  EXPECT_FALSE(records[2].placed);
  EXPECT_FALSE(records[2].patch.valid());
}

}  // namespace
}  // namespace isthmus
