#include "server/wire/page/map/shown_map.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

namespace isthmus {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr double looks_still_m = 1e-3;

/// Order matters; for telling changes only.
void mix(std::uint64_t& sum, std::int64_t value) {
  sum ^= static_cast<std::uint64_t>(value);
  sum *= 0x100000001b3;  // FNV-1a's prime
}

/// Of each island: what its patches and relations look like.
std::map<IslandId, std::uint64_t> looks(const ShownMap& shown) {
  std::map<IslandId, std::uint64_t> sums;
  const MapCopy& map = shown.map();
  for (std::size_t i = 0; i < map.poses.size(); ++i) {
    std::uint64_t& sum = sums[shown.island_of[i]];
    const Pose& pose = map.poses[i];
    mix(sum, static_cast<std::int64_t>(i));
    for (const double part : {pose.x, pose.y, pose.yaw})
      mix(sum, std::isfinite(part) ? std::llround(part / looks_still_m) : 0);
  }
  for (const auto& [id, relation] : map.graph.relations()) mix(sums[shown.island(relation.a)], id.value);
  return sums;
}

class Bytes {
 public:
  template <class T>
  void add(T value) {
    bytes_.append(std::bit_cast<std::array<char, sizeof(T)>>(value).data(), sizeof(T));
  }
  void add(const std::string& text) { bytes_ += text; }
  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

struct Names {
  std::map<std::string, std::int32_t> line;
  std::string text;
};

Names names_of(const MapCopy& map, const std::vector<PatchId>& patches) {
  Names names;
  for (const PatchId id : patches)
    names.line.emplace(map.patches[static_cast<std::size_t>(id.value)]->robot, 0);
  std::int32_t line = 0;
  for (auto& [name, number] : names.line) {
    number = line++;
    names.text += name + "\n";
  }
  names.text.resize((names.text.size() + 3) / 4 * 4, ' ');
  return names;
}

std::vector<const Relation*> relations_of(const ShownMap& shown, IslandId island) {
  std::vector<const Relation*> relations;
  for (const auto& [id, relation] : shown.map().graph.relations())
    if (shown.island(relation.a) == island) relations.push_back(&relation);
  return relations;
}

void add_patches(Bytes& bytes, const ShownMap& shown, const std::vector<PatchId>& patches,
                 const Names& names) {
  const MapCopy& map = shown.map();
  const auto each = [&](const auto& value) {
    for (const PatchId id : patches) bytes.add(value(static_cast<std::size_t>(id.value)));
  };
  each([](std::size_t i) { return static_cast<std::int32_t>(i); });
  each([&](std::size_t i) { return map.patches[i]->tag >= 0 ? -1 : names.line.at(map.patches[i]->robot); });
  each([&](std::size_t i) { return static_cast<float>(map.poses[i].x); });
  each([&](std::size_t i) { return static_cast<float>(map.poses[i].y); });
  each([&](std::size_t i) { return static_cast<float>(map.poses[i].yaw); });
  each([&](std::size_t i) { return tenths_of_patch(shown, i); });
}

std::int64_t first_patch_utime(const MapCopy& map, const RobotClocks& clocks) {
  std::int64_t first = std::numeric_limits<std::int64_t>::max();
  for (const PatchPtr& patch : map.patches)
    if (patch->tag < 0) first = std::min(first, clocks.server_utime(patch->robot, patch->utime));
  return first == std::numeric_limits<std::int64_t>::max() ? 0 : first;
}

}  // namespace

std::int32_t tenths_after_first(const ShownMap& shown, std::int64_t utime) {
  constexpr std::int64_t tenth_us = 100'000;
  return static_cast<std::int32_t>(std::clamp<std::int64_t>((utime - shown.first_utime) / tenth_us, 0,
                                                            std::numeric_limits<std::int32_t>::max()));
}

std::int32_t tenths_of_patch(const ShownMap& shown, std::size_t patch) {
  const PatchPtr& made = shown.map().patches[patch];
  if (made->tag >= 0) return 0;
  return tenths_after_first(shown, shown.clocks.server_utime(made->robot, made->utime));
}

ShownMap shown_map(LiveView view, const ShownMap* before, std::int64_t version) {
  ShownMap shown{std::move(view), {}, {}, {}, {}, 0};
  shown.clocks = RobotClocks(shown.map());
  shown.first_utime = first_patch_utime(shown.map(), shown.clocks);
  shown.island_of.resize(shown.map().patches.size());
  for (const std::vector<PatchId>& island : shown.map().graph.islands()) {
    for (const PatchId id : island) shown.island_of[static_cast<std::size_t>(id.value)] = island.front();
  }
  shown.look = looks(shown);
  for (const auto& [island, look] : shown.look) {
    const bool is_same = before && before->look.contains(island) && before->look.at(island) == look;
    shown.version[island] = is_same ? before->version.at(island) : version;
  }
  return shown;
}

std::string patch_arrays(const ShownMap& shown, IslandId island) {
  if (!shown.version.contains(island)) return "";
  const MapCopy& map = shown.map();
  const std::vector<PatchId> patches = map.graph.patches_of(island);
  const std::vector<const Relation*> relations = relations_of(shown, island);
  const Names names = names_of(map, patches);
  std::map<PatchId, std::int32_t> place;
  for (const PatchId id : patches) place.emplace(id, static_cast<std::int32_t>(place.size()));
  Bytes bytes;
  bytes.add(static_cast<std::uint32_t>(patches.size()));
  bytes.add(static_cast<std::uint32_t>(relations.size()));
  bytes.add(static_cast<std::uint32_t>(names.text.size()));
  bytes.add(names.text);
  add_patches(bytes, shown, patches, names);
  for (const Relation* relation : relations) bytes.add(place.at(relation->a));
  for (const Relation* relation : relations) bytes.add(place.at(relation->b));
  for (const Relation* relation : relations) bytes.add(static_cast<std::int32_t>(relation->origin.kind));
  for (const Relation* relation : relations) bytes.add(relation->origin.closure.value);
  return bytes.take();
}

}  // namespace isthmus
