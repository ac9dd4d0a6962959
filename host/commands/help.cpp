#include "host/commands/help.h"

#include <fmt/core.h>
#include <fmt/ranges.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <sstream>
#include <utility>

#include "host/process/exit_code.h"

namespace rayfarm {
namespace {

constexpr size_t kIndent = 2, kColumnOfText = 26;

/// Characters of UTF-8.
size_t columns_of(const std::string& text) {
  return static_cast<size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xc0) != 0x80; }));
}

/// `head` at the margin, `text` beside it in lines of `width`: on the head's own line if that leaves room.
std::string entry(const std::string& head, const std::string& text, size_t width) {
  std::string out = std::string(kIndent, ' ') + head;
  size_t column = kIndent + columns_of(head);
  const auto begin_line = [&] {
    out += "\n" + std::string(kColumnOfText, ' ');
    column = kColumnOfText;
  };
  if (column + 2 > kColumnOfText)
    begin_line();
  else
    out += std::string(kColumnOfText - std::exchange(column, kColumnOfText), ' ');
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    const size_t length = columns_of(word);
    const bool is_first = column == kColumnOfText;
    if (!is_first && column + 1 + length > width) begin_line();
    if (column > kColumnOfText) {
      out += ' ';
      ++column;
    }
    out += word;
    column += length;
  }
  return out + "\n";
}

std::string entries(const std::vector<OptionOutline>& options, size_t width) {
  std::string out;
  for (const OptionOutline& option : options)
    out += entry(
        fmt::format("{}{}{}", fmt::join(option.names, ", "), option.takes.empty() ? "" : " ", option.takes),
        option.help, width);
  return out;
}

std::string examples_of(const std::vector<Example>& examples) {
  std::string out;
  for (const Example& example : examples) out += fmt::format("  {}\n      {}\n", example.line, example.what);
  return out.empty() ? out : "\nExamples:\n" + out;
}

}  // namespace

size_t help_width() {
  winsize size{};
  if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return 100;
  return std::clamp<size_t>(size.ws_col, 60, 110);
}

std::string usage_of(const ProgramOutline& program, const CommandOutline& command) {
  std::string usage = fmt::format("{} {} [OPTIONS]", program.name, command.name);
  for (const OptionGroup& group : command.groups)
    for (const OptionOutline& option : group.options)
      if (option.is_required) usage += fmt::format(" {} {}", option.names.front(), option.takes);
  for (const OptionOutline& place : command.places) usage += " " + place.names.front();
  return usage;
}

std::string help_of(const ProgramOutline& program, size_t width) {
  std::string out =
      fmt::format("{}\n\nUsage: {} COMMAND [OPTIONS] …\n\nCommands:\n", program.about, program.name);
  for (const CommandOutline& command : program.commands) out += entry(command.name, command.help, width);
  out += entry("help [COMMAND]", "print this help, or that of a command", width);
  out += "\nOptions:\n" + entries(program.options, width) + examples_of(program.examples);
  out += "\nExit codes:\n";
  for (const auto& [code, meaning] : kExitCodeWords) out += entry(std::to_string(code), meaning, width);
  return out;
}

std::string help_of(const ProgramOutline& program, const CommandOutline& command, size_t width) {
  std::string out = fmt::format("{} {}: {}\n\nUsage: {}\n", program.name, command.name, command.help,
                                usage_of(program, command));
  if (!command.places.empty()) {
    out += "\n";
    for (const OptionOutline& place : command.places) out += entry(place.names.front(), place.help, width);
  }
  for (const OptionGroup& group : command.groups)
    out += fmt::format("\n{}:\n{}", group.title, entries(group.options, width));
  return out + examples_of(command.examples);
}

}  // namespace rayfarm
