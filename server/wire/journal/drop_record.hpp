#pragma once

#include <cstdint>
#include <optional>

#include "server/engine/estimator.hpp"
#include "server/wire/message/drops.hpp"
#include "server/wire/message/message.hpp"

namespace isthmus {

/// The journal's record of messages that came and were not taken: they stay counted after a restart, and a
/// spool that still holds them knows that they are settled.
Message encode_drops(std::int64_t utime, const Drops& drops);

/// Nothing where the message is no such record, or damaged: a reason that there is not, or a count
/// that cannot be, makes it so.
std::optional<Drops> read_drops(const Message& message);

/// Counts them as the server did when they came.
void count_drops(Estimator& estimator, const Drops& drops);

}  // namespace isthmus
