#include "server/output/tables/tables.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <sstream>

#include "relations/confidence.hpp"
#include "relations/mount_survey.hpp"
#include "server/output/format/csv.hpp"
#include "tests/unit/output/room.hpp"

namespace isthmus {
namespace {

using testing::lines;
using testing::map_of;
using testing::rectangle;
using testing::TemporaryDirectory;

/// Two islands: patches 0 | 1 - 2 - 3 (of R1).
MapCopy split_map() {
  MapCopy map = map_of(rectangle(0, 0, 4, 4), {{1, 1, 0}, {2, 2, 0.5}, {3, 2, 0}, {3, 3, -0.25}});
  map.graph.remove(map.graph.between(PatchId{0}, PatchId{1}).front());
  return map;
}

struct Bounds {
  double least = 1e9;
  double most = -1e9;
};

Bounds bounds_of_wkt(std::string text) {
  for (char& c : text) {
    if (std::string_view("(),\"").find(c) != std::string_view::npos) c = ' ';
  }
  std::istringstream numbers(text);
  Bounds bounds;
  for (double value = 0; numbers >> value;) {
    bounds.least = std::min(bounds.least, value);
    bounds.most = std::max(bounds.most, value);
  }
  return bounds;
}

TEST(Islands, AreRankedByPatchesAndThenById) {
  MapCopy map = map_of({}, std::vector<Pose>(6));
  RelationGraph& graph = map.graph;  // 0-1-2-3-4-5
  graph.remove(graph.between(PatchId{0}, PatchId{1}).front());
  graph.remove(graph.between(PatchId{3}, PatchId{4}).front());  // 0 | 1-2-3 | 4-5
  const RankedIslands islands = rank_islands(map);
  ASSERT_EQ(islands.patches.size(), 3u);
  EXPECT_EQ(islands.patches[0].front(), PatchId{1});
  EXPECT_EQ(islands.patches[1].front(), PatchId{4});
  EXPECT_EQ(islands.rank(PatchId{0}), 2);
  EXPECT_EQ(islands.rank(PatchId{3}), 0);
  EXPECT_EQ(islands.rank(PatchId{}), -1);
  EXPECT_EQ(islands.rank(PatchId{6}), -1);

  graph.remove(graph.between(PatchId{1}, PatchId{2}).front());  // 0 | 1 | 2-3 | 4-5
  const RankedIslands ties = rank_islands(map);
  EXPECT_EQ(ties.rank(PatchId{2}), 0);
  EXPECT_EQ(ties.rank(PatchId{4}), 1);
  EXPECT_EQ(ties.rank(PatchId{0}), 2);
  EXPECT_EQ(ties.rank(PatchId{1}), 3);

  map.left_out = {PatchId{0}};
  const RankedIslands rest = rank_islands(map);
  EXPECT_EQ(rest.patches.size(), 3u);
  EXPECT_EQ(rest.rank(PatchId{0}), -1);
  EXPECT_EQ(patch_count(map), 5u);
}

TEST(Csv, FieldsAreQuotedWhereTheyMustBe) {
  EXPECT_EQ(csv_field("plain text"), "plain text");
  EXPECT_EQ(csv_field("a,b"), "\"a,b\"");
  EXPECT_EQ(csv_field("say \"no\""), "\"say \"\"no\"\"\"");
  EXPECT_EQ(csv_field("two\nlines"), "\"two\nlines\"");
}

TEST(Numbers, ReadBackTheSame) {
  EXPECT_EQ(number(0.1), "0.1");
  EXPECT_EQ(number(1.0 / 3), "0.3333333333333333");
  EXPECT_EQ(number(std::numeric_limits<double>::infinity()), "inf");
  EXPECT_EQ(number(-std::numeric_limits<double>::quiet_NaN()), "nan");
}

TEST(Numbers, FixedHasItsDecimalsAndNoMinusZero) {
  EXPECT_EQ(fixed(1.23456789, 6), "1.234568");
  EXPECT_EQ(fixed(-1e-9, 6), "0.000000");
  EXPECT_EQ(fixed(-0.5, 1), "-0.5");
  EXPECT_GT(fixed(1e300, 6).size(), 300u);
}

TEST(Numbers, SecondsAreExactMicroseconds) {
  EXPECT_EQ(seconds(1'234'567'890'123'456), "1234567890.123456");
  EXPECT_EQ(seconds(7), "0.000007");
  EXPECT_EQ(seconds(-1'500'000), "-1.500000");
  EXPECT_EQ(seconds(std::numeric_limits<std::int64_t>::min()), "-9223372036854.775808");
}

TEST(Tables, RobotsHaveARowPerSessionInTheOrderInWhichTheyCame) {
  MapCopy map = split_map();
  map.sessions = {{"R2", 0, 1'000'000, 1'500'000, PatchId{0}},
                  {"R1", 1, 2'000'000, 3'000'001, PatchId{1}},
                  {"R2", 2, 5'000'000, 6'000'000, PatchId{}}};
  const TemporaryDirectory directory;
  write_robots(map, rank_islands(map), directory.file("robots.csv"));
  EXPECT_EQ(lines(directory.file("robots.csv")),
            (std::vector<std::string>{"robot,island,from_s,to_s", "R2,1,1.000000,1.500000",
                                      "R2,-1,5.000000,6.000000", "R1,0,2.000000,3.000001"}));
}

TEST(Tables, PatchesHavePoseCovarianceAndFreeSpaceInTheIslandsFrame) {
  const MapCopy map = split_map();
  const TemporaryDirectory directory;
  write_patches(map, rank_islands(map), directory.file("patches.csv"));
  const auto rows = lines(directory.file("patches.csv"));
  ASSERT_EQ(rows.size(), 5u);
  EXPECT_EQ(rows[0],
            "id,robot,utime_us,island,x_m,y_m,yaw_rad,cov_x_x,cov_x_y,cov_x_yaw,cov_y_y,cov_y_yaw,"
            "cov_yaw_yaw,free_space");
  EXPECT_TRUE(rows[1].starts_with("0,R1,1000000,1,1,1,0,0,0,0,0,0,0,\"MULTIPOLYGON (((")) << rows[1];
  EXPECT_TRUE(rows[2].starts_with("1,R1,2000000,0,2,2,0.5,0,0,0,0,0,0,\"MULTIPOLYGON (((")) << rows[2];
  // Every patch saw the same room, which reaches from 0 to 4 in the island's frame.
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const Bounds bounds = bounds_of_wkt(rows[i].substr(rows[i].find("(((")));
    EXPECT_NEAR(bounds.least, 0, 0.002) << rows[i];
    EXPECT_NEAR(bounds.most, 4, 0.002) << rows[i];
  }
}

TEST(Tables, ThePatchesCovarianceIsTheExactOneRelativeToTheFirstWithTheLasersMounts) {
  const MapCopy map = split_map();
  const TemporaryDirectory directory;
  write_patches(map, rank_islands(map), directory.file("patches.csv"));
  const std::vector<PatchId> others = {PatchId{3}};
  const Eigen::Matrix3d by_relations =
      exact_relative_covariances(map.graph, map.poses, PatchId{1}, others).front();
  EXPECT_GT(by_relations(0, 0), 0);
  const Eigen::Matrix3d mounts = mount_covariance(ominus(map.poses[3], map.poses[1]), "R1", "R1");
  EXPECT_GT(mounts.norm(), 1e-6);
  const Eigen::Matrix3d c = by_relations + mounts;
  const std::string wanted = number(c(0, 0)) + "," + number(c(0, 1)) + "," + number(c(0, 2)) + "," +
                             number(c(1, 1)) + "," + number(c(1, 2)) + "," + number(c(2, 2)) + ",\"";
  const std::string row = lines(directory.file("patches.csv"))[4];
  EXPECT_NE(row.find(wanted), std::string::npos) << row << "\nwanted " << wanted;
}

TEST(Tables, RelationsHaveKindCountOriginClosureAndWhatTheyDependOn) {
  MapCopy map = map_of({}, {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}});
  Relation relation;
  relation.a = PatchId{0};
  relation.b = PatchId{2};
  relation.kind = RelationKind::point_to_line;
  QuadraticFormBuilder builder;
  for (int i = 0; i < 7; ++i) builder.point_on_line({0.1 * i, 1}, {0, 1}, {0, 1}, 0.03);
  relation.measurement = Correspondences{builder.build(), 7, {}};
  relation.origin = {OriginKind::propagation, ClosureId{3}};
  map.graph.add(relation);
  relation.origin = {OriginKind::hypothesis, ClosureId{5}};
  relation.b = PatchId{1};
  map.graph.add(relation);
  const TemporaryDirectory directory;
  write_relations(map, directory.file("relations.csv"));
  EXPECT_EQ(lines(directory.file("relations.csv")),
            (std::vector<std::string>{
                "id,a,b,kind,count,origin,closure,depends_on",
                "0,0,1," + std::string(name(RelationKind::odometry)) + ",1,odometry,-1,",
                "1,1,2," + std::string(name(RelationKind::odometry)) + ",1,odometry,-1,",
                "2,0,2," + std::string(name(RelationKind::point_to_line)) + ",7,propagation,3,3",
                "3,0,1," + std::string(name(RelationKind::point_to_line)) + ",7,hypothesis,5,5"}));
}

SightingRecord record_of(const SightingEvent& sighting, Verdict verdict, Reason reason, ClosureId id) {
  SightingRecord record;
  record.sighting = sighting;
  record.verdict = verdict;
  record.reason = reason;
  record.closure = id;
  return record;
}

TEST(Tables, SightingsRepeatTheInputAndSayWhatBecameOfIt) {
  MapCopy map;
  const double inf = std::numeric_limits<double>::infinity();
  const std::vector<SightingRecord> records = {
      record_of({"R1", 5'000'001, 12, 2.5, 0.02, -0.125, 0.07}, Verdict::waiting, Reason::none, ClosureId{}),
      record_of({"R2", 6, 13, 0, inf, 0.1, 0.07}, Verdict::refused, Reason::scans_disagree, ClosureId{4})};
  for (const SightingRecord& record : records) map.sightings.append(record);
  const TemporaryDirectory directory;
  write_sightings(map, directory.file("sightings.csv"));
  EXPECT_EQ(lines(directory.file("sightings.csv")),
            (std::vector<std::string>{"utime_us,observer,barcode,range_m,bearing_rad,range_std_m,"
                                      "bearing_std_rad,verdict,reason,closure",
                                      "5000001,R1,12,2.5,-0.125,0.02,0.07,waiting,,-1",
                                      "6,R2,13,0,0.1,inf,0.07,refused,scans_disagree,4"}));
}

TEST(Tables, FindsSayWhereAndWhatSpeaksForThem) {
  MapCopy map;
  for (int i = 0; i < 2; ++i) {
    auto patch = std::make_shared<Patch>();
    patch->id = PatchId{i};
    patch->utime = 7 + i;
    map.patches.push_back(patch);
  }
  map.finds.push_back({"R1", PatchId{1}, PatchId{0}, {2, -1, 0.5}, 30, 0.75, 0.5, 0.875, 2, 2.625, true});
  const TemporaryDirectory directory;
  write_finds(map, directory.file("finds.csv"));
  EXPECT_EQ(lines(directory.file("finds.csv")),
            (std::vector<std::string>{"utime_us,robot,query,anchor,x_m,y_m,yaw_rad,way_m,search_score,"
                                      "carrier_score,seen_again,look_alikes,log_odds,waits",
                                      "8,R1,1,0,2,-1,0.5,30,0.75,0.5,0.875,2,2.625,1"}));
}

}  // namespace
}  // namespace isthmus
