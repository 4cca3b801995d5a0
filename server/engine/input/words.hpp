#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

namespace isthmus {

/// The words of an enumeration in files, messages and logs, in the order of its values, which count up from
/// 0. Given beside each enumeration; only input, output and people deal with words.
template <class Enum>
inline constexpr std::array<std::string_view, 0> words_of{};

template <class Enum>
concept HasWords = std::is_enum_v<Enum> && !words_of<Enum>.empty();

/// Whether it is one of the enumeration's values: checks what was read from a file.
template <HasWords Enum>
constexpr bool has_word(Enum value) {
  return static_cast<std::size_t>(value) < words_of<Enum>.size();
}

template <HasWords Enum>
constexpr std::string_view word(Enum value) {
  return words_of<Enum>[static_cast<std::size_t>(value)];
}

/// Nothing for what is no word of the enumeration.
template <HasWords Enum>
constexpr std::optional<Enum> value_of(std::string_view word) {
  const auto found = std::ranges::find(words_of<Enum>, word);
  if (found == words_of<Enum>.end()) return std::nullopt;
  return static_cast<Enum>(found - words_of<Enum>.begin());
}

/// What is counted of each value, by its word.
template <HasWords Enum, class Count>
std::map<std::string, Count> by_word(const std::map<Enum, Count>& counts) {
  std::map<std::string, Count> counts_by_word;
  for (const auto& [value, count] : counts) counts_by_word.emplace(word(value), count);
  return counts_by_word;
}

}  // namespace isthmus
