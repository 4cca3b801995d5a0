#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "server/wire/message/message.hpp"

namespace isthmus {

/// How far each sender has counted on each channel that it signs for: by (sender with its key's fingerprint,
/// "R1@0123456789ab", channel).
using SignatureCounters = std::map<std::pair<std::string, std::string>, std::int64_t>;

/// The journal's record of counters. `complete`: senders that are not in it have signed nothing yet.
Message encode_counters(std::int64_t utime, const SignatureCounters& counters, bool complete);

/// As `may_be_input`, for such a record.
bool may_be_counters(std::span<const std::uint8_t> beginning, std::int64_t bytes);

/// Raises `counters` to those in a message that may be such a record; false where it is none, or damaged.
/// `complete` tells whether it was one of all.
bool raise_counters(const Message& message, SignatureCounters& counters, bool& complete);

/// Whether a journal's segment was begun by a server that asked for signatures: a record of counters comes
/// before its first event. Throws std::runtime_error as EventLogReader does.
bool begins_with_counters(const std::string& segment);

}  // namespace isthmus
