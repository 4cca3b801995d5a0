#include "server/engine/places/place_memory.hpp"

#include <algorithm>

namespace isthmus {
const RigidPiece& PlaceMemory::around(const Map& map, PatchId anchor, std::span<const PatchId> without,
                                      const EngineOptions& options) {
  if (known_.size() >= most_ && !known_.contains(anchor)) make_room();
  Known& known = known_[anchor];
  known.used = ++calls_;
  const std::int64_t stamp = known.surroundings.stamp();
  known.surroundings.update(map, anchor, options, Surroundings::By::scans);
  if (known.surroundings.stamp() != stamp) {
    known.patches = patches_of_place(known.surroundings, options.place_search);
    known.place = place_of(map, known.surroundings, {}, options.place_search);
  }
  const bool is_whole = std::ranges::none_of(
      known.patches, [&](PatchId id) { return std::ranges::binary_search(without, id); });
  if (is_whole) return known.place;
  return in_part_ = place_of(map, known.surroundings, without, options.place_search);
}

void PlaceMemory::make_room() {
  known_.erase(std::ranges::min_element(known_, {}, [](const auto& entry) { return entry.second.used; }));
}

}  // namespace isthmus
