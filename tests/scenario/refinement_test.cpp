// The last pass over a log: every scan matched with the map as it is at the end.

#include "server/engine/record/refinement.hpp"

#include <Eigen/Core>

#include "tests/scenario/simulated_maps.hpp"

namespace isthmus {
namespace {

/// What one match tells of turns is as good as it gets in a bare hall: no more than chance makes of it.
constexpr double not_worse = 1.02;

class Refined : public testing::Test {
 protected:
  static SimulatedMap refined(const SimulatedMap& mapped) {
    Refinement refinement(mapped.map, Configuration{});
    for (const Event& event : mapped.run.events) refinement.take(event);
    SimulatedMap result = mapped;
    result.map.trajectory = refinement.finish();
    EXPECT_EQ(result.map.trajectory->size(), mapped.map.trajectory_rows) << "no row is lost or made";
    return result;
  }

  const SimulatedMap mapped_ = map_scenario("hall", {"laps=2"});
};

TEST_F(Refined, TrajectoryIsNotWorseAndTheMapIsTheSame) {
  Eigen::Vector2d before(0, 0), after(0, 0);
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const SimulatedMap mapped = map_scenario("hall", {"laps=2"}, seed);
    const SimulatedMap again = refined(mapped);
    const TrajectoryError error_before = judge_trajectories(mapped);
    const TrajectoryError error_after = judge_trajectories(again);
    std::printf("mean error %.4f m, %.5f rad before, %.4f m, %.5f rad after\n", error_before.mean_m,
                error_before.mean_rad, error_after.mean_m, error_after.mean_rad);
    ASSERT_GT(error_after.relations, 100U);
    EXPECT_EQ(error_after.missing, error_before.missing);
    EXPECT_EQ(map_sha256(again.map), map_sha256(mapped.map));
    before += Eigen::Vector2d(error_before.mean_m, error_before.mean_rad);
    after += Eigen::Vector2d(error_after.mean_m, error_after.mean_rad);
  }
  EXPECT_LT(after.x(), before.x());
  EXPECT_LT(after.y(), not_worse * before.y());
}

TEST_F(Refined, RowsMovedOffTheirPlaceComeBack) {
  SimulatedMap moved = mapped_;
  auto store = std::make_shared<TrajectoryStore>();
  for (TrajectoryRow row : mapped_.map.trajectory->read(0, mapped_.map.trajectory_rows)) {
    row.patch_from_robot = row.patch_from_robot * Pose{0.05, -0.04, 0.02};
    store->append(row);
  }
  store->flush();
  moved.map.trajectory = store;
  const SimulatedMap back = refined(moved);
  const std::vector<TrajectoryRow> rows = back.map.trajectory->read(0, back.map.trajectory_rows);
  const std::vector<TrajectoryRow> were = mapped_.map.trajectory->read(0, mapped_.map.trajectory_rows);
  std::size_t near = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Pose off = ominus(rows[i].patch_from_robot, were[i].patch_from_robot);
    near += std::hypot(off.x, off.y) < 0.03 && std::abs(off.yaw) < 0.01;
  }
  EXPECT_GT(near, rows.size() * 95 / 100);
}

TEST_F(Refined, SameEventsGiveTheSameTrajectory) {
  const auto first = refined(mapped_).map, second = refined(mapped_).map;
  const auto a = first.trajectory->read(0, first.trajectory_rows);
  const auto b = second.trajectory->read(0, second.trajectory_rows);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(to_vector(a[i].patch_from_robot), to_vector(b[i].patch_from_robot));
  }
}

}  // namespace
}  // namespace isthmus
