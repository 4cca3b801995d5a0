#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>

namespace isthmus {

/// A strong integer id; -1 is "none". Ids are given in order of creation and never used again.
template <class Tag>
struct Id {
  std::int32_t value = -1;

  bool valid() const { return value >= 0; }
  auto operator<=>(const Id&) const = default;
};

/// Where what belongs to a valid id stands in a list by id.
template <class Tag>
std::size_t index(Id<Tag> id) {
  return static_cast<std::size_t>(id.value);
}

using PatchId = Id<struct PatchTag>;
using RelationId = Id<struct RelationTag>;
using ClosureId = Id<struct ClosureTag>;
/// An island is named by the lowest patch id in it.
using IslandId = PatchId;

}  // namespace isthmus
