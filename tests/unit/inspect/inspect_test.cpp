#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "relations/confidence.hpp"
#include "server/output/tables/tables.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tools/inspect/confidence_picture.hpp"
#include "tools/inspect/confidence_text.hpp"
#include "tools/inspect/meeting_counts.hpp"
#include "tools/inspect/overview.hpp"
#include "tools/inspect/pose_graph.hpp"

namespace isthmus {
namespace {

/// A file with this text, which goes away with it.
class TextFile {
 public:
  explicit TextFile(const std::string& text) {
    std::string name = (std::filesystem::temp_directory_path() / "isthmus-inspect-XXXXXX").string();
    ::close(::mkstemp(name.data()));
    path_ = name;
    std::ofstream(path_) << text;
  }
  ~TextFile() { std::filesystem::remove(path_); }
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

//  0 --- 1 --- 2     3
constexpr const char* graph =
    "VERTEX_SE2 0 0 0 0\n"
    "VERTEX_SE2 1 1 0 1.5707963267948966\n"
    "VERTEX_SE2 2 1 2 1.5707963267948966\n"
    "VERTEX_SE2 3 9 9 0\n"
    "FIX 0\n"
    "FIX 3\n"
    "EDGE_SE2 0 1 1 0 1.5707963267948966 100 0 0 400 0 900\n"
    "EDGE_SE2 1 2 2 0 0 100 0 0 400 0 900\n";

TEST(PoseGraph, IsReadWithInformationTurnedToTheFirstPatchsAxes) {
  const TextFile file(graph);
  const PoseGraph map = read_pose_graph(file.path());
  ASSERT_EQ(map.poses.size(), 4u);
  EXPECT_EQ(map.poses[2], (Pose{1, 2, 1.5707963267948966}));
  ASSERT_EQ(map.graph.relations().size(), 2u);
  const Relation& relation = *map.graph.find(map.graph.between(PatchId{0}, PatchId{1}).front());
  const Eigen::Matrix3d by_pose = information(relation.measurement, Pose{1, 0, 1.5707963267948966});
  // The error's x axis is a's y axis.
  EXPECT_NEAR(by_pose(0, 0), 400, 1e-9);
  EXPECT_NEAR(by_pose(1, 1), 100, 1e-9);
  EXPECT_NEAR(by_pose(2, 2), 900, 1e-9);
}

TEST(PoseGraph, ThatNoMapWroteIsRefusedByName) {
  const auto error = [](const std::string& text) {
    const TextFile file(text);
    const std::string message = error_of([&] { read_pose_graph(file.path()); });
    return message.starts_with(file.path()) ? message.substr(file.path().size()) : "?" + message;
  };
  EXPECT_EQ(error("VERTEX_SE2 1 0 0 0\n"), ": vertex ids must be 0, 1, 2, ..., each with its pose");
  EXPECT_EQ(error("VERTEX_SE2 0 0 0 0\nEDGE_SE2 0 1 0 0 0 1 0 0 1 0 1\n"),
            ": vertex ids must be 0, 1, 2, ..., each with its pose");
  EXPECT_EQ(error("VERTEX_SE2 0 0 0\n"), ":1: expected 5 fields, found 4");
}

TEST(Confidence, IsThatOfTheChainInTheFirstPatchsFrame) {
  const TextFile file(graph);
  const PoseGraph map = read_pose_graph(file.path());
  const std::string text = confidence_text(map.graph, map.poses, PatchId{0}, PatchId{1});
  EXPECT_NE(text.find("patch 1 relative to patch 0"), std::string::npos) << text;
  EXPECT_NE(text.find("pose   x 1.0000 m, y 0.0000 m, yaw 90.000 deg"), std::string::npos) << text;
  EXPECT_NE(text.find("sigma  x 0.0500 m, y 0.1000 m, yaw 1.910 deg"), std::string::npos) << text;
  EXPECT_NE(text.find("95 %   0.1960 m along the longer axis, 3.743 deg; both axes at once 0.2448 m"),
            std::string::npos)
      << text;
}

TEST(Confidence, WhatCannotBeAnsweredIsSaid) {
  const TextFile file(graph);
  const PoseGraph map = read_pose_graph(file.path());
  const auto error = [&](int a, int b) {
    return error_of([&] { confidence_text(map.graph, map.poses, PatchId{a}, PatchId{b}); });
  };
  EXPECT_EQ(error(0, 3), "patches 0 and 3 are on different islands");
  EXPECT_EQ(error(0, 4), "there is no patch 4");
  EXPECT_EQ(error(-1, 0), "there is no patch -1");
}

constexpr const char* report = R"({
  "events": 120, "scans": 40, "scans_matched": 38, "scans_predicted": {"no_overlap": 2}, "sightings": 7,
  "dropped": {"unknown_robot": 3}, "patches": 7, "relations": 9, "islands": 2,
  "island_list": [{"id": 2, "patches": 5, "robots": ["R1", "R2"]}, {"id": 0, "patches": 2, "robots": ["R1"]}],
  "sessions": [{"number": 0, "robot": "R1", "island": 1, "from_utime": 1000000, "to_utime": 2500000},
               {"number": 1, "robot": "R2", "island": -1, "from_utime": 0, "to_utime": 0}],
  "closures": [{"id": 4, "kind": "merge", "state": "accepted", "utime": 2000000, "robots": ["R1", "R2"],
                "reason": "", "patches_touched": 6, "work_steps": 3, "event_time_s": 0.5,
                "evidence": {"compared": 8, "matched": 6, "way_m": 21, "revisit_log_odds": -2.5,
                             "shared_log_odds": 12.5, "fit_log_odds": -0.25, "log_odds": 9.75}},
               {"id": 5, "kind": "merge", "state": "withdrawn", "utime": 3000000, "robots": ["R1", "R3"],
                "reason": "by an operator", "patches_touched": 2, "work_steps": 1, "event_time_s": 0}],
  "log_duration_s": 60, "wall_s": 1, "cpu_s": 0.9, "realtime_factor": 60,
  "event_latency_ms": {"p50": 0.1, "p99": 2, "max": 3.25}, "peak_rss_mb": 31, "map_sha256": "abc"})";

TEST(Overview, ShowsCountersIslandsSessionsAndClosuresWithIds) {
  MeetingCounts meetings;
  meetings.sightings_by_verdict = {{Verdict::accepted, 2}, {Verdict::refused, 4}, {Verdict::waiting, 1}};
  meetings.refused_by_reason = {{"gate", 3}, {"unknown_barcode", 1}};
  meetings.by_closure[4] = {2, 5};
  meetings.by_closure[6] = {1, 0};
  EXPECT_EQ(overview(report, meetings, "report.json"),
            "  map        abc\n"
            "  events     120 in 60.0 s\n"
            "  scans      40, 95.00 % matched\n"
            "  predicted  no_overlap 2\n"
            "  dropped    unknown_robot 3\n"
            "  sightings  7: accepted 2, refused 4 (gate 3, unknown_barcode 1), waiting 1\n"
            "  patches    7\n"
            "  relations  9\n"
            "  cost       0.9 s CPU, 31 MB\n"
            "  latency    0.100 ms median, 2.000 ms 99 %, 3.250 ms at most\n"
            "\nislands\n"
            "  island  id  patches  robots\n"
            "  0       2   5        R1 R2\n"
            "  1       0   2        R1\n"
            "\nsessions\n"
            "  session  robot  island  from s  to s\n"
            "  0        R1     1       1.000   2.500\n"
            "  1        R2     -       0.000   0.000\n"
            "\nclosures\n"
            "  closure  kind   state      at s   robots  evidence                    sightings  relations  "
            "dependents  reason\n"
            "  4        merge  accepted   2.000  R1 R2   6 of 8 match, log-odds 9.8  2          5          "
            "0\n"
            "  5        merge  withdrawn  3.000  R1 R3                               0          0          "
            "0           by an operator\n");
}

TEST(Overview, ShowsWhatARunWithoutSightingsHas) {
  const std::string text = overview(report, {}, "report.json");
  EXPECT_NE(text.find("  sightings  7\n"), std::string::npos) << text;
}

TEST(Overview, ShowsWhereTheMapContradictsItself) {
  EXPECT_EQ(overview(report, {}, "report.json").find("contradict"), std::string::npos);
  std::string contradicted = report;
  contradicted.insert(contradicted.find_last_of('}'),
                      R"(, "contradictions": [{"island": 2, "x_m": 1.26, "y_m": -4.0, "pairs": 12,
                          "robots": ["R1", "R2"], "patches": [3, 4, 8]}])");
  const std::string text = overview(contradicted, {}, "report.json");
  const std::string shown =
      "\ncontradictions of the map with itself\n"
      "  island id  x m  y m   patches  pairs  robots\n"
      "  2          1.3  -4.0  3        12     R1 R2\n";
  EXPECT_TRUE(text.ends_with(shown)) << text;
}

TEST(MeetingCounts, AreTheSameFromAMapAndFromItsTables) {
  MapCopy map;
  for (int i = 0; i < 3; ++i) map.graph.add_patch(PatchId{i});
  const auto relate = [&](int a, int b, int closure) {
    Relation relation;
    relation.a = PatchId{a};
    relation.b = PatchId{b};
    relation.kind = RelationKind::relative_pose;
    relation.measurement = RelativePose{{1, 0, 0}, Eigen::Matrix3d::Identity()};
    relation.origin = {closure < 0 ? OriginKind::odometry : OriginKind::sighting, ClosureId{closure}};
    map.graph.add(relation);
  };
  relate(0, 1, -1);
  relate(0, 2, 3);
  relate(1, 2, 3);
  Relation seen = *map.graph.find(RelationId{2});
  seen.origin = {OriginKind::sighting, {}};  // the map had its ends near one another by closure 3
  map.graph.add(seen);
  map.sightings = {{{}, Verdict::accepted, Reason::none, ClosureId{3}},
                   {{}, Verdict::refused, Reason::forbidden, ClosureId{4}},
                   {{}, Verdict::refused, Reason::unknown_barcode, {}},
                   {{}, Verdict::waiting, Reason::unsupported, {}}};
  const TemporaryDirectory directory;
  write_sightings(map, directory / "sightings.csv");
  write_relations(map, directory / "relations.csv");
  for (const MeetingCounts& counts : {count_meetings(map), read_meeting_counts(directory / "")}) {
    EXPECT_EQ(counts.sightings_by_verdict,
              (std::map<Verdict, int>{{Verdict::accepted, 1}, {Verdict::refused, 2}, {Verdict::waiting, 1}}));
    EXPECT_EQ(counts.refused_by_reason,
              (std::map<std::string, int>{{"forbidden", 1}, {"unknown_barcode", 1}}));
    ASSERT_EQ(counts.by_closure.size(), 2U);
    EXPECT_EQ(counts.by_closure.at(3).sightings, 1);
    EXPECT_EQ(counts.by_closure.at(3).relations, 2);
    EXPECT_EQ(counts.by_closure.at(4).sightings, 1);
    EXPECT_EQ(counts.by_closure.at(4).relations, 0);
    EXPECT_EQ(counts.by_closure.at(3).dependents, 1);
  }
}

TEST(MeetingCounts, AreRefusedWithAVerdictThatThereIsNot) {
  const TemporaryDirectory directory;
  std::ofstream(directory / "sightings.csv") << "verdict,reason,closure\naccepted,,1\nmaybe,,1\n";
  try {
    read_meeting_counts(directory / "");
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("sightings.csv:3: 'maybe' is no verdict"), std::string::npos)
        << error.what();
  }
}

TEST(MeetingCounts, AreNoneWithoutTables) {
  const TemporaryDirectory directory;
  EXPECT_TRUE(read_meeting_counts(directory / "").sightings_by_verdict.empty());
}

/// Two sightings, each of rank two, join patches 1 and 2 of what were two islands.
TEST(Confidence, OfAMergedIslandComesFromRangesAndBearings) {
  RelationGraph graph_of_two;
  const std::vector<Pose> poses = {{0, 0, 0}, {2, 0, 0}, {2, 2, 1}, {4, 2, 1}};
  for (int i = 0; i < 4; ++i) graph_of_two.add_patch(PatchId{i});
  const auto relate = [&](int a, int b, const Eigen::Matrix3d& information) {
    Relation relation;
    relation.a = PatchId{a};
    relation.b = PatchId{b};
    relation.kind = RelationKind::relative_pose;
    relation.measurement = RelativePose{
        ominus(poses[static_cast<std::size_t>(b)], poses[static_cast<std::size_t>(a)]), information};
    graph_of_two.add(relation);
  };
  const Eigen::Matrix3d position_only = Eigen::Vector3d(400, 400, 0).asDiagonal();
  relate(0, 1, 1e4 * Eigen::Matrix3d::Identity());
  relate(2, 3, 1e4 * Eigen::Matrix3d::Identity());
  relate(1, 2, position_only);
  EXPECT_NE(
      error_of([&] { confidence_text(graph_of_two, poses, PatchId{0}, PatchId{2}); }).find("undetermined"),
      std::string::npos)
      << "one sighting leaves the heading open";
  relate(0, 3, position_only);
  const std::string text = confidence_text(graph_of_two, poses, PatchId{1}, PatchId{2});
  EXPECT_NE(text.find("pose   x 0.0000 m, y 2.0000 m, yaw 57.296 deg"), std::string::npos) << text;
}

TEST(ConfidencePicture, EllipsesAreEnlargedByARoundNumberUntilTheyAreSeen) {
  EXPECT_DOUBLE_EQ(enlargement(0.05, 40), 20);  // 2.4 m of 40
  EXPECT_DOUBLE_EQ(enlargement(3, 40), 1);
  EXPECT_DOUBLE_EQ(enlargement(100, 40), 1) << "never made smaller";
  EXPECT_GT(enlargement(0, 40), 1000);
}

TEST(ConfidencePicture, IsDrawnOfTheIslandsPatches) {
  const TemporaryDirectory directory;
  RelationGraph chain;
  std::vector<Pose> poses;
  std::vector<PatchId> patches;
  for (int i = 0; i < 600; ++i) {
    chain.add_patch(PatchId{i});
    patches.push_back(PatchId{i});
    poses.push_back({0.1 * i, 0.5, 0.3});
    if (i == 0) continue;
    Relation relation;
    relation.a = PatchId{i - 1};
    relation.b = PatchId{i};
    relation.kind = RelationKind::relative_pose;
    relation.measurement =
        RelativePose{ominus(poses[static_cast<std::size_t>(i)], poses[static_cast<std::size_t>(i - 1)]),
                     1e4 * Eigen::Matrix3d::Identity()};
    chain.add(relation);
  }
  const OccupancyGrid grid{0.05, -1, -1, 1300, 80, std::vector<std::uint8_t>(1300 * 80, OccupancyGrid::free)};
  const SheetText text = confidence_sheet_text({chain, poses, patches, grid, 2, 4'000'000, 9'000'000},
                                               PatchId{3}, PatchId{577}, Eigen::Matrix3d::Identity(), 2);
  EXPECT_EQ(text.title, "Island 2: patch 577 relative to patch 3");
  EXPECT_TRUE(text.subtitle.ends_with("; from 4.0 s to 9.0 s")) << text.subtitle;
  write_confidence_picture({chain, poses, patches, grid}, PatchId{3}, PatchId{577}, directory / "far.png");
  write_confidence_picture({chain, poses, patches, grid}, PatchId{3}, PatchId{4}, directory / "near.png");
  std::ostringstream png;
  png << std::ifstream(directory / "far.png", std::ios::binary).rdbuf();
  EXPECT_EQ(png.str().substr(1, 3), "PNG");
  EXPECT_TRUE(std::filesystem::exists(directory / "near.png"));

  chain.remove(chain.between(PatchId{3}, PatchId{4}).front());
  EXPECT_FALSE(error_of([&] {
                 write_confidence_picture({chain, poses, patches, grid}, PatchId{3}, PatchId{577},
                                          directory / "torn.png");
               }).empty());
  EXPECT_FALSE(std::filesystem::exists(directory / "torn.png"));
}

TEST(Overview, WhatIsNoReportIsAnErrorThatNamesTheFile) {
  for (const char* text : {"", "[]", "{\"events\": 1}", "{\"events\":"}) {
    const std::string error = error_of([&] { overview(text, {}, "out/report.json"); });
    EXPECT_TRUE(error.starts_with("out/report.json: not a report of Isthmus: ")) << error;
  }
}

}  // namespace
}  // namespace isthmus
