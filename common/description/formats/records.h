#pragma once
// Text files whose lines are records: a keyword and what belongs to it. OBJ and MTL are such.
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "common/errors/input_error.h"
#include "common/errors/stop.h"

namespace rayfarm {

/// The number that a whole word is, perhaps with a plus before it; nothing if it is none, or too large for a
/// double. Rounded correctly, the smallest to 0; may be infinite if the word says so.
std::optional<double> parse_number(std::string_view word);

/// True if a record may begin at a place of a text: behind the end of a line that does not go on (`\\`).
bool may_begin_record(std::string_view text, size_t at);

/// A walk through the words of a text, record by record. Lines end in a line feed, a carriage return or both;
/// a record goes on in the next line behind a backslash that ends its own. Comments do not.
class Records {
 public:
  /// `text` must outlive it; `lines_before` it stand in the file.
  Records(std::string_view text, std::string path, std::stop_token stop, int lines_before = 0)
      : text_(text), path_(std::move(path)), stop_(std::move(stop)), line_(lines_before), end_line_(line_) {}

  /// Goes on to the next record that is neither empty nor a comment and takes its keyword. False at the end.
  /// Throws Stopped.
  bool next();
  std::string_view keyword() const { return keyword_; }
  int line() const { return line_; }       ///< where the record begins
  int lines() const { return end_line_; }  ///< so far, and at the end: how many there are

  bool has_more() { return !peek().empty(); }  ///< words of this record
  std::string_view word();                     ///< the next one; empty at the record's end
  std::string_view peek();                     ///< the same, without taking it
  std::string rest();                          ///< of the record, without the space around it
  double number();                             ///< the next word; throws InputError if it is no finite number
  float float_number();                        ///< the same as the nearest float; beyond all: infinite
  bool has_number();                           ///< true if the next word begins as a number does
  /// True, once, if a number stood like 3.1+e2, whose exponent nobody reads (it is 3.1 to all programs).
  bool take_stray_exponent() { return std::exchange(has_stray_exponent_, false); }

  SourcePlace place() const;  ///< of the word taken last
  SourcePlace line_place() const { return {path_, line_}; }
  [[noreturn]] void fail(std::string_view problem) const { throw InputError(place(), problem); }

 private:
  bool is_space_at(size_t at) const;
  /// Where the line that holds `at` ends.
  size_t end_of_line(size_t at);
  size_t next_line(size_t end) const;

  std::string_view text_, row_, keyword_;
  std::string path_;
  std::stop_token stop_;
  size_t begin_ = 0, at_ = 0, taken_ = 0;  ///< of the next record; of the next word and the last in `row_`
  size_t feed_ = 0;                        ///< of line feeds, the first from the last line's beginning on
  bool is_long_ = false;                   ///< the record is of several lines
  bool has_stray_exponent_ = false;
  int line_ = 0, end_line_ = 0, looks_ = 0;
};

}  // namespace rayfarm
