#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/text/lines.hpp"

namespace isthmus {

/// Reads a CSV file with a header line; columns are found by name, in any order. Fields may be quoted (with
/// doubled quotes inside); a quoted field ends on its line. Every error is a FileError naming file and line.
class CsvReader {
 public:
  explicit CsvReader(const std::string& file);

  /// Goes to the next row, passing over empty lines and `#` comments; false at the end. A row whose number of
  /// fields differs from the header's is an error.
  bool next();

  bool has_column(std::string_view column) const;
  /// A field of the current row. A column that the header lacks is an error.
  const std::string& text(std::string_view column) const;
  double number(std::string_view column) const;  ///< finite or not, but a number
  double finite(std::string_view column) const;
  std::int64_t integer(std::string_view column) const;

  [[noreturn]] void fail(const std::string& reason) const;

 private:
  std::optional<std::size_t> find(std::string_view column) const;

  LineReader lines_;
  std::vector<std::string> header_;
  std::vector<std::string> row_;
};

/// The fields of one CSV line; nothing where a quote stays open.
std::optional<std::vector<std::string>> split_csv_line(std::string_view line);

}  // namespace isthmus
