#pragma once

#include <optional>
#include <span>

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

/// Its mean over patches, of what others say of each: every patch counts once, however many it is
/// compared with. So a few far from where two maps meet, where a loop is still open, do not outvote the rest.
class ContradictionByPatch {
 public:
  /// Keeps a reference to the manifold.
  ContradictionByPatch(const Manifold& manifold, const ContradictionOptions& options)
      : manifold_(manifold), options_(options) {}

  /// Compares a patch with others of its island, where the manifold has them.
  void add(PatchId patch, std::span<const PatchId> others);

  int pairs() const { return pairs_; }
  double mean() const { return patches_ > 0 ? sum_ / patches_ : 0; }

 private:
  const Manifold& manifold_;
  ContradictionOptions options_;
  double sum_ = 0;
  int patches_ = 0;
  int pairs_ = 0;
};

}  // namespace isthmus
