#include "server/engine/sightings/mutual_observations.hpp"

#include <algorithm>
#include <utility>

#include "server/engine/sightings/placing.hpp"

namespace isthmus {
namespace {

// Of what a sighting was refused for: whether another map might not have.
bool is_refusal_by_map(Reason reason) {
  return reason == Reason::contradicts_map || reason == Reason::unsupported ||
         reason == Reason::too_little_support || is_refusal_by_trial(reason);
}

}  // namespace

void MutualObservations::take(const SightingEvent& sighting, const std::string& target, bool is_tag,
                              std::int64_t now_utime) {
  Evidence evidence;
  evidence.record = log_.size();
  evidence.sighting = sighting;
  evidence.target = target;
  evidence.is_tag = is_tag;
  evidence.receive_utime = now_utime;
  log_.append({sighting, Verdict::waiting, Reason::not_placed_yet, {}});
  unplaced_.push_back(std::move(evidence));
}

void MutualObservations::refuse(const SightingEvent& sighting, Reason reason) {
  log_.append({sighting, Verdict::refused, reason, {}});
}

void MutualObservations::place(World world, const TagPatches& tags) {
  std::deque<Evidence> still;
  std::vector<Evidence> placed;
  for (Evidence& evidence : unplaced_) {
    const bool waited = world.no_more_waiting ||
                        world.now_utime > evidence.receive_utime + world.options.closures.placing_wait_us;
    const Placing placing =
        place_on_manifold(world.robots, tags, waited, evidence, world.options.odometry_noise);
    switch (placing.state) {
      case Placing::State::waits:
        still.push_back(std::move(evidence));
        break;
      case Placing::State::impossible:
        set_verdict(evidence, Verdict::refused, placing.reason);
        break;
      case Placing::State::placed:
        placed.push_back(std::move(evidence));
        break;
    }
  }
  unplaced_ = std::move(still);
  for (Evidence& evidence : placed) {
    if (is_settled_by_map(world, evidence)) continue;
    set_verdict(evidence, Verdict::waiting, evidence.doubt);
    pool_.push_back(std::move(evidence));
    pool_changed_ = true;
  }
}

// Whether the map could tell, so that the sighting is accepted. One that contradicts the map is most likely
// false; but several that agree may know better.
bool MutualObservations::is_settled_by_map(World world, Evidence& evidence) {
  if (!evidence.target_place) return false;
  const Judgement judgement = judge_.judge(world.map, evidence, world.options);
  if (judgement == Judgement::contradicts) evidence.doubt = Reason::contradicts_map;
  if (judgement == Judgement::contradicts || judgement == Judgement::unknown) return false;
  set_verdict(evidence, Verdict::accepted, Reason::agrees_with_map);
  if (judgement == Judgement::teaches) add_to_map(world, evidence);
  return true;
}

void MutualObservations::add_to_map(World world, const Evidence& evidence) {
  const std::optional<Relation> relation =
      sighting_relation(world.map, evidence, {}, world.options.alignment, world.options.evidence);
  if (!relation) return;
  world.map.relate(*relation);
  const PatchId patch = evidence.observer.pose.patch;
  if (std::ranges::find(to_refit_, patch) == to_refit_.end()) to_refit_.push_back(patch);
}

void MutualObservations::consider_again(const TagPatches& tags) {
  for (Evidence& evidence : pool_) {
    const auto tag = tags.find(evidence.sighting.barcode);
    if (evidence.is_tag) evidence.target_place.reset();
    if (evidence.is_tag && tag != tags.end())
      evidence.target_place = place_of_tag(tag->second, evidence.sighting.utime);
    evidence.judge_again = true;
  }
  judging_again_ = !pool_.empty();
}

void MutualObservations::judge_again(World world) {
  int judged = 0;
  auto kept = pool_.begin();  // in place: with many robots thousands wait, and few are judged at a time
  for (Evidence& evidence : pool_) {
    const bool now = evidence.judge_again && judged < world.options.closures.max_judged_again;
    if (now) {
      ++judged;
      evidence.judge_again = false;
      if (is_settled_by_map(world, evidence)) continue;
      set_verdict(evidence, Verdict::waiting, evidence.doubt);
    }
    if (&*kept != &evidence) *kept = std::move(evidence);
    ++kept;
  }
  pool_.erase(kept, pool_.end());
  judging_again_ = std::ranges::any_of(pool_, &Evidence::judge_again);
  pool_changed_ = true;
}

void MutualObservations::refit_next(World world) {
  if (to_refit_.empty()) return;
  world.map.refit_around(to_refit_.front(), world.options.map_fit.window_patches);
  to_refit_.pop_front();
}

std::vector<Evidence> MutualObservations::take_out(const std::set<std::size_t>& places) {
  std::vector<Evidence> taken;
  std::vector<Evidence> rest;
  for (std::size_t i = 0; i < pool_.size(); ++i)
    (places.contains(i) ? taken : rest).push_back(std::move(pool_[i]));
  pool_ = std::move(rest);
  return taken;
}

void MutualObservations::put_back(std::vector<Evidence> evidence, Reason doubt, ClosureId closure) {
  for (Evidence& one : evidence) {
    one.doubt = doubt;
    set_verdict(one, Verdict::waiting, doubt, closure);
    pool_.push_back(std::move(one));
  }
  sort_pool();
}

std::optional<Evidence> MutualObservations::placed_again(const World& world, const TagPatches& tags,
                                                         std::size_t record) const {
  Evidence evidence;
  evidence.record = record;
  evidence.sighting = log_[record].sighting;
  evidence.receive_utime = world.now_utime;
  const auto worn = std::ranges::find_if(world.robots, [&](const auto& entry) {
    return entry.second.declared && entry.second.declaration.barcode == evidence.sighting.barcode;
  });
  evidence.is_tag = worn == world.robots.end();
  evidence.target = evidence.is_tag ? tag_name(evidence.sighting.barcode) : worn->first;
  const Placing placing = place_on_manifold(world.robots, tags, true, evidence, world.options.odometry_noise);
  if (placing.state != Placing::State::placed) return std::nullopt;
  return evidence;
}

void MutualObservations::reopen(const World& world, const TagPatches& tags,
                                std::span<const std::size_t> records) {
  for (const std::size_t record : records) {
    if (log_.verdict(record) == Verdict::waiting) continue;  // it is there already
    std::optional<Evidence> evidence = placed_again(world, tags, record);
    if (!evidence) {
      log_.set_verdict(record, Verdict::refused, Reason::no_pose_at_stamp, {});
      continue;
    }
    set_verdict(*evidence, Verdict::waiting, evidence->doubt);
    pool_.push_back(*std::move(evidence));
  }
  sort_pool();
}

std::vector<std::size_t> MutualObservations::refused_by_map(std::size_t max_count) const {
  std::vector<std::size_t> records;
  for (std::size_t i = log_.size(); i-- > 0 && records.size() < max_count;) {
    const SightingRecord record = log_[i];
    if (record.verdict == Verdict::refused && is_refusal_by_map(record.reason)) records.push_back(i);
  }
  std::ranges::reverse(records);
  return records;
}

void MutualObservations::refuse(const std::set<std::size_t>& places) {
  if (places.empty()) return;
  for (const Evidence& evidence : take_out(places)) set_verdict(evidence, Verdict::refused, evidence.doubt);
}

void MutualObservations::remove(std::span<const Evidence> evidence) {
  std::set<std::size_t> records;
  for (const Evidence& one : evidence) records.insert(one.record);
  std::erase_if(pool_, [&](const Evidence& one) { return records.contains(one.record); });
}

void MutualObservations::refuse_pool() {
  for (const Evidence& evidence : pool_) set_verdict(evidence, Verdict::refused, evidence.doubt);
  pool_.clear();
}

void MutualObservations::forget_robot(const std::string& robot) {
  const auto is_its = [&](const Evidence& evidence) {
    if (evidence.sighting.robot != robot && evidence.target != robot) return false;
    set_verdict(evidence, Verdict::refused, Reason::robot_dropped);
    return true;
  };
  std::erase_if(pool_, is_its);
  std::erase_if(unplaced_, is_its);
}

void MutualObservations::set_verdict(std::span<const Evidence> evidence, Verdict verdict, Reason reason,
                                     ClosureId closure) {
  for (const Evidence& one : evidence) set_verdict(one, verdict, reason, closure);
}

void MutualObservations::set_verdict(const Evidence& evidence, Verdict verdict, Reason reason,
                                     ClosureId closure) {
  log_.set_verdict(evidence.record, verdict, reason, closure);
}

void MutualObservations::forget_lone_refits(const RelationGraph& graph) {
  std::erase_if(to_refit_, [&](PatchId patch) { return graph.of(patch).empty(); });
}

void MutualObservations::sort_pool() { std::ranges::stable_sort(pool_, {}, &Evidence::record); }

}  // namespace isthmus
