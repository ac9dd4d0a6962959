#include "common/description/formats/gltf/value.h"

#include <fmt/core.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace rayfarm {

using Json = nlohmann::json;

namespace {

constexpr int kMostNesting = 128;
constexpr size_t kMostValues = 4'000'000;

/// Throws InputError for what is no JSON, or too much of it.
class Looker : public Json::json_sax_t {
 public:
  explicit Looker(const std::string& path) : path_(path) {}
  bool null() override { return count(); }
  bool boolean(bool) override { return count(); }
  bool number_integer(number_integer_t) override { return count(); }
  bool number_unsigned(number_unsigned_t) override { return count(); }
  bool number_float(number_float_t, const string_t&) override { return count(); }
  bool string(string_t&) override { return count(); }
  bool binary(binary_t&) override { return count(); }
  bool key(string_t&) override { return count(); }
  bool start_object(size_t) override { return enter(); }
  bool end_object() override { return leave(); }
  bool start_array(size_t) override { return enter(); }
  bool end_array() override { return leave(); }
  bool parse_error(size_t, const std::string&, const Json::exception& e) override {
    // "[json.exception.parse_error.101] parse error at line 1, column 2: …"
    std::string problem = e.what();
    if (const size_t end = problem.find("] "); end != std::string::npos) problem.erase(0, end + 2);
    throw InputError(
        {path_}, fmt::format("not valid JSON: {}; the file is damaged or cut off", problem.substr(0, 300)));
  }

 private:
  bool count() {
    if (++values_ > kMostValues)
      throw InputError({path_}, fmt::format("its JSON has more than {} values", kMostValues));
    return true;
  }
  bool enter() {
    if (++depth_ > kMostNesting)
      throw InputError({path_}, fmt::format("its JSON is nested more than {} deep", kMostNesting));
    return count();
  }
  bool leave() {
    --depth_;
    return true;
  }

  const std::string& path_;
  int depth_ = 0;
  size_t values_ = 0;
};

}  // namespace

void GltfValue::fail(std::string_view problem) const {
  throw InputError(place(), where_.empty() ? std::string(problem) : fmt::format("{}: {}", where_, problem));
}

std::string GltfValue::where_of(const char* key) const {
  return where_.empty() ? key : fmt::format("{}.{}", where_, key);
}

bool GltfValue::has(const char* key) const {
  if (!json_->is_object()) fail("an object, {…}, was expected");
  return json_->contains(key);
}

std::optional<GltfValue> GltfValue::find(const char* key) const {
  if (!has(key)) return std::nullopt;
  return GltfValue(*json_->find(key), *path_, where_of(key));
}

GltfValue GltfValue::at(const char* key) const {
  if (auto value = find(key)) return *value;
  fail(fmt::format("`{}` is missing", key));
}

std::vector<std::string> GltfValue::keys() const {
  if (!json_->is_object()) fail("an object, {…}, was expected");
  std::vector<std::string> keys;
  for (const auto& item : json_->items()) keys.push_back(item.key());
  return keys;
}

size_t GltfValue::size() const {
  if (!json_->is_array()) fail("a list, […], was expected");
  return json_->size();
}

GltfValue GltfValue::operator[](size_t i) const {
  return {(*json_)[i], *path_, fmt::format("{}[{}]", where_, i)};
}

double GltfValue::number() const {
  if (!json_->is_number()) fail("a number was expected");
  const auto value = json_->get<double>();
  if (!std::isfinite(value)) fail("a finite number was expected");
  return value;
}

uint64_t GltfValue::whole_number() const {
  const double value = number();
  if (json_->is_number_unsigned()) return json_->get<uint64_t>();
  if (!(value >= 0 && value < 0x1p53 && value == std::floor(value)))
    fail("a whole number from 0 on was expected");
  return static_cast<uint64_t>(value);
}

const std::string& GltfValue::text() const {
  if (!json_->is_string()) fail("a string was expected");
  return json_->get_ref<const std::string&>();
}

bool GltfValue::boolean() const {
  if (!json_->is_boolean()) fail("true or false was expected");
  return json_->get<bool>();
}

std::vector<double> GltfValue::numbers(size_t count) const {
  if (size() != count) fail(fmt::format("a list of {} numbers was expected, not of {}", count, size()));
  std::vector<double> values;
  for (size_t i = 0; i < count; ++i) values.push_back((*this)[i].number());
  return values;
}

Vec3 GltfValue::vector3() const {
  const std::vector<double> v = numbers(3);
  return {v[0], v[1], v[2]};
}

double GltfValue::number(const char* key, double otherwise) const {
  const auto value = find(key);
  return value ? value->number() : otherwise;
}

double GltfValue::number_in(const char* key, double otherwise, double least, double most) const {
  const double value = number(key, otherwise);
  if (!(value >= least && value <= most))
    at(key).fail(fmt::format("a number from {:g} to {:g} was expected, not {:g}", least, most, value));
  return value;
}

uint64_t GltfValue::whole_number(const char* key, uint64_t otherwise) const {
  const auto value = find(key);
  return value ? value->whole_number() : otherwise;
}

bool GltfValue::boolean(const char* key, bool otherwise) const {
  const auto value = find(key);
  return value ? value->boolean() : otherwise;
}

std::string GltfValue::text(const char* key, const char* otherwise) const {
  const auto value = find(key);
  return value ? value->text() : otherwise;
}

uint32_t GltfValue::index(const char* key, size_t count) const {
  const auto value = find(key);
  if (!value) return kNone;
  const uint64_t index = value->whole_number();
  if (index >= count)
    value->fail(fmt::format("{} does not exist: the file has {}, counted from 0", index, count));
  return static_cast<uint32_t>(index);
}

std::optional<GltfValue> GltfValue::extension(const char* name) const {
  const auto all = find("extensions");
  return all ? all->find(name) : std::nullopt;
}

std::shared_ptr<const Json> parse_gltf_json(std::string_view text, const std::string& path) {
  // Looked through before anything is made of it. (The library's parser with a callback looks at all of a
  // list for each object in it.)
  Looker looker(path);
  Json::sax_parse(text.begin(), text.end(), &looker);
  return std::make_shared<const Json>(Json::parse(text.begin(), text.end()));
}

}  // namespace rayfarm
