#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace isthmus {

/// The whole text as a number; nothing where it is not one ("1.5m", "", "1e999").
std::optional<double> parse_double(std::string_view text);
std::optional<float> parse_float(std::string_view text);
std::optional<std::int64_t> parse_integer(std::string_view text);

/// Seconds in decimal notation as microseconds, exact for up to six decimals and rounded to the nearest
/// beyond (half away from zero). Nothing where it is no number or does not fit.
std::optional<std::int64_t> parse_seconds_as_us(std::string_view text);

/// Splits at blanks and tabs into `words`, which is reused.
void split_words(std::string_view line, std::vector<std::string_view>& words);

}  // namespace isthmus
