#pragma once
// The scene as bytes: [magic, sizes] [arrays, each aligned to 64 bytes] [table, by cereal]. The bytes hold
// offsets only, so they may be copied, sent or mapped anywhere that is aligned to 64 bytes.
#include <cstddef>
#include <cstdlib>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/scene/scene.h"

namespace rayfarm {

/// The bytes are not a scene block of this build, or are damaged.
class SceneBlockError : public std::runtime_error {
 public:
  explicit SceneBlockError(const std::string& what)
      : std::runtime_error("the scene block is damaged: " + what) {}
};

/// An owned block, aligned to 64 bytes.
struct SceneBlock {
  struct Free {
    void operator()(std::byte* p) const { std::free(p); }
  };
  std::unique_ptr<std::byte, Free> data;
  size_t size = 0;
  std::span<const std::byte> bytes() const { return {data.get(), size}; }
  /// Gives memory of the bytes from `first` up to `end` back: they must not be read any more.
  void give_back(size_t first, size_t end) { release_pages(data.get() + first, end - first); }
};

/// Copies the arrays into a new block.
SceneBlock encode_scene(const Scene& scene);
/// Moves them there: each goes as it is copied, so that never two copies of all stand beside each other.
SceneBlock encode_scene(SceneArrays<GrowingArray>&& arrays);

/// A view into `bytes`, which must be aligned to 64 bytes and outlive it. Every offset, count and index is
/// checked against the bytes at hand: a damaged block ends in SceneBlockError, never in a read outside of it.
Scene decode_scene(std::span<const std::byte> bytes);

}  // namespace rayfarm
