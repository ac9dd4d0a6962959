#pragma once
// How far the reading of a scene's files is, for people who wait.
#include <atomic>
#include <cstdint>

namespace rayfarm {

/// Bytes of the text files that were opened so far (YAML, NFF and OBJ); what is read again counts again.
/// Loaders count, any thread may look.
struct ReadProgress {
  std::atomic<uint64_t> total = 0, done = 0;
};

/// Nobody need wait: `progress` may be null.
inline void count_opened(ReadProgress* progress, uint64_t bytes) {
  if (progress) progress->total += bytes;
}
inline void count_read(ReadProgress* progress, uint64_t bytes) {
  if (progress) progress->done += bytes;
}

}  // namespace rayfarm
