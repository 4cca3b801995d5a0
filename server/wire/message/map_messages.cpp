#include "server/wire/message/map_messages.hpp"

#include <cmath>
#include <string>

namespace isthmus {
namespace {

/// Below the 64 KiB of a UDP datagram, with room for headers.
constexpr int max_chunk_bytes = 60'000;

void append_ring(patch_t& message, const Ring& ring) {
  message.ring_sizes.push_back(static_cast<std::int32_t>(ring.size()));
  for (const Eigen::Vector2d& vertex : ring) {
    message.x_m.push_back(static_cast<float>(vertex.x()));
    message.y_m.push_back(static_cast<float>(vertex.y()));
  }
}

patch_t patch_message(const Patch& patch, const Pose& map_from_patch, IslandId island, bool with_free_space) {
  patch_t message{};
  message.id = patch.id.value;
  message.island = island.value;
  message.robot = patch.robot;
  message.utime = patch.utime;
  message.map_from_patch[0] = map_from_patch.x;
  message.map_from_patch[1] = map_from_patch.y;
  message.map_from_patch[2] = map_from_patch.yaw;
  if (with_free_space) {
    for (const PolygonWithHoles& polygon : patch.free_space.polygons()) {
      append_ring(message, polygon.outer);
      for (const Ring& hole : polygon.holes) append_ring(message, hole);
    }
  }
  message.nrings = static_cast<std::int32_t>(message.ring_sizes.size());
  message.nvertices = static_cast<std::int32_t>(message.x_m.size());
  return message;
}

relation_t relation_message(const Relation& relation) {
  relation_t message{};
  message.id = relation.id.value;
  message.a = relation.a.value;
  message.b = relation.b.value;
  message.kind = std::string(name(relation.kind));
  message.origin = std::string(name(relation.origin.kind));
  message.closure = relation.origin.closure.value;
  message.count = count(relation);
  return message;
}

/// Fills chunks one after the other.
class ChunkWriter {
 public:
  ChunkWriter(std::int64_t utime, bool whole) : utime_(utime), whole_(whole) {}

  void add(patch_t patch) {
    map_t& chunk = room_for(patch._getEncodedSizeNoHash());
    chunk.patches.push_back(std::move(patch));
    chunk.npatches += 1;
  }
  void add(relation_t relation) {
    map_t& chunk = room_for(relation._getEncodedSizeNoHash());
    chunk.relations.push_back(std::move(relation));
    chunk.nrelations += 1;
  }
  void add_removed(RelationId id) {
    map_t& chunk = room_for(4);
    chunk.removed_relations.push_back(id.value);
    chunk.nremoved += 1;
  }

  std::vector<map_t> finish() {
    if (chunks_.empty() && whole_) start();
    for (map_t& chunk : chunks_) chunk.nchunks = static_cast<std::int32_t>(chunks_.size());
    return std::move(chunks_);
  }

 private:
  void start() {
    map_t chunk{};
    chunk.utime = utime_;
    chunk.whole = whole_ ? 1 : 0;
    chunk.chunk = static_cast<std::int32_t>(chunks_.size());
    chunks_.push_back(std::move(chunk));
    bytes_ = 0;
  }
  map_t& room_for(int bytes) {
    if (chunks_.empty() || bytes_ + bytes > max_chunk_bytes) start();
    bytes_ += bytes;
    return chunks_.back();
  }

  std::int64_t utime_;
  bool whole_;
  int bytes_ = 0;
  std::vector<map_t> chunks_;
};

/// The island of each patch, by patch id.
std::vector<IslandId> islands_by_patch(const MapCopy& map) {
  std::vector<IslandId> by_patch(map.patches.size());
  for (const std::vector<PatchId>& island : map.graph.islands()) {
    for (const PatchId patch : island) by_patch[static_cast<std::size_t>(patch.value)] = island.front();
  }
  return by_patch;
}

bool is_still_pose(const Pose& a, const Pose& b) {
  return std::hypot(a.x - b.x, a.y - b.y) < MapMessages::still_m &&
         std::abs(wrap_angle(a.yaw - b.yaw)) < MapMessages::still_rad;
}

}  // namespace

std::vector<map_t> MapMessages::whole(const MapCopy& map, std::int64_t utime) {
  patches_.clear();
  relation_counts_.clear();
  ChunkWriter writer(utime, true);
  const std::vector<IslandId> islands = islands_by_patch(map);
  for (std::size_t i = 0; i < map.patches.size(); ++i) {
    writer.add(patch_message(*map.patches[i], map.poses[i], islands[i], true));
    patches_.push_back({map.poses[i], islands[i]});
  }
  for (const auto& [id, relation] : map.graph.relations()) {
    writer.add(relation_message(relation));
    relation_counts_[id] = count(relation);
  }
  return writer.finish();
}

std::vector<map_t> MapMessages::changes(const MapCopy& map, std::int64_t utime) {
  ChunkWriter writer(utime, false);
  const std::vector<IslandId> islands = islands_by_patch(map);
  for (std::size_t i = 0; i < map.patches.size(); ++i) {
    const bool is_new = i >= patches_.size();
    if (is_new) patches_.emplace_back();
    SentPatch& sent = patches_[i];
    if (!is_new && sent.island == islands[i] && is_still_pose(sent.pose, map.poses[i])) continue;
    writer.add(patch_message(*map.patches[i], map.poses[i], islands[i], is_new));
    sent = {map.poses[i], islands[i]};
  }
  for (const auto& [id, relation] : map.graph.relations()) {
    const auto [sent, is_new] = relation_counts_.try_emplace(id, count(relation));
    if (!is_new && sent->second == count(relation)) continue;
    writer.add(relation_message(relation));
    sent->second = count(relation);
  }
  for (auto sent = relation_counts_.begin(); sent != relation_counts_.end();) {
    if (map.graph.find(sent->first)) {
      ++sent;
    } else {
      writer.add_removed(sent->first);
      sent = relation_counts_.erase(sent);
    }
  }
  return writer.finish();
}

grid_t grid_message(const OccupancyGrid& grid, IslandId island, std::int64_t utime) {
  grid_t message{};
  message.utime = utime;
  message.island = island.value;
  message.resolution_m = grid.resolution_m;
  message.origin_x_m = grid.origin_x_m;
  message.origin_y_m = grid.origin_y_m;
  message.width = grid.width;
  message.height = grid.height;
  message.npixels = static_cast<std::int32_t>(grid.pixels.size());
  message.pixels = grid.pixels;
  return message;
}

}  // namespace isthmus
