#include "server/feature_maps/output/feature_record.hpp"

namespace isthmus {
namespace {

ClosureState state_of(FusionState state) {
  if (state == FusionState::accepted) return ClosureState::accepted;
  return state == FusionState::waiting ? ClosureState::waiting : ClosureState::withdrawn;
}

ClosureRecord closure_of(const FusionRecord& fusion) {
  ClosureRecord record;
  record.id = {fusion.id};
  record.kind = ClosureKind::merge;
  record.state = state_of(fusion.state);
  record.utime = record.start_utime = record.end_utime = fusion.utime;
  record.robots = fusion.robots;
  if (record.state == ClosureState::accepted) record.reason = Reason::merged_islands;
  if (record.state == ClosureState::waiting) record.reason = Reason::too_little_support;
  if (record.state == ClosureState::withdrawn) record.reason = Reason::forbidden;
  record.account.supporters = static_cast<int>(fusion.clues);
  record.account.matched = static_cast<int>(fusion.duplicates);
  record.account.revisit_log_odds = fusion.clues_log_odds + fusion.since_log_odds;
  record.account.shared_log_odds = fusion.twins_log_odds;
  return record;
}

Counters counters_of(const FeatureMaps& maps, const SightingLog& sightings) {
  Counters counters;
  counters.events = maps.counts.events;
  counters.scans = maps.counts.scans;
  counters.scans_matched = maps.counts.scans_used;
  counters.sightings = static_cast<std::int64_t>(sightings.size());
  counters.first_receive_utime = maps.counts.first_receive_utime;
  counters.last_receive_utime = maps.counts.last_receive_utime;
  for (const auto& [reason, count] : maps.counts.dropped)
    if (const auto known = value_of<DropReason>(reason)) counters.dropped[*known] = count;
  return counters;
}

}  // namespace

SightingRecord record_of(const FeatureSighting& sighting) {
  SightingRecord record{sighting.sighting, Verdict::refused, Reason::unsupported, {sighting.fusion}};
  if (sighting.used) {
    record.verdict = Verdict::accepted;
    record.reason = Reason::agrees_with_map;
  } else if (sighting.reason == "waits") {
    record.verdict = Verdict::waiting;
    record.reason = Reason::too_little_support;
  } else if (const auto known = value_of<Reason>(sighting.reason)) {
    record.reason = *known;
  }
  return record;
}

MapCopy record_of(const FeatureMaps& summary, const SightingLog& sightings) {
  MapCopy copy;
  copy.feature_islands = summary.teams.size();
  copy.sightings = sightings;
  for (const FusionRecord& fusion : summary.fusions) copy.closures.push_back(closure_of(fusion));
  copy.counters = counters_of(summary, sightings);
  return copy;
}

}  // namespace isthmus
