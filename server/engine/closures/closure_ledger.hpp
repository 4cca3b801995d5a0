#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "server/engine/closures/closure_draft.hpp"
#include "server/engine/closures/closure_record.hpp"
#include "server/engine/sightings/evidence.hpp"

namespace isthmus {

/// What became of a closure: accepted, refused, withdrawn, or waiting for more support.
struct ClosureOutcome {
  ClosureId id;
  ClosureState state = ClosureState::waiting;
  Reason reason = Reason::none;
  double value = 0;  ///< of one that waits: patches that would come to be joined

  auto members() { return std::tie(id, state, reason, value); }
};

/// All closures that were ever proposed, by id: what each says, the sightings that speak for it, what
/// became of it, and whether operators have forbidden it.
class ClosureLedger {
 public:
  struct Entry {
    ClosureRecord record;
    std::vector<Evidence> evidence;
    std::vector<Relation> blamed;  ///< of one that was accepted: it took them out of the map
    bool forbidden = false;
    ClosureId forbidden_as;  ///< of one that was refused: it says what this one says, which is forbidden

    auto members() { return std::tie(record, evidence, blamed, forbidden, forbidden_as); }
  };

  ClosureId take_id() { return ClosureId{next_id_++}; }
  /// A closure whose trial begins; of one that has been on trial before, the record goes on.
  Entry& enter(const ClosureDraft& draft, std::vector<Evidence> evidence = {});
  /// As if it had not been proposed: its id, if it is the last, is that of the next.
  void strike(ClosureId id);

  Entry& at(ClosureId id) { return entries_.at(id); }
  /// Nothing for an id that was never proposed.
  Entry* find(ClosureId id);
  const Entry* find(ClosureId id) const;

  /// Where scans proposed it, they get the outcome.
  void decide(Entry& entry, ClosureState state, Reason reason, double value = 0);
  std::vector<ClosureOutcome> take_outcomes() { return std::exchange(outcomes_, {}); }

  /// Operators may forbid a closure by its id before it is proposed.
  void forbid_id(ClosureId id) { forbidden_ids_.insert(id); }
  bool is_forbidden_id(ClosureId id) const { return forbidden_ids_.contains(id); }
  /// Whether there was something to allow.
  bool allow_id(ClosureId id) { return forbidden_ids_.erase(id) > 0; }
  /// It, and those of scans that were refused as saying what it says, may come again.
  void allow(Entry& entry);
  /// The forbidden closure that a map brings about on which something has been tried out, if any.
  std::optional<ClosureId> forbidden_by(const Map& map, const Map& tried, const EngineOptions& options) const;
  /// Sightings that say once more what is forbidden are kept with the closure that they speak for.
  void keep_with_forbidden(ClosureId forbidden, std::vector<Evidence> evidence);

  /// Changes the places of all sightings that speak for closures.
  void correct(const std::function<void(Evidence&)>& change);
  std::vector<ClosureRecord> records() const;
  /// By id; of those that were proposed.
  std::vector<ClosureId> forbidden() const;
  /// The loops of an island that were closed by what was seen there, the least sure of them.
  std::vector<UncertainClosure> closed_loops(const RelationGraph& graph, IslandId island) const;
  /// By id.
  const std::map<ClosureId, Entry>& entries() const { return entries_; }

  auto members() { return std::tie(entries_, forbidden_ids_, outcomes_, next_id_); }

 private:
  std::map<ClosureId, Entry> entries_;
  std::set<ClosureId> forbidden_ids_;
  std::vector<ClosureOutcome> outcomes_;
  std::int32_t next_id_ = 0;
};

}  // namespace isthmus
