#pragma once
// What the command line takes, as plain data: help, manual pages and completions are all written from it.
#include <string>
#include <vector>

namespace rayfarm {

/// A command as it may be typed, and what comes of it.
struct Example {
  std::string line, what;
};

/// An option, or a word in its place.
struct OptionOutline {
  std::vector<std::string> names;  ///< with dashes; of a word in its place one, without
  std::string takes;               ///< what follows it: `FILE`, `N`, `sah|thesis`; empty: nothing
  std::vector<std::string> words;  ///< those that may follow it, if they can be listed
  std::string help;
  bool is_required = false;
};

struct OptionGroup {
  std::string title;
  std::vector<OptionOutline> options;
};

struct CommandOutline {
  std::string name, help;
  std::vector<OptionOutline> places{};  ///< words in their places, in order
  std::vector<OptionGroup> groups{};
  std::vector<Example> examples{};
};

struct ProgramOutline {
  std::string name, about, version;
  std::vector<OptionOutline> options{};  ///< that stand before any command
  std::vector<CommandOutline> commands{};
  std::vector<Example> examples{};
};

}  // namespace rayfarm
