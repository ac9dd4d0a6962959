#pragma once
// JSON: values to write, and files that Rayfarm wrote, read again. The library that does it is known to
// json.cpp alone.
#include <concepts>
#include <cstdint>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace rayfarm {

/// A file is not JSON, or a value is not there or not of the type that is asked for.
class JsonError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A value to write; null at first.
class Json {
 public:
  using Array = std::vector<Json>;
  using Object = std::map<std::string, Json>;  ///< written in the order of its names

  Json() = default;
  Json(bool value) : value_(value) {}
  Json(double value) : value_(value) {}
  Json(const char* value) : value_(std::string(value)) {}
  Json(std::string value) : value_(std::move(value)) {}
  Json(Array value) : value_(std::move(value)) {}
  Json(Object value) : value_(std::move(value)) {}
  Json(std::signed_integral auto value) : value_(int64_t{value}) {}
  Json(std::unsigned_integral auto value) : value_(uint64_t{value}) {}
  template <typename T>
  Json(const std::vector<T>& values) : value_(Array(values.begin(), values.end())) {}

  /// A member, made if it is not there; null becomes an object.
  Json& operator[](const std::string& name) { return as<Object>()[name]; }
  /// Null becomes an array.
  void push_back(Json value) { as<Array>().push_back(std::move(value)); }

  /// `indent`: spaces a level; below 0: all in one line. Throws JsonError if a text is not UTF-8.
  std::string dump(int indent = -1) const;

 private:
  friend struct JsonConversion;
  template <typename T>
  T& as() {
    if (std::holds_alternative<std::monostate>(value_)) value_ = T();
    return std::get<T>(value_);
  }
  std::variant<std::monostate, bool, int64_t, uint64_t, double, std::string, Array, Object> value_;
};

/// A value that was read. All members throw JsonError if it is of another type.
class JsonView {
 public:
  /// Throws IoError if the file can't be read, JsonError if it is not JSON.
  static JsonView read_file(const std::string& path);

  JsonView at(const std::string& name) const;
  bool has(const std::string& name) const;
  size_t size() const;
  double number() const;
  int integer() const;
  uint64_t count() const;
  std::string text() const;
  std::vector<double> numbers() const;
  std::vector<JsonView> elements() const;

 private:
  explicit JsonView(std::shared_ptr<const void> value) : value_(std::move(value)) {}
  std::shared_ptr<const void> value_;  ///< holds the whole file
};

}  // namespace rayfarm
