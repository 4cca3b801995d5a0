#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "server/engine/places/place_search.hpp"

namespace isthmus {

/// Places as they were searched last: one piece of way after another is searched for at the same ones. What
/// it gives is what `place_around` would, so it is no part of the engine's state.
class PlaceMemory {
 public:
  /// @param most  how many it keeps, of some 50 kB: those that were asked for last
  explicit PlaceMemory(std::size_t most = 1024) : most_(most) {}

  /// See `place_around`. It is there until the next call.
  const RigidPiece& around(const Map& map, PatchId anchor, std::span<const PatchId> without,
                           const EngineOptions& options);

  bool knows(PatchId anchor) const { return known_.contains(anchor); }
  std::size_t size() const { return known_.size(); }

  /// A snapshot has nothing of it.
  template <class Archive>
  void save(Archive& /*archive*/) const {}
  template <class Archive>
  void load(Archive& /*archive*/) {
    known_.clear();
  }

 private:
  struct Known {
    Surroundings surroundings;
    std::vector<PatchId> patches;  ///< that the place is chosen from
    RigidPiece place;
    std::int64_t used = 0;
  };
  void make_room();

  std::size_t most_;
  std::map<PatchId, Known> known_;
  std::int64_t calls_ = 0;
  RigidPiece in_part_;
};

}  // namespace isthmus
