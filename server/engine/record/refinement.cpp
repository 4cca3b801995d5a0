#include "server/engine/record/refinement.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "scanmatch/match.hpp"
#include "server/engine/map/surroundings.hpp"
#include "server/engine/record/bridge.hpp"

namespace isthmus {
Refinement::Refinement(const MapCopy& map, const Configuration& configuration)
    : configuration_(configuration) {
  for (const auto& [name, robot] : configuration_.robots) lasers_[name] = robot.robot.laser;
  for (std::size_t i = 0; i < map.patches.size(); ++i) map_.add(map.patches[i], map.poses[i]);
  for (const auto& [id, relation] : map.graph.relations()) map_.relate(relation);
  rows_ = map.trajectory->read(0, map.trajectory_rows);
  for (std::size_t i = 0; i < rows_.size(); ++i)
    row_of_[{map.sessions[static_cast<std::size_t>(rows_[i].session)].robot, rows_[i].utime}] = i;
  matched_.resize(rows_.size());
  odom_from_robot_.resize(rows_.size());
}

void Refinement::take(const Event& event) {
  if (const auto* robot = std::get_if<RobotEvent>(&event.body)) take(*robot);
  if (const auto* odometry = std::get_if<OdometryEvent>(&event.body)) take(*odometry);
  if (const auto* scan = std::get_if<ScanEvent>(&event.body)) take(*scan);
}

// What the configuration says of a robot stands against what the robot says.
void Refinement::take(const RobotEvent& robot) {
  const auto configured = configuration_.robots.find(robot.robot);
  if (configured == configuration_.robots.end() || !configured->second.declared)
    lasers_[robot.robot] = robot.laser;
}

void Refinement::take(const OdometryEvent& odometry) {
  OdometryTrack& track = odometry_[odometry.robot];
  track.add(odometry.utime, odometry.odom_from_robot);
  std::erase_if(untold_[odometry.robot], [&](std::size_t row) {
    odom_from_robot_[row] = track.at(rows_[row].utime);
    return track.newest_utime() >= rows_[row].utime;
  });
}

const std::vector<LocalPatch>& Refinement::well_determined_around(PatchId patch) {
  const auto [found, is_new] = well_determined_.try_emplace(patch);
  if (!is_new) return found->second;
  Surroundings surroundings;
  surroundings.update(map_, patch, options_, Surroundings::By::scans);
  for (const Determined& determined : surroundings.patches()) {
    const bool far = std::hypot(determined.local_from_patch.x, determined.local_from_patch.y) >
                     2 * options_.surroundings.reach_m;
    if (determined.well_determined && !far)
      found->second.push_back({map_.manifold().shared_patch(determined.patch), determined.local_from_patch});
  }
  return found->second;
}

LocalMap Refinement::local_map(const TrajectoryRow& row, std::span<const ScanPoint> points) {
  struct Near {
    LocalPatch patch;
    double distance_m;
  };
  std::vector<Near> near;
  for (const LocalPatch& local : well_determined_around(row.patch)) {
    const Pose patch_from_robot = ominus(row.patch_from_robot, local.local_from_patch);
    const double distance_m = std::hypot(patch_from_robot.x, patch_from_robot.y);
    if (distance_m > options_.surroundings.reach_m) continue;
    if (overlap_share(*local.patch, patch_from_robot, points, options_.surroundings) <
        options_.surroundings.min_overlap)
      continue;
    near.push_back({local, distance_m});
  }
  std::ranges::stable_sort(near, {}, &Near::distance_m);
  // The nearest, as none is newer than another here.
  if (near.size() > options_.surroundings.max_patches()) near.resize(options_.surroundings.max_patches());
  LocalMap local;
  local.reference = row.patch;
  for (const Near& n : near) local.patches.push_back(n.patch);
  return local;
}

void Refinement::take(const ScanEvent& scan) {
  const auto row_number = row_of_.find({scan.robot, scan.scan.utime});
  const auto laser = lasers_.find(scan.robot);
  if (row_number == row_of_.end() || laser == lasers_.end()) return;
  const std::size_t row = row_number->second;
  if (!(odom_from_robot_[row] = odometry_[scan.robot].at(scan.scan.utime)))
    untold_[scan.robot].push_back(row);
  const auto lies_at = match(to_points(scan.scan, laser->second, options_.patch.normals), rows_[row]);
  if (!lies_at) return;
  rows_[row].patch_from_robot = *lies_at;
  matched_[row] = true;
  ++refined_;
}

std::optional<Pose> Refinement::match(std::span<const ScanPoint> points, const TrajectoryRow& row) {
  if (static_cast<int>(points.size()) < options_.match.min_pairs) return std::nullopt;
  const LocalMap local = local_map(row, points);
  if (local.patches.empty()) return std::nullopt;
  MatchOptions match_options = options_.match;
  const RefinementOptions& its = options_.refinement;
  // The scan lies nearly right.
  match_options.start_kernel_m = options_.weak_direction.start_kernels * match_options.kernel_m;
  match_options.max_points = std::numeric_limits<int>::max();
  Prediction carried{row.patch_from_robot, Eigen::Matrix3d::Zero()};
  const double off_m = its.carried_sigma_m;
  carried.information.diagonal() =
      Eigen::Vector3d(off_m, off_m, options_.common.yaw_rad(off_m)).cwiseAbs2().cwiseInverse();
  const Match match = match_scan(local, points, carried, match_options);
  if (!match.ok || match.quality.score < options_.localise.min_score) return std::nullopt;
  return match.local_from_robot;
}

Pose Refinement::map_from_robot(std::size_t row) const {
  return map_.manifold().pose(rows_[row].patch) * rows_[row].patch_from_robot;
}

void Refinement::bridge_gaps() {
  std::map<std::int32_t, std::vector<std::size_t>> sessions;
  for (std::size_t row = 0; row < rows_.size(); ++row) sessions[rows_[row].session].push_back(row);
  for (auto& [session, rows] : sessions) {
    std::ranges::stable_sort(rows, {}, [&](std::size_t row) { return rows_[row].utime; });
    std::optional<std::size_t> last;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (!matched_[rows[i]]) continue;
      if (last && i > *last + 1) bridge_gap(std::span(rows).subspan(*last, i - *last + 1));
      last = i;
    }
  }
}

// Between two that are not matched, as the engine had them: it knows more of odometry's errors than one step
// tells.
void Refinement::bridge_gap(std::span<const std::size_t> rows) {
  const IslandId island = map_.graph().island(rows_[rows.front()].patch);
  std::vector<Pose> steps;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    if (map_.graph().island(rows_[rows[i]].patch) != island) return;
    const bool is_end = i == 1 || i + 1 == rows.size();
    const std::optional<Pose>&from = odom_from_robot_[rows[i - 1]], &to = odom_from_robot_[rows[i]];
    if (is_end && !(from && to)) return;
    steps.push_back(is_end ? ominus(*to, *from)
                           : ominus(map_from_robot(rows[i]), map_from_robot(rows[i - 1])));
  }
  const std::vector<Pose> poses =
      bridge(map_from_robot(rows.front()), steps, map_from_robot(rows.back()), options_.odometry_noise);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    TrajectoryRow& row = rows_[rows[i + 1]];
    row.patch_from_robot = ominus(poses[i], map_.manifold().pose(row.patch));
  }
}

std::shared_ptr<const TrajectoryStore> Refinement::finish() {
  bridge_gaps();
  auto store = std::make_shared<TrajectoryStore>();
  for (const TrajectoryRow& row : rows_) store->append(row);
  store->flush();
  return store;
}

}  // namespace isthmus
