#pragma once

#include <vector>

#include "server/features/fusion/fusion.hpp"
#include "server/features/fusion/landmark_tree.hpp"
#include "server/features/fusion/tie_filter.hpp"

namespace isthmus {

/// That feature `two` of the second map is feature `one` of the first (indices), given the ties so far.
struct TwinCandidate {
  std::size_t one = 0;
  std::size_t two = 0;
  MapTie tie;
  GivenTie given;
  LocalVector residual;          ///< with the place of the second map as the ties have it
  LocalMatrix covariance;        ///< and what that may be off
  Eigen::Index silent_rows = 0;  ///< first ones, that count for the gate alone: the direction of a wall
  double squared_distance = 0;
  double log_chance = 0;  ///< logarithm of the density with which an unrelated feature would be found there
};

/// What the searches of a fusion may still cost, counted in steps: candidates looked at, pairs of them that
/// are compared, and pairings tried. So what there is of look-alikes bounds a fusion, and not the clock.
class SearchWork {
 public:
  explicit SearchWork(std::size_t steps) : left_(steps) {}
  /// False, and nothing is left, where there is not so much.
  bool spend(std::size_t steps) {
    const bool enough = steps <= left_;
    left_ = enough ? left_ - steps : 0;
    return enough;
  }
  std::size_t left() const { return left_; }

 private:
  std::size_t left_;
};

/// What may be each one's twin, and which of several features' possible twins are theirs.
///
/// An account of evidence: a pair is that much more likely than two unrelated features as the density of its
/// residual, given the pairs before it, is above that of features of its kind thereabouts. Of a segment only
/// the line's distance and its ends count: a building's walls are parallel, so that two have one direction
/// says nothing. All ways to pair a group of features are looked at together (branch and bound, so that where
/// the whole group may be off it is seen by how its members lie to one another), and a pair holds where the
/// best way with it is `min_log_odds` more likely than the best way without. A search that ends at its bound
/// has not seen all ways: nothing of it holds.
class TwinSearch {
 public:
  TwinSearch(const TiedMaps& maps, const LandmarkTree& tree, const FusionOptions& options);

  /// Those of one feature, nearest first; `taken` marks features of the first map that have a twin.
  std::vector<TwinCandidate> candidates(const TiedMaps& maps, const TieFilter& ties, std::size_t two,
                                        const std::vector<bool>& taken, SearchWork& work) const;

  /// Indices of the candidates that hold, by feature of the second map as they come; candidates of one
  /// feature lie side by side.
  std::vector<std::size_t> certain(const TiedMaps& maps, const TieFilter& ties,
                                   const std::vector<TwinCandidate>& all, SearchWork& work) const;

 private:
  double log_chance(const FeatureState& one, std::size_t index, const MapTie& tie) const;

  const LandmarkTree& tree_;
  const FusionOptions& options_;
  Gates gates_;
  double largest_sigma_one_ = 0;
};

}  // namespace isthmus
