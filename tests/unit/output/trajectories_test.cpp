#include "server/output/tables/trajectories.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "server/output/report.hpp"
#include "tests/unit/output/room.hpp"

namespace isthmus {
namespace {

using testing::lines;
using testing::TemporaryDirectory;

TEST(Trajectories, RowsAreInEventOrderAndProjectedByThePatchesFinalPoses) {
  MapCopy map = testing::map_of({}, {{0, 0, 0}, {10, 5, 1.5707963267948966}});
  auto store = std::make_shared<TrajectoryStore>();
  store->append({2'000'000, 0, PatchId{0}, {1, 0, 0}});
  store->append({1'500'000, 0, PatchId{1}, {1, 0, 0}});  // an older stamp that came later
  store->append({2'000'500, 1, PatchId{1}, {0, 0, 1.5707963267948966}});
  store->append({3'000'000, 2, PatchId{0}, {-2, 0.25, 0}});
  store->flush();
  map.trajectory = store;
  map.trajectory_rows = store->size();
  map.sessions = {{"R1", 0, 0, 0, PatchId{0}}, {"R2", 1, 0, 0, PatchId{1}}, {"R1", 2, 0, 0, PatchId{0}}};

  const TemporaryDirectory directory;
  write_trajectories(map, directory.path());
  EXPECT_EQ(lines(directory.file("R1.tum")),
            (std::vector<std::string>{"2.000000 1.000000 0.000000 0 0 0 0.000000000 1.000000000",
                                      "1.500000 10.000000 6.000000 0 0 0 0.707106781 0.707106781",
                                      "3.000000 -2.000000 0.250000 0 0 0 0.000000000 1.000000000"}));
  EXPECT_EQ(lines(directory.file("R2.tum")),
            (std::vector<std::string>{"2.000500 10.000000 5.000000 0 0 0 1.000000000 0.000000000"}));
}

TEST(Trajectories, RowsAfterTheCopyAreNotRead) {
  MapCopy map = testing::map_of({}, {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}});
  map.trajectory_rows = 2;
  const TemporaryDirectory directory;
  write_trajectories(map, directory.path());
  EXPECT_EQ(lines(directory.file("R1.tum")).size(), 2u);
}

TEST(Trajectories, ManyRowsAreReadInParts) {
  MapCopy map = testing::map_of({}, {{0, 0, 0}});
  auto store = std::make_shared<TrajectoryStore>();
  for (int i = 0; i < 10'000; ++i) store->append({i, 0, PatchId{0}, {}});
  store->flush();
  map.trajectory = store;
  map.trajectory_rows = store->size();
  std::int64_t next = 0;
  for_each_row(map, [&](const ProjectedRow& row) { EXPECT_EQ(row.utime, next++); });
  EXPECT_EQ(next, 10'000);
}

TEST(Trajectories, RowsOnAnotherIslandThanTheirSessionAreLeftOutAndCounted) {
  MapCopy map = testing::map_of({}, {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}});
  map.graph.remove(map.graph.between(PatchId{1}, PatchId{2}).front());  // 0 - 1 | 2
  const TemporaryDirectory directory;
  write_trajectories(map, directory.path());
  const auto rows = lines(directory.file("R1.tum"));
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_TRUE(rows[1].starts_with("2.000000 "));
  EXPECT_EQ(count_parted_rows(map), 1u);
  const auto report = nlohmann::json::parse(report_json(map, rank_islands(map), {}));
  EXPECT_EQ(report["trajectory_rows"], 3);
  EXPECT_EQ(report["trajectory_rows_parted"], 1);
}

TEST(Trajectories, AnOddRobotNameStaysAFileOfTheDirectory) {
  EXPECT_EQ(file_name_of("R1_A-b"), "R1_A-b");
  EXPECT_EQ(file_name_of("../R1"), "%2E%2E%2FR1");
  EXPECT_EQ(file_name_of("\xc3\x84"), "%C3%84");
}

}  // namespace
}  // namespace isthmus
