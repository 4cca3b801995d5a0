#include "server/engine/closures/closures.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "relations/confidence.hpp"

namespace isthmus {
namespace {

constexpr std::int64_t placing_wait_us = 2'000'000;  // a sighting waits so long for odometry
constexpr std::int64_t weighing_us = 2'000'000;
constexpr int near_hops = 3;                    // so near in the graph, the map knows better
constexpr double sure_m = 0.3;                  // a map less sure than this of where the target is,
constexpr double sure_without_scans_m = 0.6;    // learns from a sighting only when others agree
constexpr std::size_t most_without_scans = 60;  // tags tie everything to everything: a dense graph
constexpr double informative = 1;               // of a sighting's own sigma
constexpr double another_tag_m = 0.3;
constexpr std::size_t enough_beside_another = 6;
constexpr double apart_beside_another_m = 1;
constexpr std::size_t most_for_tag = 30;  // newest sightings of a tag that is nowhere yet
constexpr int most_judged_again = 4;      // in one event: each may ask for a covariance

double largest_variance(const Eigen::Matrix2d& covariance) {
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(covariance, Eigen::EigenvaluesOnly).eigenvalues()(1);
}

// How surely the target's place is known as seen from the observer's patch, m² along the worse direction.
// Nothing where the graph near the two does not tell.
std::optional<double> target_variance(const Map& map, const Evidence& evidence, std::size_t most_patches) {
  const PatchId a = evidence.observer.pose.patch;
  const PatchId b = evidence.target_place->pose.patch;
  const auto covariance = local_relative_covariance(map.graph(), map.manifold().poses(), a, b, most_patches);
  if (!covariance) return std::nullopt;
  const Pose a_from_b = ominus(map.manifold().pose(b), map.manifold().pose(a));
  const Pose& r = evidence.target_place->pose.patch_from_object;
  const Eigen::Vector2d lever = rotate(a_from_b.yaw, {r.x, r.y});
  Eigen::Matrix<double, 2, 3> by_pose;
  by_pose << 1, 0, -lever.y(), 0, 1, lever.x();
  return largest_variance(by_pose * *covariance * by_pose.transpose());
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
  evidence.receive_utime = now_utime;
  records_.append({sighting, Verdict::waiting, Reason::not_placed_yet, {}});
  unplaced_.push_back(std::move(evidence));
}

void Closures::refuse(const SightingEvent& sighting, Reason reason) {
  records_.append({sighting, Verdict::refused, reason, {}});
}

void Closures::verdict(const Evidence& evidence, Verdict verdict, Reason reason, ClosureId closure) {
  records_.set_verdict(evidence.record, verdict, reason, closure);
}

void Closures::place_sightings(World world) {
  std::deque<Evidence> still;
  std::vector<Evidence> placed;
  for (Evidence& unplaced : unplaced_) {
    const bool waited = world.no_more_waiting || world.now_utime > unplaced.receive_utime + placing_wait_us;
    const Placing placing = place_on_manifold(world.robots, tag_patches_, waited, unplaced);
    switch (placing.state) {
      case Placing::State::waits:
        still.push_back(std::move(unplaced));
        break;
      case Placing::State::impossible:
        verdict(unplaced, Verdict::refused, placing.reason);
        break;
      case Placing::State::placed:
        placed.push_back(std::move(unplaced));
        break;
    }
  }
  unplaced_ = std::move(still);
  for (Evidence& evidence : placed) consider(world, std::move(evidence));
}

void Closures::consider(World world, Evidence evidence) {
  if (evidence.target_place && judge_by_map(world, evidence)) return;
  verdict(evidence, Verdict::waiting, evidence.doubt);
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
    verdict(evidence, Verdict::accepted, Reason::agrees_with_map);
    return true;
  }
  // Sightings close in time err alike: one of them tells what they all tell.
  std::int64_t& weighed_utime = weighed_utime_[{evidence.sighting.robot, evidence.target}];
  if (std::abs(evidence.sighting.utime - weighed_utime) < weighing_us && agrees(chart, Pose{})) {
    verdict(evidence, Verdict::accepted, Reason::agrees_with_map);
    return true;
  }
  const std::optional<double> variance =
      target_variance(world.map, evidence, scans ? world.options.confidence_patches : most_without_scans);
  if (!variance) return false;
  chart.target_variance += *variance;
  // One that contradicts the map is most likely false; but several that agree may know better.
  if (!agrees(chart, Pose{})) {
    evidence.doubt = Reason::contradicts_map;
    return false;
  }
  if (std::sqrt(*variance) > (scans ? sure_m : sure_without_scans_m)) return false;
  verdict(evidence, Verdict::accepted, Reason::agrees_with_map);
  weighed_utime = evidence.sighting.utime;
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
  const PatchId patch = evidence.observer.pose.patch;
  if (std::ranges::find(to_refit_, patch) == to_refit_.end()) to_refit_.push_back(patch);
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
    const std::size_t newest = members.size() - std::min(members.size(), most_for_tag);
    place_tag(world, key.first, {members.begin() + static_cast<std::ptrdiff_t>(newest), members.end()});
    if (tag_patches_.contains(key.first)) placed.insert(key.first);
  }
  if (placed.empty()) return;
  std::erase_if(pool_, [&](const Evidence& e) { return records_.verdict(e.record) == Verdict::accepted; });
  consider_pool_again();
}

void Closures::place_tag(World world, std::int32_t barcode, const std::vector<std::size_t>& members) {
  const PointConsensus consensus = agree_on_a_point(world.map, pool_, members);
  const std::vector<std::size_t>& best = consensus.supporters;
  if (!consensus.enough()) return;
  const Eigen::Vector2d& mean = consensus.point;
  // A misread barcode repeats itself where another tag hangs: so near one, a tag needs more to be believed.
  const IslandId island = world.map.graph().island(pool_[best.front()].observer.pose.patch);
  for (const auto& [other, patch] : tag_patches_) {
    const Pose& pose = world.map.manifold().pose(patch);
    if (world.map.graph().island(patch) == island &&
        std::hypot(pose.x - mean.x(), pose.y - mean.y()) < another_tag_m &&
        (best.size() < enough_beside_another || consensus.apart_m < apart_beside_another_m)) {
      for (const std::size_t i : best) pool_[i].doubt = Reason::another_tag_is_there;
      return;
    }
  }
  const PatchId id = world.map.manifold().next_id();
  world.map.add(make_tag_patch(id, barcode, pool_[best.front()].sighting.utime), {mean.x(), mean.y(), 0});
  tag_patches_[barcode] = id;
  for (const std::size_t i : best) {
    pool_[i].target_place = place_of_tag(id, pool_[i].sighting.utime);
    world.map.relate(*sighting_relation(world.map, pool_[i], {}));
    verdict(pool_[i], Verdict::accepted, Reason::placed_tag);
  }
  world.map.refit_around(id, world.options.window_patches);
}

void Closures::consider_pool_again() {
  for (Evidence& evidence : pool_) {
    const auto tag = tag_patches_.find(evidence.sighting.barcode);
    if (evidence.is_tag) evidence.target_place.reset();
    if (evidence.is_tag && tag != tag_patches_.end())
      evidence.target_place = place_of_tag(tag->second, evidence.sighting.utime);
    evidence.judge_again = true;
  }
  judging_again_ = !pool_.empty();
}

// What the changed map may tell now of those that wait, a few an event. Nothing is proposed meanwhile.
void Closures::judge_again(World world) {
  int judged = 0;
  for (Evidence& evidence : pool_) {
    if (!evidence.judge_again) continue;
    if (judged++ >= most_judged_again) break;
    evidence.judge_again = false;
    if (!evidence.target_place || !judge_by_map(world, evidence))
      verdict(evidence, Verdict::waiting, evidence.doubt);
  }
  std::erase_if(pool_, [&](const Evidence& e) { return records_.verdict(e.record) == Verdict::accepted; });
  judging_again_ = std::ranges::any_of(pool_, &Evidence::judge_again);
  pool_changed_ = true;
}

void Closures::advance(World world) {
  place_sightings(world);
  if (judging_again_) judge_again(world);
  if (pool_changed_ && !judging_again_) {
    pool_changed_ = false;
    place_tags(world);
    const std::vector<Group> all = groups(world);
    thin(all, world);
    propose(world);
  }
  work(world);
  if (!to_refit_.empty()) {
    world.map.refit_around(to_refit_.front(), world.options.window_patches);
    to_refit_.pop_front();
  }
}

void Closures::begin_finish(World world) {
  world.no_more_waiting = true;
  place_sightings(world);
  place_tags(world);
}

bool Closures::finish_step(World world) {
  if (step_trial(world)) return true;
  if (judging_again_) {
    judge_again(world);
    return true;
  }
  world.no_more_waiting = true;
  pool_changed_ = false;
  propose(world);
  if (trial_ || pool_changed_ || judging_again_) return true;
  for (const Evidence& evidence : pool_) verdict(evidence, Verdict::refused, evidence.doubt);
  pool_.clear();
  return false;
}

void Closures::end_trial_now(World world) {
  while (step_trial(world)) {
  }
}

bool Closures::step_trial(World world) {
  if (!trial_) return false;
  if (!trial_->done()) {
    trial_->finish_step(world.now_utime);
  } else {
    end_trial(world);
  }
  return trial_ != nullptr;
}

std::vector<ClosureRecord> Closures::closures() const {
  std::vector<ClosureRecord> records;
  for (const auto& [id, closure] : closures_) records.push_back(closure.record);
  return records;
}

}  // namespace isthmus
