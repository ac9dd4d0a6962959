#pragma once
// A text as a stream that can be stopped from another thread and counts what was read, for parsers that know
// nothing of it: they ask for the next piece now and then.
#include <streambuf>
#include <string_view>

#include "common/description/read_progress.h"
#include "common/errors/stop.h"

namespace rayfarm {

class StoppableText : public std::streambuf {
 public:
  /// `text` must outlive it.
  StoppableText(std::string_view text, std::stop_token stop, ReadProgress* progress)
      : text_(text), stop_(std::move(stop)), progress_(progress) {}

 protected:
  /// Throws Stopped. A parser that reads the buffer itself, not through the stream, lets it pass.
  int_type underflow() override {
    throw_if_stopped(stop_);
    count_read(progress_, piece_bytes_);
    piece_bytes_ = 0;
    if (text_.empty()) return traits_type::eof();
    constexpr size_t kPiece = 1 << 16;
    const std::string_view piece = text_.substr(0, kPiece);
    text_.remove_prefix(piece.size());
    piece_bytes_ = piece.size();
    char* const begin = const_cast<char*>(piece.data());  // only read from: nothing is put back
    setg(begin, begin, begin + piece.size());
    return traits_type::to_int_type(piece.front());
  }

 private:
  std::string_view text_;
  std::stop_token stop_;
  ReadProgress* progress_;
  size_t piece_bytes_ = 0;  ///< of the piece that is being read
};

}  // namespace rayfarm
