#include "server/exploration/coordinator.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include "server/exploration/clear_way.hpp"
#include "server/exploration/timed_way.hpp"
#include "server/paths/questions/relative_pose.hpp"

namespace isthmus {
namespace {

constexpr double step_s = 0.2;
constexpr double same_way = 0.5;  // the cosine of two headings that are one, and of what lies ahead
constexpr double nearer_m = 0.02;

/// A robot of an island, while rights are given.
struct Member {
  std::string name;
  const Traveller* traveller = nullptr;
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
  TimedWay wanted;
  std::optional<TimedWay> held;         // once it is decided
  std::set<std::string> makes_way_for;  // though it has more right
  std::set<std::string> holds_up;       // those whose way it stands in
};

class IslandTraffic {
 public:
  IslandTraffic(Planner& planner, IslandId island, const CoordinationOptions& options)
      : planner_(planner), island_(island), options_(options) {}

  void add(const std::string& name, const Traveller& traveller) {
    const Eigen::Vector2d at = position(planner_.project(traveller.pose));
    members_.push_back(
        {name, &traveller, at, TimedWay(points_of(at, traveller.path), options_.speed_mps), {}, {}, {}});
  }

  /// By the order in which they were added; that order may change.
  std::map<std::string, Clearance> decide() {
    std::map<std::string, Clearance> clearances;
    const std::size_t max_orders = members_.size() * members_.size();
    first_rights_ = names();
    tried_ = {first_rights_};
    do {
      clearances.clear();
      somebody_is_stuck_ = false;
      for (Member& member : members_) member.held.reset();
    } while (!decide_in_turn(clearances, max_orders));
    return clearances;
  }

  /// From now on. Where no order lets all of them get on, that which there was: else two would take turns in
  /// having the right, and neither would get on.
  std::vector<std::string> rights() const { return somebody_is_stuck_ ? first_rights_ : names(); }

 private:
  std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (const Member& member : members_) names.push_back(member.name);
    return names;
  }

  std::vector<Eigen::Vector2d> points_of(const Eigen::Vector2d& at,
                                         const std::vector<ManifoldPose>& path) const {
    std::vector<Eigen::Vector2d> points{at};
    for (const ManifoldPose& pose : path) points.push_back(position(planner_.project(pose)));
    return points;
  }

  /// False: rights have changed, and all is to be decided again.
  bool decide_in_turn(std::map<std::string, Clearance>& clearances, std::size_t max_orders) {
    for (std::size_t turn = 0; turn < members_.size(); ++turn) {
      Member& member = members_[turn];
      std::optional<Clearance> clearance = clear(member);
      const bool may_change = tried_.size() < max_orders && opened_ < options_.max_squares;
      if (!clearance && may_change && get_right(turn)) return false;
      if (!clearance) {
        somebody_is_stuck_ = true;
        clearance = Clearance{Leave::wait, {}};
      }
      member.held.emplace(points_of(member.at, clearance->path), options_.speed_mps);
      clearances[member.name] = *std::move(clearance);
    }
    return true;
  }

  /// One that cannot make way gets the right of the last of those whose way it is in, behind that one, so
  /// that the others make way for both (priority inheritance, Okumura et al. 2022); where that was tried,
  /// before it, to get out of its way. False: there is no order that was not tried.
  bool get_right(std::size_t turn) {
    std::size_t place = turn;
    while (place > 0 && !is_in_way(members_[turn], members_[turn].at, members_[place - 1], 0)) --place;
    const auto at = [&](std::size_t i) { return members_.begin() + static_cast<std::ptrdiff_t>(i); };
    const std::vector<Member> before = members_;
    for (std::size_t to = std::min(place, turn - 1) + 1; to-- > 0;) {
      for (std::size_t i = to; i < place; ++i) members_[turn].makes_way_for.insert(members_[i].name);
      std::rotate(at(to), at(turn), at(turn) + 1);
      if (tried_.insert(names()).second) return true;
      members_ = before;
    }
    return false;
  }

  /// None: it stands in another's way, and cannot get out of it.
  std::optional<Clearance> clear(Member& member) {
    member.holds_up = held_up_by(member);
    const bool has_to_leave = member.traveller->path.empty() && !is_in_nobodys_way(member, member.at, 0);
    const std::optional<double> met_s = first_meeting_s(member);
    if (!met_s && !has_to_leave) return Clearance{Leave::go, member.traveller->path};
    if (!member.traveller->path.empty()) {
      if (auto detour = way_round(member)) return Clearance{Leave::go, *std::move(detour)};
    }
    if (const auto wait_m = last_clear_m(member, met_s.value_or(0)))
      return Clearance{Leave::wait, cut(member, *wait_m)};
    // Nobody comes past one that stands in its way: as long as that is not gone, it stands as well.
    for (const bool others_stand : {has_to_leave, !has_to_leave})
      if (auto aside = way_aside(member, others_stand)) return Clearance{Leave::give_way, *std::move(aside)};
    return std::nullopt;
  }

  double apart_m(const Member& a, const Member& b) const {
    return a.traveller->footprint.radius_m + b.traveller->footprint.radius_m + options_.margin_m;
  }
  /// The same once two have driven for so long. Those that are nearer now than they may be part: they come no
  /// nearer, and are as far apart as all others in the time in which one robot drives so far.
  double room_m(const Member& a, const Member& b, double driven_s) const {
    const double apart = apart_m(a, b), now = std::min(apart, (a.at - b.at).norm() - nearer_m);
    return now + (apart - now) * std::clamp(driven_s * options_.speed_mps / apart, 0.0, 1.0);
  }

  /// Whether a robot that is at a point at a time, when it has driven for so long, meets one that holds its
  /// way.
  bool meets(const Member& member, const Eigen::Vector2d& point, double time_s, double driven_s,
             const Member& other, double early_s) const {
    return other.held->nearest_m(point, time_s - early_s, time_s + early_s) <
           room_m(member, other, std::max(0.0, driven_s - early_s));
  }

  /// Nobody comes past one that stands in its way: until that is gone, it stands as well.
  bool meets_held_up(const Member& member, const Eigen::Vector2d& point, double driven_s,
                     const Member& other) const {
    return member.holds_up.contains(other.name) &&
           (other.at - point).norm() < room_m(member, other, driven_s);
  }

  /// Whether it drives ahead of the other one, as that does: who comes from behind stops by itself.
  bool leads(const Member& member, double time_s, const Member& other) const {
    const Eigen::Vector2d heading = other.held->heading_at_s(time_s);
    const Eigen::Vector2d ahead = member.wanted.at_s(time_s) - other.held->at_s(time_s);
    return member.wanted.heading_at_s(time_s).dot(heading) > same_way &&
           ahead.dot(heading) > same_way * ahead.norm();
  }

  std::optional<double> first_meeting_s(const Member& member) const {
    for (double time_s = 0; time_s <= options_.horizon_s; time_s += step_s) {
      const Eigen::Vector2d point = member.wanted.at_s(time_s);
      for (const Member& other : members_) {
        if (!other.held) break;
        const double driven_s = std::min(time_s, std::max(member.wanted.end_s(), other.held->end_s()));
        if (!meets(member, point, time_s, driven_s, other, options_.early_s) &&
            !meets_held_up(member, point, driven_s, other))
          continue;
        if (!leads(member, time_s, other)) return time_s;
      }
    }
    return std::nullopt;
  }

  /// Whether a robot that stands at a point is in the way of one that holds its own.
  bool is_in_way(const Member& member, const Eigen::Vector2d& point, const Member& other,
                 double more_m) const {
    const TimedWay& way = other.held ? *other.held : other.wanted;
    const double apart = apart_m(member, other);
    double parted_s = 0;
    if ((point - member.at).norm() <= nearer_m && (other.at - member.at).norm() < apart + nearer_m) {
      for (const double end_s = std::min(way.end_s(), apart / options_.speed_mps); parted_s < end_s;
           parted_s += step_s)
        if ((way.at_s(parted_s) - point).norm() < room_m(member, other, parted_s) + more_m) return true;
      if (way.end_s() <= parted_s)
        return (way.at_s(parted_s) - point).norm() < room_m(member, other, way.end_s()) + more_m;
    }
    return way.nearest_m(point, parted_s, options_.horizon_s) < apart + more_m;
  }

  bool is_in_nobodys_way(const Member& member, const Eigen::Vector2d& point, double more_m) const {
    return std::ranges::none_of(members_, [&](const Member& other) {
      return counts(member, other) && is_in_way(member, point, other, more_m);
    });
  }

  /// Whether a robot keeps out of another's way.
  static bool counts(const Member& member, const Member& other) {
    return other.held || member.makes_way_for.contains(other.name);
  }
  std::set<std::string> held_up_by(const Member& member) const {
    std::set<std::string> names;
    for (const Member& other : members_)
      if (&other != &member && counts(member, other) && is_in_way(member, member.at, other, 0))
        names.insert(other.name);
    return names;
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
    const auto is_barred = [&](const Eigen::Vector2d& point, double along_m) {
      return std::ranges::any_of(members_, [&](const Member& other) {
        return comes_by(member, point, along_m, other) ||
               meets_held_up(member, point, along_m / options_.speed_mps, other);
      });
    };
    const auto is_wanted = [&](SquareId square, const Eigen::Vector2d&) { return square == wanted; };
    return search(*roadmap, member, {is_barred, is_wanted, member.wanted.length_m() + options_.detour_m});
  }

  /// `others_stand`: those whose way it is in stay where they are; else one that is decided drives on, and
  /// one that is not makes way.
  std::optional<std::vector<ManifoldPose>> way_aside(const Member& member, bool others_stand) {
    const auto roadmap = planner_.roadmap(island_, member.traveller->footprint);
    if (!roadmap) return std::nullopt;
    const auto is_aside = [&](SquareId, const Eigen::Vector2d& point) {
      if (!is_in_nobodys_way(member, point, options_.aside_m)) return false;
      return std::ranges::all_of(members_, [&](const Member& other) {
        return &other == &member || (other.at - point).norm() >= apart_m(member, other);
      });
    };
    const auto is_barred = [&](const Eigen::Vector2d& point, double along_m) {
      return std::ranges::any_of(members_, [&](const Member& other) {
        if (!others_stand || !member.holds_up.contains(other.name))
          return comes_by(member, point, along_m, other);
        return meets_held_up(member, point, along_m / options_.speed_mps, other);
      });
    };
    return search(*roadmap, member, {is_barred, is_aside, options_.max_aside_m});
  }

  /// Whether one that is decided is at a point when a robot comes there.
  bool comes_by(const Member& member, const Eigen::Vector2d& point, double along_m,
                const Member& other) const {
    const double time_s = along_m / options_.speed_mps;
    return other.held && meets(member, point, time_s, time_s, other, 0);
  }

  std::optional<std::vector<ManifoldPose>> search(const Roadmap& roadmap, const Member& member,
                                                  const WayWanted& wanted) {
    const NodeId from = planner_.room_near(roadmap, member.traveller->pose, PathQuestion{}.start_tolerance_m);
    if (from < 0) return std::nullopt;
    const std::vector<NodeId> way = find_clear_way(roadmap, from, wanted, opened_);
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
  std::vector<std::string> first_rights_;
  std::set<std::vector<std::string>> tried_;  // orders
  bool somebody_is_stuck_ = false;
  std::size_t opened_ = 0;  // squares that searches for ways looked at
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
