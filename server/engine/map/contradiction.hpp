#pragma once

#include <optional>

#include "patches/manifold.hpp"
#include "server/engine/input/options/map_options.hpp"

namespace isthmus {

/// The share of a patch's hits that lie deep in another's free space, seen in both directions: walls where
/// the other looked through. Nothing where the two hardly look at the same place.
std::optional<double> contradiction(const Patch& a, const Patch& b, const Pose& a_from_b,
                                    const ContradictionOptions& options);

/// Its mean over pairs of patches, of those that look at the same place.
class MeanContradiction {
 public:
  explicit MeanContradiction(const ContradictionOptions& options) : options_(options) {}

  void add(const Patch& a, const Patch& b, const Pose& a_from_b);
  /// Two patches of one island where the manifold has them.
  void add(const Manifold& manifold, PatchId a, PatchId b);

  int pairs() const { return pairs_; }
  double mean(double of_none = 0) const { return pairs_ > 0 ? sum_ / pairs_ : of_none; }

 private:
  ContradictionOptions options_;
  double sum_ = 0;
  int pairs_ = 0;
};

}  // namespace isthmus
