#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "server/wire/page/map/shown_map.hpp"

namespace isthmus {

/// Bytes that several answers share.
using SharedText = std::shared_ptr<const std::string>;

/// Patches and relations of islands, deflated once for each version. Any thread.
class PackedPatches {
 public:
  /// Of an island that is there.
  SharedText packed(const ShownMap& shown, IslandId island);

 private:
  std::mutex packing_;
  std::map<IslandId, std::pair<std::int64_t, SharedText>> packed_;
};

}  // namespace isthmus
