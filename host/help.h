#pragma once
// Help texts in plain words, and what was probably meant by a mistyped command or option.
#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace rayfarm {

/// Shows what an option takes (`N from 1 to 256`, `sah|thesis`, `FILE`), and none of the parser's insides.
class HelpFormatter : public CLI::Formatter {
 public:
  std::string make_option_name(const CLI::Option* option, bool is_positional) const override;
  std::string make_option_opts(const CLI::Option* option) const override;
};

struct OptionGroup {
  std::string title;
  std::vector<std::string> options;  ///< long names
};
/// Puts a command's options under titles; each must be named once.
void group_options(CLI::App& command, const std::vector<OptionGroup>& groups);

/// Names the first word that is no command or option of `app`, and what was probably meant; or nothing.
std::string find_unknown_word(const CLI::App& app, int argc, char** argv);

}  // namespace rayfarm
