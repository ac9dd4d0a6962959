#pragma once
// Threads that decompress blocks on their way to the frame buffer. One can't keep up with hundreds of nodes,
// and while it decompresses, nobody is served.
#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "protocol/messages.h"

namespace rayfarm {

class BlockDecoders {
 public:
  /// A block as it came, and its pixels as they are.
  struct Decoded {
    NodeId node;
    Bytes message;
    BlockResult block;     ///< lies in `message`; the pixels do in `pixels`
    size_t net_bytes = 0;  ///< that the pixels were on the net
    Bytes pixels;
    std::string problem;         ///< of a block that is damaged
    std::exception_ptr failure;  ///< of the host, which had no memory
  };

  /// 0 threads: as many as suit the machine. They start with the first block.
  explicit BlockDecoders(int threads = 0);
  ~BlockDecoders();
  BlockDecoders(const BlockDecoders&) = delete;
  BlockDecoders& operator=(const BlockDecoders&) = delete;

  /// A compressed block of so many pixels, which lies in `message`.
  void submit(NodeId node, Bytes message, const BlockResult& block, int width, int height);
  /// The next that is done, in whatever order. Where the threads are behind, the caller decompresses one,
  /// too.
  /// Throws what made the host fail.
  std::optional<Decoded> try_take();
  /// True if some were submitted that were not taken.
  bool has_work() const { return not_taken_ > 0; }

 private:
  struct Job {
    Decoded block;
    int width = 0, height = 0;
  };
  static Decoded decode(Job job);
  void run(const std::stop_token& stop);

  int threads_wanted_;
  size_t not_taken_ = 0;
  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::deque<Job> waiting_;
  std::deque<Decoded> done_;
  std::vector<std::jthread> threads_;  // last: they look at the others
};

}  // namespace rayfarm
