#pragma once

#include <cstdint>
#include <vector>

namespace isthmus {

/// The bytes of a generated LCM type.
template <class T>
std::vector<std::uint8_t> encoded(const T& message) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

}  // namespace isthmus
