#include "host/files/json.h"

#include <nlohmann/json.hpp>

#include "common/files/read_file.h"

namespace rayfarm {
namespace {

constexpr uintmax_t kMostBytes = 4ull << 30;  ///< of a file

const nlohmann::json& value_of(const std::shared_ptr<const void>& value) {
  return *static_cast<const nlohmann::json*>(value.get());
}

/// Calls `action` with our own errors in place of the library's.
auto translated(auto action) {
  try {
    return action();
  } catch (const nlohmann::json::exception& e) {
    throw JsonError(e.what());
  }
}

template <typename T>
T get(const std::shared_ptr<const void>& value) {
  return translated([&] { return value_of(value).get<T>(); });
}

}  // namespace

struct JsonConversion {
  nlohmann::json operator()(std::monostate) const { return nullptr; }
  nlohmann::json operator()(const Json::Array& array) const {
    auto j = nlohmann::json::array();
    for (const Json& element : array) j.push_back(convert(element));
    return j;
  }
  nlohmann::json operator()(const Json::Object& object) const {
    auto j = nlohmann::json::object();
    for (const auto& [name, member] : object) j[name] = convert(member);
    return j;
  }
  nlohmann::json operator()(const auto& value) const { return value; }
  static nlohmann::json convert(const Json& json) { return std::visit(JsonConversion(), json.value_); }
};

std::string Json::dump(int indent) const {
  return translated([&] { return JsonConversion::convert(*this).dump(indent); });
}

JsonView JsonView::read_file(const std::string& path) {
  const std::string text = read_text_file(path, kMostBytes);
  return translated(
      [&] { return JsonView(std::make_shared<const nlohmann::json>(nlohmann::json::parse(text))); });
}

JsonView JsonView::at(const std::string& name) const {
  return translated([&] { return JsonView({value_, &value_of(value_).at(name)}); });
}
bool JsonView::has(const std::string& name) const {
  return value_of(value_).contains(name);
}
size_t JsonView::size() const {
  if (!value_of(value_).is_structured()) throw JsonError("a list was expected");
  return value_of(value_).size();
}
double JsonView::number() const {
  return get<double>(value_);
}
int JsonView::integer() const {
  return get<int>(value_);
}
uint64_t JsonView::count() const {
  return get<uint64_t>(value_);
}
std::string JsonView::text() const {
  return get<std::string>(value_);
}
std::vector<double> JsonView::numbers() const {
  return get<std::vector<double>>(value_);
}
std::vector<JsonView> JsonView::elements() const {
  std::vector<JsonView> elements;
  for (const nlohmann::json& element : value_of(value_)) elements.push_back(JsonView({value_, &element}));
  return elements;
}

}  // namespace rayfarm
