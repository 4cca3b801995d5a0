#include "server/engine/rendezvous/rendezvous.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace isthmus {
namespace {

const UndecidedHypothesis* find(std::span<const UndecidedHypothesis> undecided, ClosureId id) {
  const auto found = std::ranges::find(undecided, id, &UndecidedHypothesis::id);
  return found == undecided.end() ? nullptr : &*found;
}

bool is_on_island(const Map& map, const std::map<std::string, Robot>& robots, const MeetingPlace& place) {
  const auto robot = robots.find(place.robot);
  return robot != robots.end() && robot->second.place &&
         map.graph().island(robot->second.place->pose.patch) == map.graph().island(place.pose.patch);
}

// The nearest hit along the beams that would meet a disc of this radius around a point of the robot's frame;
// nothing where no beam looks there. A beam without a return met nothing.
std::optional<double> nearest_hit_m(const Scan& scan, const Laser& laser, const Eigen::Vector2d& point,
                                    double radius_m) {
  const Eigen::Vector2d seen = inverse(laser.robot_from_laser) * point;
  const double half_rad = std::asin(std::min(1.0, radius_m / std::max(radius_m, seen.norm())));
  const double bearing = std::atan2(seen.y(), seen.x());
  std::optional<double> nearest;
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const double off = scan.bearing0_rad + static_cast<double>(i) * scan.bearing_step_rad - bearing;
    if (std::abs(wrap_angle(off)) > std::max(half_rad, std::abs(scan.bearing_step_rad))) continue;
    const BeamKind kind = classify(scan.ranges_m[i], laser);
    if (kind == BeamKind::ignored) continue;
    const double range_m = kind == BeamKind::hit ? static_cast<double>(scan.ranges_m[i])
                                                 : std::numeric_limits<double>::infinity();
    nearest = std::min(nearest.value_or(range_m), range_m);
  }
  return nearest;
}

}  // namespace

bool watches_for_the_other(const Map& map, const std::map<std::string, Robot>& robots,
                           const MeetingPlan& meeting, const std::string& robot, const Scan& scan,
                           const RendezvousOptions& options) {
  if (!is_on_island(map, robots, meeting.a) || !is_on_island(map, robots, meeting.b)) return false;
  const bool is_a = robot == meeting.a.robot;
  const MeetingPlace &own = is_a ? meeting.a : meeting.b, &others = is_a ? meeting.b : meeting.a;
  const Robot &watcher = robots.at(own.robot), &other = robots.at(others.robot);
  const Pose own_map = map.manifold().project(watcher.place->pose);
  if ((position(own_map) - position(map.manifold().project(own.pose))).norm() > options.in_place_m)
    return false;

  const Pose first_from_second = first_map_from_second_map(map, meeting.hypothesis);
  const Pose own_from_others = is_a ? first_from_second : inverse(first_from_second);
  const Eigen::Vector2d expected =
      inverse(own_map) * position(own_from_others * map.manifold().project(other.place->pose));
  const double distance_m = expected.norm();
  if (distance_m < options.min_distance_m ||
      std::abs(std::atan2(expected.y(), expected.x())) > options.facing_rad)
    return false;
  const double radius_m = other.declaration.footprint_radius_m;
  const Laser& laser = watcher.declaration.laser;
  const double seen_m = options.seen_share * radius_m;
  const auto hit_m = nearest_hit_m(scan, laser, expected, seen_m);
  const double from_laser_m = (inverse(laser.robot_from_laser) * expected).norm();
  // What ends there may be the other robot, its barcode unread.
  return hit_m && *hit_m > from_laser_m + seen_m;
}

void Rendezvous::choose(const Map& map, const std::map<std::string, Robot>& robots,
                        std::span<const UndecidedHypothesis> undecided, std::int64_t now_utime,
                        const EngineOptions& options) {
  const RendezvousOptions& its = options.rendezvous;
  next_choice_utime_ = now_utime + its.choice_interval_us;
  double kept_value = 0;
  if (meeting_) {
    const UndecidedHypothesis* still = find(undecided, meeting_->hypothesis.id);
    const bool stands = still != nullptr && is_on_island(map, robots, meeting_->a) &&
                        is_on_island(map, robots, meeting_->b) &&
                        map.graph().island(still->first) != map.graph().island(still->second);
    if (stands) {
      meeting_->hypothesis.value = kept_value = still->value;
    } else {
      meeting_.reset();
      watch_ = {};
    }
  }
  std::vector<UndecidedHypothesis> by_value(undecided.begin(), undecided.end());
  std::ranges::stable_sort(by_value, [](const auto& x, const auto& y) {
    return x.value != y.value ? x.value > y.value : x.id.value < y.id.value;
  });
  int plans = 0;
  for (const UndecidedHypothesis& hypothesis : by_value) {
    if (meeting_ && hypothesis.value <= its.worth_turning_for * kept_value) return;
    if (meeting_ && hypothesis.id == meeting_->hypothesis.id) continue;
    if (plans++ == its.max_plans) break;
    std::optional<MeetingPlan> planned = plan_meeting(map, robots, hypothesis, options.meeting);
    if (!planned) continue;
    meeting_ = std::move(planned);
    watch_ = {};
    return;
  }
  if (plans > 0) next_choice_utime_ = now_utime + its.retry_interval_us;
}

std::optional<ClosureId> Rendezvous::take_scan(const Map& map, const std::map<std::string, Robot>& robots,
                                               const std::string& robot, const Scan& scan,
                                               std::int64_t now_utime, const RendezvousOptions& options) {
  if (!meeting_ || (robot != meeting_->a.robot && robot != meeting_->b.robot)) return std::nullopt;
  Watch& watch = watch_[robot == meeting_->a.robot ? 0 : 1];
  if (!watches_for_the_other(map, robots, *meeting_, robot, scan, options)) {
    watch = {};
    return std::nullopt;
  }
  if (watch.since_utime == 0 || now_utime - watch.last_utime > options.max_gap_us)
    watch.since_utime = now_utime;
  watch.last_utime = now_utime;
  const bool both = std::ranges::all_of(watch_, [&](const Watch& one) {
    return one.since_utime != 0 && now_utime - one.last_utime <= options.max_gap_us &&
           now_utime - one.since_utime >= options.watch_us;
  });
  if (!both) return std::nullopt;
  const ClosureId refuted = meeting_->hypothesis.id;
  meeting_.reset();
  watch_ = {};
  next_choice_utime_ = 0;
  return refuted;
}

std::optional<MeetingRecord> Rendezvous::record() const {
  if (!meeting_) return std::nullopt;
  return MeetingRecord{meeting_->hypothesis.id, meeting_->a, meeting_->b};
}

void Rendezvous::take_sighting(const std::string& observer, const std::string& target) {
  if (!meeting_) return;
  const std::string &a = meeting_->a.robot, &b = meeting_->b.robot;
  if ((observer == a && target == b) || (observer == b && target == a)) watch_ = {};
}

}  // namespace isthmus
