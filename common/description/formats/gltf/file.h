#pragma once
// A glTF 2.0 file, .gltf or .glb, with its buffers: bytes are handed out only where they are there.
#include <deque>
#include <map>
#include <span>

#include "common/description/formats/gltf/value.h"
#include "common/description/load_options.h"

namespace rayfarm {

class GltfFile {
 public:
  /// Throws IoError if it can't be read, InputError if it is damaged or no glTF 2.0, and Stopped.
  GltfFile(const std::string& path, const LoadOptions& options);
  GltfFile(const GltfFile&) = delete;

  const std::string& path() const { return path_; }
  const LoadOptions& options() const { return options_; }
  GltfValue root() const { return {*json_, path_, ""}; }
  /// How many there are of a list at the top ("nodes"), and one of them.
  size_t count(const char* list) const;
  GltfValue item(const char* list, size_t i) const;
  /// How many morph targets a mesh has.
  size_t morph_targets(uint32_t mesh) const;
  /// Which of several things with these names is wanted, by its name or number. Throws InputError if none is.
  size_t find_choice(const char* kind, const std::string& wanted,
                     const std::vector<std::string>& names) const;
  /// A name for people: its own, or its place.
  std::string name_of(const GltfValue& value) const;

  struct View {
    std::span<const std::byte> bytes;
    size_t stride = 0;  ///< 0: elements stand side by side
  };
  /// Of a bufferView, decoded if it is compressed.
  View view(uint32_t index) const;
  /// The file beside this one that a URI names; none if it holds the bytes itself.
  std::optional<std::string> path_of_uri(const GltfValue& uri) const;
  /// Throws InputError: why what a URI names can't be read, and what to do where its path is of another
  /// machine.
  [[noreturn]] void fail_of_uri(const GltfValue& uri, std::string_view problem) const;
  /// What a URI names or holds.
  std::span<const std::byte> bytes_of_uri(const GltfValue& uri) const;
  /// All files that were read beside it so far.
  const std::vector<std::string>& files() const { return files_; }

  /// Counts faces and other things of a mesh, and what stands for nothing but zeros: a small file can have
  /// much of it, as accessors may be used again and again. Throws InputError beyond what its size warrants.
  void take_elements(const GltfValue& owner, uint64_t count) const;
  /// Counts what nodes need for meshes of their own: of skinned and morphed ones, which no others bend as
  /// they do. Throws InputError beyond what a program may be expected to hold.
  void take_copies(const GltfValue& owner, double bytes) const;
  void take_zeros(const GltfValue& owner, uint64_t values) const;

 private:
  void open_glb();
  std::span<const std::byte> buffer(uint32_t index, const GltfValue& user) const;
  View decoded(const GltfValue& view, const GltfValue& compression) const;

  std::string path_;
  LoadOptions options_;
  std::string glb_;                   ///< the whole file, if it is one
  std::span<const std::byte> chunk_;  ///< its binary part
  std::shared_ptr<const nlohmann::json> json_;
  mutable std::vector<std::string> files_;
  // Read when they are first asked for.
  mutable std::deque<std::string> contents_;                             ///< of files and URIs
  mutable std::map<std::string, std::span<const std::byte>> data_uris_;  ///< decoded, by where they stand
  mutable std::vector<std::optional<std::span<const std::byte>>> buffers_;
  mutable std::vector<std::optional<View>> decoded_;  ///< by view
  mutable uint64_t buffer_bytes_ = 0, elements_ = 0, zeros_ = 0;
  mutable double copied_bytes_ = 0;
};

}  // namespace rayfarm
