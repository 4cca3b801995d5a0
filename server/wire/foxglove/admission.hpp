#pragma once

#include <string>
#include <string_view>

#include "server/wire/page/http/access.hpp"

namespace isthmus::foxglove {

/// What a request for a WebSocket says.
struct Handshake {
  std::string target;         ///< path and query
  std::string host;           ///< header Host
  std::string origin;         ///< header Origin; empty: no browser
  std::string authorization;  ///< header Authorization
  std::string protocols;      ///< header Sec-WebSocket-Protocol
};

/// Whether it may watch. With a token: who has it, in the query (?token=...) or as "Bearer"; a cookie is not
/// enough, as browsers send it along for pages of other sites. Without: who names this machine as the host,
/// and is no page of another site than this machine's or Foxglove's own, as browsers let any page open a
/// WebSocket to this machine.
bool may_watch(const Access& access, const Handshake& handshake);

/// The subprotocol to speak, of those asked for; empty: none of them.
std::string_view subprotocol_for(const Handshake& handshake);

}  // namespace isthmus::foxglove
