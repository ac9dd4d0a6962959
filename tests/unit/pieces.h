#pragma once
// For tests of files that are read in pieces.
#include <gtest/gtest.h>

#include <numeric>

#include "tests/read_in_pieces.h"

namespace rayfarm::test {

/// Every byte as a border, and all of them at once: a piece a line or a record. read(text, borders) gives
/// what expect_same compares.
template <typename Read, typename ExpectSame>
void expect_same_however_cut(const std::string& text, Read read, ExpectSame expect_same) {
  const auto whole = read(text, {});
  std::vector<size_t> all(text.size());
  std::iota(all.begin(), all.end(), 0u);
  expect_same(whole, read(text, all));
  for (const size_t border : all) {
    SCOPED_TRACE(border);
    expect_same(whole, read(text, {border}));
    if (testing::Test::HasFailure()) return;
  }
}

}  // namespace rayfarm::test
