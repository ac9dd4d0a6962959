#include "host/help.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "common/errors/input_error.h"

namespace rayfarm {
namespace {

/// The words of a list such as `{a,b}` or `{a->0,b->1}`.
std::string choices_in(const std::string& list) {
  std::string words;
  for (size_t begin = 1; begin < list.size();) {
    const size_t end = std::min(list.find_first_of(",}", begin), list.size());
    const std::string entry = list.substr(begin, end - begin);
    words += (words.empty() ? "" : "|") + entry.substr(0, entry.find("->"));
    if (end >= list.size() || list[end] == '}') break;
    begin = end + 1;
  }
  return words;
}

std::string plain_type(const std::string& type) {
  if (const size_t brace = type.find('{'); brace != std::string::npos) return choices_in(type.substr(brace));
  if (const size_t range = type.find(" in ["); range != std::string::npos) {
    std::string limits = type.substr(range + 5);
    limits.resize(std::min(limits.find(']'), limits.size()));
    if (const size_t dash = limits.find(" - "); dash != std::string::npos) limits.replace(dash, 3, " to ");
    return "N from " + limits;
  }
  if (type == "UINT" || type == "INT" || type == "FLOAT") return "N";
  return type;
}

std::vector<std::string> names_of(const CLI::Option& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.get_snames()) names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
  return names;
}

}  // namespace

std::string HelpFormatter::make_option_name(const CLI::Option* option, bool is_positional) const {
  if (is_positional) return option->get_name(true, false);
  return fmt::format("{}", fmt::join(names_of(*option), ", "));
}

std::string HelpFormatter::make_option_opts(const CLI::Option* option) const {
  if (option->get_type_size() == 0 || option->get_positional()) return "";
  return " " + plain_type(option->get_type_name());
}

void group_options(CLI::App& command, const std::vector<OptionGroup>& groups) {
  for (const OptionGroup& group : groups)
    for (const std::string& name : group.options) command.get_option(name)->group(group.title);
}

std::string find_unknown_word(const CLI::App& app, int argc, char** argv) {
  if (argc < 2) return {};
  const CLI::App* command = nullptr;
  std::vector<std::string> commands;
  for (const CLI::App* c : app.get_subcommands({})) {
    commands.push_back(c->get_name());
    if (c->get_name() == argv[1]) command = c;
  }
  if (!command)
    return argv[1][0] == '-' ? ""
                             : fmt::format("unknown command '{}'{}", argv[1], suggestion(argv[1], commands));
  std::vector<std::string> options;
  for (const CLI::Option* option : command->get_options())
    for (const std::string& name : names_of(*option)) options.push_back(name);
  for (int i = 2; i < argc; ++i) {
    const std::string argument = argv[i], word = argument.substr(0, argument.find('='));
    if (word.starts_with("--") && std::find(options.begin(), options.end(), word) == options.end())
      return fmt::format("{} has no option '{}'{}", command->get_name(), word, suggestion(word, options));
  }
  return {};
}

}  // namespace rayfarm
