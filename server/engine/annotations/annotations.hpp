#pragma once

#include <functional>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "server/engine/annotations/annotation.hpp"
#include "server/engine/annotations/annotation_limits.hpp"
#include "server/engine/input/drop_reason.hpp"
#include "server/engine/input/event.hpp"
#include "server/engine/map/map.hpp"

namespace isthmus {

/// Whether a patch is on the map, and no data that an operator has dropped.
using IsOnMap = std::function<bool(PatchId)>;

/// Places and zones that operators have written on the map. Each point is held by the patch that is nearest
/// to it, so that fits and merges carry it along. Changes nothing of the map.
class Annotations {
 public:
  explicit Annotations(AnnotationLimits limits = {}) : limits_(limits) {}

  /// Returns why it is refused, or none.
  DropReason take(const AnnotationEvent& event, const Map& map, const IsOnMap& is_on_map);

  /// Points that are held by patches of a robot whose data will be dropped are held by the nearest of the
  /// others from now on, where there is one; to be called before.
  void leave(const std::string& robot, const Map& map, const IsOnMap& is_on_map);

  bool empty() const { return annotations_.empty(); }
  /// By name. A point whose patch is gone, or is on another island than most of them (a merge was
  /// withdrawn), is told from the nearest of the others: the annotation keeps the shape it was drawn in.
  std::vector<AnnotationRecord> records(const Map& map, const IsOnMap& is_on_map) const;

  /// For snapshots.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(annotations_);
  }

 private:
  AnnotationLimits limits_;
  std::vector<Annotation> annotations_;  // by name, without case
};

/// Whether a text can name a place or zone.
bool is_annotation_name(const std::string& text);

/// Whether two names are the same.
bool is_same_name(const std::string& a, const std::string& b);

}  // namespace isthmus
