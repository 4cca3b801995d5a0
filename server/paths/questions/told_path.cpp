#include "server/paths/questions/told_path.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "patches/segment.hpp"
#include "server/paths/questions/relative_pose.hpp"

namespace isthmus {
namespace {

/// What is left of a path: the robot, then the places that it comes to.
struct Rest {
  std::vector<Eigen::Vector2d> points;
  std::size_t next = 0;  ///< of the path's places: the second point
};

class Comparison {
 public:
  Comparison(Planner& planner, const ToldPath& told, const PathNow& now)
      : planner_(planner), told_(told), now_(now), robot_(position(planner.project(now.robot))) {
    for (const ManifoldPose& pose : told.poses) points_.push_back(position(planner.project(pose)));
  }

  PathChange change() const {
    const Rest rest = rest_of();
    if (now_.drives && (robot_ - points_.back()).norm() <= ToldPath::at_end_m) return PathChange::arrived;
    if (now_.path.refusal != Refusal::none || is_blocked(rest)) return PathChange::blocked;
    const Eigen::Vector2d end = position(planner_.project(now_.path.poses.back()));
    if ((end - points_.back()).norm() > ToldPath::at_end_m) return PathChange::target_moved;
    for (std::size_t i = rest.next; i < points_.size(); ++i)
      if ((points_[i] - told_.map_points[i]).norm() > ToldPath::moved_m) return PathChange::moved;
    const double longest_m = ToldPath::longest_share * now_.path.length_m + ToldPath::at_end_m;
    return length_m(rest) > longest_m ? PathChange::shortened : PathChange::none;
  }

 private:
  /// From where the robot is nearest to the path, on a stretch whose patches are near its own along
  /// relations: where a path lies over itself the other stretch is none of it.
  Rest rest_of() const {
    Rest rest{{robot_}, 0};
    if (now_.drives) {
      double least_m = std::numeric_limits<double>::infinity();
      for (std::size_t i = 1; i < points_.size(); ++i) {
        const double apart_m = distance_to_segment_m(robot_, points_[i - 1], points_[i]);
        if (!(apart_m < least_m) || !planner_.near().near(now_.robot.patch, told_.poses[i].patch)) continue;
        least_m = apart_m;
        rest.next = i;
      }
    }
    rest.points.insert(rest.points.end(), points_.begin() + static_cast<std::ptrdiff_t>(rest.next),
                       points_.end());
    return rest;
  }

  static double length_m(const Rest& rest) {
    double length = 0;
    for (std::size_t i = 1; i < rest.points.size(); ++i)
      length += (rest.points[i] - rest.points[i - 1]).norm();
    return length;
  }

  bool is_blocked(const Rest& rest) const {
    if (!now_.over_ground) return false;
    const IslandId island = planner_.map().graph.island(now_.robot.patch);
    const auto roadmap = planner_.roadmap(island, now_.footprint);
    if (!roadmap) return true;
    for (std::size_t i = 1; i < rest.points.size(); ++i) {
      const PatchId patch = told_.poses[rest.next + i - 1].patch;
      if (planner_.map().graph.island(patch) != island) return true;
      if (!fits_along(*roadmap, rest.points[i - 1], rest.points[i], patch)) return true;
    }
    return false;
  }

  /// A robot that stands closer to something than asked leaves it first.
  bool fits_along(const Roadmap& roadmap, const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                  PatchId patch) const {
    const double within_m = now_.footprint.clearance_m + ground_cell_m;
    const int steps = static_cast<int>(std::ceil((to - from).norm() / ground_cell_m));
    for (int step = 1; step <= steps; ++step) {
      const Eigen::Vector2d point = from + (to - from) * (static_cast<double>(step) / steps);
      if ((point - robot_).norm() <= PathQuestion{}.start_tolerance_m) continue;
      const NodeId node = roadmap.ground().find(cell_of(point), patch);
      if (node >= 0 && roadmap.fits(node)) continue;
      const Pose& map_from_patch = planner_.map().poses[static_cast<std::size_t>(patch.value)];
      const ManifoldPose at{patch, ominus({point.x(), point.y(), 0}, map_from_patch)};
      if (planner_.room_near(roadmap, at, within_m) < 0) return false;
    }
    return true;
  }

  Planner& planner_;
  const ToldPath& told_;
  const PathNow& now_;
  Eigen::Vector2d robot_;
  std::vector<Eigen::Vector2d> points_;  // of the told path, as the map is now
};

}  // namespace

PathChange change_of(Planner& planner, const ToldPath& told, const PathNow& now) {
  const bool there_is = now.path.refusal == Refusal::none;
  if (told.poses.empty()) return there_is ? PathChange::opened : PathChange::none;
  if (!there_is && check(planner.map(), now.robot) != Refusal::none) return PathChange::blocked;
  const bool on_map = std::ranges::all_of(
      told.poses, [&](const ManifoldPose& pose) { return check(planner.map(), pose) == Refusal::none; });
  return on_map ? Comparison(planner, told, now).change() : PathChange::blocked;
}

}  // namespace isthmus
