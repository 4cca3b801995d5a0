#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "isthmus/annotation_t.hpp"
#include "isthmus/command_t.hpp"
#include "isthmus/initial_pose_t.hpp"
#include "server/engine/input/drop_reason.hpp"
#include "server/engine/input/event.hpp"
#include "server/wire/message/server_configuration.hpp"

namespace isthmus {

/// Who signed a message: a robot or an operator, which of its channels, and how far it had counted there.
struct Signature {
  std::string sender;
  std::string channel;
  std::int64_t counter = 0;
};

/// A message as LCM carries it.
struct Message {
  std::int64_t utime = 0;  ///< receive time, the LCM log header's
  std::string channel;
  std::vector<std::uint8_t> bytes;
  std::optional<Signature> signature = std::nullopt;  ///< of the envelope that it came in, if any
  std::int64_t received = -1;  ///< number in the order of receipt, as its journal entry tells; -1: none
  std::int64_t sequence = -1;  ///< number in the journal that it was read from; -1: none
};

/// What a channel's message became: an event, or the reason why not.
struct Decoded {
  std::optional<Event> event;
  std::string robot;                     ///< upper case; empty where the channel belongs to none
  DropReason reason = DropReason::none;  ///< none for an event
  bool ours = true;  ///< false: a channel that is not Isthmus' input (ignored, not counted as dropped)
};

/// Checks the bytes (fingerprint, counts and string lengths within bounds, exact length) before any decode,
/// then the values (finite, within reason), and makes an event.
Decoded decode(const ChannelNames& configured, const std::string& channel,
               std::span<const std::uint8_t> bytes, std::int64_t receive_utime);

/// What an order's message says, whether or not it is one that can be carried out; nothing where the bytes
/// are not safe to decode.
std::optional<command_t> read_order(std::span<const std::uint8_t> bytes);
std::optional<annotation_t> read_annotation(std::span<const std::uint8_t> bytes);
std::optional<initial_pose_t> read_initial_pose(std::span<const std::uint8_t> bytes);

/// Whether these can be the first bytes of an input message of so many, on whatever channel: by its
/// fingerprint and the counts that it holds.
bool may_be_input(std::span<const std::uint8_t> beginning, std::int64_t bytes);

/// The message of an event, on the default channels.
Message encode(const Event& event);

}  // namespace isthmus
