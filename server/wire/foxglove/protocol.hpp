#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "server/output/foxglove/messages.hpp"

/// The WebSocket protocol of Foxglove and Lichtblick, version 1
/// (github.com/foxglove/ws-protocol/blob/main/docs/spec.md): what a server says that only sends, and what it
/// is told. Subscriptions are numbered by viewers, channels by the server.
namespace isthmus::foxglove {

/// Two names of one protocol, the one preferred first.
inline constexpr std::array<std::string_view, 2> subprotocols = {"foxglove.sdk.v1", "foxglove.websocket.v1"};

struct FoxgloveChannel {
  std::uint32_t id = 0;
  std::string topic;
  Kind kind = Kind::log;
};

std::string server_info(const std::string& session);
std::string advertisement(const std::vector<FoxgloveChannel>& channels);
std::string withdrawal(const std::vector<std::uint32_t>& channels);
/// Tells a viewer what is wrong with what it said.
std::string complaint(const std::string& what);

/// What goes before a message's own bytes.
std::string data_head(std::uint32_t subscription, std::int64_t utime);

struct Subscription {
  std::uint32_t id = 0;
  std::uint32_t channel = 0;
};
/// What a viewer says. `wrong` tells why nothing was understood; empty where it was, or where it is something
/// that this server does not do and may overlook.
struct ViewerRequest {
  std::vector<Subscription> subscribe;
  std::vector<std::uint32_t> unsubscribe;
  std::string wrong;
};
ViewerRequest parse_viewer_request(std::string_view text);

}  // namespace isthmus::foxglove
