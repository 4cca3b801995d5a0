#include "tools/text/numbers.hpp"

#include <charconv>
#include <cmath>
#include <limits>

namespace isthmus {
namespace {

template <class Number>
std::optional<Number> parse(std::string_view text) {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  Number value{};
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc{} || stop != end) return std::nullopt;
  return value;
}

bool all_digits(std::string_view text) { return text.find_first_not_of("0123456789") == text.npos; }

/// The first six decimals as microseconds, the seventh rounding them.
std::int64_t decimals_as_us(std::string_view decimals) {
  std::int64_t us = 0;
  for (std::size_t i = 0; i < 6; ++i) us = us * 10 + (i < decimals.size() ? decimals[i] - '0' : 0);
  return us + (decimals.size() > 6 && decimals[6] >= '5' ? 1 : 0);
}

std::optional<std::int64_t> from_floating_seconds(std::string_view text) {
  const auto seconds = parse<double>(text);
  if (!seconds || !(std::abs(*seconds) < 9e12)) return std::nullopt;
  return std::llround(*seconds * 1e6);
}

}  // namespace

std::optional<double> parse_double(std::string_view text) { return parse<double>(text); }
std::optional<float> parse_float(std::string_view text) { return parse<float>(text); }
std::optional<std::int64_t> parse_integer(std::string_view text) { return parse<std::int64_t>(text); }

std::optional<std::int64_t> parse_seconds_as_us(std::string_view text) {
  std::string_view digits = text;
  const bool negative = !digits.empty() && digits[0] == '-';
  if (negative) digits.remove_prefix(1);
  const std::size_t point = digits.find('.');
  const std::string_view whole = digits.substr(0, point);
  const std::string_view decimals = point == digits.npos ? std::string_view{} : digits.substr(point + 1);
  if (!all_digits(whole) || !all_digits(decimals)) return from_floating_seconds(text);
  if (whole.empty() && decimals.empty()) return std::nullopt;
  const auto seconds = whole.empty() ? std::optional<std::int64_t>(0) : parse<std::int64_t>(whole);
  if (!seconds || *seconds >= 9'000'000'000'000) return std::nullopt;
  const std::int64_t us = *seconds * 1'000'000 + decimals_as_us(decimals);
  return negative ? -us : us;
}

void split_words(std::string_view line, std::vector<std::string_view>& words) {
  words.clear();
  std::size_t at = 0;
  while ((at = line.find_first_not_of(" \t", at)) != line.npos) {
    const std::size_t end = std::min(line.find_first_of(" \t", at), line.size());
    words.push_back(line.substr(at, end - at));
    at = end;
  }
}

}  // namespace isthmus
