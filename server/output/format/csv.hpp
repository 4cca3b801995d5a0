#pragma once

#include <concepts>
#include <string>
#include <string_view>

#include "patches/ids.hpp"
#include "server/output/format/atomic_file.hpp"
#include "server/output/format/number.hpp"

namespace isthmus {

inline std::string csv_field(double value) { return number(value); }
inline std::string csv_field(std::integral auto value) { return std::to_string(value); }
template <class Tag>
std::string csv_field(Id<Tag> id) {
  return std::to_string(id.value);
}
/// Text is quoted where it must be (RFC 4180).
inline std::string csv_field(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(text);
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}
inline std::string csv_field(const std::string& text) { return csv_field(std::string_view(text)); }
inline std::string csv_field(const char* text) { return csv_field(std::string_view(text)); }

/// A table with a line of column names; complete or absent, as every output file. Numbers are written so that
/// they read back the same.
class CsvFile {
 public:
  CsvFile(std::string path, std::string_view columns) : file_(std::move(path)) {
    file_.write(columns);
    file_.write("\n");
  }

  template <class First, class... Rest>
  void row(const First& first, const Rest&... rest) {
    std::string line = csv_field(first);
    ((line += ',', line += csv_field(rest)), ...);
    line += '\n';
    file_.write(line);
  }

  void commit() { file_.commit(); }

 private:
  AtomicFile file_;
};

}  // namespace isthmus
