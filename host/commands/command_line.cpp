#include "host/commands/command_line.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>

#include "common/errors/input_error.h"
#include "host/commands/help.h"
#include "host/process/exit_code.h"

namespace rayfarm {
namespace {

/// What an option takes, in plain words, from how the parser tells it: `TEXT:{a,b}`, `S:INT in [1 - 256]`.
struct Taken {
  std::string name;                ///< `a|b`, `S`, `N`
  std::vector<std::string> words;  ///< a, b
  std::string range;               ///< `1 to 256`
};

/// The plain words at the beginning of a list such as `rgb|spectral[:N]`; none if it is no list.
std::vector<std::string> words_in(const std::string& list) {
  const std::string plain = list.substr(0, list.find('['));
  if (plain.empty()) return {};
  if (plain.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-|") != std::string::npos) return {};
  return CLI::detail::split(plain, '|');
}

Taken taken_by(const CLI::Option& option) {
  if (option.get_type_size() == 0) return {};
  std::string type = option.get_type_name();
  Taken taken;
  if (const size_t brace = type.find('{'); brace != std::string::npos) {
    type = type.substr(brace + 1, type.find('}') - brace - 1);
    std::replace(type.begin(), type.end(), ',', '|');
  }
  if (const size_t range = type.find(" in ["); range != std::string::npos) {
    taken.range = type.substr(range + 5, type.find(']', range) - range - 5);
    if (const size_t dash = taken.range.find(" - "); dash != std::string::npos)
      taken.range.replace(dash, 3, " to ");
    type.resize(range);
    if (const size_t colon = type.rfind(':'); colon != std::string::npos) type.resize(colon);
  }
  taken.name = type == "UINT" || type == "INT" || type == "FLOAT" ? "N" : type;
  taken.words = words_in(taken.name);
  return taken;
}

std::vector<std::string> names_of(const CLI::Option& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.get_snames()) names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
  return names;
}

OptionOutline outline_of(const CLI::Option& option) {
  const Taken taken = taken_by(option);
  OptionOutline outline{names_of(option), taken.name, taken.words, option.get_description(),
                        option.get_required()};
  if (option.get_positional()) outline.names = {option.get_name(true, false)};
  if (!taken.range.empty()) outline.help += "; from " + taken.range;
  return outline;
}

CommandOutline outline_of(const CLI::App& command) {
  CommandOutline outline{command.get_name(), command.get_description()};
  for (const CLI::Option* option : command.get_options()) {
    if (option->get_positional()) {
      outline.places.push_back(outline_of(*option));
      continue;
    }
    const auto is_its = [&](const OptionGroup& group) { return group.title == option->get_group(); };
    auto group = std::find_if(outline.groups.begin(), outline.groups.end(), is_its);
    if (group == outline.groups.end()) group = outline.groups.insert(group, {option->get_group(), {}});
    group->options.push_back(outline_of(*option));
  }
  // The parser's own, --help, is its first; people look for it last.
  std::rotate(outline.groups.begin(), outline.groups.begin() + 1, outline.groups.end());
  return outline;
}

}  // namespace

const Option& Option::required() const {
  option_->required();
  return *this;
}

const Option& Option::for_users() const {
  option_->configurable(false);
  return *this;
}

const Option& Option::takes(const std::string& name) const {
  option_->type_name(name);
  return *this;
}

const Option& Option::may_stand_alone() const {
  option_->expected(0, 1);
  return *this;
}

const Option& Option::read_first() const {
  option_->trigger_on_parse();
  return *this;
}

Option Options::add(CLI::Option* option) {
  if (!option->get_positional()) option->group(group_);
  option->configurable(asked_by_ == AskedBy::scenes_too);  // as the library calls what files may set
  return Option(option);
}

namespace {
/// NaN is in no range, though the parser's own check lets it pass, and that prints small limits as 0.
CLI::Validator in_range(double least, double most) {
  return CLI::Validator(
      [least, most](std::string& text) {
        double value = 0;
        return CLI::detail::lexical_cast(text, value) && value >= least && value <= most
                   ? std::string()
                   : fmt::format("{} is not a number from {:g} to {:g}", text, least, most);
      },
      "");
}

/// The parser's own check says "Value x not in range".
template <typename Number>
CLI::Validator in_whole_range(Number least, Number most) {
  return CLI::Validator(
      [least, most](std::string& text) {
        Number value = 0;
        return CLI::detail::lexical_cast(text, value) && value >= least && value <= most
                   ? std::string()
                   : fmt::format("'{}' is not a whole number from {} to {}", text, least, most);
      },
      fmt::format("{} in [{} - {}]", CLI::detail::type_name<Number>(), least, most));
}

/// The parser's problems in the words of people.
std::string problem_of(const CLI::ParseError& e, const CLI::App& app) {
  const std::string what = e.what();
  if (e.get_name() == "ArgumentMismatch" && what.find(": At Most 1 required") != std::string::npos) {
    const std::string name = what.substr(0, what.find(':'));
    for (const CLI::App* command : app.get_subcommands())
      if (const CLI::Option* option = command->get_option_no_throw(name))
        return fmt::format("{} is given {} times; give it once", fmt::join(names_of(*option), ", or "),
                           option->count());
  }
  if (constexpr std::string_view kBefore = "Could not convert: "; what.starts_with(kBefore))
    return fmt::format("{}: this value can't be read; a flag stands alone, or with `true` or `false`",
                       what.substr(kBefore.size()));
  return what;
}

/// Where an output is missing: the word that seems to be meant for it, as one may type it behind the scene.
std::string guess_output(const CLI::ParseError& e, const std::vector<std::string>& words) {
  if (std::string_view(e.what()) != "--output is required") return {};
  for (size_t i = 1; i < words.size(); ++i)
    for (const std::string_view extension : {".png", ".exr"})
      if (!words[i].starts_with('-') && words[i].ends_with(extension))
        return fmt::format(" (-o {}?)", words[i]);
  return {};
}
}  // namespace

Option Options::text(const std::string& names, std::string& target, const std::string& help,
                     const std::string& type) {
  return add(command_->add_option(names, target, help)->type_name(type));
}
Option Options::text(const std::string& names, std::function<void(const std::string&)> take,
                     const std::string& help, const std::string& type) {
  return add(command_->add_option_function<std::string>(names, std::move(take), help)->type_name(type));
}

Option Options::number(const std::string& names, int& target, int least, int most, const std::string& help) {
  return add(command_->add_option(names, target, help)->check(in_whole_range(least, most)));
}
Option Options::number(const std::string& names, std::optional<int>& target, int least, int most,
                       const std::string& help) {
  return add(command_->add_option(names, target, help)->check(in_whole_range(least, most)));
}
Option Options::number(const std::string& names, std::optional<double>& target, double least, double most,
                       const std::string& help) {
  return add(command_->add_option(names, target, help)->check(in_range(least, most)));
}
Option Options::number(const std::string& names, uint32_t& target, uint32_t least, uint32_t most,
                       const std::string& help) {
  return add(command_->add_option(names, target, help)->check(in_whole_range(least, most)));
}
Option Options::number(const std::string& names, std::optional<uint32_t>& target, uint32_t least,
                       uint32_t most, const std::string& help) {
  return add(command_->add_option(names, target, help)->check(in_whole_range(least, most)));
}
Option Options::number(const std::string& names, double& target, double least, double most,
                       const std::string& help) {
  return add(command_->add_option(names, target, help)->check(in_range(least, most)));
}
Option Options::number(const std::string& names, uint64_t& target, const std::string& help) {
  // Not the parser's own conversion: it wraps negative numbers round, and takes 010 for 8.
  const auto read = [](const std::string& text, uint64_t& value) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc() && end == text.data() + text.size();
  };
  const auto refuse = [read](const std::string& text) {
    uint64_t value = 0;
    return read(text, value) ? std::string()
                             : fmt::format("'{}' is not a whole number from 0 to {}", text, UINT64_MAX);
  };
  return add(command_
                 ->add_option_function<std::string>(
                     names, [&target, read](const std::string& text) { read(text, target); }, help)
                 ->type_name("UINT")
                 ->check(CLI::Validator(refuse, "")));
}

constexpr const char* kList = "N,...";

Option Options::numbers(const std::string& names, std::vector<int>& target, int least, int most,
                        const std::string& help) {
  return add(command_->add_option(names, target, help)
                 ->delimiter(',')
                 ->type_name(kList)
                 ->check(in_whole_range(least, most)));
}
Option Options::numbers(const std::string& names, std::vector<double>& target, double least, double most,
                        const std::string& help) {
  return add(command_->add_option(names, target, help)
                 ->delimiter(',')
                 ->type_name(kList)
                 ->check(in_range(least, most)));
}

Option Options::flag(const std::string& names, bool& target, const std::string& help) {
  return add(command_->add_flag(names, target, help));
}

Option Options::word(const std::string& names, std::function<void(const std::string&)> take,
                     const std::vector<std::string>& words, const std::string& help) {
  return add(
      command_->add_option_function<std::string>(names, std::move(take), help)->check(CLI::IsMember(words)));
}

Option Options::index_of(const std::string& name, std::function<void(size_t)> take,
                         const std::vector<std::string>& words, const std::string& help) {
  const auto list = fmt::format("{}", fmt::join(words, "|"));
  return text(
      name,
      [=](const std::string& word) {
        const auto found = std::find(words.begin(), words.end(), word);
        if (found == words.end())
          throw UsageError(fmt::format("{}: '{}' is unknown; choose {}", name, word, list));
        take(static_cast<size_t>(found - words.begin()));
      },
      help, list);
}

CommandLine::CommandLine(const std::string& program, const std::string& about, const std::string& version)
    : version_(version), app_(std::make_unique<CLI::App>(about, program)) {
  app_->set_help_flag("-h,--help", "print this help");
  app_->set_version_flag("--version", program + " " + version, "print the version");
  app_->require_subcommand(1);
}

CommandLine::~CommandLine() = default;

Options CommandLine::add(Verb verb) {
  CLI::App* command = app_->add_subcommand(verb.name, verb.help);
  command->get_help_ptr()->group("Help");
  examples_[verb.name] = verb.examples;
  command->callback([this, verb = std::move(verb)] { chosen_ = verb; });
  return Options(command);
}

ProgramOutline CommandLine::outline() const {
  const CLI::App& app = *app_;
  ProgramOutline outline{app.get_name(), app.get_description(), version_};
  for (const CLI::Option* option : app.get_options()) outline.options.push_back(outline_of(*option));
  for (const CLI::App* command : app.get_subcommands({})) {
    outline.commands.push_back(outline_of(*command));
    outline.commands.back().examples = examples_.at(command->get_name());
  }
  outline.examples = outline.commands.empty() ? std::vector<Example>() : outline.commands.front().examples;
  return outline;
}

/// Of the command that was typed, or of the program.
std::string CommandLine::help() const {
  const ProgramOutline program = outline();
  const std::vector<CLI::App*> typed = app_->get_subcommands();
  for (const CommandOutline& command : program.commands)
    if (!typed.empty() && typed.front()->get_name() == command.name)
      return help_of(program, command, help_width());
  return help_of(program, help_width());
}

Request CommandLine::parse(int argc, char** argv) {
  std::vector<std::string> words(argv + 1, argv + argc);
  if (!words.empty() && words.front() == "help") {  // as `rayfarm help render` may be typed
    words.erase(words.begin());
    words.resize(std::min<size_t>(words.size(), 1));
    words.push_back("--help");
  }
  const auto refuse = [&](const std::string& problem) {
    const std::string unknown = find_unknown_word(words);
    return Request{{},
                   fmt::format("rayfarm: {}\nTry 'rayfarm --help' or 'rayfarm COMMAND --help'.\n",
                               unknown.empty() ? problem : unknown),
                   kUsageError};
  };
  if (words.empty()) return refuse("a command is missing, as in 'rayfarm render SCENE -o FILE'");
  try {
    read_words(words);
    chosen_->check(words);
    return {chosen_, {}, kComplete};
  } catch (const CLI::CallForHelp&) {
    if (app_->get_subcommands().empty() && words.front().front() != '-')
      return refuse("");  // unknown command
    return {{}, help(), kComplete};
  } catch (const CLI::CallForVersion& version) {
    return {{}, fmt::format("{}\n", version.what()), kComplete};
  } catch (const CLI::ParseError& e) {
    return refuse(problem_of(e, *app_) + guess_output(e, words));
  } catch (const UsageError& e) {
    return refuse(e.what());
  }
}

void CommandLine::read_words(const std::vector<std::string>& words) {
  app_->parse(std::vector<std::string>(words.rbegin(), words.rend()));  // as the library takes them
}

void CommandLine::read(const std::vector<std::string>& words) {
  try {
    read_words(words);
  } catch (const CLI::ParseError& e) {
    throw UsageError(problem_of(e, *app_));
  }
}

const CLI::Option* CommandLine::find_option(const std::string& command, const std::string& name) const {
  return std::as_const(*app_).get_subcommand(command)->get_option_no_throw(name);
}

bool CommandLine::is_given(const std::string& command, const std::string& name) const {
  const CLI::Option* option = find_option(command, name);
  return option && option->count() > 0;
}

OptionKind CommandLine::kind_of(const std::string& command, const std::string& name) const {
  const CLI::Option* option = find_option(command, name);
  if (!option) return OptionKind::none;
  return option->get_configurable() ? OptionKind::for_scenes : OptionKind::for_users;
}

std::vector<std::string> CommandLine::names_for_scenes(const std::string& command) const {
  std::vector<std::string> names;
  for (const CLI::Option* option : std::as_const(*app_).get_subcommand(command)->get_options())
    if (option->get_configurable() && !option->get_lnames().empty())
      names.push_back(option->get_lnames().front());
  return names;
}

std::string CommandLine::find_unknown_word(const std::vector<std::string>& words) const {
  if (words.empty()) return {};
  const CLI::App* command = nullptr;
  std::vector<std::string> commands;
  for (const CLI::App* c : std::as_const(*app_).get_subcommands({})) {
    commands.push_back(c->get_name());
    if (c->get_name() == words[0]) command = c;
  }
  if (!command)
    return words[0][0] == '-'
               ? ""
               : fmt::format("unknown command '{}'{}", words[0], suggestion(words[0], commands));
  std::vector<std::string> options;
  for (const CLI::Option* option : command->get_options())
    for (const std::string& name : names_of(*option)) options.push_back(name);
  for (size_t i = 1; i < words.size(); ++i) {
    const std::string word = words[i].substr(0, words[i].find('='));
    if (word.starts_with("--") && std::find(options.begin(), options.end(), word) == options.end())
      return fmt::format("{} has no option '{}'{}", command->get_name(), word, suggestion(word, options));
  }
  return {};
}

}  // namespace rayfarm
