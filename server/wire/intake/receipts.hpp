#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "isthmus/received_t.hpp"
#include "server/wire/message/message.hpp"

namespace isthmus {

/// What is acknowledged on ISTHMUS_RECEIVED: for each channel, how many messages were kept since the server
/// began, and the sender's stamp in the last one. Bounded: of senders that the server does not know only some
/// are remembered.
class Receipts {
 public:
  /// `known`: of a robot that the map knows, or of a channel that belongs to none.
  void add(const Message& message, bool known);

  received_t message(std::int64_t utime, std::int64_t since_utime) const;

 private:
  struct Channel {
    std::int64_t messages = 0;
    std::int64_t newest_utime = 0;
    bool known = false;
  };

  void forget_strangers();

  std::map<std::string, Channel> channels_;  ///< by name, upper case
  std::size_t strangers_ = 0;                ///< of them, those that are not known
};

}  // namespace isthmus
