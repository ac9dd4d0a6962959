#pragma once
// A text as a stream that can be stopped from another thread, for parsers that know nothing of it: they ask
// for the next piece now and then.
#include <streambuf>
#include <string_view>

#include "common/errors/stop.h"

namespace rayfarm {

class StoppableText : public std::streambuf {
 public:
  /// `text` must outlive it.
  StoppableText(std::string_view text, std::stop_token stop) : text_(text), stop_(std::move(stop)) {}

 protected:
  /// Throws Stopped. A parser that reads the buffer itself, not through the stream, lets it pass.
  int_type underflow() override {
    throw_if_stopped(stop_);
    if (text_.empty()) return traits_type::eof();
    constexpr size_t kPiece = 1 << 16;
    const std::string_view piece = text_.substr(0, kPiece);
    text_.remove_prefix(piece.size());
    char* const begin = const_cast<char*>(piece.data());  // only read from: nothing is put back
    setg(begin, begin, begin + piece.size());
    return traits_type::to_int_type(piece.front());
  }

 private:
  std::string_view text_;
  std::stop_token stop_;
};

}  // namespace rayfarm
