#include "server/wire/network/reassembly.hpp"

#include <algorithm>
#include <optional>
#include <utility>

namespace isthmus {
namespace {

/// What a held fragment takes beside its bytes: a node of the map, and the allocator's share of two blocks.
constexpr std::size_t piece_overhead_bytes = 128;

std::size_t held_bytes(const LcmPacket& packet) { return packet.data.size() + piece_overhead_bytes; }

}  // namespace

void Reassembly::take(const LcmSender& sender, std::span<const std::uint8_t> datagram, std::int64_t utime,
                      std::int64_t now_us) {
  while (!by_age_.empty() &&
         messages_.at(by_age_.begin()->second).touched_us + limits_.time_to_live_us < now_us)
    remove_oldest(DropReason::fragments_lost);
  const std::optional<LcmPacket> packet = parse_lcm_packet(datagram);
  if (!packet) {
    sink_.drop("", DropReason::malformed_packet);
  } else if (packet->is_fragment) {
    take_fragment(sender, *packet, utime, now_us);
  } else if (sink_.wants(packet->channel)) {
    sink_.deliver(utime, packet->channel, packet->data);
  }
}

void Reassembly::take_fragment(const LcmSender& sender, const LcmPacket& packet, std::int64_t utime,
                               std::int64_t now_us) {
  if (const DropReason reason = refusal(packet); reason != DropReason::none) {
    // Once for each message; of one whose first fragment is lost nobody knows whether it was wanted.
    if (packet.names_channel() && sink_.wants(packet.channel)) sink_.drop(packet.channel, reason);
    return;
  }
  const Key key{sender, packet.sequence};
  Unfinished& message = message_of(key, packet, now_us);
  if (message.closed) return;
  if (packet.names_channel() && !sink_.wants(packet.channel)) return close(message, DropReason::none);
  touch(key, message, now_us);
  add(message, packet);
  if (!message.closed && message.pieces.size() == message.fragments) finish(message, utime);
  while (bytes_ > limits_.bytes) remove_oldest(DropReason::too_many_unfinished);
}

/// Why no message of such a size is put together.
DropReason Reassembly::refusal(const LcmPacket& packet) const {
  if (packet.message_bytes > limits_.message_bytes) return DropReason::message_too_large;
  return packet.fragments > limits_.fragments ? DropReason::too_many_fragments : DropReason::none;
}

/// The message that a fragment belongs to, begun if there is none.
Reassembly::Unfinished& Reassembly::message_of(const Key& key, const LcmPacket& packet, std::int64_t now_us) {
  const auto found = messages_.find(key);
  if (found != messages_.end()) {
    const Unfinished& message = found->second;
    if (message.message_bytes == packet.message_bytes && message.fragments == packet.fragments)
      return found->second;
    remove(found, DropReason::fragments_lost);  // its sender counts anew
  }
  make_room(key.sender);
  Unfinished& message = messages_[key];
  message.message_bytes = packet.message_bytes;
  message.fragments = packet.fragments;
  touch(key, message, now_us);
  return message;
}

void Reassembly::add(Unfinished& message, const LcmPacket& packet) {
  const auto [piece, is_new] = message.pieces.try_emplace(packet.number);
  if (!is_new) {
    const bool is_the_same =
        piece->second.offset == packet.offset && std::ranges::equal(piece->second.data, packet.data);
    if (!is_the_same) close(message, DropReason::malformed_packet);
    return;
  }
  piece->second = {packet.offset, {packet.data.begin(), packet.data.end()}};
  if (packet.names_channel()) message.channel = packet.channel;
  message.held_bytes += held_bytes(packet);
  bytes_ += held_bytes(packet);
}

void Reassembly::finish(Unfinished& message, std::int64_t utime) {
  std::vector<std::uint8_t> whole;
  whole.reserve(message.message_bytes);
  for (const auto& [number, piece] : message.pieces) {
    if (piece.offset != whole.size()) return close(message, DropReason::malformed_packet);
    whole.insert(whole.end(), piece.data.begin(), piece.data.end());
  }
  if (whole.size() != message.message_bytes) return close(message, DropReason::malformed_packet);
  close(message, DropReason::none);
  sink_.deliver(utime, message.channel, whole);
}

/// Nothing more is taken of it; with a reason, it is lost.
void Reassembly::close(Unfinished& message, DropReason reason) {
  if (reason != DropReason::none && message.pieces.contains(0)) sink_.drop(message.channel, reason);
  bytes_ -= std::exchange(message.held_bytes, 0);
  message.pieces.clear();
  message.closed = true;
}

/// For one more message of a sender.
void Reassembly::make_room(const LcmSender& sender) {
  const auto first = messages_.lower_bound(Key{sender, 0});
  auto oldest = first;
  std::size_t count = 0;
  for (auto message = first; message != messages_.end() && message->first.sender == sender; ++message) {
    if (message->second.turn < oldest->second.turn) oldest = message;
    ++count;
  }
  if (count >= limits_.messages_of_sender) remove(oldest, DropReason::fragments_lost);
  if (messages_.size() >= limits_.messages) remove_oldest(DropReason::too_many_unfinished);
}

void Reassembly::touch(const Key& key, Unfinished& message, std::int64_t now_us) {
  by_age_.erase(message.turn);
  message.turn = ++next_turn_;
  message.touched_us = now_us;
  by_age_.emplace(message.turn, key);
}

void Reassembly::remove(Messages::iterator message, DropReason reason) {
  if (!message->second.closed) close(message->second, reason);
  by_age_.erase(message->second.turn);
  messages_.erase(message);
}

}  // namespace isthmus
