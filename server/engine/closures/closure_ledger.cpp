#include "server/engine/closures/closure_ledger.hpp"

#include <algorithm>
#include <iterator>

namespace isthmus {
namespace {

constexpr std::size_t max_kept = 400;   // of the sightings that say what is forbidden, the newest
constexpr std::size_t max_doubted = 4;  // of the loops of an island: bounds what a trial costs

double confirmed_log_odds(const std::map<ClosureId, ClosureLedger::Entry>& entries, ClosureId loop) {
  double sum = 0;
  for (const auto& [id, entry] : entries) {
    const ClosureRecord& record = entry.record;
    if (record.kind == ClosureKind::loop && record.state == ClosureState::accepted &&
        std::ranges::binary_search(record.account.rests_on, loop))
      sum += record.account.confirmed_log_odds();
  }
  return sum;
}

}  // namespace

ClosureLedger::Entry& ClosureLedger::enter(const ClosureDraft& draft, std::vector<Evidence> evidence) {
  const auto [found, is_new] = entries_.try_emplace(draft.record.id);
  Entry& entry = found->second;
  const ClosureRecord before = std::exchange(entry.record, draft.record);
  if (!is_new) {
    entry.record.start_utime = before.start_utime;
    entry.record.patches_touched = before.patches_touched;
    entry.record.work_steps = before.work_steps;
    entry.record.account = before.account;
  }
  entry.evidence = std::move(evidence);
  return entry;
}

void ClosureLedger::strike(ClosureId id) {
  entries_.erase(id);
  if (id.value + 1 == next_id_) --next_id_;
}

ClosureLedger::Entry* ClosureLedger::find(ClosureId id) {
  const auto found = entries_.find(id);
  return found == entries_.end() ? nullptr : &found->second;
}

const ClosureLedger::Entry* ClosureLedger::find(ClosureId id) const {
  const auto found = entries_.find(id);
  return found == entries_.end() ? nullptr : &found->second;
}

void ClosureLedger::decide(Entry& entry, ClosureState state, Reason reason, double value) {
  entry.record.state = state;
  entry.record.reason = reason;
  outcomes_.push_back({entry.record.id, state, reason, value});
}

void ClosureLedger::allow(Entry& entry) {
  const ClosureId id = entry.record.id;
  entry.forbidden = false;
  forbidden_ids_.erase(id);
  entry.record.reason = Reason::allowed_again;
  for (auto& [other, its] : entries_) {
    if (!its.record.from_scans || (other != id && its.forbidden_as != id)) continue;
    its.forbidden_as = {};
    outcomes_.push_back({other, ClosureState::waiting, Reason::allowed_again, 0});
  }
}

std::optional<ClosureId> ClosureLedger::forbidden_by(const Map& map, const Map& tried,
                                                     const EngineOptions& options) const {
  const auto found = std::ranges::find_if(entries_, [&](const auto& entry) {
    return entry.second.forbidden && brings_about(map, tried, entry.second.record.joining, options);
  });
  if (found == entries_.end()) return std::nullopt;
  return found->first;
}

void ClosureLedger::keep_with_forbidden(ClosureId forbidden, std::vector<Evidence> evidence) {
  std::vector<Evidence>& kept = at(forbidden).evidence;
  std::ranges::move(evidence, std::back_inserter(kept));
  if (kept.size() > max_kept) kept.erase(kept.begin(), kept.end() - static_cast<std::ptrdiff_t>(max_kept));
}

void ClosureLedger::correct(const std::function<void(Evidence&)>& change) {
  for (auto& [id, entry] : entries_) std::ranges::for_each(entry.evidence, change);
}

// What operators have measured is not in doubt. A loop is as sure as it was on its trial, and as all those
// since that were found where only a map with it had them. Each costs a fit of the island to look at.
std::vector<UncertainClosure> ClosureLedger::closed_loops(const RelationGraph& graph, IslandId island) const {
  std::vector<UncertainClosure> found;
  for (const auto& [id, entry] : entries_) {
    const ClosureRecord& record = entry.record;
    if (record.kind != ClosureKind::loop || record.state != ClosureState::accepted ||
        record.reason == Reason::measured_start || graph.island(record.joining.first) != island)
      continue;
    found.push_back({id, std::max(0.0, record.account.log_odds()) + confirmed_log_odds(entries_, id)});
  }
  std::ranges::stable_sort(found, {}, &UncertainClosure::log_odds);
  found.resize(std::min(found.size(), max_doubted));
  return found;
}

std::vector<ClosureRecord> ClosureLedger::records() const {
  std::vector<ClosureRecord> records;
  for (const auto& [id, entry] : entries_) records.push_back(entry.record);
  return records;
}

std::vector<ClosureId> ClosureLedger::forbidden() const {
  std::vector<ClosureId> ids;
  for (const auto& [id, entry] : entries_)
    if (entry.forbidden) ids.push_back(id);
  return ids;
}

}  // namespace isthmus
