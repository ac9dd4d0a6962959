#pragma once
// Long lists of numbers, read from their text by all cores.
#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include "common/description/read_progress.h"
#include "common/errors/stop.h"

namespace rayfarm {

/// What stands between the brackets of a YAML flow sequence of numbers, `1, 2.5`, or of sequences of them,
/// `[1, 2], [3, 4]`: the items.
class NumberList {
 public:
  /// `inside` must outlive it.
  NumberList(std::string_view inside, std::stop_token stop, ReadProgress* progress = nullptr);

  size_t size() const { return size_; }          ///< items
  bool is_nested() const { return is_nested_; }  ///< they are sequences
  size_t piece_count() const { return pieces_.size(); }

  /// What is done with the numbers of item `i`, one if the list is not nested.
  using Take = std::function<void(size_t piece, size_t i, std::span<const double> numbers)>;
  /// Calls `take` for all items: for those of a piece in their order, for pieces at once. Throws InputError
  /// if something else than a finite number of a sane size stands there, or in another way than this. Returns
  /// how many values there are, numbers and sequences.
  size_t for_each(const Take& take) const;

 private:
  struct Piece {
    std::string_view text;
    size_t first_item = 0;
  };
  std::vector<Piece> pieces_;
  std::stop_token stop_;
  ReadProgress* progress_;
  size_t size_ = 0;
  bool is_nested_ = false;
};

}  // namespace rayfarm
