#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>

#include "server/wire/intake/inbox.hpp"
#include "server/wire/message/channel.hpp"
#include "server/wire/network/reassembly.hpp"
#include "server/wire/questions/question_desk.hpp"
#include "server/wire/trust/authenticator.hpp"
#include "server/wire/watch/mistakes.hpp"

namespace isthmus {

/// Called with an operator's order that is refused before the engine could see it, and with its stamp. Any
/// thread.
using RefusedOrder = std::function<void(const command_t& order, DropReason reason, std::int64_t utime)>;

/// Who is notified of what is received.
struct ReceptionWatch {
  RefusedOrder refused_order;                         ///< empty: nobody
  std::shared_ptr<Mistakes> mistakes;                 ///< none: nobody
  std::shared_ptr<QuestionDesk> questions = nullptr;  ///< takes those of a network; none: nobody does
};

/// Decides which of the messages that were received are let into the inbox; the others are counted there by
/// reason. Envelopes are opened. Any thread.
class Reception {
 public:
  Reception(Inbox& inbox, ChannelNames configured, Authenticator authenticator = Authenticator(),
            ReceptionWatch watch = {});

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
  DropReason push(const Channel& channel, std::int64_t utime, const std::string& name,
                  std::span<const std::uint8_t> bytes,
                  const std::optional<Signature>& signature = std::nullopt);
  DropReason let_in_envelope(std::int64_t utime, std::span<const std::uint8_t> bytes);
  DropReason ask(std::span<const std::uint8_t> bytes);
  void refuse_stranger(const Channel& channel, std::span<const std::uint8_t> bytes);
  void count_refused(const std::string& robot, DropReason reason);
  void tell_refused(std::int64_t utime, const std::string& channel, std::span<const std::uint8_t> bytes,
                    DropReason reason) const;

  Inbox& inbox_;
  ChannelNames configured_;
  Authenticator authenticator_;
  ReceptionWatch watch_;
  std::mutex mutex_;  ///< of the authenticator
};

}  // namespace isthmus
