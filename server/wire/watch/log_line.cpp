#include "server/wire/watch/log_line.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <ctime>

namespace isthmus {
namespace {

constexpr std::array<std::string_view, 4> level_names = {"debug", "info", "warning", "error"};

std::string utc(std::int64_t utime) {
  const std::time_t seconds = utime / 1'000'000;
  std::tm parts{};
  gmtime_r(&seconds, &parts);
  std::array<char, 32> text{};
  const std::size_t size = std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%S", &parts);
  std::array<char, 8> milliseconds{};
  std::snprintf(milliseconds.data(), milliseconds.size(), ".%03dZ", static_cast<int>(utime / 1000 % 1000));
  return std::string(text.data(), size) + milliseconds.data();
}

bool is_plain(char c) { return c > ' ' && c < 127 && c != '"' && c != '=' && c != '\\'; }

std::string quoted(std::string_view value) {
  if (!value.empty() && std::all_of(value.begin(), value.end(), is_plain)) return std::string(value);
  std::string text = "\"";
  for (const char c : value) {
    if (c == '"' || c == '\\') text += '\\';
    const bool is_control = static_cast<unsigned char>(c) < ' ' || c == 127;
    text += is_control ? ' ' : c;
  }
  return text + "\"";
}

}  // namespace

std::optional<LogLevel> parse_log_level(std::string_view text) {
  const auto found = std::find(level_names.begin(), level_names.end(), text);
  if (found == level_names.end()) return std::nullopt;
  return static_cast<LogLevel>(found - level_names.begin());
}

std::string log_line(std::int64_t utime, LogLevel level, std::string_view message, const LogFields& fields) {
  std::string line = "time=" + utc(utime) + " level=";
  line += level_names[static_cast<std::size_t>(level)];
  line += " msg=" + quoted(message);
  for (const auto& [key, value] : fields) line += " " + key + "=" + quoted(value);
  return line;
}

Log log_to_stderr(LogLevel min_level) {
  return [min_level](LogLevel level, std::string_view message, const LogFields& fields) {
    if (level < min_level) return;
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    const std::int64_t utime = std::chrono::duration_cast<std::chrono::microseconds>(now).count();
    const std::string line = log_line(utime, level, message, fields) + "\n";
    std::fwrite(line.data(), 1, line.size(), stderr);  // one call: lines of several threads do not mix
  };
}

}  // namespace isthmus
