#include "common/image/exr_streams.h"

#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "common/files/regular_file.h"

namespace rayfarm {
namespace {

constexpr size_t kAheadBytes = 1 << 16;

[[noreturn]] void fail_stream(int error) {
  throw std::runtime_error(std::strerror(error ? error : EIO));
}

}  // namespace

void ExrOutput::write(const char bytes[], int count) {
  const auto size = static_cast<size_t>(count);
  errno = 0;
  if (std::fwrite(bytes, 1, size, file_) != size) fail_stream(errno);
}

uint64_t ExrOutput::tellp() {
  return static_cast<uint64_t>(ftello(file_));
}

void ExrOutput::seekp(uint64_t position) {
  if (fseeko(file_, static_cast<off_t>(position), SEEK_SET) != 0) fail_stream(errno);
}

ExrInput::ExrInput(std::FILE* file, Overlay overlay) : IStream("the file"), file_(file), overlay_(overlay) {
  struct stat status {};
  if (fstat(fileno(file), &status) != 0) fail_stream(errno);
  end_ = static_cast<uint64_t>(status.st_size);
}

bool ExrInput::read(char bytes[], int count) {
  const std::span to(reinterpret_cast<std::byte*>(bytes), static_cast<size_t>(count));
  if (to.size() >= kAheadBytes) {
    read_through(position_, to);
  } else {
    if (position_ < ahead_begin_ || position_ + to.size() > ahead_begin_ + ahead_.size()) {
      const uint64_t left = end_ - std::min(end_, position_);
      std::vector<std::byte> next(std::max(to.size(), std::min<size_t>(kAheadBytes, left)));
      read_through(position_, next);
      ahead_ = std::move(next);
      ahead_begin_ = position_;
    }
    std::memcpy(to.data(), ahead_.data() + (position_ - ahead_begin_), to.size());
  }
  position_ += to.size();
  return position_ < end_;
}

void ExrInput::read_through(uint64_t from, std::span<std::byte> to) const {
  if (read_at(file_, from, to) != to.size()) throw std::runtime_error("the file ends too early");
  const uint64_t begin = std::max(from, overlay_.begin),
                 end = std::min(from + to.size(), overlay_.begin + overlay_.bytes.size());
  if (begin < end)
    std::memcpy(to.data() + (begin - from), overlay_.bytes.data() + (begin - overlay_.begin), end - begin);
}

}  // namespace rayfarm
