#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <exception>

#include "server/engine/engine.hpp"

namespace {

using namespace isthmus;

/// As many rows of a trajectory as the saved state says that there were, where that is not many.
std::shared_ptr<TrajectoryStore> rows_for(std::span<const std::uint8_t> saved) {
  auto rows = std::make_shared<TrajectoryStore>();
  std::uint64_t toml_bytes = 0;
  std::uint64_t count = 0;
  if (saved.size() < 16) return rows;
  std::memcpy(&toml_bytes, saved.data(), 8);
  if (toml_bytes > saved.size() - 16) return rows;
  std::memcpy(&count, saved.data() + 8 + toml_bytes, 8);
  for (std::uint64_t i = 0; i < count && count <= 1000; ++i) rows->append({});
  return rows;
}

}  // namespace

/// Input: what an engine saved, and what may have become of it. It is refused with a reason, or is an engine
/// that saves the same.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span saved(data, size);
  try {
    const Engine engine = Engine::restore(saved, rows_for(saved));
    map_sha256(engine.copy());
    const std::vector<std::uint8_t> again = engine.save();
    if (Engine::restore(again, rows_for(again)).save() != again) std::abort();
  } catch (const std::exception&) {
  }
  return 0;
}
