#pragma once

#include <optional>
#include <span>
#include <tuple>
#include <vector>

#include "patches/patch.hpp"

namespace isthmus {

/// A pose on the manifold (Howard et al. 2006, III-A): the pose r of something in the frame of a patch.
struct ManifoldPose {
  PatchId patch;
  Pose patch_from_object;
};

/// The patches and their projected poses. Ids are dense: 0, 1, 2, ... Patches of different islands live in
/// different planes; which island a patch is on is the relation graph's knowledge, so queries here take the
/// candidates to look at.
class Manifold {
 public:
  PatchId next_id() const { return PatchId{static_cast<std::int32_t>(patches_.size())}; }
  /// The patch's id must be next_id().
  void add(PatchPtr patch, const Pose& map_from_patch);

  std::size_t size() const { return patches_.size(); }
  const Patch& patch(PatchId id) const { return *patches_[index(id)]; }
  const PatchPtr& shared_patch(PatchId id) const { return patches_[index(id)]; }
  const Pose& pose(PatchId id) const { return poses_[index(id)]; }
  /// a_from_b of the projected poses: b's pose seen from a, π_b ⊖ π_a. Both patches must be on one island.
  Pose relative_pose(PatchId a, PatchId b) const { return ominus(pose(b), pose(a)); }
  void set_pose(PatchId id, const Pose& map_from_patch) { poses_[index(id)] = map_from_patch; }

  std::span<const PatchPtr> patches() const { return patches_; }
  std::span<const Pose> poses() const { return poses_; }
  std::span<Pose> poses() { return poses_; }

  /// The projection of a manifold pose on its island's plane: r ⊕ π.
  Pose project(const ManifoldPose& pose) const;

  /// The pose r̄ in another patch of the same island (eq. 3): r̄ = r ⊕ π ⊖ π̄. Meaningful as "the same point
  /// of the manifold" only where the patches overlap (eq. 2).
  ManifoldPose transform(const ManifoldPose& pose, PatchId target) const;

  /// The identity test (eq. 2): the patches' free spaces overlap in projection and the projected poses agree.
  /// Both patches must be on one island.
  bool same_pose(const ManifoldPose& a, const ManifoldPose& b, double tolerance_m = 1e-6,
                 double tolerance_rad = 1e-6) const;

  /// Whether the projections of two patches' free spaces overlap.
  bool overlap(PatchId a, PatchId b) const;

  /// Around its origin a patch is free this far in every direction: a robot stood there.
  static constexpr double footprint_m = 0.5;

  /// Projects a pose of the plane back on the manifold (eq. 14): the candidate with the nearest origin whose
  /// free space contains the pose's position; the nearest origin of all where none contains it. A
  /// patch contains what its laser saw as free, and its footprint.
  std::optional<ManifoldPose> project_back(const Pose& map_from_object,
                                           std::span<const PatchId> candidates) const;

  auto members() { return std::tie(patches_, poses_); }

 private:
  std::vector<PatchPtr> patches_;
  std::vector<Pose> poses_;
};

}  // namespace isthmus
