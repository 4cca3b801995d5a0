#include "server/wire/journal/set_aside.hpp"

#include <charconv>
#include <filesystem>
#include <fstream>
#include <optional>
#include <stdexcept>
#include <vector>

#include "server/output/format/csv.hpp"

namespace isthmus {
namespace {

constexpr std::string_view columns = "sequence,receive_utime,robot,channel,reason";
constexpr std::size_t column_count = 5;

std::string path_in(const std::string& directory) {
  return (std::filesystem::path(directory) / "set-aside.csv").string();
}

/// RFC 4180, of one line.
std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"') {
      const bool doubled = quoted && i + 1 < line.size() && line[i + 1] == '"';
      if (doubled) fields.back() += line[++i];
      if (!doubled) quoted = !quoted;
    } else if (line[i] == ',' && !quoted) {
      fields.emplace_back();
    } else {
      fields.back() += line[i];
    }
  }
  return fields;
}

std::optional<std::int64_t> parsed_integer(const std::string& text) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

}  // namespace

SetAsideEvents read_set_aside(const std::string& directory) {
  SetAsideEvents events;
  const std::string path = path_in(directory);
  std::ifstream file(path);
  if (!file && !std::filesystem::exists(path)) return events;
  const auto fail = [&](int line, const std::string& why) {
    throw std::runtime_error(path + ":" + std::to_string(line) + ": " + why);
  };
  std::string line;
  if (!std::getline(file, line) || line != columns) fail(1, "must be " + std::string(columns));
  for (int number = 2; std::getline(file, line); ++number) {
    const std::vector<std::string> fields = fields_of(line);
    if (fields.size() != column_count) fail(number, "has not as many fields as columns");
    const std::optional<std::int64_t> sequence = parsed_integer(fields[0]);
    const std::optional<std::int64_t> utime = parsed_integer(fields[1]);
    if (!sequence || *sequence < 0 || !utime) fail(number, "sequence and receive_utime must be integers");
    events[*sequence] = {*utime, fields[2], fields[3], fields[4]};
  }
  return events;
}

void write_set_aside(const std::string& directory, const SetAsideEvents& events) {
  CsvFile file(path_in(directory), columns);
  for (const auto& [sequence, event] : events)
    file.row(sequence, event.utime, event.robot, event.channel, event.reason);
  file.commit();
}

}  // namespace isthmus
