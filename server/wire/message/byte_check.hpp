#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "server/engine/input/drop_reason.hpp"

namespace isthmus {

/// One member of an LCM type, as far as the number of its bytes goes.
struct Member {
  enum class Kind {
    fixed,  ///< `size` bytes
    array,  ///< an int32 count, at most `cap`, and that many elements of `size` bytes
    text,   ///< an int32 length, at most `cap` with its final NUL, and that many bytes, NUL only at the end
    list,   ///< an int32 count, at most `cap`, and that many structs of the members `of`, `size` of them
  };
  Kind kind = Kind::fixed;
  std::int32_t size = 0;
  std::int32_t cap = 0;
  const Member* of = nullptr;
};

constexpr Member fixed(std::int32_t bytes) { return {Member::Kind::fixed, bytes, 0}; }
constexpr Member array(std::int32_t element_bytes, std::int32_t max_count) {
  return {Member::Kind::array, element_bytes, max_count};
}
constexpr Member text(std::int32_t max_bytes) { return {Member::Kind::text, 1, max_bytes}; }

template <std::size_t size>
constexpr Member list(const std::array<Member, size>& of, std::int32_t max_count) {
  return {Member::Kind::list, static_cast<std::int32_t>(size), max_count, of.data()};
}

/// Walks the members of a message, before any generated decoder sees it: those trust counts and lengths.
/// Returns the reason for refusal, `bad_fingerprint` or `bad_length` (a count or length out of bounds, or a
/// message longer or shorter than they say); `none` for a message that is safe to decode.
DropReason check_bytes(std::int64_t fingerprint, std::span<const Member> members,
                       std::span<const std::uint8_t> bytes);

/// Whether these can be the first bytes of a message of so many: its fingerprint is there, and counts and
/// lengths agree as far as they are. A message that is all there must be one that `check_bytes` finds safe.
bool may_begin(std::int64_t fingerprint, std::span<const Member> members,
               std::span<const std::uint8_t> beginning, std::int64_t bytes);

/// Big-endian integers, as in LCM messages and logs. There must be enough bytes.
std::int32_t read_int32(std::span<const std::uint8_t> bytes);
std::int64_t read_int64(std::span<const std::uint8_t> bytes);

}  // namespace isthmus
