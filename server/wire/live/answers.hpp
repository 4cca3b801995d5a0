#pragma once

#include <cstdint>
#include <string>

#include "isthmus/command_t.hpp"
#include "server/engine/input/drop_reason.hpp"
#include "server/wire/live/map_publisher.hpp"
#include "server/wire/message/message.hpp"
#include "server/wire/watch/log_line.hpp"

namespace isthmus {

/// Tells what became of operators' orders: on ISTHMUS_ANSWER those who sent them, in the log everybody. Any
/// thread.
class Answers {
 public:
  Answers(Publish publish, Log log) : publish_(std::move(publish)), log_(std::move(log)) {}

  /// `signer`: of the envelope that the order came in, if any. `reason` none: it is done. `remark`: what is
  /// to be known of one that is done; may be empty.
  void tell(const command_t& order, const std::optional<Signature>& signer, DropReason reason,
            const std::string& remark, std::int64_t utime) const;

 private:
  Publish publish_;
  Log log_;
};

}  // namespace isthmus
