#include "server/program/usage.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <string_view>

#include "server/program/option_tree.hpp"
#include "server/program/spelling.hpp"
#include "server/program/values.hpp"

namespace isthmus {
namespace {

using Words = std::vector<std::string>;

/// "--output", "-o": of the program and of the command that was given.
Words option_names(const CLI::App& app, bool hidden_too) {
  Words names;
  for (const CLI::Option* option : options_of(app)) {
    if (!hidden_too && !is_shown(*option)) continue;
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    for (const std::string& name : option->get_snames()) names.push_back("-" + name);
  }
  for (const CLI::App* command : app.get_subcommands()) {
    const Words more = option_names(*command, hidden_too);
    names.insert(names.end(), more.begin(), more.end());
  }
  return names;
}

/// What is wrong with an argument that looks like an option and is none; empty: nothing.
std::string wrong_option(const CLI::App& app, const Words& arguments) {
  const Words names = option_names(app, true);
  for (const std::string& argument : arguments) {
    if (argument == "--") break;
    const std::string name = argument.substr(0, argument.find('='));
    if (!name.starts_with("--") || std::ranges::find(names, name) != names.end()) continue;
    return "there is no option " + name + did_you_mean(name, option_names(app, false));
  }
  return "";
}

/// The same of the first word that is nearly a command, where none was given; it may be an option's value
/// that comes first.
std::string wrong_command(const CLI::App& app, const Words& arguments) {
  if (!app.get_subcommands().empty()) return "";
  Words names;
  for (const CLI::App* command : commands_of(app)) names.push_back(command->get_name());
  for (const std::string& word : arguments) {
    if (word.starts_with("-")) continue;
    if (const std::string meant = did_you_mean(word, names); !meant.empty())
      return std::string("there is no command '").append(word).append("'").append(meant);
  }
  return "";
}

/// "--island or --patch" of a text in which "[--island,--patch]" stands; empty: none does.
std::string alternatives_in(const std::string& text) {
  const std::size_t begin = text.find('['), end = text.rfind(']');
  if (begin == std::string::npos || end == std::string::npos) return "";
  const Words names = CLI::detail::split(text.substr(begin + 1, end - begin - 1), ',');
  std::string list;
  for (std::size_t i = 0; i < names.size(); ++i)
    list += (i == 0 ? "" : i + 1 == names.size() ? " or " : ", ") + names[i];
  return list;
}

/// What a missing argument without a name of its own on the command line is; empty: it has one.
std::string meaning_of(const CLI::App& app, const std::string& name) {
  for (const CLI::Option* option : options_of(app))
    if (option->get_positional() && option->get_name() == name) return ": " + option->get_description();
  return "";
}

/// CLI11's reasons, as people would say them where they are no sentences.
std::string plain_reason(const CLI::App& app, const CLI::Error& error) {
  std::string text = error.what();
  constexpr std::string_view unread = "Could not convert: ";
  if (text.starts_with(unread)) {
    const std::size_t equals = text.find(" = ");
    return text.substr(unread.size(), equals - unread.size()) + " cannot be '" + text.substr(equals + 3) +
           "'";
  }
  constexpr std::string_view excludes = " excludes ";
  if (const std::size_t at = text.find(excludes); at != std::string::npos)
    return text.substr(0, at) + " and " + text.substr(at + excludes.size()) + " do not go together";
  if (error.get_name() == "ArgumentMismatch" && text.ends_with(" missing"))
    return text.substr(0, text.find(':')) + " needs a value";
  if (error.get_name() == "RequiredError" && text.find("1 option") != std::string::npos)
    if (const std::string list = alternatives_in(text); !list.empty())
      return list + " is needed" + (text.find("were given") == std::string::npos ? "" : ", and only one");
  if (constexpr std::string_view required = " is required"; text.ends_with(required))
    return text + meaning_of(app, text.substr(0, text.size() - required.size()));
  return text;
}

/// Lines that follow on the first begin as far in as that does.
std::string indented(const std::string& text, std::size_t columns) {
  std::string all;
  for (const char c : text) {
    all += c;
    if (c == '\n') all.append(columns, ' ');
  }
  return all;
}

/// The commands there are, where one should have been given.
std::string list_of_commands(const CLI::App& app) {
  if (commands_of(app).empty() || !app.get_subcommands().empty()) return "";
  std::size_t width = 0;
  for (const CLI::App* command : commands_of(app)) width = std::max(width, command->get_name().size());
  std::string list = "Which of these?\n";
  for (const CLI::App* command : commands_of(app)) {
    std::string name = command->get_name();
    name.resize(width, ' ');
    list += "  " + name + "  " + indented(command->get_description(), width + 4) + "\n";
  }
  return list;
}

std::string count_text(const CLI::Option& option) {
  if (option.get_expected_max() == CLI::detail::expected_max_vector_size) return " ...";
  const int count = option.get_items_expected_min();
  return count > 1 ? " x " + std::to_string(count) : "";
}

class PlainHelp : public CLI::Formatter {
 public:
  /// Without empty lines at its end.
  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override {
    std::string text = Formatter::make_help(app, std::move(name), mode);
    text.erase(text.find_last_not_of('\n') + 1);
    return text + "\n";
  }

  /// A group of options, as below a program's other ones.
  std::string make_expanded(const CLI::App* app) const override {
    if (!app->get_name().empty()) return Formatter::make_expanded(app);
    std::string text = "\n" + app->get_description() + ":\n";
    for (const CLI::Option* option : app->get_options())
      if (is_shown(*option) && option != app->get_help_ptr()) text += make_option(option, false);
    return text;
  }

  std::string make_option_opts(const CLI::Option* option) const override {
    if (!option->get_option_text().empty()) return " " + option->get_option_text();
    std::string text;
    if (option->get_type_size() != 0) {
      text = " " + value_text(*option);
      if (!option->get_default_str().empty()) text += " [" + option->get_default_str() + "]";
      text += count_text(*option);
      if (option->get_required()) text += " REQUIRED";
    }
    for (const CLI::Option* other : option->get_needs()) text += " (with " + other->get_name() + ")";
    return text;
  }
};

void set_formatter(CLI::App& app, const std::shared_ptr<CLI::Formatter>& formatter) {
  app.formatter(formatter);
  for (CLI::App* below : app.get_subcommands(std::function<bool(CLI::App*)>()))
    set_formatter(*below, formatter);
}

}  // namespace

std::string usage_text(const CLI::App& app, const CLI::Error& error, const Words& arguments) {
  std::string reason = wrong_option(app, arguments);
  if (reason.empty()) reason = wrong_command(app, arguments);
  if (reason.empty()) reason = plain_reason(app, error);
  return reason + "\n" + list_of_commands(app);
}

void use_plain_help(CLI::App& app) { set_formatter(app, std::make_shared<PlainHelp>()); }

}  // namespace isthmus
