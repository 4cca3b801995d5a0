#include "server/wire/message/byte_check.hpp"

#include <algorithm>

namespace isthmus {
namespace {

enum class Fit {
  no,
  yes,
  cut_off,  ///< as far as the bytes go
};

/// What of a message is still to be walked over; of its last bytes some may not be there.
struct Rest {
  std::span<const std::uint8_t> there;
  std::int64_t bytes = 0;

  /// Takes bytes from the front.
  Fit take(std::int64_t count) {
    if (count > bytes) return Fit::no;
    bytes -= count;
    if (count > static_cast<std::int64_t>(there.size())) return Fit::cut_off;
    there = there.subspan(static_cast<std::size_t>(count));
    return Fit::yes;
  }
};

/// Ends at its first NUL.
bool is_text(std::span<const std::uint8_t> bytes) {
  return std::find(bytes.begin(), bytes.end(), 0) == bytes.end() - 1;
}

Fit take_members(Rest& rest, std::span<const Member> members);

Fit take_structs(Rest& rest, const Member& list, std::int32_t count) {
  for (std::int32_t i = 0; i < count; ++i) {
    const Fit fit = take_members(rest, {list.of, static_cast<std::size_t>(list.size)});
    if (fit != Fit::yes) return fit;
  }
  return Fit::yes;
}

Fit take_member(Rest& rest, const Member& member) {
  if (member.kind == Member::Kind::fixed) return rest.take(member.size);
  const auto counted = rest.there;
  if (const Fit fit = rest.take(4); fit != Fit::yes) return fit;
  const std::int32_t count = read_int32(counted);
  const std::int32_t least = member.kind == Member::Kind::text ? 1 : 0;
  if (count < least || count > member.cap) return Fit::no;
  if (member.kind == Member::Kind::list) return take_structs(rest, member, count);
  const auto elements = rest.there;
  const std::int64_t bytes = std::int64_t{count} * member.size;
  const Fit fit = rest.take(bytes);
  if (fit != Fit::yes || member.kind != Member::Kind::text) return fit;
  return is_text(elements.first(static_cast<std::size_t>(bytes))) ? Fit::yes : Fit::no;
}

Fit take_members(Rest& rest, std::span<const Member> members) {
  for (const Member& member : members) {
    if (const Fit fit = take_member(rest, member); fit != Fit::yes) return fit;
  }
  return Fit::yes;
}

}  // namespace

DropReason check_bytes(std::int64_t fingerprint, std::span<const Member> members,
                       std::span<const std::uint8_t> bytes) {
  if (bytes.size() < 8) return DropReason::bad_length;
  if (read_int64(bytes) != fingerprint) return DropReason::bad_fingerprint;
  Rest rest{bytes.subspan(8), static_cast<std::int64_t>(bytes.size()) - 8};
  return take_members(rest, members) == Fit::yes && rest.bytes == 0 ? DropReason::none
                                                                    : DropReason::bad_length;
}

bool may_begin(std::int64_t fingerprint, std::span<const Member> members,
               std::span<const std::uint8_t> beginning, std::int64_t bytes) {
  if (beginning.size() < 8 || read_int64(beginning) != fingerprint) return false;
  Rest rest{beginning.subspan(8), bytes - 8};
  const Fit fit = take_members(rest, members);
  return fit == Fit::cut_off || (fit == Fit::yes && rest.bytes == 0);
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
