#include "server/program/values.hpp"

#include <cmath>
#include <cstdio>
#include <limits>
#include <sstream>
#include <utility>

#include "server/program/option_tree.hpp"
#include "server/program/spelling.hpp"

namespace isthmus {
namespace {

constexpr char between_words = '|';

std::string number_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.10g", value);
  return text;
}

/// A check that reads a Value and asks whether it is allowed. `kind`: "number"; `bounds`: "from 0 to 1".
template <class Value, class Allowed>
CLI::Validator checked(const std::string& kind, const std::string& bounds, Allowed allowed) {
  const std::string what = kind + (bounds.empty() ? "" : " " + bounds);
  const auto check = [what, allowed](std::string& text) {
    Value value{};
    return CLI::detail::lexical_cast(text, value) && allowed(value) ? std::string()
                                                                    : "'" + text + "' is not " + what;
  };
  return {check, bounds};
}

template <class Allowed>
CLI::Validator checked_number(const std::string& bounds, Allowed allowed) {
  return checked<double>("a number", bounds,
                         [allowed](double value) { return std::isfinite(value) && allowed(value); });
}

/// Numbers' types as people call them.
std::string type_text(const std::string& type) {
  if (type == "FLOAT") return "NUMBER";
  if (type == "INT" || type == "UINT") return "INTEGER";
  return type;
}

/// The type that CLI11 or the program names, and the bounds behind it: CLI11 hands both out as
/// "FLOAT:from 0 to 1".
std::pair<std::string, std::string> type_and_bounds(const CLI::Option& option) {
  const std::string text = option.get_type_name();
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) return {text, ""};
  return {text.substr(0, colon), text.substr(colon + 1)};
}

/// Of "[INT,INT]" and "INT" alike: what each single value is.
std::string single_type(std::string type) {
  if (type.starts_with('[')) type = type.substr(1, type.find_first_of(",]") - 1);
  return type;
}

}  // namespace

CLI::Validator finite_number() {
  return checked_number("", [](double) { return true; });
}

CLI::Validator number_in(double least, double most) {
  return checked_number("from " + number_text(least) + " to " + number_text(most),
                        [=](double value) { return value >= least && value <= most; });
}

CLI::Validator number_from(double least) {
  return checked_number("of at least " + number_text(least), [=](double value) { return value >= least; });
}

CLI::Validator number_above(double bound) {
  return checked_number("above " + number_text(bound), [=](double value) { return value > bound; });
}

CLI::Validator integer_in(std::int64_t least, std::int64_t most) {
  return checked<std::int64_t>("an integer", "from " + std::to_string(least) + " to " + std::to_string(most),
                               [=](std::int64_t value) { return value >= least && value <= most; });
}

CLI::Validator integer_from(std::int64_t least) {
  return checked<std::int64_t>("an integer", "of at least " + std::to_string(least),
                               [=](std::int64_t value) { return value >= least; });
}

CLI::Validator one_of(const std::vector<std::string>& words) {
  std::string list, alternatives;
  for (const std::string& word : words) {
    list += (list.empty() ? "" : ", ") + word;
    alternatives += (alternatives.empty() ? "" : std::string(1, between_words)) + word;
  }
  const auto check = [words, list](std::string& text) {
    for (const std::string& word : words)
      if (word == text) return std::string();
    return "'" + text + "' is none of " + list + did_you_mean(text, words);
  };
  return {check, alternatives};
}

std::string value_text(const CLI::Option& option) {
  if (option.get_type_size() == 0) return "";
  const auto [type, bounds] = type_and_bounds(option);
  if (!allowed_words(option).empty()) return bounds;
  return type_text(single_type(type)) + (bounds.empty() ? "" : " (" + bounds + ")");
}

std::vector<std::string> allowed_words(const CLI::Option& option) {
  const std::string bounds = type_and_bounds(option).second;
  std::vector<std::string> words;
  if (bounds.find(between_words) == std::string::npos) return words;
  std::istringstream stream(bounds);
  for (std::string word; std::getline(stream, word, between_words);) words.push_back(word);
  return words;
}

void check_types(CLI::App& app) {
  for (CLI::Option* option : all_options_of(app)) {
    const auto [type, bounds] = type_and_bounds(*option);
    if (!bounds.empty() || option->get_type_size() == 0) continue;
    const std::string single = single_type(type);
    if (single == "FLOAT") option->check(finite_number());
    if (single == "INT")
      option->check(checked<std::int64_t>("an integer", "", [](std::int64_t) { return true; }));
    if (single == "UINT") option->check(integer_from(0).description(""));
  }
}

}  // namespace isthmus
