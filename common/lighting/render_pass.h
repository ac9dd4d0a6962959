#pragma once
// Passes: parts of a picture's samples.
#include <cstddef>
#include <cstdint>
#include <span>

namespace rayfarm {

/// A picture's samples may come in passes, each of which goes on from the sums of the one before: so the last
/// gives the pixels that one pass for all would.
struct RenderPass {
  uint32_t index = 0, count = 1;
  /// What the pass before gave as RenderedPixels::running of the same rectangle; the first has none.
  std::span<const std::byte> before;

  bool is_last() const { return index + 1 == count; }
  /// Of the pass's samples, of so many of a pixel. None is empty where there are as many samples as passes.
  uint32_t begin(uint32_t samples) const { return share(samples, index); }
  uint32_t end(uint32_t samples) const { return share(samples, index + 1); }

 private:
  uint32_t share(uint32_t samples, uint32_t passes) const {
    return static_cast<uint32_t>(uint64_t{samples} * passes / count);
  }
};

}  // namespace rayfarm
