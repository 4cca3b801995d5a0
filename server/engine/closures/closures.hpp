#pragma once

#include <deque>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "server/engine/closures/closure_record.hpp"
#include "server/engine/closures/joining.hpp"
#include "server/engine/map/credit.hpp"
#include "server/engine/propagation/trial.hpp"
#include "server/engine/sightings/evidence.hpp"
#include "server/engine/sightings/placing.hpp"
#include "server/engine/sightings/sighting_log.hpp"

namespace isthmus {

/// What closures work on, lent for one call.
struct World {
  Map& map;
  std::map<std::string, Robot>& robots;
  const EngineOptions& options;
  std::int64_t now_utime = 0;  ///< receive time of the event
  bool no_more_waiting = false;
};

/// A closure that scans propose (hypotheses.hpp): how a patch of one chart lies to one of another, by several
/// finds that agree.
struct ScanProposal {
  ClosureId id;   ///< of a record there is already; invalid: a new one
  PatchId first;  ///< of the older island, in a merge
  PatchId second;
  Pose first_from_second;
  std::vector<Relation> relations;  ///< of the finds; their origin is still to be given
  int finds = 0;
  double way_m = 0;  ///< of a loop: what lies between its ends, over the map
  /// The map hardly says where one lies to the other: buildings that repeat themselves are to be feared.
  bool cautious = false;
  std::vector<std::string> robots;
};

/// From sightings to closures (Howard et al. 2006, IV-B and IV-C): places each sighting on the manifold,
/// judges it by the map, gathers what the map cannot judge until several agree, tries them out beside the
/// map, and keeps the record. What is undecided waits, at no harm.
class Closures {
 public:
  /// A sighting that makes sense on its own. `tag`: the barcode is a fixed tag's.
  void take(const SightingEvent& sighting, const std::string& target, bool tag, std::int64_t now_utime);
  /// One that does not; kept for the record.
  void refuse(const SightingEvent& sighting, Reason reason);
  /// A robot starts at a measured place relative to another (configuration, `start`).
  void propose_start(World world, const Relation& relation, const std::string& robot,
                     const std::string& with);

  /// What an event brings on: places and judges sightings, and works at the trial within its credit.
  void advance(World world);
  /// The same to the end, as if nothing more will come: first this, then steps until one returns false.
  void begin_finish(World world);
  bool finish_step(World world);
  /// Whether something is on trial: one thing at a time.
  bool on_trial() const { return trial_ != nullptr; }
  /// The running trial to its end.
  void end_trial_now(World world);
  /// One step towards that, whatever the credit; false: nothing is on trial any more.
  bool step_trial(World world);

  /// What scans say goes the same way, through the same trial and record. There must be none on trial.
  ClosureId propose_from_scans(World world, const ScanProposal& proposal);
  /// Keeps record of what is not worth a trial yet.
  ClosureId note_from_scans(World world, const ScanProposal& proposal, Reason reason);
  void refuse_from_scans(ClosureId id, Reason reason);
  /// What became of a closure that scans proposed: accepted, refused, or waiting for more support.
  struct Ruling {
    ClosureId id;
    ClosureState state = ClosureState::waiting;
    Reason reason = Reason::none;
    double value = 0;  ///< of one that waits: patches that would come to be joined

    auto members() { return std::tie(id, state, reason, value); }
  };
  std::vector<Ruling> take_rulings() { return std::exchange(rulings_, {}); }

  bool has_work() const {
    return !unplaced_.empty() || judging_again_ || trial_ != nullptr || !to_refit_.empty();
  }

  /// Operators: no closure of this id, or like it, from now on; an accepted one is taken back. Returns why
  /// not, or nothing.
  std::string forbid(World world, ClosureId id, bool must_be_accepted);
  /// Takes that back: the sightings are looked at again.
  std::string allow(ClosureId id);

  /// A robot's data is taken out: nothing that it saw, or that saw it, waits any longer. A trial is put off.
  void forget_robot(const std::string& robot);

  const SightingLog& sightings() const { return records_; }
  std::vector<ClosureRecord> closures() const;
  const std::map<std::int32_t, PatchId>& tags() const { return tag_patches_; }
  /// Counts of the sightings by verdict.
  int waiting() const { return static_cast<int>(unplaced_.size() + pool_.size()); }
  /// A patch of each island that merges, closures and withdrawals have changed since this was last asked.
  std::vector<PatchId> take_changed() { return std::exchange(changed_, {}); }

  auto members() {
    return std::tie(records_, unplaced_, pool_, pool_changed_, judging_again_, tried_, patches_, looked_at_,
                    to_refit_, tag_patches_, closures_, forbidden_, trial_, weighed_utime_, next_id_, credit_,
                    changed_, rulings_);
  }

 private:
  struct Closure {
    ClosureRecord record;
    std::vector<Evidence> evidence;
    Joining joining;
    bool forbidden = false;
    bool from_scans = false;
    ClosureId forbidden_as;  ///< of one that was refused: it says what this one says, which is forbidden

    auto members() { return std::tie(record, evidence, joining, forbidden, from_scans, forbidden_as); }
  };
  /// Sightings between the same two charts.
  struct Group {
    bool merge = false;
    std::string key;
    IslandId older;
    IslandId younger;
    std::vector<std::size_t> members;  ///< in the pool, by time
  };

  void verdict(const Evidence& evidence, Verdict verdict, Reason reason, ClosureId closure = {});
  void place_sightings(World world);
  void consider(World world, Evidence evidence);
  bool judge_by_map(World world, Evidence& evidence);
  void add_to_map(World world, const Evidence& evidence);
  void place_tags(World world);
  void place_tag(World world, std::int32_t barcode, const std::vector<std::size_t>& members);
  void consider_pool_again();
  void judge_again(World world);

  std::vector<Group> groups(World world) const;
  void thin(const std::vector<Group>& groups, World world);
  void propose(World world);
  bool propose(World world, const Group& group);
  bool propose_by_tag(World world, const Group& group, std::size_t least);
  void begin_trial(World world, const Group& group, const Alignment& alignment, const Joining& joining);
  void begin_trial(World world, Proposal proposal);
  bool refuse_if_forbidden(World world, ClosureId id, const Map& tried);
  bool refuse_as_forbidden(World world, ClosureId id, const Map& tried);
  std::vector<Evidence> take_supporters(const Group& group, const Alignment& alignment);
  void work(World world);
  void end_trial(World world);
  void put_off(ClosureId id);
  void put_off_trial();
  void take_back(World world, Closure& closure);
  void fall(ClosureId id);
  void put_on_own_ground(World world, const Map& together);
  void unplace_tags(World world, std::vector<Relation>& gone);
  void reopen(World world, std::size_t record);
  void return_to_pool(std::vector<Evidence>& evidence, Reason doubt);
  void rule(const Closure& closure, double value = 0);

  SightingLog records_;
  std::deque<Evidence> unplaced_;
  std::vector<Evidence> pool_;
  bool pool_changed_ = false;
  bool judging_again_ = false;        ///< some of the pool are still to be
  std::map<std::string, int> tried_;  ///< by group: the support of the trial that was refused
  std::size_t patches_ = 0;           ///< when last worked
  std::map<std::string, std::pair<std::size_t, std::size_t>> looked_at_;  ///< by group: its size and newest
  std::deque<PatchId> to_refit_;  ///< patches that sightings were added to
  std::map<std::int32_t, PatchId> tag_patches_;
  std::map<ClosureId, Closure> closures_;
  std::set<ClosureId> forbidden_;  ///< before they were ever proposed
  std::unique_ptr<Trial> trial_;
  /// When a sighting of that target by that observer was last weighed against the map's own confidence.
  std::map<std::pair<std::string, std::string>, std::int64_t> weighed_utime_;
  std::int32_t next_id_ = 0;
  Credit credit_;
  std::vector<PatchId> changed_;
  std::vector<Ruling> rulings_;
};

}  // namespace isthmus
