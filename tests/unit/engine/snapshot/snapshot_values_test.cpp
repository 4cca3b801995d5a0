#include "server/engine/snapshot/snapshot_values.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <stdexcept>
#include <string>

#include "server/engine/input/drop_reason.hpp"
#include "server/engine/snapshot/snapshot_archive.hpp"
#include "tests/support/solids.hpp"
#include "tests/support/walls.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

template <class Value>
std::vector<std::uint8_t> saved(const Value& value) {
  SnapshotWriter writer;
  writer(value);
  return writer.take();
}

template <class Value>
Value restored(const std::vector<std::uint8_t>& bytes) {
  SnapshotReader reader(bytes);
  Value value{};
  reader(value);
  EXPECT_EQ(reader.bytes_left(), 0U);
  return value;
}

TEST(SnapshotArchive, KeepsNumbersToTheBit) {
  for (const double number :
       {-0.0, 1.0 / 3, std::numeric_limits<double>::denorm_min(), std::numeric_limits<double>::infinity()}) {
    const auto back = restored<double>(saved(number));
    EXPECT_EQ(std::bit_cast<std::uint64_t>(back), std::bit_cast<std::uint64_t>(number));
  }
  EXPECT_EQ(restored<std::int64_t>(saved(std::numeric_limits<std::int64_t>::min())),
            std::numeric_limits<std::int64_t>::min());
  EXPECT_TRUE(restored<bool>(saved(true)));
  EXPECT_EQ(saved(true).size(), 1U);
}

TEST(SnapshotArchive, KeepsContainers) {
  const std::map<std::string, std::vector<double>> value = {{"a", {1, 2}}, {"", {}}};
  EXPECT_EQ((restored<std::map<std::string, std::vector<double>>>(saved(value))), value);
}

TEST(SnapshotArchive, RefusesBytesThatEndTooEarly) {
  std::vector<std::uint8_t> bytes = saved(1.5);
  bytes.pop_back();
  EXPECT_THROW(restored<double>(bytes), std::runtime_error);
}

// Before any memory is asked for.
TEST(SnapshotArchive, RefusesToCountMoreThanThereIs) {
  std::vector<std::uint8_t> bytes = saved(std::vector<double>{1});
  bytes.at(7) = 0x70;
  EXPECT_THROW(restored<std::vector<double>>(bytes), std::runtime_error);
}

using Dropped = std::map<DropReason, std::int64_t>;
using DroppedByWord = std::map<std::string, std::int64_t>;

TEST(SnapshotValues, CountByTheWordsOfReasons) {
  const Dropped dropped = {{DropReason::not_signed, 3}, {DropReason::unknown_sender, 1}};
  EXPECT_EQ(saved(dropped), saved(DroppedByWord{{"unknown_sender", 1}, {"unsigned", 3}}));
  EXPECT_EQ(restored<Dropped>(saved(dropped)), dropped);
}

TEST(SnapshotValues, RefuseToCountByAReasonThatThereIsNot) {
  EXPECT_THROW(restored<Dropped>(saved(DroppedByWord{{"not_signed", 3}})), std::runtime_error);
}

TEST(SnapshotValues, KeepARelation) {
  Relation relation;
  relation.id = RelationId{4};
  relation.a = PatchId{-1};
  relation.kind = RelationKind::odometry;
  relation.measurement = RelativePose{{1, 2, 3}, 5 * Eigen::Matrix3d::Identity()};
  relation.origin = {OriginKind::sighting, ClosureId{2}, 9};
  relation.robust_scale = 0.5;
  const auto back = restored<Relation>(saved(relation));
  EXPECT_EQ(back.id, relation.id);
  EXPECT_EQ(back.kind, relation.kind);
  EXPECT_EQ(back.origin, relation.origin);
  EXPECT_EQ(back.robust_scale, 0.5);
  EXPECT_EQ(std::get<RelativePose>(back.measurement).a_from_b, (Pose{1, 2, 3}));
  EXPECT_EQ(std::get<RelativePose>(back.measurement).information, 5 * Eigen::Matrix3d::Identity());
}

TEST(SnapshotValues, RefuseToNameAPatchThatIsNotThere) {
  EXPECT_THROW(restored<PatchId>(saved(PatchId{1})), std::runtime_error);
  EXPECT_THROW(restored<PatchId>(saved(PatchId{-2})), std::runtime_error);
  EXPECT_EQ(restored<PatchId>(saved(PatchId{-1})), PatchId{-1});
}

// Shared patches stay shared, and what a scan makes of a patch is made again.
TEST(SnapshotValues, WriteEachPatchOnce) {
  const PatchPtr patch = patch_from(furnished_room(), PatchId{0}, {});
  const std::vector<PatchPtr> twice = {patch, patch};
  const std::vector<std::uint8_t> once = saved(std::vector<PatchPtr>{patch});
  EXPECT_EQ(saved(twice).size(), once.size() + sizeof(patch->id.value));
  const auto back = restored<std::vector<PatchPtr>>(saved(twice));
  ASSERT_EQ(back.size(), 2U);
  EXPECT_EQ(back[0], back[1]);
  EXPECT_EQ(back[0]->robot, patch->robot);
  EXPECT_EQ(back[0]->scan.ranges_m, patch->scan.ranges_m);
  ASSERT_EQ(back[0]->points.size(), patch->points.size());
  EXPECT_EQ(back[0]->points.back().position, patch->points.back().position);
  EXPECT_EQ(back[0]->star.ranges_m(), patch->star.ranges_m());
  EXPECT_EQ(area_m2(back[0]->free_space), area_m2(patch->free_space));
}

TEST(SnapshotValues, KeepAPatchWithoutAScanAsItWas) {
  auto swept = std::make_shared<Patch>();
  swept->id = PatchId{0};
  swept->tag = 17;
  swept->free_space = Polysolid({PolygonWithHoles{{{0, 0}, {2, 0}, {2, 1}, {0, 1}}, {}}});
  const auto back = restored<PatchPtr>(saved(PatchPtr(swept)));
  EXPECT_EQ(back->tag, 17);
  EXPECT_NEAR(area_m2(back->free_space), 2, 1e-9);
}

}  // namespace
}  // namespace isthmus
