#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <tuple>
#include <vector>

#include "server/engine/map/drift.hpp"
#include "server/engine/map/fit_job.hpp"
#include "server/engine/map/reason.hpp"
#include "server/engine/propagation/layers_job.hpp"
#include "server/engine/propagation/propagation.hpp"
#include "server/engine/propagation/trial_account.hpp"

namespace isthmus {

/// By how many sightings agree that a closure is true: any two may, by chance.
inline double log_odds_of_agreeing(std::size_t sightings, const TrialOptions& options) {
  return sightings > 2 ? options.log_odds_per_sighting * static_cast<double>(sightings - 2) : 0;
}

/// Where scans found a loop to close: how a patch lies to one that they take for near it, and the way over
/// the map between the two (m).
struct Revisit {
  PatchId anchor;
  PatchId query;
  Pose anchor_from_query;
  double way_m = 0;

  auto members() { return std::tie(anchor, query, anchor_from_query, way_m); }
};

/// A closure that several sightings, or finds of scans, propose: how the patches of one map lie to those of
/// another.
struct Proposal {
  ClosureId id;
  bool merge = false;               ///< of two islands; else a loop on one
  IslandId older;                   ///< whose frame stays
  IslandId younger;                 ///< of a merge
  Pose older_from_younger;          ///< of a merge: the rough alignment
  std::vector<Relation> relations;  ///< of the sightings or finds, with this closure as their origin
  int supporters = 0;
  bool two_way = false;
  bool from_scans = false;  ///< relations are of scans that agree, nobody has seen anybody
  /// What the map may err by beyond its covariance, where the loop closes: variances of x, y, yaw.
  Eigen::Vector3d beyond_covariance = systematic_variance(0, {});
  bool cautious = true;            ///< the map hardly knows how its ends lie: fitted as more matches
  int look_alikes = 1;             ///< places that look alike, of which this is one
  double prior_log_odds = 0;       ///< that it is true, before it is tried
  std::optional<Revisit> revisit;  ///< of a loop from scans
  OpenLoop loop;                   ///< of a loop: what may be to blame for it
  bool measured = false;           ///< placed by the operators themselves: no test can refuse it

  auto members() {
    return std::tie(id, merge, older, younger, older_from_younger, relations, supporters, two_way, from_scans,
                    beyond_covariance, cautious, look_alikes, prior_log_odds, revisit, loop, measured);
  }
};

/// A proposal tried out beside the map: provisional relations and poses over the shared patches (Howard et
/// al. 2006, IV-B and IV-C, on a copy). Advances in bounded steps, one at a time; fits of whole islands are
/// jobs in another thread. The map itself changes only when it is accepted.
class Trial {
 public:
  Trial() = default;  ///< to be read from a snapshot
  Trial(const Map& map, Proposal proposal, const EngineOptions& options, std::int64_t now_utime);

  /// Tells a running job that an event was handled.
  void advance(std::int64_t now_utime);
  /// One bounded piece of work. Returns false where a job has to end first.
  bool step(std::int64_t now_utime);
  /// The same, but waits for a job that has to end first: repeated until it is done, it runs to the end.
  void finish_step(std::int64_t now_utime);
  void finish(std::int64_t now_utime);

  bool done() const { return stage_ == Stage::done; }
  bool accepted() const { return done() && !undecided_ && refusal_ == Reason::none; }
  /// Nothing spoke against it, but too little for it: more sightings may come.
  bool undecided() const { return done() && undecided_; }
  /// Why it was refused or is undecided; none where it was accepted, and where sightings are too few.
  Reason refusal() const { return refusal_; }
  /// By what it was judged; empty where it was refused before.
  const TrialAccount& account() const { return account_; }
  const Proposal& proposal() const { return proposal_; }
  /// The map as the trial has it now.
  const Map& map() const { return map_; }
  int patches_touched() const { return static_cast<int>(propagation_.matched().size()); }
  /// Relations of the map that it takes out: wrong, if the closure is right.
  const std::vector<RelationId>& blamed() const { return blamed_; }
  int fits() const { return fits_; }  ///< of whole islands
  int work_steps() const { return propagation_.steps() + fits_; }

  /// Takes what was accepted over into the map, which may have grown since.
  void commit(Map& map) const;

  auto members() {
    return std::tie(options_, proposal_, map_, patches_at_start_, first_relation_, blamed_, gate_before_,
                    propagation_, poses_before_, job_, layers_, stage_, fits_, matched_at_fit_, refusal_,
                    undecided_, account_);
  }

 private:
  enum class Stage { start, propagate, last_propagate, judge, look_for_layers, done };

  /// Of the first relation, or where scans found a loop to close: by these the map before is held against it.
  std::pair<PatchId, PatchId> ends() const;
  void begin_fit(std::int64_t now_utime, bool with_gate);
  bool jumps_too_far(const Eigen::Matrix3d& before) const;
  double revisit_log_odds(const std::optional<Eigen::Matrix3d>& before) const;
  void end_fit();
  void take_out(const FitJob::Result& wrong);
  void propagate(std::int64_t now_utime);
  /// Whether what matches is enough to judge by.
  bool tells_enough() const;
  /// Whether the map is fitted anew while more and more of it matches.
  bool refits() const;
  bool hardly_known(const std::optional<Eigen::Matrix3d>& covariance) const;
  void judge(std::int64_t now_utime);
  void judge_sightings();
  /// Why sightings are refused that `disagree` by more than their noise or do not; `none` if they are not.
  Reason refusal_of_sightings(bool disagree) const;
  void judge_scans();
  void judge_loop();
  /// Of a loop that nothing refutes.
  void accept_or_wait();
  /// Whether drawing once what was drawn twice, or twice what was drawn once, may decide.
  bool layers_would_tell() const;
  void look_for_layers(std::int64_t now_utime);
  void judge_layers();
  void judge_merge();
  /// What two maps share and what each has beyond it.
  void judge_shared_part();
  void leave_undecided(Reason why);
  bool scans_disagree() const;
  double shared_log_odds(double way_m, double width_m) const;
  /// Against the closure, by walls of one side in the other's free space beyond what each does itself.
  double log_odds_by_walls() const;
  /// Mean share of hits of one side deep in the other's free space.
  double mean_contradiction() const;
  /// Mean χ² per residual of the sightings that proposed it, after the fit.
  double sighting_cost() const;
  /// Mean χ² of the relations of finds above what each alone costs, after the fit: how far they pull at one
  /// another.
  double find_cost() const;
  /// What patches of one side contradict each other: people, glass, and maps that bend.
  double own_contradiction() const;
  /// Whether the two sides contradict one another more than each does itself.
  bool puts_walls_in_free_space(double contradiction) const;

  EngineOptions options_;
  Proposal proposal_;
  Map map_;
  std::size_t patches_at_start_ = 0;
  std::size_t first_relation_ = 0;
  std::vector<RelationId> blamed_;
  std::optional<Pose> gate_before_;  ///< of a loop: of its second end in its first, as the map had it
  Propagation propagation_;
  std::vector<Pose> poses_before_;  ///< by patch id
  std::unique_ptr<FitJob> job_;
  std::optional<LayersJob> layers_;
  Stage stage_ = Stage::start;
  int fits_ = 0;
  std::size_t matched_at_fit_ = 0;
  Reason refusal_ = Reason::none;
  bool undecided_ = false;
  TrialAccount account_;
};

}  // namespace isthmus
