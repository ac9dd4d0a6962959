#include "host/commands/command_line.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>
#include <sstream>

#include "common/errors/input_error.h"
#include "host/process/exit_code.h"

namespace rayfarm {
namespace {

/// The words of a list such as `{a,b}`.
std::string choices_in(const std::string& list) {
  std::string words = list.substr(1, list.find('}') - 1);
  std::replace(words.begin(), words.end(), ',', '|');
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

/// Shows what an option takes (`N from 1 to 256`, `sah|thesis`, `FILE`), and none of the parser's insides.
class HelpFormatter : public CLI::Formatter {
 public:
  std::string make_option_name(const CLI::Option* option, bool is_positional) const override {
    if (is_positional) return option->get_name(true, false);
    return fmt::format("{}", fmt::join(names_of(*option), ", "));
  }
  std::string make_option_opts(const CLI::Option* option) const override {
    if (option->get_type_size() == 0 || option->get_positional()) return "";
    return " " + plain_type(option->get_type_name());
  }
};

}  // namespace

const Option& Option::required() const {
  option_->required();
  return *this;
}

const Option& Option::for_users() const {
  option_->configurable(false);
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

Option Options::numbers(const std::string& names, std::vector<int>& target, int least, int most,
                        const std::string& help) {
  return add(command_->add_option(names, target, help)->delimiter(',')->check(in_whole_range(least, most)));
}
Option Options::numbers(const std::string& names, std::vector<double>& target, double least, double most,
                        const std::string& help) {
  return add(command_->add_option(names, target, help)->delimiter(',')->check(in_range(least, most)));
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
    : app_(std::make_unique<CLI::App>(about, program)) {
  app_->formatter(std::make_shared<HelpFormatter>());
  app_->set_version_flag("--version", program + " " + version);
  app_->require_subcommand(1);
}

CommandLine::~CommandLine() = default;

Options CommandLine::add(Verb verb) {
  CLI::App* command = app_->add_subcommand(verb.name, verb.help);
  command->callback([this, verb = std::move(verb)] { chosen_ = verb; });
  return Options(command);
}

Request CommandLine::parse(int argc, char** argv) {
  const auto refuse = [&](const std::string& problem) {
    const std::string unknown = find_unknown_word(argc, argv);
    return Request{{},
                   fmt::format("rayfarm: {}\nTry 'rayfarm --help' or 'rayfarm COMMAND --help'.\n",
                               unknown.empty() ? problem : unknown),
                   kUsageError};
  };
  try {
    const std::vector<std::string> words(argv + 1, argv + argc);
    read_words(words);
    chosen_->check(words);
    return {chosen_, {}, kComplete};
  } catch (const CLI::ParseError& e) {
    std::ostringstream out, err;
    if (app_->exit(e, out, err) == 0) return {{}, out.str(), kComplete};
    return refuse(problem_of(e, *app_));
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

std::string CommandLine::find_unknown_word(int argc, char** argv) const {
  if (argc < 2) return {};
  const CLI::App* command = nullptr;
  std::vector<std::string> commands;
  for (const CLI::App* c : std::as_const(*app_).get_subcommands({})) {
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
