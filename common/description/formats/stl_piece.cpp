#include "common/description/formats/stl_piece.h"

#include <cctype>
#include <cmath>

#include "common/description/formats/mesh_faces.h"
#include "common/description/formats/row_words.h"

namespace rayfarm {
namespace {

constexpr uint64_t kRowsPerLook = 1 << 12;

bool is_word(std::string_view word, std::string_view lower) {
  return word.size() == lower.size() &&
         std::equal(word.begin(), word.end(), lower.begin(),
                    [](char a, char b) { return std::tolower(static_cast<unsigned char>(a)) == b; });
}

class StlPieceReader {
 public:
  StlPieceReader(std::string_view text, const std::string& path, const std::stop_token& stop, StlPiece& piece)
      : words_(text, path, 0), stop_(stop), piece_(piece) {}

  void read() {
    for (uint64_t row = 0; words_.next_row(); ++row) {
      if (row % kRowsPerLook == 0) throw_if_stopped(stop_);
      read_row();
    }
    if (state_ != State::between) words_.fail("the file ends within a facet; it was cut off");
  }

 private:
  enum class State { between, in_facet, in_loop, behind_loop };

  void read_row() {
    const std::string_view key = words_.word();
    if (is_word(key, "vertex") && state_ == State::in_loop) {
      piece_.points.push_back(read_vector());
      if (++piece_.sides.back() > limits::kPolygonPoints)
        words_.fail(fmt::format("a facet has at most {} corners", limits::kPolygonPoints));
    } else if (is_word(key, "facet") && state_ == State::between) {
      if (!is_word(words_.word(), "normal")) words_.fail("expected `facet normal x y z`");
      piece_.normals.push_back(read_normal());
      piece_.sides.push_back(0);
      piece_.is_open = true;
      state_ = State::in_facet;
    } else if (is_word(key, "outer") && state_ == State::in_facet) {
      if (!is_word(words_.word(), "loop")) words_.fail("expected `outer loop`");
      state_ = State::in_loop;
    } else if (is_word(key, "endloop") && state_ == State::in_loop) {
      state_ = State::behind_loop;
    } else if (is_word(key, "endfacet") && state_ == State::behind_loop) {
      state_ = State::between;
    } else if (is_word(key, "solid") && state_ == State::between) {
      return;  // a name follows
    } else if (is_word(key, "endsolid") && state_ == State::between) {
      piece_.is_closed = true;
      piece_.is_open = false;
      return;
    } else {
      static constexpr const char* kExpected[] = {"facet, solid or endsolid", "`outer loop`",
                                                  "vertex or endloop", "endfacet"};
      words_.fail(
          fmt::format("expected {}, found '{}'", kExpected[static_cast<size_t>(state_)], key.substr(0, 40)));
    }
    if (words_.has_more()) words_.fail(fmt::format("'{}' is too much here", words_.word().substr(0, 40)));
  }

  glm::vec3 read_vector() {
    glm::vec3 v;
    for (int k = 0; k < 3; ++k) v[k] = words_.real();
    if (!is_position(v))
      words_.fail(fmt::format("the vertex is not finite or beyond {:g}", limits::kCoordinate));
    return v;
  }
  /// Some programs write `nan` for facets without area.
  glm::vec3 read_normal() {
    glm::vec3 v(0);
    for (int k = 0; k < 3; ++k) {
      const std::string_view word = words_.peek();
      if (word.find("IND") != std::string_view::npos || word.find("NAN") != std::string_view::npos) {
        words_.word();  // Microsoft's -1.#IND
        continue;
      }
      const float number = words_.real();
      if (std::isfinite(number)) v[k] = number;
    }
    return v;
  }

  RowWords words_;
  const std::stop_token& stop_;
  StlPiece& piece_;
  State state_ = State::between;
};

}  // namespace

bool may_begin_facet(std::string_view text, size_t at) {
  if (!begins_line(text, at)) return false;
  const size_t begin = text.find_first_not_of(" \t", at);
  constexpr size_t kLetters = 5;
  return begin != std::string_view::npos && begin + kLetters < text.size() &&
         is_word(text.substr(begin, kLetters), "facet") &&
         (text[begin + kLetters] == ' ' || text[begin + kLetters] == '\t');
}

void read_stl_piece(std::string_view text, const std::string& path, const std::stop_token& stop,
                    StlPiece& piece) {
  StlPieceReader(text, path, stop, piece).read();
}

}  // namespace rayfarm
