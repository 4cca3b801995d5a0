#pragma once

#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "patches/patch.hpp"
#include "relations/fit.hpp"
#include "relations/weakest_cut.hpp"
#include "server/engine/input/options/map_options.hpp"

namespace isthmus {

/// The relations of an island as links that may be wrong. The relations that a patch's scan left when it was
/// placed are wrong together: a scan that was taken for one that lies elsewhere fits all that it seemed to
/// fit. What was matched later, and what odometry said, are mistakes of their own. The worse a relation fits
/// where the map has its patches, the likelier it is wrong.
std::vector<UncertainLink> uncertain_links(const RelationGraph& graph, IslandId island,
                                           std::span<const Pose> poses, const WeakLinkOptions& options);

/// A loop that was closed earlier, and the log-odds that this was right.
struct UncertainClosure {
  ClosureId id;
  double log_odds = 0;

  auto members() { return std::tie(id, log_odds); }
};

/// A loop that closes otherwise than a map has it: the patches that lie near one another by it, of either
/// side, how the second side moves by it, in the plane of the island, the way over the map between them, and
/// the loops of the island that were closed before.
struct OpenLoop {
  std::vector<PatchId> first;
  std::vector<PatchId> second;
  Pose first_from_second;
  double way_m = 0;
  std::vector<UncertainClosure> closed_before = {};

  auto members() { return std::tie(first, second, first_from_second, way_m, closed_before); }
};

/// What the relations of a map were wrong in, if a closure is right that they are at odds with: a link, or a
/// closure that was accepted before, with all that rests on it.
struct Blame {
  double log_odds = 0;       ///< that it is right, but for the closure,
  double none_log_odds = 0;  ///< and that all are that might be wrong in its stead, each as sure as it is
  WeakestCut link;           ///< nothing in it: an earlier closure is to blame,
  ClosureId closure;         ///< this
  std::vector<RelationId> wrong;  ///< those that do not agree with the closure, by id
  double cost = 0;          ///< of the fit with the closure and without those, and of the noise of those
  std::vector<Pose> poses;  ///< of the island by that fit
};

/// How far robots can have gone from one of their patches to another.
struct Reach {
  std::vector<PatchPtr> patches;  ///< by id; none: as far as may be
  double max_speed_m_per_s = 0;
  double slack_m = 0;  ///< that patches may be off beyond it

  /// Bounds the way that a robot made in the time between two of its patches; what different robots made
  /// has no bound.
  double between_m(PatchId a, PatchId b) const;
};

/// A map and a loop that is at odds with it. Keeps references.
struct Contradiction {
  const OpenLoop& loop;
  const RelationGraph& before;  ///< without the closure,
  std::span<const Pose> poses_before;
  const RelationGraph& fitted;  ///< and with it,
  double cost;                  ///< which its fit costs
  double max_log_odds;          ///< where it is surer that no link, or no closure, is wrong, none is to blame
  double log_window;  ///< logarithm of the volume (m² rad) that was searched: a place that looks alike is
                      ///< anywhere in it
  const Reach& reach;
};

/// Whether the link that is weakest around a loop, or a loop that was closed before, was wrong, rather than
/// all relations off by a little: where the island, fitted with the closure, costs more than without the
/// culprit, beyond what its own noise costs in any case, by more than the log-odds that it is right. (The
/// costs are negative log-likelihoods.) Of several that which explains most. A link is the surer the farther
/// off it would have to be, what slips does so by metres, and certain where no robot gets so far. That it is
/// that link and none of the others was not known before: each adds to the odds that one is wrong by its own.
std::optional<Blame> blame(const Contradiction& map, const WeakLinkOptions& options);

}  // namespace isthmus
