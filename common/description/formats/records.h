#pragma once
// Text files whose lines are records: a keyword and what belongs to it. OBJ and MTL are such.
#include <optional>
#include <string>
#include <string_view>

#include "common/errors/input_error.h"
#include "common/errors/stop.h"

namespace rayfarm {

/// The number that a whole word is, perhaps with a plus before it; nothing if it is none, or too large for a
/// double. Rounded correctly, the smallest to 0; may be infinite if the word says so.
std::optional<double> parse_number(std::string_view word);

/// A walk through the words of a text, line by line. Lines end in a line feed, a carriage return or both.
class Records {
 public:
  /// `text` must outlive it; `lines_before` it stand in the file.
  Records(std::string_view text, std::string path, std::stop_token stop, int lines_before = 0)
      : text_(text), path_(std::move(path)), stop_(std::move(stop)), line_(lines_before) {}

  /// Goes on to the next line that is neither empty nor a comment and takes its keyword. False at the end.
  /// Throws Stopped.
  bool next();
  std::string_view keyword() const { return keyword_; }
  int line() const { return line_; }  ///< at the end: how many there are

  bool has_more() { return !peek().empty(); }  ///< words on this line
  std::string_view word();                     ///< the next one; empty at the line's end
  std::string_view peek();                     ///< the same, without taking it
  std::string_view rest();                     ///< of the line, without the space around it
  double number();                             ///< the next word; throws InputError if it is no finite number
  float float_number();                        ///< the same as the nearest float; beyond all: infinite
  bool has_number();                           ///< true if the next word begins as a number does

  SourcePlace place() const { return {path_, line_, column_}; }  ///< of the word taken last
  SourcePlace line_place() const { return {path_, line_}; }
  [[noreturn]] void fail(std::string_view problem) const { throw InputError(place(), problem); }

 private:
  std::string_view text_, row_, keyword_;
  std::string path_;
  std::stop_token stop_;
  size_t begin_ = 0, at_ = 0;
  int line_ = 0, column_ = 0;
};

}  // namespace rayfarm
