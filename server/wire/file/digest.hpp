#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

namespace isthmus {

using Digest = std::array<std::uint8_t, 32>;

Digest sha256(std::span<const std::uint8_t> bytes);

/// HMAC-SHA-256 (RFC 2104).
Digest hmac_sha256(std::span<const std::uint8_t> key, std::span<const std::uint8_t> bytes);

/// Whether `expected` begins with these bytes; in constant time.
bool begins_with(const Digest& expected, std::span<const std::uint8_t> bytes);

/// The first bytes of a digest.
template <std::size_t size>
std::array<std::uint8_t, size> first_bytes(const Digest& digest) {
  static_assert(size <= sizeof(Digest));
  std::array<std::uint8_t, size> first{};
  std::copy_n(digest.begin(), size, first.begin());
  return first;
}

/// Unpredictable random bytes. Throws std::runtime_error where the system has none.
std::array<std::uint8_t, 16> random_bytes();

}  // namespace isthmus
