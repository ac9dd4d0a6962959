#pragma once
// A value of a glTF file's JSON, which knows where it stands, so that errors can say so.
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/errors/input_error.h"
#include "common/math/index.h"
#include "common/math/vector.h"

namespace rayfarm {

class GltfValue {
 public:
  /// Both must outlive it. `where`: "nodes[3].mesh"; empty for the whole.
  GltfValue(const nlohmann::json& json, const std::string& path, std::string where)
      : json_(&json), path_(&path), where_(std::move(where)) {}

  /// All throw InputError where the value is not what is asked for.
  [[noreturn]] void fail(std::string_view problem) const;
  SourcePlace place() const { return {*path_}; }
  const std::string& where() const { return where_; }

  bool has(const char* key) const;
  std::optional<GltfValue> find(const char* key) const;
  GltfValue at(const char* key) const;
  std::vector<std::string> keys() const;

  size_t size() const;  ///< of a list
  GltfValue operator[](size_t i) const;

  double number() const;  ///< finite
  uint64_t whole_number() const;
  const std::string& text() const;
  bool boolean() const;
  std::vector<double> numbers(size_t count) const;
  Vec3 vector3() const;

  // Of its members, which may be missing.
  double number(const char* key, double otherwise) const;
  double number_in(const char* key, double otherwise, double least, double most) const;
  uint64_t whole_number(const char* key, uint64_t otherwise) const;
  bool boolean(const char* key, bool otherwise) const;
  std::string text(const char* key, const char* otherwise) const;
  /// Of one of `count` things; kNone if it is missing.
  uint32_t index(const char* key, size_t count) const;
  std::optional<GltfValue> extension(const char* name) const;

 private:
  std::string where_of(const char* key) const;

  const nlohmann::json* json_;
  const std::string* path_;
  std::string where_;
};

/// Parses JSON, which may be hostile: nested at most 128 deep and of 4 million values. Throws InputError.
std::shared_ptr<const nlohmann::json> parse_gltf_json(std::string_view text, const std::string& path);

}  // namespace rayfarm
