#pragma once
// The command line: commands with long GNU options in any order, help texts in plain words, and what was
// probably meant by a mistyped word. The parser's library is known to command_line.cpp alone.
#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "host/commands/outline.h"
#include "host/render/run_render.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace rayfarm {

/// What was typed can't be meant; the message says why.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Who may give an option.
enum class AskedBy {
  command_line,
  scenes_too  ///< where the command line does not
};

/// What a name is among a command's options.
enum class OptionKind { none, for_users, for_scenes };

/// What can be said of an option once it is added.
class Option {
 public:
  explicit Option(CLI::Option* option) : option_(option) {}
  /// It must be given.
  const Option& required() const;
  /// Scenes can't ask for it, whatever its group says.
  const Option& for_users() const;
  /// What the help says that it takes, where the kind of value has more of a name: `S` for seconds.
  const Option& takes(const std::string& name) const;
  /// Nothing need follow it: what it takes is then an empty text.
  const Option& may_stand_alone() const;
  /// It is taken up before those without this, wherever it stands: they change what it sets.
  const Option& read_first() const;

 private:
  CLI::Option* option_;
};

/// The options of one command. `names` are `--long` or `-s,--long`, or those of a word in its place, without
/// dashes. A target keeps what it holds if its option is not given; it must live until the command line is
/// parsed.
class Options {
 public:
  explicit Options(CLI::App* command) : command_(command) {}

  /// The options that follow stand under this title in the help.
  void begin_group(const std::string& title, AskedBy asked_by = AskedBy::command_line) {
    group_ = title;
    asked_by_ = asked_by;
  }

  /// `type` is what the help says it takes.
  Option text(const std::string& names, std::string& target, const std::string& help,
              const std::string& type = "TEXT");
  /// Text that `take` makes something of, or throws UsageError.
  Option text(const std::string& names, std::function<void(const std::string&)> take, const std::string& help,
              const std::string& type);

  Option number(const std::string& names, int& target, int least, int most, const std::string& help);
  Option number(const std::string& names, std::optional<int>& target, int least, int most,
                const std::string& help);
  Option number(const std::string& names, uint32_t& target, uint32_t least, uint32_t most,
                const std::string& help);
  Option number(const std::string& names, std::optional<uint32_t>& target, uint32_t least, uint32_t most,
                const std::string& help);
  Option number(const std::string& names, double& target, double least, double most, const std::string& help);
  Option number(const std::string& names, std::optional<double>& target, double least, double most,
                const std::string& help);
  Option number(const std::string& names, uint64_t& target, const std::string& help);
  /// Several, with commas between them.
  Option numbers(const std::string& names, std::vector<int>& target, int least, int most,
                 const std::string& help);
  Option numbers(const std::string& names, std::vector<double>& target, double least, double most,
                 const std::string& help);

  /// Sets the target to true; `!--name` to false.
  Option flag(const std::string& names, bool& target, const std::string& help);

  /// One of the words that `choices` name, with what they mean; the help lists them in this order.
  template <typename Value, typename Target>
  Option choice(const std::string& name, Target& target,
                const std::vector<std::pair<std::string, Value>>& choices, const std::string& help) {
    std::vector<std::string> words;
    for (const auto& choice : choices) words.push_back(choice.first);
    return index_of(
        name, [&target, choices](size_t i) { target = choices[i].second; }, words, help);
  }
  /// One of some words that mean themselves.
  Option word(const std::string& names, std::function<void(const std::string&)> take,
              const std::vector<std::string>& words, const std::string& help);

 private:
  Option index_of(const std::string& name, std::function<void(size_t)> take,
                  const std::vector<std::string>& words, const std::string& help);
  Option add(CLI::Option* option);
  CLI::App* command_;
  std::string group_ = "Options";
  AskedBy asked_by_ = AskedBy::command_line;
};

/// What Options::choice takes of an enumeration whose words stand in the order of its values.
template <typename Value, size_t count>
std::vector<std::pair<std::string, Value>> choices(const std::array<const char*, count>& words) {
  std::vector<std::pair<std::string, Value>> choices;
  for (size_t i = 0; i < count; ++i) choices.emplace_back(words[i], static_cast<Value>(i));
  return choices;
}

/// How scenes are rendered; main gives it, which knows the roles of processes.
struct Renders {
  RunRender as_launched;  ///< with all processes that were launched
  RunRender here;         ///< in this process alone
};

struct Verb {
  std::string name, help;
  std::vector<Example> examples{};
  /// Does what was asked for and returns the exit code. Results go to stdout, problems are thrown.
  std::function<int(const Renders&)> run;
  /// Throws UsageError if what was typed, the words from the command's name on, does not fit together.
  std::function<void(const std::vector<std::string>&)> check = [](const auto&) {};
  bool is_for_all_ranks = false;  ///< else it is one process's work
};

/// What the user asks for.
struct Request {
  std::optional<Verb> verb;  ///< empty: nothing but the message
  std::string message;
  int exit_code = 0;  ///< of the message: help and version give 0, errors kUsageError
};

class CommandLine {
 public:
  CommandLine(const std::string& program, const std::string& about, const std::string& version);
  ~CommandLine();
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;

  Options add(Verb verb);
  Request parse(int argc, char** argv);
  ProgramOutline outline() const;

  /// Reads words, the first of which is a command, into the targets of its options. Throws UsageError.
  void read(const std::vector<std::string>& words);
  /// Of a command's options, by `--name`: whether the words had it, and who may give it.
  bool is_given(const std::string& command, const std::string& name) const;
  OptionKind kind_of(const std::string& command, const std::string& name) const;
  /// Without dashes, each option by its first name.
  std::vector<std::string> names_for_scenes(const std::string& command) const;

 private:
  void read_words(const std::vector<std::string>& words);
  const CLI::Option* find_option(const std::string& command, const std::string& name) const;
  /// Names the first word that is no command or option, and what was probably meant; or nothing.
  std::string find_unknown_word(const std::vector<std::string>& words) const;
  std::string help() const;
  std::string version_;
  std::unique_ptr<CLI::App> app_;
  std::map<std::string, std::vector<Example>> examples_;  ///< by command
  std::optional<Verb> chosen_;
};

}  // namespace rayfarm
