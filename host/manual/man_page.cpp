#include "host/manual/man_page.h"

#include <fmt/core.h>

#include <cctype>

#include "host/commands/help.h"
#include "host/process/exit_code.h"

namespace rayfarm {
namespace {

/// Text that roff prints as it is: its own signs, and hyphens that are to be typed and found as such.
std::string plain(const std::string& text) {
  std::string out = text.starts_with('.') || text.starts_with('\'') ? "\\&" : "";
  for (const char c : text) {
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else if (c == '\'')
      out += "\\(aq";
    else if (c == '`')
      out += "\\(ga";
    else if (c == '^')
      out += "\\(ha";
    else if (c == '~')
      out += "\\(ti";
    else
      out += c;
  }
  return out;
}

std::string bold(const std::string& text) {
  return "\\fB" + plain(text) + "\\fR";
}
std::string italic(const std::string& text) {
  return "\\fI" + plain(text) + "\\fR";
}

std::string section(const std::string& title) {
  return ".SH " + title + "\n";
}
std::string item(const std::string& head, const std::string& text) {
  return ".TP\n" + head + "\n" + plain(text) + "\n";
}

/// What is given to an option: words to be typed in bold, names of values in italics.
std::string taken(const OptionOutline& option) {
  if (option.takes.empty()) return "";
  return " " + (option.words.empty() ? italic(option.takes) : bold(option.takes));
}

std::string option_items(const std::vector<OptionOutline>& options) {
  std::string out;
  for (const OptionOutline& option : options) {
    std::string head;
    for (const std::string& name : option.names) head += (head.empty() ? "" : ", ") + bold(name);
    out += item(head + taken(option), option.help);
  }
  return out;
}

std::string examples_of(const std::vector<Example>& examples) {
  if (examples.empty()) return "";
  std::string out = section("EXAMPLES");
  for (const Example& example : examples) out += item(bold(example.line), example.what);
  return out;
}

std::string exit_codes() {
  std::string out = section("EXIT STATUS");
  for (const auto& [code, meaning] : kExitCodeWords) out += item(bold(std::to_string(code)), meaning);
  return out;
}

/// The date is left out: the same source gives the same page on any day.
std::string begin_page(const ProgramOutline& program, const std::string& name, const std::string& about) {
  std::string title = name;
  for (char& c : title) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return fmt::format(".\\\" Made by rayfarm_manual from the options of {0} {1}.\n", program.name,
                     program.version) +
         fmt::format(".TH {} 1 \"\" \"{} {}\" \"User Commands\"\n", plain(title), program.name,
                     program.version) +
         section("NAME") + plain(name) + " \\- " + plain(about) + "\n";
}

std::string page_name(const ProgramOutline& program, const CommandOutline& command) {
  return program.name + "-" + command.name;
}

}  // namespace

std::string man_page_of(const ProgramOutline& program) {
  std::string out = begin_page(program, program.name, program.about.substr(program.about.find(": ") + 2));
  out += section("SYNOPSIS") + bold(program.name) + " " + italic("COMMAND") + " [" + italic("OPTIONS") +
         "] ...\n";
  out += section("DESCRIPTION") +
         plain(
             "Rayfarm renders stills and animations by ray tracing. Under mpirun rank 0 is the host, which "
             "loads the scene and hands out parts of the picture, and every other rank is a node, which "
             "traces them. Without mpirun host and nodes share one process, with a node per core. The "
             "picture is the same to the byte for any number of processes.") +
         "\n";
  out += section("COMMANDS");
  for (const CommandOutline& command : program.commands) out += item(bold(command.name), command.help);
  out +=
      item(bold("help") + " [" + italic("COMMAND") + "]", "print what may be typed, here or for a command");
  out += section("OPTIONS") + option_items(program.options);
  out += exit_codes() + examples_of(program.examples);
  out += section("ENVIRONMENT") +
         item(bold("RAYFARM_NET"),
              "the net that joins several machines, an interface or an address range, as mpi-env reads it "
              "when it is sourced; without it all ranks run on one machine and open no port");
  out += section("FILES") + plain("Below the folder that also holds bin/rayfarm:") + "\n";
  out += item(italic("share/rayfarm/mpi-env"),
              "what Open MPI needs so that a lost node costs nothing but its own work; to be sourced before "
              "mpirun");
  out += item(italic("share/rayfarm/scenes"), "scenes to render");
  out += item(italic("share/rayfarm/rayfarm.schema.json"), "the JSON Schema of YAML scenes, for editors");
  out +=
      item(italic("lib/rayfarm/rayfarm_image_formats.so"), "reads textures; loaded by scenes that have some");
  out += section("SEE ALSO");
  for (const CommandOutline& command : program.commands) out += bold(page_name(program, command)) + "(1),\n";
  return out + bold("mpirun") + "(1)\n";
}

std::string man_page_of(const ProgramOutline& program, const CommandOutline& command) {
  std::string out = begin_page(program, page_name(program, command), command.help);
  out += section("SYNOPSIS") + bold(program.name + " " + command.name) +
         plain(usage_of(program, command).substr(program.name.size() + 1 + command.name.size())) + "\n";
  if (!command.places.empty()) {
    out += section("ARGUMENTS");
    for (const OptionOutline& place : command.places) out += item(italic(place.names.front()), place.help);
  }
  out += section("OPTIONS");
  for (const OptionGroup& group : command.groups)
    out += ".SS " + plain(group.title) + "\n" + option_items(group.options);
  return out + exit_codes() + examples_of(command.examples) + section("SEE ALSO") + bold(program.name) +
         "(1)\n";
}

}  // namespace rayfarm
