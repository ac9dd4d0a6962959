#pragma once
// Text that all cores read, cut into pieces where something in it begins. What is read is the same however
// the text is cut; a piece with an error is read again by whoever knows what stands before it.
#include <span>
#include <string_view>
#include <vector>

#include "common/description/read_progress.h"
#include "common/errors/input_error.h"
#include "common/parallel/parallel_for.h"

namespace rayfarm {

/// Where pieces of a text of this size may end: enough text for each that a thread's start does not count,
/// few enough that all cores end together.
inline std::vector<size_t> borders_of_pieces(size_t bytes) {
  constexpr size_t kPieceBytes = 1 << 20;
  std::vector<size_t> borders;
  for (size_t at = kPieceBytes; at < bytes; at += kPieceBytes) borders.push_back(at);
  return borders;
}

/// Cuts a text at the first place from each border on, of borders in rising order, where
/// may_begin(text, place).
template <typename MayBegin>
std::vector<std::string_view> cut_text(std::string_view text, std::span<const size_t> borders,
                                       MayBegin may_begin) {
  std::vector<std::string_view> pieces;
  size_t begin = 0;
  for (size_t border : borders) {
    if (border <= begin) continue;
    while (border < text.size() && !may_begin(text, border)) ++border;
    if (border >= text.size()) break;
    pieces.push_back(text.substr(begin, border - begin));
    begin = border;
  }
  pieces.push_back(text.substr(begin));
  return pieces;
}

/// Calls read(text, piece) for each text, and counts its bytes; where that throws an InputError,
/// piece.is_broken.
template <typename Piece, typename Read>
std::vector<Piece> read_pieces(std::span<const std::string_view> texts, ReadProgress* progress, Read read) {
  for (const std::string_view text : texts) count_opened(progress, text.size());
  std::vector<Piece> pieces(texts.size());
  parallel_for(pieces.size(), [&](size_t i) {
    try {
      read(texts[i], pieces[i]);
    } catch (const InputError&) {
      pieces[i].is_broken = true;
    }
    count_read(progress, texts[i].size());
  });
  return pieces;
}

}  // namespace rayfarm
