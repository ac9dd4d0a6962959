#include "common/description/formats/yaml_document.h"

#include <fmt/ranges.h>

#include <filesystem>

namespace rayfarm {
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
