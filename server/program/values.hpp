#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <map>
#include <string>
#include <type_traits>
#include <vector>

namespace isthmus {

/// What options take, with reasons that say what was given and what is allowed; CLI11's own checks take "nan"
/// for a number in any range, and print bounds with 309 digits. Each is both for `check` and for --help.
/// @{

/// Any number but "nan" and "inf".
CLI::Validator finite_number();

/// A finite number; the bounds are allowed.
CLI::Validator number_in(double least, double most);
CLI::Validator number_from(double least);
CLI::Validator number_above(double bound);

CLI::Validator integer_in(std::int64_t least, std::int64_t most);
CLI::Validator integer_from(std::int64_t least);

/// One of these words; the nearest is suggested.
CLI::Validator one_of(const std::vector<std::string>& words);
/// @}

/// The same for `transform`, where words stand for the values of an enumeration.
template <class Enumeration>
CLI::Validator one_of(const std::map<std::string, Enumeration>& values) {
  std::vector<std::string> words;
  for (const auto& [word, value] : values) words.push_back(word);
  const CLI::Validator check = one_of(words);
  const auto number_of_word = [check, values](std::string& text) {
    std::string wrong = check(static_cast<const std::string&>(text));
    if (wrong.empty())
      text = std::to_string(static_cast<std::underlying_type_t<Enumeration>>(values.at(text)));
    return wrong;
  };
  return {number_of_word, check.get_description()};
}

/// For --help and manuals: "NUMBER (0.01 to 100)", "FILE", "debug|info"; empty for flags.
std::string value_text(const CLI::Option& option);

/// The words that an option takes, where it takes one of some.
std::vector<std::string> allowed_words(const CLI::Option& option);

/// Options of a program or command that take numbers refuse what is none in plain words; what bounds they
/// have beyond that is up to each.
void check_types(CLI::App& app);

}  // namespace isthmus
