#pragma once

#include <tuple>
#include <vector>

#include "relations/confidence.hpp"
#include "scanmatch/local_map.hpp"
#include "server/engine/input/engine_options.hpp"
#include "server/engine/map/map.hpp"

namespace isthmus {

/// A patch that is determined relative to another.
struct Determined {
  PatchId patch;
  Pose local_from_patch;       ///< in the frame of the reference patch
  Eigen::Matrix3d covariance;  ///< of that pose
  /// Eq. 12 holds by scans and odometry alone: it belongs to the local map. Sightings are exact to
  /// some centimetres only, too coarse for aligning walls.
  bool well_determined = false;
  bool by_all_relations = false;  ///< eq. 12 holds by all relations

  auto members() { return std::tie(patch, local_from_patch, covariance, well_determined, by_all_relations); }
};

/// The surroundings of a patch: what is determined relative to it, kept until the patch or the graph near it
/// changes. `well_determined` patches, those of eq. 12, make the local map that every scan is matched with;
/// the others are where a local loop may be about to close, and are matched on their own (local_loop.hpp).
class Surroundings {
 public:
  /// By which relations patches are determined here. What scans and odometry say is all that localisation
  /// needs; where loops may close, sightings tell where to look. By all, which of them make the local map is
  /// left open; where that is asked too, it is by both, which costs twice as much.
  enum class By { scans, all, both };

  /// Looks again if the reference, or the graph near it, has changed since.
  void update(const Map& map, PatchId reference, const EngineOptions& options, By by) {
    update(map, reference, options, by, options.surroundings.confidence_patches);
  }
  void update(const Map& map, PatchId reference, const EngineOptions& options, By by,
              std::size_t max_patches);

  PatchId reference() const { return reference_; }
  /// Changes whenever `update` had to look again.
  std::int64_t stamp() const { return stamp_; }
  const std::vector<Determined>& patches() const { return patches_; }

  /// The well determined patches near a pose that a scan from there would overlap with: the oldest, which
  /// hold the map together, and the newest.
  LocalMap local_map(const Map& map, const Pose& local_from_robot, std::span<const ScanPoint> points,
                     const EngineOptions& options) const;

  /// The well determined patches nearest to a pose, whatever a scan from there would see: for a scan whose
  /// pose is in doubt. As many as a local map has at most.
  LocalMap nearest_patches(const Map& map, const Pose& local_from_robot,
                           const SurroundingsOptions& options) const;

  auto members() { return std::tie(reference_, stamp_, max_patches_, by_, looked_at_, patches_); }

 private:
  PatchId reference_;
  std::int64_t stamp_ = -1;  // of `looked_at_` when they were looked at
  std::size_t max_patches_ = 0;
  By by_ = By::scans;
  std::vector<PatchId> looked_at_;
  std::vector<Determined> patches_;
};

/// Whether a relation was measured by matching scans.
bool is_match(const Relation& relation);
/// Whether a relation is as fine as matching needs: of scans, or of odometry from patch to patch.
bool says_where_walls_are(const Relation& relation);

/// Share of a scan's points that have a patch's point near them, at a pose: a quick look at every few beams.
double overlap_share(const Patch& patch, const Pose& patch_from_robot, std::span<const ScanPoint> points,
                     const SurroundingsOptions& options);

}  // namespace isthmus
