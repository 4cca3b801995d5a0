#pragma once

#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "server/engine/closures/closure_ledger.hpp"
#include "server/engine/closures/parting.hpp"
#include "server/engine/closures/scan_proposal.hpp"
#include "server/engine/closures/sighting_proposer.hpp"
#include "server/engine/closures/trial_runner.hpp"
#include "server/engine/input/drop_reason.hpp"
#include "server/engine/robot/world.hpp"
#include "server/engine/sightings/mutual_observations.hpp"
#include "server/engine/sightings/tag_placer.hpp"

namespace isthmus {

/// From sightings and finds to closures (Howard et al. 2006, IV-B and IV-C): lets the owners of what is seen,
/// of tags, of groups that agree, of the running trial and of the record work together. Undecided
/// closures wait; the map stays consistent.
class Closures {
 public:
  /// A sighting that makes sense on its own. `is_tag`: the barcode is a fixed tag's.
  void take(const SightingEvent& sighting, const std::string& target, bool is_tag, std::int64_t now_utime);
  /// A sighting that does not make sense; kept for the record.
  void refuse(const SightingEvent& sighting, Reason reason);
  /// A robot starts at a measured place relative to another (configuration, `start`).
  void propose_start(World world, const Relation& relation, const std::string& robot,
                     const std::string& with);

  /// After each event: places and judges sightings, and works at the trial within its credit.
  void advance(World world);
  /// The same to the end, when no more events will come: first this, then steps until one returns false.
  void begin_finish(World world);
  bool finish_step(World world);
  /// One of the same steps, but what is left at their end is not refused: it may be worth something later.
  bool try_waiting(World world);
  /// Whether something is on trial: one thing at a time.
  bool on_trial() const { return trials_.trial() != nullptr; }
  /// One step of the running trial, whatever the credit; false: nothing is on trial any more.
  bool step_trial(World world);

  /// What scans say goes the same way, through the same trial and record. There must be none on trial.
  ClosureId propose_from_scans(World world, const ScanProposal& finds);
  /// One that scans proposed and something else has refuted.
  void refuse_from_scans(ClosureId id, Reason reason);
  std::vector<ClosureOutcome> take_outcomes() { return ledger_.take_outcomes(); }

  bool has_work() const { return observations_.has_work() || on_trial() || !doubts_.empty(); }

  /// Operators: no closure of this id, or like it, from now on; an accepted one is taken back. Returns why
  /// not, or `none`.
  DropReason forbid(World world, ClosureId id, bool must_be_accepted);
  /// Takes that back: the sightings are looked at again.
  DropReason allow(ClosureId id);

  /// A robot's data is taken out: nothing that it saw, or that saw it, waits any longer. A trial is put off.
  void forget_robot(const std::string& robot);

  const SightingLog& sightings() const { return observations_.log(); }
  std::vector<ClosureRecord> closures() const { return ledger_.records(); }
  /// Of these, by id, those that operators have forbidden: what `allow` takes.
  std::vector<ClosureId> forbidden() const { return ledger_.forbidden(); }
  /// The patches of the tags that have a place.
  const TagPatches& tags() const { return tags_.patches(); }
  /// A patch of each island that merges, closures and withdrawals have changed since this was last asked.
  std::vector<PatchId> take_changed() { return std::exchange(changed_, {}); }

  /// Of each merge since this was last asked: the patches of the smaller of the two islands.
  std::vector<std::vector<PatchId>> take_merged() { return std::exchange(merged_, {}); }

  auto members() {
    return std::tie(observations_, tags_, proposer_, ledger_, trials_, doubts_, changed_, merged_);
  }

 private:
  using Entry = ClosureLedger::Entry;

  /// Whether a merge is wrong, by a closure that was not accepted.
  struct Doubt {
    ClosureId by;
    PartingsJob partings;
    bool is_of_another_map = false;  ///< relations have gone since, or islands become one

    auto members() { return std::tie(by, partings, is_of_another_map); }
  };

  void propose(World world);
  void propose(World world, const SightingGroup& group, const GroupAgreement& agreement);
  void begin_trial(World world, Proposal proposal);
  void end_trial(World world);
  void accept(World world, const Trial& trial, Entry& closure);
  void withdraw(World world, ClosureId contradicted);
  /// Asks which merges are wrong if a closure that was not accepted is right.
  void doubt_merges(World world, const Entry& closure);
  void doubt_anew();
  void settle_doubt(World world);
  void withdraw_what_it_contradicts(World world, std::span<const Parting> partings);
  void withdraw_what_it_rivals(World world, const Entry& closure, std::span<const Parting> partings);
  void put_off(Entry& closure);
  void put_off_trial();
  bool refuse_if_forbidden(World world, Entry& closure, const Map& tried);
  bool refuse_as_forbidden(World world, Entry& closure, const Map& tried);
  void look_at_all_again();

  MutualObservations observations_;
  TagPlacer tags_;
  SightingProposer proposer_;
  ClosureLedger ledger_;
  TrialRunner trials_;
  std::vector<Doubt> doubts_;  ///< in the order in which they arose
  std::vector<PatchId> changed_;
  std::vector<std::vector<PatchId>> merged_;
};

}  // namespace isthmus
