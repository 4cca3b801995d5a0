#include "server/wire/page/map/packed_patches.hpp"

#include <zlib.h>

#include <stdexcept>

namespace isthmus {
namespace {

SharedText deflated(const std::string& bytes) {
  uLongf size = ::compressBound(static_cast<uLong>(bytes.size()));
  std::string packed(size, '\0');
  const auto* from = reinterpret_cast<const Bytef*>(bytes.data());
  if (::compress2(reinterpret_cast<Bytef*>(packed.data()), &size, from, static_cast<uLong>(bytes.size()),
                  Z_BEST_SPEED) != Z_OK)
    throw std::runtime_error("zlib has no memory");
  packed.resize(size);
  return std::make_shared<const std::string>(std::move(packed));
}

}  // namespace

SharedText PackedPatches::packed(const ShownMap& shown, IslandId island) {
  const std::int64_t version = shown.version.at(island);
  const std::lock_guard lock(packing_);
  std::erase_if(packed_, [&](const auto& kept) { return !shown.version.contains(kept.first); });
  auto& [kept_version, text] = packed_[island];
  if (!text || kept_version < version) {
    text = deflated(patch_arrays(shown, island));
    kept_version = version;
  }
  return text;
}

}  // namespace isthmus
