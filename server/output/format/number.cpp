#include "server/output/format/number.hpp"

#include <array>
#include <charconv>
#include <cmath>

namespace isthmus {

std::string number(double value) {
  if (std::isnan(value)) return "nan";
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  return {text.data(), end};
}

std::string fixed(double value, int decimals) {
  if (std::isnan(value)) return "nan";
  std::array<char, 384> text{};  // the largest double has 309 digits before the point
  const auto end =
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed, decimals).ptr;
  std::string result(text.data(), end);
  if (result.front() == '-' && result.find_first_not_of("-0.") == std::string::npos) result.erase(0, 1);
  return result;
}

std::string seconds(std::int64_t utime) {
  // Through unsigned, so that the most negative time has a magnitude too.
  const auto bits = static_cast<std::uint64_t>(utime);
  const std::uint64_t magnitude = utime < 0 ? std::uint64_t{0} - bits : bits;
  const std::string fraction = std::to_string(magnitude % 1'000'000);
  return (utime < 0 ? "-" : "") + std::to_string(magnitude / 1'000'000) + "." +
         std::string(6 - fraction.size(), '0') + fraction;
}

}  // namespace isthmus
