#pragma once

#include <cstdint>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <string>

#include "server/wire/intake/inbox.hpp"
#include "server/wire/message/channel.hpp"
#include "server/wire/network/reassembly.hpp"
#include "server/wire/trust/authenticator.hpp"
#include "server/wire/watch/log_line.hpp"

namespace isthmus {

/// Decides which of the messages that were received are let into the inbox; the others are counted there by
/// reason. Envelopes are opened. Any thread.
class Reception {
 public:
  Reception(Inbox& inbox, ChannelNames configured, Authenticator authenticator = Authenticator(),
            Log log = {});

  /// A network's message. Where keys are configured, those without an envelope are refused. Returns why it
  /// was refused; none where it is in the inbox, or was none of ours.
  DropReason take(std::int64_t utime, const std::string& channel,
                  std::span<const std::uint8_t> bytes) noexcept;
  /// The same for what joins datagrams. It refers to this.
  LcmSink sink();

  /// A log's message: taken with or without an envelope, as who may write to it may do worse. Waits for room
  /// in the inbox; false once that is closed.
  bool take_waiting(const Message& logged);

 private:
  bool wants(const std::string& channel) const;
  Opened opened(std::int64_t utime, std::span<const std::uint8_t> bytes);
  DropReason let_in(std::int64_t utime, const std::string& name, std::span<const std::uint8_t> bytes);
  void push(const Channel& channel, std::int64_t utime, const std::string& name,
            std::span<const std::uint8_t> bytes, const std::optional<Signature>& signature = std::nullopt);
  void refuse_stranger(const std::string& robot);

  Inbox& inbox_;
  ChannelNames configured_;
  Authenticator authenticator_;
  Log log_;
  std::mutex mutex_;  ///< of what follows, and of the authenticator
  std::set<std::string> strangers_told_;
};

}  // namespace isthmus
