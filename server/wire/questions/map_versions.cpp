#include "server/wire/questions/map_versions.hpp"

#include <algorithm>
#include <iterator>

namespace isthmus {
namespace {

bool is_same(const Pose& a, const Pose& b) { return a.x == b.x && a.y == b.y && a.yaw == b.yaw; }

RelationId last_relation(const RelationGraph& graph) {
  RelationId last;
  for (const auto& [id, relation] : graph.relations()) last = id;
  return last;
}

}  // namespace

bool MapVersions::note(const MapCopy& map, std::int64_t utime) {
  const std::int64_t next = std::max(utime, version_ + 1);
  const RelationId last = last_relation(map.graph);
  bool differs = relations_ != map.graph.relations().size() || last_relation_ != last;
  std::vector<PatchId> dropped_or_back;
  std::set_symmetric_difference(left_out_.begin(), left_out_.end(), map.left_out.begin(), map.left_out.end(),
                                std::back_inserter(dropped_or_back));
  changed_.resize(map.poses.size());
  for (std::size_t i = 0; i < map.poses.size(); ++i) {
    const PatchId id{static_cast<std::int32_t>(i)};
    const bool stays = i < poses_.size() && is_same(poses_[i], map.poses[i]) &&
                       !std::binary_search(dropped_or_back.begin(), dropped_or_back.end(), id);
    if (stays) continue;
    changed_[i] = next;
    differs = true;
  }
  poses_ = map.poses;
  left_out_ = map.left_out;
  relations_ = map.graph.relations().size();
  last_relation_ = last;
  if (differs || version_ == 0) version_ = next;
  return differs;
}

std::optional<std::vector<PatchId>> MapVersions::changed_since(std::int64_t version) const {
  if (version > version_) return std::nullopt;
  std::vector<PatchId> changed;
  for (std::size_t i = 0; i < changed_.size(); ++i)
    if (changed_[i] > version) changed.push_back(PatchId{static_cast<std::int32_t>(i)});
  return changed;
}

}  // namespace isthmus
