#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "server/engine/closures/closures.hpp"
#include "server/engine/hypotheses/hypothesis_counts.hpp"
#include "server/engine/hypotheses/undecided.hpp"
#include "server/engine/places/consistency.hpp"
#include "server/engine/places/place_candidates.hpp"

namespace isthmus {

/// Finds that wait until several agree all around the loops that they form (pairwise consistency
/// maximisation, Mangelson et al. 2018), and the hypotheses that were proposed of them.
class HypothesisPool {
 public:
  /// A find joins the pool with its agreements with those that wait there.
  void take(World world, const std::string& robot, Find find, HypothesisCounts& counts);
  /// Proposes what has become possible, unless something is on trial.
  void advance(World world, Closures& closures, HypothesisCounts& counts);
  /// The same whatever has changed. False: nothing was proposed.
  bool propose(World world, Closures& closures, HypothesisCounts& counts);
  /// Takes in what became of those that were proposed, and passes on what has been refuted.
  void take_outcomes(World world, Closures& closures, HypothesisCounts& counts);
  /// What was tried may be proposed again.
  void try_all_again();

  /// A robot's data is taken out.
  void forget_robot(const Map& map, const std::string& robot);
  /// Something else has shown it to be false.
  void refute(ClosureId id, Reason reason);

  /// Where a patch lies if those that wait are true, by those on either side of which it lies near.
  std::vector<PlaceHint> hints(const Map& map, PatchId patch, const EngineOptions& options) const;

  std::vector<UndecidedHypothesis> undecided() const;
  std::size_t waiting() const { return pool_.size(); }

  auto members() {
    return std::tie(pool_, agreements_, changed_, hypotheses_, parked_, refused_merges_, refused_loops_,
                    refuted_);
  }

 private:
  struct Waiting {
    Find find;
    std::string robot;
    ClosureId hypothesis;  ///< that it has been proposed with, if any

    auto members() { return std::tie(find, robot, hypothesis); }
  };
  struct Refutation {
    ClosureId id;
    Reason reason = Reason::none;

    auto members() { return std::tie(id, reason); }
  };
  struct Hypothesis {
    UndecidedHypothesis says;
    int tried = 0;  ///< finds when it was last on trial
    bool undecided = false;

    auto members() { return std::tie(says, tried, undecided); }
  };

  bool propose(World world, Closures& closures, const std::vector<std::size_t>& set);
  double log_odds(const std::vector<std::size_t>& set, const AnswersAlongWayOptions& options) const;
  double rivals_log_odds(const Map& map, const std::vector<std::size_t>& set,
                         const EngineOptions& options) const;
  void conclude(const Map& map, const ClosureOutcome& outcome, const EngineOptions& options);
  void take_in(World world, ClosureId closure);
  void let_go(World world, ClosureId withdrawn, HypothesisCounts& counts);
  void reopen(World world, HypothesisCounts& counts);
  void remove(const std::vector<bool>& gone);

  std::vector<Waiting> pool_;
  AgreementTable agreements_;
  bool changed_ = false;
  std::map<ClosureId, Hypothesis> hypotheses_;
  std::map<ClosureId, std::vector<Waiting>> parked_;  ///< finds of closures that may be withdrawn or allowed
  std::vector<Waiting> refused_merges_;  ///< the newest finds of two islands whose merge was refused,
  std::vector<Waiting> refused_loops_;   ///< and of loops that were
  std::vector<Refutation> refuted_;
};

}  // namespace isthmus
