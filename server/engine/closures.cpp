#include "server/engine/closures.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "relations/confidence.hpp"

namespace isthmus {
namespace {

constexpr std::int64_t placing_wait_us = 2'000'000;  // FORMATS.md: a sighting waits so long for odometry
constexpr int near_hops = 3;                         // so near in the graph, the map knows better
constexpr double sure_m = 0.3;                       // a map less sure than this of where the target is,
constexpr double sure_without_scans_m = 0.6;         // learns from a sighting only when others agree
constexpr double informative = 0.5;                  // of a sighting's own sigma
constexpr double another_tag_m = 0.3;
constexpr std::size_t enough_for_tag = 3;
constexpr double apart_for_tag_m = 0.5;  // two are enough from places so far apart

PastPlace tag_place(PatchId patch, std::int64_t utime) {
  return {utime, 0, {patch, Pose{}}, Eigen::Matrix3d::Zero(), Pose{}};
}

double largest_variance(const Eigen::Matrix2d& covariance) {
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(covariance, Eigen::EigenvaluesOnly).eigenvalues()(1);
}

// How surely the target's place is known as seen from the observer's patch, m² along the worse direction.
// Nothing where the two are far from each other in the graph.
std::optional<double> target_variance(const Map& map, const Evidence& evidence,
                                      const EngineOptions& options) {
  const PatchId a = evidence.observer.pose.patch;
  const PatchId b = evidence.target_place->pose.patch;
  if (a == b) return 0;
  const auto covariances =
      local_relative_covariances(map.graph(), map.manifold().poses(), a, options.confidence_patches);
  const auto found = covariances.find(b);
  if (found == covariances.end()) return std::nullopt;
  const Pose a_from_b = ominus(map.manifold().pose(b), map.manifold().pose(a));
  const Pose& r = evidence.target_place->pose.patch_from_object;
  const Eigen::Vector2d lever = rotate(a_from_b.yaw, {r.x, r.y});
  Eigen::Matrix<double, 2, 3> by_pose;
  by_pose << 1, 0, -lever.y(), 0, 1, lever.x();
  return largest_variance(by_pose * found->second * by_pose.transpose());
}

bool sees_walls(const Map& map, const PastPlace& place) {
  return !map.manifold().patch(place.pose.patch).points.empty();
}

}  // namespace

void Closures::take(const SightingEvent& sighting, const std::string& target, bool tag,
                    std::int64_t now_utime) {
  Evidence evidence;
  evidence.record = records_.size();
  evidence.sighting = sighting;
  evidence.target = target;
  evidence.is_tag = tag;
  records_.push_back({sighting, "waiting", "not_placed_yet", {}});
  unplaced_.push_back({std::move(evidence), now_utime});
}

void Closures::refuse(const SightingEvent& sighting, const std::string& reason) {
  records_.push_back({sighting, "refused", reason, {}});
}

void Closures::verdict(const Evidence& evidence, const std::string& verdict, const std::string& reason,
                       ClosureId closure) {
  SightingRecord& record = records_[evidence.record];
  record.verdict = verdict;
  record.reason = reason;
  record.closure = closure;
}

// Returns why the sighting cannot be placed; "wait" while it still may. Empty: it is placed.
std::string Closures::place(World world, Evidence& evidence, bool waited) const {
  const auto place_of = [&](const std::string& name, std::optional<PastPlace>& place) -> std::string {
    const auto found = world.robots.find(name);
    if (found == world.robots.end()) return "unknown_robot";
    const Robot& robot = found->second;
    const std::int64_t utime = evidence.sighting.utime;
    if (!robot.history.empty() && robot.history.oldest_utime() > utime) return "before_first_scan";
    place = robot.history.at(utime, robot.odometry, robot.noise);
    if (place) return "";
    if (!waited) return "wait";
    if (robot.history.empty()) return "before_first_scan";
    return robot.odometry.empty() || robot.odometry.newest_utime() < utime ? "stamp_in_future"
                                                                           : "no_pose_at_stamp";
  };
  std::optional<PastPlace> observer;
  if (const std::string reason = place_of(evidence.sighting.robot, observer); !reason.empty()) return reason;
  evidence.observer = *observer;
  if (evidence.is_tag) {
    const auto tag = tag_patches_.find(evidence.sighting.barcode);
    if (tag != tag_patches_.end()) evidence.target_place = tag_place(tag->second, evidence.sighting.utime);
    return "";
  }
  return place_of(evidence.target, evidence.target_place);
}

void Closures::place_sightings(World world) {
  std::deque<Unplaced> still;
  std::vector<Evidence> placed;
  for (Unplaced& unplaced : unplaced_) {
    const bool waited = world.no_more_waiting || world.now_utime > unplaced.receive_utime + placing_wait_us;
    const std::string reason = place(world, unplaced.evidence, waited);
    if (reason == "wait") {
      still.push_back(std::move(unplaced));
    } else if (!reason.empty()) {
      verdict(unplaced.evidence, "refused", reason);
    } else {
      placed.push_back(std::move(unplaced.evidence));
    }
  }
  unplaced_ = std::move(still);
  for (Evidence& evidence : placed) consider(world, std::move(evidence));
}

void Closures::consider(World world, Evidence evidence) {
  if (evidence.target_place && judge_by_map(world, evidence)) return;
  verdict(evidence, "waiting", evidence.doubt);
  pool_.push_back(std::move(evidence));
  pool_changed_ = true;
}

// Whether the map could tell: true where the sighting is accepted or refused.
bool Closures::judge_by_map(World world, Evidence& evidence) {
  const RelationGraph& graph = world.map.graph();
  const PatchId a = evidence.observer.pose.patch;
  const PatchId b = evidence.target_place->pose.patch;
  if (graph.island(a) != graph.island(b)) return false;
  ChartSighting chart = chart_sighting(world.map, evidence);
  const bool scans =
      sees_walls(world.map, evidence.observer) && sees_walls(world.map, *evidence.target_place);
  if (scans && agrees(chart, Pose{}) && graph.hops(a, b, near_hops)) {
    verdict(evidence, "accepted", "agrees_with_map");
    return true;
  }
  const std::optional<double> variance = target_variance(world.map, evidence, world.options);
  if (!variance) return false;
  chart.target_variance += *variance;
  if (!agrees(chart, Pose{})) {
    verdict(evidence, "refused", "contradicts_map");
    return true;
  }
  if (std::sqrt(*variance) > (scans ? sure_m : sure_without_scans_m)) return false;
  verdict(evidence, "accepted", "agrees_with_map");
  const double own = std::isfinite(chart.range_sigma_m)
                         ? chart.range_sigma_m
                         : chart.bearing_sigma_rad * std::max(1.0, chart.range_m);
  if (!scans && std::sqrt(*variance) > informative * own) add_to_map(world, evidence);
  return true;
}

void Closures::add_to_map(World world, const Evidence& evidence) {
  const std::optional<Relation> relation = sighting_relation(world.map, evidence, {});
  if (!relation) return;
  world.map.relate(*relation);
  world.map.refit_around(evidence.observer.pose.patch, world.options.window_patches);
}

// Tags that are nowhere yet: several sightings from one island that agree on a point place it there.
void Closures::place_tags(World world) {
  std::map<std::pair<std::int32_t, IslandId>, std::vector<std::size_t>> sightings;
  for (std::size_t i = 0; i < pool_.size(); ++i) {
    if (pool_[i].target_place) continue;
    const IslandId island = world.map.graph().island(pool_[i].observer.pose.patch);
    sightings[{pool_[i].sighting.barcode, island}].push_back(i);
  }
  std::set<std::int32_t> placed;
  for (const auto& [key, members] : sightings) {
    if (members.size() < 2 || tag_patches_.contains(key.first)) continue;
    place_tag(world, key.first, members);
    if (tag_patches_.contains(key.first)) placed.insert(key.first);
  }
  if (!placed.empty()) consider_pool_again(world);
}

void Closures::place_tag(World world, std::int32_t barcode, const std::vector<std::size_t>& members) {
  std::vector<std::size_t> best;
  for (const std::size_t i : members) {
    const std::optional<Eigen::Vector2d> point = measured_point(world.map, pool_[i]);
    if (!point) continue;
    const SightingEvent& s = pool_[i].sighting;
    const double variance = std::pow(std::max(s.range_sigma_m, s.range_m * s.bearing_sigma_rad), 2);
    std::vector<std::size_t> agreeing;
    for (const std::size_t j : members)
      if (j == i || agrees(chart_sighting_of_point(world.map, pool_[j], *point, variance), Pose{}))
        agreeing.push_back(j);
    if (agreeing.size() > best.size()) best = std::move(agreeing);
  }
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  double apart_m = 0;
  int points = 0;
  for (const std::size_t i : best) {
    const Pose pose = world.map.manifold().project(pool_[i].observer.pose);
    const Pose first = world.map.manifold().project(pool_[best.front()].observer.pose);
    apart_m = std::max(apart_m, std::hypot(pose.x - first.x, pose.y - first.y));
    if (const auto point = measured_point(world.map, pool_[i])) {
      mean += *point;
      ++points;
    }
  }
  if (best.size() < 2 || points == 0 || (best.size() < enough_for_tag && apart_m < apart_for_tag_m)) return;
  mean /= points;
  // A misread barcode repeats itself where another tag hangs.
  const IslandId island = world.map.graph().island(pool_[best.front()].observer.pose.patch);
  for (const auto& [other, patch] : tag_patches_) {
    const Pose& pose = world.map.manifold().pose(patch);
    if (world.map.graph().island(patch) == island &&
        std::hypot(pose.x - mean.x(), pose.y - mean.y()) < another_tag_m) {
      for (const std::size_t i : best) pool_[i].doubt = "another_tag_is_there";
      return;
    }
  }
  const PatchId id = world.map.manifold().next_id();
  world.map.add(make_tag_patch(id, barcode, pool_[best.front()].sighting.utime), {mean.x(), mean.y(), 0});
  tag_patches_[barcode] = id;
  for (const std::size_t i : best) {
    pool_[i].target_place = tag_place(id, pool_[i].sighting.utime);
    world.map.relate(*sighting_relation(world.map, pool_[i], {}));
    verdict(pool_[i], "accepted", "placed_tag");
  }
  world.map.refit_around(id, world.options.window_patches);
  std::erase_if(pool_, [&](const Evidence& e) { return records_[e.record].reason == "placed_tag"; });
}

void Closures::consider_pool_again(World world) {
  std::vector<Evidence> pool = std::exchange(pool_, {});
  for (Evidence& evidence : pool) {
    const auto tag = tag_patches_.find(evidence.sighting.barcode);
    if (evidence.is_tag && tag != tag_patches_.end())
      evidence.target_place = tag_place(tag->second, evidence.sighting.utime);
    consider(world, std::move(evidence));
  }
}

void Closures::advance(World world) {
  place_sightings(world);
  if (pool_changed_) {
    pool_changed_ = false;
    place_tags(world);
    const std::vector<Group> all = groups(world);
    thin(all, world);
    propose(world);
  }
  work(world);
  last_utime_ = world.now_utime;
}

void Closures::finish(World world) {
  world.no_more_waiting = true;
  place_sightings(world);
  place_tags(world);
  do {
    if (trial_) {
      trial_->finish(world.now_utime);
      end_trial(world);
    }
    propose(world);
  } while (trial_);
  for (const Evidence& evidence : pool_) verdict(evidence, "refused", evidence.doubt);
  pool_.clear();
}

std::vector<ClosureRecord> Closures::closures() const {
  std::vector<ClosureRecord> records;
  for (const auto& [id, closure] : closures_) records.push_back(closure.record);
  return records;
}

}  // namespace isthmus
