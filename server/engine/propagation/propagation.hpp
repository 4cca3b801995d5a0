#pragma once

#include <deque>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "server/engine/input/engine_options.hpp"
#include "server/engine/map/map.hpp"

namespace isthmus {

/// Propagates a change of topology through a map (Howard et al. 2006, IV-B, steps 2 to 5): a queue of
/// patches, each of which is matched with what now lies near it, and whose neighbours follow where that found
/// new relations.
///
/// *New* is a relation across the border: between patches that, before the change, were far from one another
/// in the graph or not connected, and that have no relation yet; far by matches and odometry, since a
/// sighting says little of where walls are. A patch comes to the queue a few times at most, so the queue
/// ends.
///
/// The same serves without a single change to start from ("proximity matching"): patches that have come to be
/// well determined relative to one another, by whatever means, and lie near, but are not related.
class Propagation {
 public:
  Propagation() = default;  ///< to be read from a snapshot
  /// `before` is the graph without the change; none for proximity matching, which takes the
  /// current graph.
  Propagation(std::optional<RelationGraph> before, Origin origin)
      : before_(std::move(before)), origin_(origin) {}

  void enqueue(PatchId patch, const PropagationOptions& options);
  bool done() const { return queue_.empty(); }

  /// Takes the first patch off the queue. Returns whether new relations were added.
  bool step(Map& map, const EngineOptions& options);
  /// Puts back on the queue what was compared and did not fit, once more: poses are better now.
  void retry(const PropagationOptions& options);

  /// For proximity matching: patches may come to the queue again.
  void forget_visits();

  /// Those of a patch's side of the border, by id.
  std::vector<PatchId> same_side(const Map& map, PatchId patch, const PropagationOptions& options) const;

  /// The graph without the change.
  const RelationGraph& before() const { return *before_; }

  int steps() const { return steps_; }
  const std::vector<PatchId>& matched() const { return matched_; }  ///< in order, each once
  const std::vector<PatchId>& unmatched() const {
    return unmatched_;
  }  ///< compared where they must fit, and did not

  auto members() {
    return std::tie(before_, origin_, queue_, visits_, matched_, unmatched_, untold_, steps_);
  }

 private:
  struct Visits {
    int count = 0;
    bool queued = false;
    bool matched = false;
    bool unmatched = false;

    auto members() { return std::tie(count, queued, matched, unmatched); }
  };
  Visits& visits(PatchId patch);
  bool is_joined(const Map& map, PatchId patch) const;
  void take_from_unmatched(PatchId patch);
  std::vector<PatchId> candidates(const Map& map, PatchId patch, const EngineOptions& options) const;

  std::optional<RelationGraph> before_;
  Origin origin_;
  std::deque<PatchId> queue_;
  std::vector<Visits> visits_;  // by patch id
  std::vector<PatchId> matched_;
  std::vector<PatchId> unmatched_;
  std::vector<PatchId> untold_;  // that look where what they were compared with does not: that tells nothing
  int steps_ = 0;
};

}  // namespace isthmus
