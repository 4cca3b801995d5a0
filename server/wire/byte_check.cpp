#include "server/wire/byte_check.hpp"

#include <algorithm>

namespace isthmus {
namespace {

/// Takes bytes from the front; false where there are too few.
bool take(std::span<const std::uint8_t>& rest, std::int64_t count) {
  if (count > static_cast<std::int64_t>(rest.size())) return false;
  rest = rest.subspan(static_cast<std::size_t>(count));
  return true;
}

/// Ends at its first NUL.
bool is_text(std::span<const std::uint8_t> bytes) {
  return std::find(bytes.begin(), bytes.end(), 0) == bytes.end() - 1;
}

bool take_member(std::span<const std::uint8_t>& rest, const Member& member);

bool take_structs(std::span<const std::uint8_t>& rest, const Member& list, std::int32_t count) {
  const std::span members(list.of, static_cast<std::size_t>(list.size));
  for (std::int32_t i = 0; i < count; ++i) {
    if (!std::all_of(members.begin(), members.end(),
                     [&](const Member& one) { return take_member(rest, one); }))
      return false;
  }
  return true;
}

bool take_member(std::span<const std::uint8_t>& rest, const Member& member) {
  if (member.kind == Member::Kind::fixed) return take(rest, member.size);
  if (rest.size() < 4) return false;
  const std::int32_t count = read_int32(rest);
  const std::int32_t least = member.kind == Member::Kind::text ? 1 : 0;
  if (count < least || count > member.cap) return false;
  take(rest, 4);
  if (member.kind == Member::Kind::list) return take_structs(rest, member, count);
  const std::int64_t bytes = std::int64_t{count} * member.size;
  if (bytes > static_cast<std::int64_t>(rest.size())) return false;
  if (member.kind == Member::Kind::text && !is_text(rest.first(static_cast<std::size_t>(bytes))))
    return false;
  return take(rest, bytes);
}

}  // namespace

std::string_view check_bytes(std::int64_t fingerprint, std::span<const Member> members,
                             std::span<const std::uint8_t> bytes) {
  if (bytes.size() < 8) return "bad_length";
  if (read_int64(bytes) != fingerprint) return "bad_fingerprint";
  std::span<const std::uint8_t> rest = bytes.subspan(8);
  for (const Member& member : members) {
    if (!take_member(rest, member)) return "bad_length";
  }
  return rest.empty() ? "" : "bad_length";
}

std::int32_t read_int32(std::span<const std::uint8_t> bytes) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = (value << 8) | bytes[i];
  return static_cast<std::int32_t>(value);
}

std::int64_t read_int64(std::span<const std::uint8_t> bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < 8; ++i) value = (value << 8) | bytes[i];
  return static_cast<std::int64_t>(value);
}

}  // namespace isthmus
