#include "host/farm/block_decoders.h"

#include <algorithm>
#include <system_error>

#include "protocol/block_codec.h"

namespace rayfarm {
namespace {

/// A thread decompresses some 60 Mpixel/s, a host that does nothing else serves a few hundred.
constexpr int kMostThreads = 4;
/// So many blocks that wait for each thread are a sign that the threads are behind.
constexpr size_t kMostWaiting = 8;

}  // namespace

BlockDecoders::BlockDecoders(int threads)
    : threads_wanted_(threads > 0 ? threads
                                  : std::clamp(static_cast<int>(std::thread::hardware_concurrency()) / 2, 1,
                                               kMostThreads)) {}

BlockDecoders::~BlockDecoders() {
  for (std::jthread& thread : threads_) thread.request_stop();
}

void BlockDecoders::submit(NodeId node, Bytes message, const BlockResult& block, int width, int height) {
  Job job{{node, std::move(message), block, block.pixels.size(), {}, {}, {}}, width, height};
  ++not_taken_;
  {
    const std::lock_guard lock(mutex_);
    waiting_.push_back(std::move(job));
  }
  if (threads_.size() < static_cast<size_t>(threads_wanted_)) {
    try {
      threads_.emplace_back([this](const std::stop_token& stop) { run(stop); });
    } catch (const std::system_error&) {  // the system gives no more of them; `try_take` does without
      threads_wanted_ = static_cast<int>(threads_.size());
    }
  }
  changed_.notify_one();
}

BlockDecoders::Decoded BlockDecoders::decode(Job job) {
  Decoded& block = job.block;
  try {
    block.pixels = decompress_rgb8(block.block.pixels, job.width, job.height);
    block.block.pixels = block.pixels;
    block.block.is_compressed = false;
  } catch (const ProtocolError& e) {
    block.problem = e.what();
  } catch (...) {
    block.failure = std::current_exception();
  }
  return std::move(block);
}

void BlockDecoders::run(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (changed_.wait(lock, stop, [this] { return !waiting_.empty(); })) {
    if (stop.stop_requested()) return;  // nobody takes what is left
    Job job = std::move(waiting_.front());
    waiting_.pop_front();
    lock.unlock();
    Decoded decoded = decode(std::move(job));
    lock.lock();
    done_.push_back(std::move(decoded));
  }
}

std::optional<BlockDecoders::Decoded> BlockDecoders::try_take() {
  if (not_taken_ == 0) return std::nullopt;
  std::unique_lock lock(mutex_);
  std::optional<Decoded> next;
  if (!done_.empty()) {
    next = std::move(done_.front());
    done_.pop_front();
  } else if (waiting_.size() > kMostWaiting * threads_.size()) {
    Job job = std::move(waiting_.front());
    waiting_.pop_front();
    lock.unlock();
    next = decode(std::move(job));
  }
  if (!next) return next;
  --not_taken_;
  if (next->failure) std::rethrow_exception(next->failure);
  return next;
}

}  // namespace rayfarm
