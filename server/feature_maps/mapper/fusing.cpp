// How a FeatureMapper makes one map of two, and what it holds of that afterwards.

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/feature_maps/mapper/feature_mapper.hpp"
#include "server/feature_maps/meeting/placement.hpp"

namespace isthmus {
namespace {

const RobotInState& robot_of(const Team& team, const Journey& journey) {
  return team.filter.state().robots[static_cast<std::size_t>(journey.member)];
}

std::vector<Clue> clues_of(std::span<const Heard> heard) {
  std::vector<Clue> clues;
  for (const Heard& one : heard) clues.push_back(one.clue);
  return clues;
}

}  // namespace

/// Robots that see one another for a while meet once.
int FeatureMapper::encounter_of(int one, int two, std::int64_t utime) {
  Encounter& last = encounters_[std::minmax(one, two)];
  if (last.begun_utime == 0 || std::abs(seconds_between(last.begun_utime, utime)) > options_.encounter_s)
    last = {++encounter_count_, utime};
  return last.number;
}

/// A sighting between robots on different maps.
std::string FeatureMapper::hear(const MapInput& input, int observer, int target, const FeatureRobot& seen) {
  const auto& sighting = std::get<SightingEvent>(input.event->body);
  const Journey& own = journeys_[static_cast<std::size_t>(observer)];
  const Journey& other = journeys_[static_cast<std::size_t>(target)];
  Heard heard{{}, observer, target, sighting.utime, sightings_.size() - 1, input.number};
  Clue& clue = heard.clue;
  clue.kind = own.team < other.team ? ClueKind::seen_from_one : ClueKind::seen_from_two;
  clue.number = input.number;
  clue.encounter = encounter_of(observer, target, sighting.utime);
  const bool is_told = std::any_of(heard_.begin(), heard_.end(), [&](const Heard& before) {
    return before.clue.encounter == clue.encounter && before.observer == observer;
  });
  if (is_told) return "same_encounter";
  Pose there = robot_of(team_of(other), other).map_from_robot;
  if (input.odom_from_target) there = there * ominus(*input.odom_from_target, seen.odom_from_last);
  const double moved_m = options_.target_speed_m_s * input.target_late_s;
  clue.observer = robot_of(team_of(own), own).map_from_robot;
  clue.observer_covariance = pose_covariance(team_of(own).filter.state(), own.member);
  clue.target = position(there);
  clue.target_covariance = pose_covariance(team_of(other).filter.state(), other.member).topLeftCorner<2, 2>();
  clue.target_covariance.diagonal().array() += moved_m * moved_m;
  clue.range_m = sighting.range_m;
  clue.range_sigma_m = sighting.range_sigma_m;
  clue.bearing_rad = sighting.bearing_rad;
  clue.bearing_sigma_rad = sighting.bearing_sigma_rad;
  const int one = std::min(own.team, other.team), two = std::max(own.team, other.team);
  heard_.push_back(heard);
  sightings_.back().reason = "waits";
  consider(one, two);
  return "waits";
}

std::vector<Heard> FeatureMapper::heard_between(int one, int two) const {
  std::vector<Heard> between;
  for (Heard heard : heard_) {
    const int of_observer = journeys_[static_cast<std::size_t>(heard.observer)].team;
    const int of_target = journeys_[static_cast<std::size_t>(heard.target)].team;
    if (std::minmax(of_observer, of_target) != std::minmax(one, two)) continue;
    heard.clue.kind = of_observer == one ? ClueKind::seen_from_one : ClueKind::seen_from_two;
    between.push_back(heard);
  }
  if (between.size() > options_.max_clues)
    between.erase(between.begin(), between.end() - static_cast<std::ptrdiff_t>(options_.max_clues));
  // How the maps erred since then is not known; what is of now is as exact as it says.
  for (Heard& heard : between) {
    if (std::abs(seconds_between(heard.utime, between.back().utime)) > options_.encounter_s) continue;
    heard.clue.observer_covariance.setZero();
    heard.clue.target_covariance.setZero();
  }
  return between;
}

/// Fixed barcodes that both maps know.
std::vector<Heard> FeatureMapper::tags_between(int one, int two) const {
  const Team &first = teams_[static_cast<std::size_t>(one)], &second = teams_[static_cast<std::size_t>(two)];
  const auto first_number = [&](const Team& team, std::int32_t barcode) {
    std::int32_t number = next_number_;
    for (const int journey : team.journeys)
      if (const auto seen = first_seen_.find({journey, barcode}); seen != first_seen_.end())
        number = std::min(number, seen->second);
    return number;
  };
  std::vector<Heard> tags;
  for (const auto& [barcode, id] : first.landmarks) {
    const auto other = second.landmarks.find(barcode);
    if (other == second.landmarks.end()) continue;
    const FeatureState &a = first.filter.state(), &b = second.filter.state();
    const auto in_one = index_of(a, id), in_two = index_of(b, other->second);
    if (!in_one || !in_two || tags.size() >= options_.max_clues) continue;
    Heard tag;
    tag.clue.kind = ClueKind::same_place;
    tag.clue.number = std::max(first_number(first, barcode), first_number(second, barcode));
    tag.clue.encounter = -1 - static_cast<int>(tags.size());
    tag.clue.place = a.features[*in_one].feature.a;
    tag.clue.target = b.features[*in_two].feature.a;
    tag.clue.place_covariance = feature_covariance(a, *in_one).topLeftCorner<2, 2>();
    tag.clue.target_covariance = feature_covariance(b, *in_two).topLeftCorner<2, 2>();
    tag.observer = first.journeys.front();
    tag.target = second.journeys.front();
    tag.fusion = tag.clue.number;
    tags.push_back(tag);
  }
  return tags;
}

void FeatureMapper::forget_waiting(std::int32_t fusion) {
  const auto found = fusions_.find(fusion);
  if (found == fusions_.end() || found->second.state != FusionState::waiting) return;
  fusions_.erase(found);
  const auto of_it =
      std::ranges::find_if(open_, [&](const auto& entry) { return entry.second.fusion == fusion; });
  if (of_it != open_.end()) close_meeting(of_it->first.first, of_it->first.second);
}

/// Whether two maps are one by now.
void FeatureMapper::consider(int one, int two) {
  std::vector<Heard> heard = tags_between(one, two);
  for (Heard& sighting : heard_between(one, two)) heard.push_back(std::move(sighting));
  const std::optional<MapPlacement> placement = best_placement(clues_of(heard), options_.placement);
  if (!placement || placement->log_odds <= 0) return;
  std::int32_t id = next_number_;
  bool is_forbidden = false;
  for (const std::size_t i : placement->agreeing) id = std::min(id, heard[i].fusion);
  for (const std::size_t i : placement->agreeing) {
    is_forbidden = is_forbidden || forbidden_.contains(heard[i].fusion);
    for (Heard& kept : heard_)
      if (kept.clue.number == heard[i].clue.number) kept.fusion = id;
  }
  for (const std::size_t i : placement->agreeing)
    if (heard[i].fusion != id) forget_waiting(heard[i].fusion);  // the same, by an earlier sign of it
  FusionRecord& record = fusions_[id];
  if (record.id < 0) record.id = id;
  record.clues_log_odds = placement->log_odds;
  record.clues = placement->agreeing.size();
  record.utime = 0;
  std::set<std::string> robots;
  for (const std::size_t i : placement->agreeing) {
    record.utime = std::max(record.utime, heard[i].utime);
    for (const int journey : {heard[i].observer, heard[i].target})
      robots.insert(journeys_[static_cast<std::size_t>(journey)].robot);
  }
  record.robots.assign(robots.begin(), robots.end());
  record.state = is_forbidden ? FusionState::withdrawn : FusionState::waiting;
  if (!is_forbidden) fuse_at(one, two, heard, *placement, record);
}

/// Makes one map of two where clues and what the maps have in common are enough; else nothing changes.
void FeatureMapper::fuse_at(int one, int two, const std::vector<Heard>& heard, const MapPlacement& placement,
                            FusionRecord& record) {
  Team &first = teams_[static_cast<std::size_t>(one)], &second = teams_[static_cast<std::size_t>(two)];
  first.filter.gather();
  second.filter.gather();
  const Heard& newest = heard[placement.agreeing.back()];
  const auto member_on = [&](int team) {
    const Journey& observer = journeys_[static_cast<std::size_t>(newest.observer)];
    return observer.team == team ? observer.member
                                 : journeys_[static_cast<std::size_t>(newest.target)].member;
  };
  const int member_1 = member_on(one), member_2 = member_on(two);
  const Pose pose_1 = first.filter.state().robots[static_cast<std::size_t>(member_1)].map_from_robot;
  const Pose pose_2 = second.filter.state().robots[static_cast<std::size_t>(member_2)].map_from_robot;
  const Pose met = placement.one_from_two * pose_2;
  const Eigen::Matrix3d by =
      ominus_jacobians(met, pose_1).by_q * compose_jacobians(placement.one_from_two, pose_2).by_left;
  const RobotAlignment alignment{ominus(met, pose_1), by * placement.covariance * by.transpose()};
  const JoinedTeams joined =
      joined_at_meeting(first, {member_1}, second, {member_2}, alignment, options_.fusion);
  record.duplicates = joined.duplicates.size();
  record.twins_log_odds = 0;
  if (placement.log_odds < options_.clues_suffice_log_odds)
    record.twins_log_odds = twins_log_odds(
        joined.duplicates.size(), twins_by_chance(first.filter.state(), member_1, second.filter.state(),
                                                  member_2, alignment, options_.fusion, options_.twins));
  if (record.log_odds() < options_.fusion_log_odds) return;
  const bool may_overlap = first.filter.feature_count() > 0 && second.filter.feature_count() > 0;
  if (joined.duplicates.empty() && may_overlap)
    return keep_open(one, two, member_1, member_2, alignment, record.id);
  std::set<std::size_t> agreeing;
  for (const std::size_t i : placement.agreeing)
    if (heard[i].clue.kind != ClueKind::same_place) agreeing.insert(heard[i].row);
  accept(one, two, joined, agreeing, record);
}

/// Two maps become one.
void FeatureMapper::accept(int one, int two, const JoinedTeams& joined, const std::set<std::size_t>& agreeing,
                           FusionRecord& record) {
  record.state = FusionState::accepted;
  record.duplicates = joined.duplicates.size();
  record.side_1 = teams_[static_cast<std::size_t>(one)].journeys;
  record.side_2 = teams_[static_cast<std::size_t>(two)].journeys;
  close_account(one, two, agreeing, record.id);
  join(one, two, joined);
}

/// What was heard between two maps that are one now, and which placings of them waited.
void FeatureMapper::close_account(int one, int two, const std::set<std::size_t>& agreeing,
                                  std::int32_t fusion) {
  forget_waiting_by_walls(one, two, fusion);
  std::erase_if(heard_, [&](const Heard& heard) {
    const int of_observer = journeys_[static_cast<std::size_t>(heard.observer)].team;
    const int of_target = journeys_[static_cast<std::size_t>(heard.target)].team;
    if (std::minmax(of_observer, of_target) != std::minmax(one, two)) return false;
    FeatureSighting& row = sightings_[heard.row];
    row.used = agreeing.contains(heard.row);
    row.reason = row.used ? "" : "contradicts_fusion";
    row.fusion = fusion;
    tell(heard.row);
    if (heard.fusion != fusion) forget_waiting(heard.fusion);
    return true;
  });
}

/// What an encounter of robots that a fusion brought together says of it.
void FeatureMapper::judge_fusion(int observer, int target, const LinearMeasurement& measured,
                                 const SightingEvent& sighting) {
  for (auto& [id, fusion] : fusions_) {
    if (!fusion.brought_together(observer, target)) continue;
    sightings_.back().fusion = id;
    const int before = encounter_count_;
    if (encounter_of(observer, target, sighting.utime) <= before) return;  // the same encounter says it once
    const Team& team = team_of(journeys_[static_cast<std::size_t>(observer)]);
    const LocalMatrix s = innovation_covariance(team.filter.state().covariance, measured);
    const auto rows = static_cast<double>(measured.residual.size());
    const double squared = squared_distance(team.filter.state().covariance, measured);
    double falsely = 0;
    if (std::isfinite(sighting.range_sigma_m)) falsely -= std::log(options_.placement.reach_m);
    if (std::isfinite(sighting.bearing_sigma_rad)) falsely -= std::log(2 * std::numbers::pi);
    const double truly = -0.5 * (squared + std::log(s.determinant()) + rows * std::log(2 * std::numbers::pi));
    const double share = options_.placement.true_share;
    fusion.since_log_odds += std::log(share * std::exp(std::min(truly - falsely, 500.0)) + 1 - share);
    if (fusion.log_odds() < 0) contradicted_ = id;
    return;
  }
}

}  // namespace isthmus
