#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "server/engine/input/drop_reason.hpp"
#include "server/wire/network/lcm_packet.hpp"

namespace isthmus {

/// Where a datagram came from: an IPv4 address and port, in the host's byte order.
struct LcmSender {
  std::uint32_t address = 0;
  std::uint16_t port = 0;

  auto operator<=>(const LcmSender&) const = default;
};

/// What takes the messages of a network.
struct LcmSink {
  /// Whether messages on a channel are taken; no memory is spent on others.
  std::function<bool(std::string_view channel)> wants;
  /// A whole message, once; the bytes are valid during the call. `utime`: when its last datagram was
  /// received.
  std::function<void(std::int64_t utime, std::string_view channel, std::span<const std::uint8_t>)> deliver;
  /// A message was lost on a channel that is wanted, or a datagram was none of LCM's (channel empty).
  std::function<void(std::string_view channel, DropReason reason)> drop;
};

/// Bounds of what unfinished messages may take: anybody can send fragments under any address.
struct ReassemblyLimits {
  std::size_t message_bytes = 1024 * 1024;  ///< as InboxLimits
  /// Of a message. Every IPv4 host takes datagrams of 576 bytes (RFC 791): nobody needs fragments of less
  /// than 512.
  std::size_t fragments = 2048;
  /// Of one sender, finished ones included. LCM's senders finish one message before the next; more are under
  /// assembly at once only where the network changes their order.
  std::size_t messages_of_sender = 8;
  std::size_t messages = 1000;           ///< of all senders; as many as liblcm holds
  std::size_t bytes = 16 * 1024 * 1024;  ///< of all senders; as many as liblcm holds
  /// Microseconds since a message's last fragment. Its fragments are sent at once, one behind the other.
  std::int64_t time_to_live_us = 1'000'000;
};

/// Makes messages of the datagrams of LCM's UDP protocol, in whatever order they come: those of a fragmented
/// message come out once, when the last is there, and only where they fit together without gap or overlap.
/// What is unfinished is bounded; beyond that, the message that has waited longest for a fragment goes first.
/// Reasons of drops: malformed_packet, message_too_large, too_many_fragments, fragments_lost (unfinished when
/// its time was over), too_many_unfinished (unfinished when the bounds for all were reached). One thread.
class Reassembly {
 public:
  explicit Reassembly(LcmSink sink, ReassemblyLimits limits = {}) : sink_(std::move(sink)), limits_(limits) {}

  /// `utime`: receive time, microseconds; `now_us`: a clock that never goes back.
  void take(const LcmSender& sender, std::span<const std::uint8_t> datagram, std::int64_t utime,
            std::int64_t now_us);

  std::size_t messages() const { return messages_.size(); }  ///< unfinished, or lately finished
  std::size_t bytes() const { return bytes_; }               ///< held, bookkeeping included

 private:
  struct Key {
    LcmSender sender;
    std::uint32_t sequence = 0;

    auto operator<=>(const Key&) const = default;
  };
  struct Piece {
    std::uint32_t offset = 0;
    std::vector<std::uint8_t> data;
  };
  struct Unfinished {
    std::uint32_t message_bytes = 0;
    std::uint16_t fragments = 0;
    bool closed = false;  ///< delivered, dropped or not wanted: more of its fragments are nothing new
    std::string channel;
    std::map<std::uint16_t, Piece> pieces;
    std::size_t held_bytes = 0;
    std::int64_t touched_us = 0;
    std::uint64_t turn = 0;  ///< its key in by_age_
  };
  using Messages = std::map<Key, Unfinished>;

  void take_fragment(const LcmSender& sender, const LcmPacket& packet, std::int64_t utime,
                     std::int64_t now_us);
  DropReason refusal(const LcmPacket& packet) const;
  Unfinished& message_of(const Key& key, const LcmPacket& packet, std::int64_t now_us);
  void add(Unfinished& message, const LcmPacket& packet);
  void finish(Unfinished& message, std::int64_t utime);
  void close(Unfinished& message, DropReason reason);
  void make_room(const LcmSender& sender);
  void touch(const Key& key, Unfinished& message, std::int64_t now_us);
  void remove(Messages::iterator message, DropReason reason);
  void remove_oldest(DropReason reason) { remove(messages_.find(by_age_.begin()->second), reason); }

  LcmSink sink_;
  ReassemblyLimits limits_;
  Messages messages_;
  std::map<std::uint64_t, Key> by_age_;  ///< all of messages_, the one longest without a fragment first
  std::uint64_t next_turn_ = 0;
  std::size_t bytes_ = 0;
};

}  // namespace isthmus
