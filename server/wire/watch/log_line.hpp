#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace isthmus {

enum class LogLevel { debug, info, warning, error };

/// Nothing for a text that names none.
std::optional<LogLevel> parse_log_level(std::string_view text);

using LogFields = std::vector<std::pair<std::string, std::string>>;

/// One event in one line of key=value: time (UTC), level, msg, then the fields. What holds more than a word
/// is quoted, so that a line stays a line whatever came over the wire.
std::string log_line(std::int64_t utime, LogLevel level, std::string_view message, const LogFields& fields);

/// Where log lines go; any thread, and must not throw. Empty: nowhere.
using Log = std::function<void(LogLevel level, std::string_view message, const LogFields& fields)>;

/// To stderr, from `min_level` on.
Log log_to_stderr(LogLevel min_level);

}  // namespace isthmus
