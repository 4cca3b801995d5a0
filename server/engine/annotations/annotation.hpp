#pragma once

#include <Eigen/Core>
#include <string>
#include <tuple>
#include <vector>

#include "patches/manifold.hpp"
#include "server/engine/input/annotation_kind.hpp"

namespace isthmus {

/// A point of a place or zone, held by a patch: where both were in an island's plane when it was drawn. All
/// points of an annotation were drawn in one plane, so that one whose patch is gone can be told from another.
struct Anchor {
  PatchId patch;
  Pose drawn_from_patch;
  Eigen::Vector2d drawn = Eigen::Vector2d::Zero();  ///< m

  auto members() { return std::tie(patch, drawn_from_patch, drawn); }
};

/// A place, with one anchor, or a zone, with one for each corner.
struct Annotation {
  AnnotationKind kind = AnnotationKind::place;
  std::string name;
  double max_speed_m_s = 0;  ///< of a speed zone
  double drawn_yaw_rad = 0;  ///< of a place, in the plane it was drawn in
  std::vector<Anchor> anchors;

  /// Whether it is one that could have been drawn: of a snapshot that may be damaged.
  bool is_sound() const;

  auto members() { return std::tie(kind, name, max_speed_m_s, drawn_yaw_rad, anchors); }
};

/// An annotation as the map has it now.
struct AnnotationRecord {
  AnnotationKind kind = AnnotationKind::place;
  std::string name;
  double max_speed_m_s = 0;  ///< of a speed zone; else 0
  IslandId island;           ///< none where it is lost
  /// A place, or a zone's corners in turn; of those only the position counts. All on `island`: a fit of the
  /// map moves them along.
  std::vector<ManifoldPose> points;
  int moved = 0;      ///< points whose patch is gone or on another island, told from the others
  bool lost = false;  ///< no patch that holds it is on the map (an operator has dropped a robot's data)
};

}  // namespace isthmus
