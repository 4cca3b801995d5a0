#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>

#include "server/wire/journal/signature.hpp"
#include "server/wire/message/server_configuration.hpp"

namespace isthmus {

/// An envelope that was opened, or the reason why not.
struct Opened {
  std::optional<Message> message;        ///< with its signature
  std::string robot;                     ///< whose message it is or claims to be; empty: no robot's
  DropReason reason = DropReason::none;  ///< none where it was opened
};

/// Decides which messages are believed, once the configuration holds keys: those in an envelope whose sender
/// has a key, signed with it, counting on, and on a channel that is the sender's: a robot's own and tags; for
/// an operator commands and tags; questions about the map for both. A sender with a new key counts from the
/// beginning: what the old key signed is no longer believed, and an exhausted counter no longer blocks the
/// sender. One thread.
class Authenticator {
 public:
  /// `counters`: what was accepted before is not taken again.
  explicit Authenticator(Authentication keys = {}, SignatureCounters counters = {});

  bool is_required() const { return keys_.is_required(); }

  Opened open(const ChannelNames& configured, std::int64_t utime, std::span<const std::uint8_t> bytes);

 private:
  struct Signer {
    AuthKey key;
    std::string name;  ///< of sender and key, for its counters
  };

  bool counts_on(const std::string& sender, const std::string& stream, const Signer& signer,
                 std::int64_t counter);

  Authentication keys_;
  std::map<std::string, Signer> signers_;  ///< by sender
  SignatureCounters counters_;
};

}  // namespace isthmus
