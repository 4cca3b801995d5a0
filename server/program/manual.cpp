#include "server/program/manual.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>

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

bool is_shown(const CLI::Option& option) { return !option.get_group().empty(); }

std::string entry_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::string name = option.get_positional() ? option.get_single_name() : option.get_name(false, true);
  std::string text = ".TP\n\\fB" + roff(name) + "\\fR";
  if (!type.empty() && option.get_type_size() != 0) text += " \\fI" + roff(type) + "\\fR";
  if (!option.get_default_str().empty()) text += " [" + roff(option.get_default_str()) + "]";
  return text + "\n" + roff(option.get_description()) + (option.get_required() ? " (required)" : "") + "\n";
}

std::string entries_of(const CLI::App& app) {
  std::string text;
  for (const CLI::Option* option : app.get_options())
    if (is_shown(*option)) text += entry_of(*option);
  return text;
}

/// The names that bash may complete, with spaces between.
std::string words_of(const CLI::App& app) {
  std::string words;
  for (const CLI::Option* option : app.get_options()) {
    if (!is_shown(*option)) continue;
    for (const std::string& name : option->get_lnames()) words += " --" + name;
    for (const std::string& name : option->get_snames()) words += " -" + name;
  }
  return words;
}

}  // namespace

std::vector<const CLI::App*> commands_of(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App*) { return true; });
}

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
    cases += "      " + command->get_name() + ") words+=\"" + words_of(*command) + "\" ;;\n";
  }
  std::string text = function + "()\n{\n  local word words=\"" + words_of(app) + commands + "\"\n";
  if (!cases.empty())
    text += "  for word in \"${COMP_WORDS[@]}\"; do\n    case $word in\n" + cases + "    esac\n  done\n";
  text += "  COMPREPLY=($(compgen -W \"$words\" -- \"${COMP_WORDS[COMP_CWORD]}\"))\n}\n";
  return text + "complete -o default -F " + function + " " + app.get_name() + "\n";
}

}  // namespace isthmus
