#include "server/exploration/coordinator.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "server/exploration/clear_way.hpp"
#include "server/exploration/timed_way.hpp"
#include "server/paths/questions/relative_pose.hpp"

namespace isthmus {
namespace {

constexpr double step_s = 0.2;
constexpr double same_way = 0.5;  // the cosine of two headings that are one
constexpr double nearer_m = 0.02;
constexpr double leaving_s = 3;  // two that are near one another are given so long to part

/// A robot of an island, while rights are given.
struct Member {
  std::string name;
  const Traveller* traveller = nullptr;
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
  TimedWay wanted;
  std::optional<TimedWay> held;  // once it is decided
};

class IslandTraffic {
 public:
  IslandTraffic(Planner& planner, IslandId island, const CoordinationOptions& options)
      : planner_(planner), island_(island), options_(options) {}

  void add(const std::string& name, const Traveller& traveller) {
    const Eigen::Vector2d at = position(planner_.project(traveller.pose));
    members_.push_back(
        {name, &traveller, at, TimedWay(points_of(at, traveller.path), options_.speed_mps), {}});
  }

  /// By the order in which they were added; that order may change.
  std::map<std::string, Clearance> decide() {
    std::map<std::string, Clearance> clearances;
    const std::size_t max_changes = members_.size() * members_.size();
    for (std::size_t changes = 0;; ++changes) {
      clearances.clear();
      for (Member& member : members_) member.held.reset();
      if (!decide_in_turn(clearances, changes < max_changes)) return clearances;
    }
  }

  std::vector<std::string> rights() const {
    std::vector<std::string> names;
    for (const Member& member : members_) names.push_back(member.name);
    return names;
  }

 private:
  std::vector<Eigen::Vector2d> points_of(const Eigen::Vector2d& at,
                                         const std::vector<ManifoldPose>& path) const {
    std::vector<Eigen::Vector2d> points{at};
    for (const ManifoldPose& pose : path) points.push_back(position(planner_.project(pose)));
    return points;
  }

  /// True: rights have changed, and all is to be decided again.
  bool decide_in_turn(std::map<std::string, Clearance>& clearances, bool may_change) {
    for (std::size_t turn = 0; turn < members_.size(); ++turn) {
      Member& member = members_[turn];
      std::size_t barred = turn;  // whose way it is in
      std::optional<Clearance> clearance = clear(member, barred);
      if (!clearance && may_change && barred < turn) {
        std::rotate(members_.begin() + static_cast<std::ptrdiff_t>(barred),
                    members_.begin() + static_cast<std::ptrdiff_t>(turn),
                    members_.begin() + static_cast<std::ptrdiff_t>(turn) + 1);
        return true;
      }
      if (!clearance) clearance = Clearance{Leave::wait, {}};
      member.held.emplace(points_of(member.at, clearance->path), options_.speed_mps);
      clearances[member.name] = *std::move(clearance);
    }
    return false;
  }

  std::optional<Clearance> clear(const Member& member, std::size_t& barred) {
    const std::optional<double> met_s = first_meeting_s(member);
    if (!met_s) return Clearance{Leave::go, member.traveller->path};
    if (!member.traveller->path.empty()) {
      if (auto detour = way_round(member)) return Clearance{Leave::go, *std::move(detour)};
    }
    if (const auto wait_m = last_clear_m(member, *met_s)) return Clearance{Leave::wait, cut(member, *wait_m)};
    if (auto aside = way_aside(member)) return Clearance{Leave::give_way, *std::move(aside)};
    for (std::size_t i = 0; i < members_.size() && members_[i].held; ++i)
      if (may_pass(member, members_[i]) && is_in_way(member, member.at, members_[i], 0))
        barred = std::min(barred, i);
    return std::nullopt;
  }

  /// Nobody gets more right than one that has a goal by having none.
  static bool may_pass(const Member& member, const Member& other) {
    return !member.traveller->path.empty() || other.traveller->path.empty();
  }

  double apart_m(const Member& a, const Member& b) const {
    return a.traveller->footprint.radius_m + b.traveller->footprint.radius_m + options_.margin_m;
  }
  /// The same, but that two that are nearer now need at first only not come nearer still.
  double room_m(const Member& a, const Member& b, double time_s) const {
    const double apart = apart_m(a, b);
    return time_s > leaving_s ? apart : std::min(apart, (a.at - b.at).norm() - nearer_m);
  }

  /// Whether a robot that is at a point at a time meets one that holds its way.
  bool meets(const Member& member, const Eigen::Vector2d& point, double time_s, const Member& other,
             double early_s) const {
    return other.held->nearest_m(point, time_s - early_s, time_s + early_s) < room_m(member, other, time_s);
  }

  /// Whether it drives ahead of the other one, as that does: who comes from behind stops by itself.
  bool leads(const Member& member, double time_s, const Member& other) const {
    const Eigen::Vector2d heading = other.held->heading_at_s(time_s);
    return member.wanted.heading_at_s(time_s).dot(heading) > same_way &&
           (member.wanted.at_s(time_s) - other.held->at_s(time_s)).dot(heading) > 0;
  }

  std::optional<double> first_meeting_s(const Member& member) const {
    for (double time_s = 0; time_s <= options_.horizon_s; time_s += step_s) {
      const Eigen::Vector2d point = member.wanted.at_s(time_s);
      for (const Member& other : members_) {
        if (!other.held) break;
        if (meets(member, point, time_s, other, options_.early_s) && !leads(member, time_s, other))
          return time_s;
      }
    }
    return std::nullopt;
  }

  /// Whether a robot that stands at a point is in the way of one that holds its own.
  bool is_in_way(const Member& member, const Eigen::Vector2d& point, const Member& other,
                 double more_m) const {
    const double room =
        (point - member.at).norm() > nearer_m ? apart_m(member, other) : room_m(member, other, 0);
    return other.held->nearest_m(point, 0, options_.horizon_s) < room + more_m;
  }

  bool is_in_nobodys_way(const Member& member, const Eigen::Vector2d& point, double more_m) const {
    for (const Member& other : members_)
      if (other.held && is_in_way(member, point, other, more_m)) return false;
    return true;
  }

  /// How far along its way it may come and wait there before it meets somebody.
  std::optional<double> last_clear_m(const Member& member, double met_s) const {
    for (double time_s = met_s; time_s >= 0; time_s -= step_s)
      if (is_in_nobodys_way(member, member.wanted.at_s(time_s), 0)) return time_s * options_.speed_mps;
    return is_in_nobodys_way(member, member.at, 0) ? std::optional<double>(0) : std::nullopt;
  }

  std::vector<ManifoldPose> cut(const Member& member, double along_m) const {
    const std::vector<ManifoldPose>& path = member.traveller->path;
    // The way's first point is where the robot is.
    const std::size_t before = std::min(member.wanted.point_before(along_m), path.size());
    std::vector<ManifoldPose> left(path.begin(), path.begin() + static_cast<std::ptrdiff_t>(before));
    if (before == path.size()) return left;
    const Eigen::Vector2d end = member.wanted.at_m(along_m);
    if ((end - member.at).norm() < nearer_m) return {};
    const ManifoldPose& next = path[before];
    left.push_back({next.patch, ominus({end.x(), end.y(), planner_.project(next).yaw}, frame(next.patch))});
    return left;
  }

  const Pose& frame(PatchId patch) const {
    return planner_.map().poses[static_cast<std::size_t>(patch.value)];
  }

  std::optional<std::vector<ManifoldPose>> way_round(const Member& member) {
    const auto roadmap = planner_.roadmap(island_, member.traveller->footprint);
    const NodeId goal =
        roadmap ? planner_.room_near(*roadmap, member.traveller->path.back(), PathQuestion{}.goal_tolerance_m)
                : -1;
    if (goal < 0) return std::nullopt;
    const SquareId wanted = roadmap->square(goal);
    return search(
        *roadmap, member, [&](SquareId square, const Eigen::Vector2d&) { return square == wanted; },
        member.wanted.length_m() + options_.detour_m);
  }

  std::optional<std::vector<ManifoldPose>> way_aside(const Member& member) {
    const auto roadmap = planner_.roadmap(island_, member.traveller->footprint);
    if (!roadmap) return std::nullopt;
    const auto is_aside = [&](SquareId, const Eigen::Vector2d& point) {
      if (!is_in_nobodys_way(member, point, options_.aside_m)) return false;
      return std::ranges::all_of(members_, [&](const Member& other) {
        return &other == &member || (other.at - point).norm() >= apart_m(member, other);
      });
    };
    return search(*roadmap, member, is_aside, options_.max_aside_m);
  }

  std::optional<std::vector<ManifoldPose>> search(
      const Roadmap& roadmap, const Member& member,
      const std::function<bool(SquareId, const Eigen::Vector2d&)>& is_wanted, double max_m) const {
    const NodeId from = planner_.room_near(roadmap, member.traveller->pose, PathQuestion{}.start_tolerance_m);
    if (from < 0) return std::nullopt;
    const auto is_barred = [&](const Eigen::Vector2d& point, double along_m) {
      return std::ranges::any_of(members_, [&](const Member& other) {
        return other.held && meets(member, point, along_m / options_.speed_mps, other, 0);
      });
    };
    const std::vector<NodeId> way = find_clear_way(roadmap, from, {is_barred, is_wanted, max_m});
    if (way.empty()) return std::nullopt;
    return poses_of(roadmap, member, way);
  }

  std::vector<ManifoldPose> poses_of(const Roadmap& roadmap, const Member& member,
                                     const std::vector<NodeId>& way) const {
    std::vector<ManifoldPose> poses;
    Eigen::Vector2d at = member.at;
    for (const NodeId node : way) {
      const Eigen::Vector2d point = roadmap.ground().centre(node), by = point - at;
      const PatchId leader = roadmap.ground().layer(node).leader;
      const double yaw =
          by.norm() > 0 ? std::atan2(by.y(), by.x()) : planner_.project(member.traveller->pose).yaw;
      poses.push_back({leader, ominus({point.x(), point.y(), yaw}, frame(leader))});
      at = point;
    }
    return poses;
  }

  Planner& planner_;
  IslandId island_;
  const CoordinationOptions& options_;
  std::vector<Member> members_;  // by right
};

}  // namespace

std::map<std::string, Clearance> Coordinator::coordinate(Planner& planner,
                                                         const std::map<std::string, Traveller>& team) {
  for (const auto& [name, traveller] : team)
    if (std::ranges::find(rights_, name) == rights_.end()) rights_.push_back(name);
  std::erase_if(rights_, [&](const std::string& name) { return !team.contains(name); });
  std::stable_partition(rights_.begin(), rights_.end(),
                        [&](const std::string& name) { return !team.at(name).path.empty(); });
  std::map<IslandId, IslandTraffic> islands;
  for (const std::string& name : rights_) {
    const Traveller& traveller = team.at(name);
    if (check(planner.map(), traveller.pose) != Refusal::none) continue;
    const IslandId island = planner.map().graph.island(traveller.pose.patch);
    islands.try_emplace(island, planner, island, options_).first->second.add(name, traveller);
  }
  std::map<std::string, Clearance> clearances;
  std::vector<std::string> rights;
  for (auto& [island, traffic] : islands) {
    clearances.merge(traffic.decide());
    for (std::string& name : traffic.rights()) rights.push_back(std::move(name));
  }
  for (std::string& name : rights_)
    if (std::ranges::find(rights, name) == rights.end()) rights.push_back(std::move(name));
  rights_ = std::move(rights);
  return clearances;
}

}  // namespace isthmus
