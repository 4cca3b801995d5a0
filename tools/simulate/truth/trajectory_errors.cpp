#include "tools/simulate/truth/trajectory_errors.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "server/output/tables/trajectories.hpp"

namespace isthmus {
namespace {

constexpr std::int64_t nearest_us = 100'000;  // from a relation's stamp to a pose

}  // namespace

TrajectoryErrors::TrajectoryErrors(const MapCopy& map) {
  for_each_row(map, [&](const ProjectedRow& row) {
    rows_[row.session.robot].push_back({row.utime, map.graph.island(row.patch), row.map_from_robot});
  });
  for (auto& [robot, rows] : rows_) std::ranges::stable_sort(rows, {}, &Row::utime);
}

std::optional<double> TrajectoryErrors::error_m(const ScanRelation& relation) const {
  const Row *a = nearest(relation.robot1, relation.utime1), *b = nearest(relation.robot2, relation.utime2);
  if (a == nullptr || b == nullptr || a->island != b->island) return std::nullopt;
  const Pose estimate = ominus(b->map_from_robot, a->map_from_robot);
  return std::hypot(estimate.x - relation.pose.x, estimate.y - relation.pose.y);
}

std::optional<IslandId> TrajectoryErrors::island(const std::string& robot, std::int64_t utime) const {
  const Row* row = nearest(robot, utime);
  return row == nullptr ? std::nullopt : std::optional(row->island);
}

const TrajectoryErrors::Row* TrajectoryErrors::nearest(const std::string& robot, std::int64_t utime) const {
  const auto rows = rows_.find(robot);
  if (rows == rows_.end()) return nullptr;
  auto at = std::ranges::lower_bound(rows->second, utime, {}, &Row::utime);
  if (at == rows->second.end() ||
      (at != rows->second.begin() && utime - std::prev(at)->utime <= at->utime - utime)) {
    --at;
  }
  return std::abs(at->utime - utime) <= nearest_us ? &*at : nullptr;
}

}  // namespace isthmus
