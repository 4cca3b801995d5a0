#include "tools/text/csv.hpp"

#include <algorithm>
#include <cmath>

#include "tools/text/numbers.hpp"

namespace isthmus {
namespace {

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == text.npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

bool is_content(std::string_view line) {
  const std::string_view text = trimmed(line);
  return !text.empty() && text[0] != '#';
}

}  // namespace

std::optional<std::vector<std::string>> split_csv_line(std::string_view line) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (quoted && c == '"' && i + 1 < line.size() && line[i + 1] == '"') {
      fields.back() += '"';
      ++i;
    } else if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      fields.emplace_back();
    } else {
      fields.back() += c;
    }
  }
  if (quoted) return std::nullopt;
  for (std::string& field : fields) field = std::string(trimmed(field));
  return fields;
}

CsvReader::CsvReader(const std::string& file) : lines_(file) {
  while (const auto line = lines_.next()) {
    if (!is_content(*line)) continue;
    auto fields = split_csv_line(*line);
    if (!fields) fail("a quote is not closed");
    header_ = std::move(*fields);
    return;
  }
  throw FileError(file, 0, "no header line");
}

bool CsvReader::next() {
  while (const auto line = lines_.next()) {
    if (!is_content(*line)) continue;
    auto fields = split_csv_line(*line);
    if (!fields) fail("a quote is not closed");
    if (fields->size() != header_.size()) {
      fail("wrong count of fields: " + std::to_string(fields->size()) + " instead of " +
           std::to_string(header_.size()));
    }
    row_ = std::move(*fields);
    return true;
  }
  return false;
}

std::optional<std::size_t> CsvReader::find(std::string_view column) const {
  const auto at = std::find(header_.begin(), header_.end(), column);
  if (at == header_.end()) return std::nullopt;
  return static_cast<std::size_t>(at - header_.begin());
}

bool CsvReader::has_column(std::string_view column) const { return find(column).has_value(); }

const std::string& CsvReader::text(std::string_view column) const {
  const auto at = find(column);
  if (!at) fail("no column '" + std::string(column) + "' in the header");
  return row_[*at];
}

double CsvReader::number(std::string_view column) const {
  const auto value = parse_double(text(column));
  if (!value) fail("not a number in column " + std::string(column) + ": '" + text(column) + "'");
  return *value;
}

double CsvReader::finite(std::string_view column) const {
  const double value = number(column);
  if (!std::isfinite(value)) fail("not finite in column " + std::string(column));
  return value;
}

std::int64_t CsvReader::integer(std::string_view column) const {
  const auto value = parse_integer(text(column));
  if (!value) fail("not an integer in column " + std::string(column) + ": '" + text(column) + "'");
  return *value;
}

void CsvReader::fail(const std::string& reason) const {
  throw FileError(lines_.file(), lines_.number(), reason);
}

}  // namespace isthmus
