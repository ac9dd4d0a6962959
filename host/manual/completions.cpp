#include "host/manual/completions.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace rayfarm {
namespace {

enum class Completes { nothing, words, files, folders };

Completes completes(const OptionOutline& option) {
  if (!option.words.empty()) return Completes::words;
  if (option.takes == "FILE") return Completes::files;
  return option.takes == "FOLDER" ? Completes::folders : Completes::nothing;
}
/// `[PORT]`: nothing need follow the option.
bool may_stand_alone(const OptionOutline& option) {
  return option.takes.empty() || option.takes.starts_with('[');
}
/// Of words in their places: those that are no words of a list are files.
Completes completes_in_place(const OptionOutline& place) {
  return place.words.empty() ? Completes::files : Completes::words;
}

std::vector<OptionOutline> options_of(const CommandOutline& command) {
  std::vector<OptionOutline> all;
  for (const OptionGroup& group : command.groups)
    all.insert(all.end(), group.options.begin(), group.options.end());
  return all;
}

std::string names_of(const std::vector<OptionOutline>& options) {
  std::vector<std::string> names;
  for (const OptionOutline& option : options)
    names.insert(names.end(), option.names.begin(), option.names.end());
  return fmt::format("{}", fmt::join(names, " "));
}

std::string names_of(const std::vector<CommandOutline>& commands) {
  std::vector<std::string> names;
  for (const CommandOutline& command : commands) names.push_back(command.name);
  return fmt::format("{}", fmt::join(names, " "));
}

/// The first clause of a help text: menus have a line for it.
std::string short_help(const std::string& help) {
  return help.substr(0, std::min(help.find("; "), help.find(" (")));
}

/// `text` between single quotes of a shell in which `quote` stands for one of them.
std::string quoted(const std::string& text, const std::string& quote) {
  std::string out = "'";
  for (const char c : text) c == '\'' ? out += quote : out += c;
  return out + "'";
}

std::string bash_action(Completes what, const std::vector<std::string>& words) {
  switch (what) {
    case Completes::words:
      return fmt::format("words {}", quoted(fmt::format("{}", fmt::join(words, " ")), ""));
    case Completes::files:
      return "paths -f";
    case Completes::folders:
      return "paths -d";
    case Completes::nothing:
      break;
  }
  return "words ''";
}

/// With backslashes before what _arguments and _describe read as their own signs.
std::string zsh_text(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '[' || c == ']' || c == ':' || c == '\\') out += '\\';
    out += c;
  }
  return out;
}

std::string zsh_action(Completes what, const std::vector<std::string>& words) {
  switch (what) {
    case Completes::words:
      return fmt::format("({})", fmt::join(words, " "));
    case Completes::files:
      return "_files";
    case Completes::folders:
      return "_files -/";
    case Completes::nothing:
      break;
  }
  return " ";
}

std::string fish_action(Completes what, const std::vector<std::string>& words) {
  switch (what) {
    case Completes::words:
      return fmt::format(" -x -a '{}'", fmt::join(words, " "));
    case Completes::files:
      return " -r -F";
    case Completes::folders:
      return " -x -a '(__fish_complete_directories)'";
    case Completes::nothing:
      break;
  }
  return " -x";
}

std::string fish_text(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '\\') escaped += '\\';
    escaped += c;
  }
  return quoted(escaped, "\\'");
}

}  // namespace

std::string bash_completion_of(const ProgramOutline& program) {
  std::string out = fmt::format(R"(# Completion of {0} for bash; made by rayfarm_manual from the options.
_{0}_words() {{
  mapfile -t COMPREPLY < <(compgen -W "$1" -- "$word")
}}
_{0}_paths() {{
  compopt -o filenames 2>/dev/null
  mapfile -t COMPREPLY < <(compgen "$1" -- "$word")
}}
_{0}() {{
  local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD-1]}}
  # --option=word comes as three words.
  if [ "$word" = = ]; then
    word=
  elif [ "$before" = = ]; then
    before=${{COMP_WORDS[COMP_CWORD-2]}}
  fi
  COMPREPLY=()
  if [ "$COMP_CWORD" = 1 ]; then
    _{0}_words "{1} help {2}"
    return
  fi
  case ${{COMP_WORDS[1]}} in
    help) _{0}_words "{1}" ;;
)",
                                program.name, names_of(program.commands), names_of(program.options));
  for (const CommandOutline& command : program.commands) {
    out += fmt::format("    {})\n      case $before in\n", command.name);
    for (const OptionOutline& option : options_of(command))
      if (!may_stand_alone(option))
        out += fmt::format("        {}) _{}_{} ;;\n", fmt::join(option.names, "|"), program.name,
                           bash_action(completes(option), option.words));
    // Any place takes what the first takes: which one a word is in depends on all options before it.
    const OptionOutline* place = command.places.empty() ? nullptr : &command.places.front();
    out += fmt::format(R"(        *)
          if [[ $word == -* ]]; then
            _{0}_words "{1}"
          else
            _{0}_{2}
          fi
          ;;
      esac
      ;;
)",
                       program.name, names_of(options_of(command)),
                       place ? bash_action(completes_in_place(*place), place->words) : "words ''");
  }
  return out + fmt::format("  esac\n}}\ncomplete -F _{0} {0}\n", program.name);
}

std::string zsh_completion_of(const ProgramOutline& program) {
  std::string out = fmt::format(R"(#compdef {0}
# Completion of {0} for zsh; made by rayfarm_manual from the options.
_{0}() {{
  local -a commands=(
)",
                                program.name);
  for (const CommandOutline& command : program.commands)
    out += fmt::format("    {}\n", quoted(command.name + ":" + zsh_text(short_help(command.help)), "'\\''"));
  out +=
      "    'help:print what may be typed'\n  )\n  if (( CURRENT == 2 )); then\n    _describe command "
      "commands\n";
  out += "    _arguments";
  for (const OptionOutline& option : program.options)
    for (const std::string& name : option.names)
      out += " " + quoted(name + "[" + zsh_text(option.help) + "]", "'\\''");
  out +=
      "\n    return\n  fi\n  local command=$words[2]\n  shift words\n  (( CURRENT-- ))\n  case $command in\n";
  out += "    help) _describe command commands ;;\n";
  for (const CommandOutline& command : program.commands) {
    out += fmt::format("    {})\n      _arguments -S", command.name);
    for (const OptionOutline& option : options_of(command))
      for (const std::string& name : option.names) {
        std::string line = option.names.size() > 1 ? fmt::format("({})", fmt::join(option.names, " ")) : "";
        line += name;
        if (!option.takes.empty()) line += name.starts_with("--") ? "=" : "+";
        line += "[" + zsh_text(short_help(option.help)) + "]";
        if (!option.takes.empty())
          line += (may_stand_alone(option) ? "::" : ":") +
                  zsh_text(option.words.empty() ? option.takes : "word") + ":" +
                  zsh_action(completes(option), option.words);
        out += " \\\n        " + quoted(line, "'\\''");
      }
    for (size_t i = 0; i < command.places.size(); ++i) {
      const OptionOutline& place = command.places[i];
      out += fmt::format(" \\\n        '{}:{}:{}'", i + 1, place.names.front(),
                         zsh_action(completes_in_place(place), place.words));
    }
    out += "\n      ;;\n";
  }
  return out + fmt::format("  esac\n}}\n_{0} \"$@\"\n", program.name);
}

std::string fish_completion_of(const ProgramOutline& program) {
  std::string out = fmt::format(
      "# Completion of {0} for fish; made by rayfarm_manual from the options.\n"
      "complete -c {0} -f\n",
      program.name);
  const auto line = [&](const std::string& when, const std::string& rest) {
    out += fmt::format("complete -c {} -n '{}'{}\n", program.name, when, rest);
  };
  const auto option_line = [&](const std::string& when, const OptionOutline& option) {
    std::string rest;
    for (const std::string& name : option.names)
      rest += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
    if (!may_stand_alone(option)) rest += fish_action(completes(option), option.words);
    line(when, rest + " -d " + fish_text(short_help(option.help)));
  };
  const std::string at_first = "__fish_use_subcommand";
  for (const OptionOutline& option : program.options) option_line(at_first, option);
  line(at_first, " -a help -d 'print what may be typed'");
  line("__fish_seen_subcommand_from help", fmt::format(" -a '{}'", names_of(program.commands)));
  for (const CommandOutline& command : program.commands) {
    line(at_first, fmt::format(" -a {} -d {}", command.name, fish_text(short_help(command.help))));
    const std::string when = "__fish_seen_subcommand_from " + command.name;
    for (const OptionOutline& option : options_of(command)) option_line(when, option);
    if (command.places.empty()) continue;
    const OptionOutline& place = command.places.front();
    line(when, completes_in_place(place) == Completes::files
                   ? " -F"
                   : fmt::format(" -a '{}'", fmt::join(place.words, " ")));
  }
  return out;
}

}  // namespace rayfarm
