#include "server/engine/annotations/annotations.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <span>
#include <utility>

#include "server/engine/annotations/polygon_check.hpp"
#include "server/engine/input/robot_name.hpp"
#include "server/engine/map/ways.hpp"

namespace isthmus {
namespace {

using Point = Eigen::Vector2d;

bool is_patch(const Map& map, PatchId id, const IsOnMap& is_on_map) {
  return id.valid() && id.value < map.manifold().next_id().value && is_on_map(id);
}

/// What an annotation says, in the plane of one island.
struct Drawing {
  IslandId island;
  std::vector<Point> points;
  double yaw_rad = 0;
  DropReason refusal = DropReason::none;
};

Drawing refused(DropReason reason) { return {{}, {}, 0, reason}; }

Drawing drawing_of(const AnnotationEvent& event, const Map& map, const IsOnMap& is_on_map) {
  Drawing drawing;
  drawing.island = event.island;
  drawing.yaw_rad = event.yaw_rad;
  const bool in_plane = event.island.valid();
  if (in_plane &&
      (!is_patch(map, event.island, is_on_map) || map.graph().island(event.island) != event.island))
    return refused(DropReason::unknown_patch);
  for (const AnnotationEvent::Point& point : event.points) {
    if (in_plane) {
      drawing.points.push_back(point.position);
      continue;
    }
    if (!is_patch(map, point.patch, is_on_map)) return refused(DropReason::unknown_patch);
    const IslandId island = map.graph().island(point.patch);
    if (drawing.island.valid() && island != drawing.island) return refused(DropReason::other_island);
    drawing.island = island;
    const Pose& map_from_patch = map.manifold().pose(point.patch);
    drawing.points.push_back(map_from_patch * point.position);
    drawing.yaw_rad = map_from_patch.yaw + event.yaw_rad;
  }
  return drawing;
}

/// Of some patches, the one whose origin is nearest to a point and that `may_hold` it.
template <class MayHold>
std::optional<PatchId> nearest(const Map& map, const std::vector<PatchId>& patches, const Point& point,
                               double within_m, const MayHold& may_hold) {
  std::optional<PatchId> best;
  double least = within_m;
  for (const PatchId id : patches) {
    const double distance = (position(map.manifold().pose(id)) - point).norm();
    if (!(distance <= least) || (best && distance == least) || !may_hold(id)) continue;
    best = id;
    least = distance;
  }
  return best;
}

/// Patches of an island that can hold a point: of those of tags only the position is known.
std::vector<PatchId> holders(const Map& map, IslandId island, const IsOnMap& is_on_map) {
  std::vector<PatchId> patches;
  for (const PatchId id : map.graph().patches_of(island))
    if (is_on_map(id) && map.manifold().patch(id).tag < 0) patches.push_back(id);
  return patches;
}

/// Nothing where a point is too far from the map.
std::optional<std::vector<Anchor>> anchored(const Map& map, const Drawing& drawing,
                                            const AnnotationLimits& limits, const IsOnMap& is_on_map) {
  const std::vector<PatchId> patches = holders(map, drawing.island, is_on_map);
  std::vector<Anchor> anchors;
  std::vector<double> ways;
  for (const Point& point : drawing.points) {
    const auto is_of_same_stretch = [&](PatchId id) {
      if (anchors.empty()) return true;
      const Point from = position(anchors.front().drawn_from_patch);
      const double straight_m = (position(map.manifold().pose(id)) - from).norm();
      return ways[static_cast<std::size_t>(id.value)] <= limits.way_share * straight_m + limits.way_m;
    };
    const auto patch = nearest(map, patches, point, limits.from_patch_m, is_of_same_stretch);
    if (!patch) return std::nullopt;
    anchors.push_back({*patch, map.manifold().pose(*patch), point});
    if (ways.empty()) ways = ways_over_relations_m(map, std::span(&*patch, 1));
  }
  return anchors;
}

DropReason check_shape(const AnnotationEvent& event, const Drawing& drawing, const AnnotationLimits& limits) {
  if (!is_zone(event.kind)) return DropReason::none;
  const bool fine = drawing.points.size() <= limits.corners && is_simple(drawing.points) &&
                    std::abs(signed_area_m2(drawing.points)) >= limits.min_area_m2;
  return fine ? DropReason::none : DropReason::bad_polygon;
}

bool is_letter_or_digit(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
}

/// The island that most anchors are on that are on the map, of several the lowest; none where none is.
IslandId home_of(const Annotation& annotation, const Map& map, const IsOnMap& is_on_map) {
  std::map<IslandId, int> counts;
  for (const Anchor& anchor : annotation.anchors)
    if (is_patch(map, anchor.patch, is_on_map)) counts[map.graph().island(anchor.patch)] += 1;
  const auto most =
      std::ranges::max_element(counts, [](const auto& a, const auto& b) { return a.second < b.second; });
  return most == counts.end() ? IslandId{} : most->first;
}

ManifoldPose held_by(const Anchor& holder, const Point& drawn, double drawn_yaw_rad) {
  return {holder.patch, ominus({drawn.x(), drawn.y(), drawn_yaw_rad}, holder.drawn_from_patch)};
}

bool holds_numbers(const Anchor& anchor) {
  const Pose& pose = anchor.drawn_from_patch;
  return std::isfinite(pose.x) && std::isfinite(pose.y) && std::isfinite(pose.yaw) &&
         anchor.drawn.allFinite();
}

}  // namespace

bool Annotation::is_sound() const {
  constexpr std::size_t min_corners = 3;
  const bool counts = is_zone(kind) ? anchors.size() >= min_corners : anchors.size() == 1;
  return kind != AnnotationKind::erase && counts && is_annotation_name(name) &&
         std::isfinite(max_speed_m_s) && std::isfinite(drawn_yaw_rad) &&
         std::ranges::all_of(anchors, holds_numbers);
}

DropReason Annotations::take(const AnnotationEvent& event, const Map& map, const IsOnMap& is_on_map) {
  const std::string key = upper_case(event.name);
  const auto at = std::ranges::lower_bound(annotations_, key, {},
                                           [](const Annotation& one) { return upper_case(one.name); });
  const bool is_there = at != annotations_.end() && is_same_name(at->name, event.name);
  if (event.kind == AnnotationKind::erase) {
    if (!is_there) return DropReason::no_such_name;
    annotations_.erase(at);
    return DropReason::none;
  }
  if (is_there && !event.replace) return DropReason::name_taken;
  if (!is_there && annotations_.size() >= limits_.annotations) return DropReason::too_many_annotations;
  const Drawing drawing = drawing_of(event, map, is_on_map);
  if (drawing.refusal != DropReason::none) return drawing.refusal;
  if (const DropReason reason = check_shape(event, drawing, limits_); reason != DropReason::none)
    return reason;
  std::optional<std::vector<Anchor>> anchors = anchored(map, drawing, limits_, is_on_map);
  if (!anchors) return DropReason::off_the_map;
  Annotation drawn{event.kind, event.name, event.max_speed_m_s, drawing.yaw_rad, *std::move(anchors)};
  if (is_there)
    *at = std::move(drawn);
  else
    annotations_.insert(at, std::move(drawn));
  return DropReason::none;
}

void Annotations::leave(const std::string& robot, const Map& map, const IsOnMap& is_on_map) {
  const auto stays = [&](PatchId id) { return is_on_map(id) && map.manifold().patch(id).robot != robot; };
  for (Annotation& annotation : annotations_) {
    const IslandId island = home_of(annotation, map, is_on_map);
    if (!island.valid()) continue;
    const std::vector<PatchId> patches = holders(map, island, stays);
    for (Anchor& anchor : annotation.anchors) {
      if (!is_patch(map, anchor.patch, is_on_map) || stays(anchor.patch) ||
          map.graph().island(anchor.patch) != island)
        continue;
      const Pose& now = map.manifold().pose(anchor.patch);
      const Point point = now * (inverse(anchor.drawn_from_patch) * anchor.drawn);
      const auto other = nearest(map, patches, point, limits_.from_patch_m, [](PatchId) { return true; });
      if (!other) continue;
      // As if the other had held it from the beginning: in the plane it was drawn in.
      const Pose drawn_from_now = anchor.drawn_from_patch * inverse(now);
      anchor = {*other, drawn_from_now * map.manifold().pose(*other), anchor.drawn};
    }
  }
}

std::vector<AnnotationRecord> Annotations::records(const Map& map, const IsOnMap& is_on_map) const {
  std::vector<AnnotationRecord> records;
  for (const Annotation& annotation : annotations_) {
    AnnotationRecord record;
    record.kind = annotation.kind;
    record.name = annotation.name;
    record.max_speed_m_s = annotation.max_speed_m_s;
    record.island = home_of(annotation, map, is_on_map);
    record.lost = !record.island.valid();
    const auto holds = [&](const Anchor& anchor) {
      return record.lost ||
             (is_patch(map, anchor.patch, is_on_map) && map.graph().island(anchor.patch) == record.island);
    };
    for (const Anchor& anchor : annotation.anchors) {
      const Anchor* holder = holds(anchor) ? &anchor : nullptr;
      for (const Anchor& other : annotation.anchors) {
        if (holds(anchor) || !holds(other)) continue;
        const double distance = (other.drawn - anchor.drawn).norm();
        if (!holder || distance < (holder->drawn - anchor.drawn).norm()) holder = &other;
      }
      record.moved += holder == &anchor ? 0 : 1;
      record.points.push_back(held_by(*holder, anchor.drawn, annotation.drawn_yaw_rad));
    }
    records.push_back(std::move(record));
  }
  return records;
}

bool is_annotation_name(const std::string& text) {
  constexpr std::size_t max_letters = 48;
  return !text.empty() && text.size() <= max_letters && is_letter_or_digit(text.front()) &&
         is_letter_or_digit(text.back()) && std::ranges::all_of(text, [](char c) {
           return is_letter_or_digit(c) || c == ' ' || c == '.' || c == '_' || c == '-';
         });
}

bool is_same_name(const std::string& a, const std::string& b) { return upper_case(a) == upper_case(b); }

}  // namespace isthmus
