#include "server/program/manual.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>

#include "server/program/option_tree.hpp"
#include "server/program/values.hpp"

namespace isthmus {
namespace {

/// Text as roff takes it: no line begins with a control character, and a minus is one.
std::string roff(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '\\') {
      escaped += "\\e";
    } else if (c == '-') {
      escaped += "\\-";
    } else {
      if ((c == '.' || c == '\'') && (escaped.empty() || escaped.back() == '\n')) escaped += "\\&";
      escaped += c;
    }
  }
  return escaped;
}

std::string entry_of(const CLI::Option& option) {
  const std::string value = value_text(option);
  const std::string name = option.get_positional() ? option.get_single_name() : option.get_name(false, true);
  std::string text = ".TP\n\\fB" + roff(name) + "\\fR";
  if (!value.empty()) text += " \\fI" + roff(value) + "\\fR";
  if (!option.get_default_str().empty()) text += " [" + roff(option.get_default_str()) + "]";
  return text + "\n" + roff(option.get_description()) + (option.get_required() ? " (required)" : "") + "\n";
}

/// Options that a program's page or --help tells of; --help itself stands under the program only.
std::vector<const CLI::Option*> shown_options(const CLI::App& app) {
  std::vector<const CLI::Option*> options = options_of(app);
  std::erase_if(options, [&app](const CLI::Option* option) {
    return !is_shown(*option) || (app.get_parent() != nullptr && option == app.get_help_ptr());
  });
  return options;
}

std::string entries_of(const CLI::App& app) {
  std::string text;
  for (const CLI::Option* option : shown_options(app)) text += entry_of(*option);
  return text;
}

std::vector<std::string> names_of(const CLI::Option& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
  for (const std::string& name : option.get_snames()) names.push_back("-" + name);
  return names;
}

/// The names that bash may complete, with spaces between.
std::string option_words(const CLI::App& app) {
  std::string words;
  for (const CLI::Option* option : shown_options(app))
    for (const std::string& name : names_of(*option)) words += " " + name;
  return words;
}

/// For each option that takes one of some words: a case of the word before, in which only they fit.
std::string value_cases(const CLI::App& app) {
  std::string cases;
  for (const CLI::Option* option : shown_options(app)) {
    std::string names, words;
    for (const std::string& name : names_of(*option)) names += (names.empty() ? "" : "|") + name;
    for (const std::string& word : allowed_words(*option)) words += (words.empty() ? "" : " ") + word;
    if (!words.empty()) cases += "    " + names + ") words=\"" + words + "\" ;;\n";
  }
  for (const CLI::App* command : commands_of(app)) cases += value_cases(*command);
  return cases;
}

}  // namespace

std::string man_page(const CLI::App& app, const std::string& version) {
  const std::string& name = app.get_name();
  std::string title = name;
  std::ranges::transform(title, title.begin(),
                         [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  std::string text = ".TH " + title + " 1 \"\" \"" + roff(version) + "\" Isthmus\n";
  text += ".SH NAME\n" + roff(name) + " \\- a command of the Isthmus mapping server\n";
  text +=
      ".SH SYNOPSIS\n.B " + roff(name) + "\n[options]" + (commands_of(app).empty() ? "" : " command") + "\n";
  text += ".SH DESCRIPTION\n" + roff(app.get_description()) + "\n.SH OPTIONS\n" + entries_of(app);
  if (!commands_of(app).empty()) text += ".SH COMMANDS\n";
  for (const CLI::App* command : commands_of(app))
    text += ".SS " + roff(command->get_name()) + "\n" + roff(command->get_description()) + "\n" +
            entries_of(*command);
  return text + ".SH EXIT STATUS\n0: done; 1: it could not be done; 2: wrong usage.\n";
}

std::string bash_completion(const CLI::App& app) {
  std::string function = "_" + app.get_name();
  std::ranges::replace(function, '-', '_');
  std::string commands;
  std::string cases;
  for (const CLI::App* command : commands_of(app)) {
    commands += " " + command->get_name();
    cases += "      " + command->get_name() + ") words+=\"" + option_words(*command) + "\" ;;\n";
  }
  std::string text = function + "()\n{\n  local word words=\"" + option_words(app) + commands + "\"\n";
  if (!cases.empty())
    text += "  for word in \"${COMP_WORDS[@]}\"; do\n    case $word in\n" + cases + "    esac\n  done\n";
  text += "  local at=$COMP_CWORD typed=${COMP_WORDS[COMP_CWORD]}\n";
  if (const std::string values = value_cases(app); !values.empty()) {
    // Bash takes "--option=value" for three words.
    text += "  [ \"$typed\" = = ] && { typed=; at=$((at + 1)); }\n";
    text += "  [ \"${COMP_WORDS[at - 1]}\" = = ] && at=$((at - 1))\n";
    text += "  case ${COMP_WORDS[at - 1]} in\n" + values + "  esac\n";
  }
  text += "  COMPREPLY=($(compgen -W \"$words\" -- \"$typed\"))\n}\n";
  return text + "complete -o default -F " + function + " " + app.get_name() + "\n";
}

}  // namespace isthmus
