#include "common/description/formats/yaml_document.h"

#include <fmt/ranges.h>

#include <filesystem>

namespace rayfarm {
namespace {

/// A line of the text, and its number from 1.
struct NumberedLine {
  std::string_view text;
  int number;
};

/// The line, from 0, and up to `before` lines before it.
std::vector<NumberedLine> lines_up_to(std::string_view text, int line, int before) {
  std::vector<NumberedLine> lines;
  for (int i = 0; i <= line && !text.empty(); ++i) {
    const size_t end = std::min(text.find('\n'), text.size());
    if (i >= line - before) lines.push_back({text.substr(0, end), i + 1});
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

/// The colour, as #ffeecc, that begins the comment there; empty if none does.
std::string_view colour_at(std::string_view rest) {
  const size_t length = std::min(rest.find_first_not_of("0123456789abcdefABCDEF", 1), rest.size());
  const bool ends = length == rest.size() || std::string_view(" \t\r,}]").find(rest[length]) != rest.npos;
  return ends && (length == 4 || length == 7) ? rest.substr(0, length) : std::string_view();
}

/// Of colours without quotes between brackets, whose closing ones the comment hides.
std::string find_hidden_colour(const std::vector<NumberedLine>& lines) {
  int open = 0;
  for (const NumberedLine& line : lines) {
    char quote = 0, before = ' ';
    for (size_t i = 0; i < line.text.size(); before = line.text[i++]) {
      const char c = line.text[i];
      if (quote) {
        if (c == quote) quote = 0;
      } else if (c == '\'' || c == '"') {
        quote = c;
      } else if (c == '[' || c == '{') {
        ++open;
      } else if (c == ']' || c == '}') {
        open = std::max(open - 1, 0);
      } else if (c == '#' && (before == ' ' || before == '\t')) {
        const std::string_view colour = colour_at(line.text.substr(i));
        if (open > 0 && !colour.empty())
          return fmt::format("; in line {}, what follows a # is a comment: put '{}' in quotes", line.number,
                             colour);
        break;
      }
    }
  }
  return {};
}

}  // namespace

std::string advice_on_yaml(std::string_view text, int line, std::string_view problem) {
  if (problem.starts_with("unknown escape character") || problem.find("hex number") != problem.npos)
    return "; in double quotes a \\ begins an escape: write / in its place, or use single quotes";
  constexpr int kFlowLines = 8;  // the library tells the place where what is open can't go on
  if (const std::string advice = find_hidden_colour(lines_up_to(text, line, kFlowLines)); !advice.empty())
    return advice;
  for (const NumberedLine& l : lines_up_to(text, line, 1))
    if (const size_t end = l.text.find_first_not_of(" \t"); l.text.substr(0, end).find('\t') != l.text.npos)
      return fmt::format("; line {} is indented by a tab: YAML takes blanks alone", l.number);
  return {};
}

void YamlProblems::throw_if_any() const {
  if (!lines_.empty()) throw InputError(fmt::format("{}", fmt::join(lines_, "\n")));
}

void YamlProblems::add(const InputError& e) {
  if (std::find(lines_.begin(), lines_.end(), e.what()) != lines_.end()) return;
  lines_.emplace_back(e.what());
  if (!is_full()) return;
  lines_.emplace_back("more may be wrong; these first");
  throw_if_any();
}

void YamlNames::define(const YamlValue& key, uint32_t id) {
  const std::string name = key.text();
  if (!ids_.emplace(name, id).second) key.fail(fmt::format("{} '{}' is defined twice", kind_, name));
  names_.push_back(name);
}

uint32_t YamlNames::find(const YamlValue& value, const std::string& otherwise) const {
  const auto found = ids_.find(value.text());
  if (found == ids_.end()) value.fail_unknown(kind_, names_, otherwise);
  return found->second;
}

std::string YamlDocument::path_of(const YamlValue& file) const {
  return (std::filesystem::path(folder) / file.text()).string();
}

}  // namespace rayfarm
