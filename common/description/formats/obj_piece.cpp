#include "common/description/formats/obj_piece.h"

#include <charconv>
#include <cmath>
#include <unordered_map>

namespace rayfarm {
namespace {

/// In a file of rubbish every line is of another kind.
constexpr size_t kMostKinds = 4096;

class PieceReader {
 public:
  PieceReader(std::string_view text, const std::string& path, int lines_before, const std::stop_token& stop,
              ObjPiece& piece)
      : records_(text, path, stop, lines_before), lines_before_(lines_before), piece_(piece) {}

  void read() {
    while (records_.next()) read_record();
    piece_.lines = records_.line() - lines_before_;
  }

 private:
  void read_record() {
    const std::string_view key = records_.keyword();
    std::array<float, 3> v{};
    if (key == "v") {
      if (read_numbers(3, v) >= 6) count_unused("a vertex's colour");
      const Vec3 p(v[0], v[1], v[2]);
      if (!(max_magnitude(p) <= limits::kCoordinate) && piece_.first_bad_position == SIZE_MAX)
        piece_.first_bad_position = piece_.positions.size();
      piece_.positions.emplace_back(v[0], v[1], v[2]);
    } else if (key == "f") {
      read_face();
    } else if (key == "vn") {
      read_numbers(3, v);
      piece_.normals.emplace_back(v[0], v[1], v[2]);
    } else if (key == "vt") {
      read_numbers(1, v);
      piece_.uvs.emplace_back(v[0], v[1]);
    } else if (key == "usemtl" || key == "mtllib") {
      const std::string_view text = records_.rest();
      const SourcePlace place = records_.place();
      piece_.settings.push_back(
          {key == "mtllib", piece_.sides.size(), text, place.line - lines_before_, place.column});
    } else if (key == "s") {
      piece_.smoothing_groups.insert(records_.word());
    } else if (key != "g" && key != "o") {
      count_unused(fmt::format("`{}`", key.substr(0, 40)));
    }
  }

  /// At least `least` numbers, of which the first three are kept. Returns how many there are.
  size_t read_numbers(size_t least, std::array<float, 3>& kept) {
    size_t count = 0;
    for (; count < least || records_.has_number(); ++count) {
      const float number = records_.float_number();
      if (!std::isfinite(number)) records_.fail("the number is beyond what a mesh holds (3.4e38)");
      if (count < 3) kept[count] = number;
    }
    return count;
  }

  void read_face() {
    uint32_t count = 0;
    for (std::string_view word; !(word = records_.word()).empty(); ++count)
      if (!read_corner(word))
        records_.fail(fmt::format("expected a corner like 1, 1/2, 1//3 or 1/2/3, counted from 1, found '{}'",
                                  word.substr(0, 40)));
    if (count > 0) piece_.sides.push_back(count);
    if (count < 3) count_unused("a face of fewer than three corners");
  }

  /// Corners are `v`, `v/vt`, `v//vn` or `v/vt/vn`, whole numbers other than 0.
  bool read_corner(std::string_view word) {
    const char* at = word.data();
    const char* const end = at + word.size();
    const size_t corner = piece_.corners[ObjPiece::position].size();
    for (const ObjPiece::Part part : {ObjPiece::position, ObjPiece::uv, ObjPiece::normal}) {
      const bool is_left_out = part == ObjPiece::uv && at != end && *at == '/';
      if (!is_left_out) {
        int index = 0;
        const auto [stop, error] = std::from_chars(at, end, index);
        if (error != std::errc{} || index == 0) return false;
        at = stop;
        add_index(part, corner, index);
      }
      if (at == end) {
        // Where some corners name what this one does not.
        for (const ObjPiece::Part other : {ObjPiece::uv, ObjPiece::normal})
          if (auto& indices = piece_.corners[other]; !indices.empty())
            indices.resize(corner + 1, ObjPiece::kNothing);
        return true;
      }
      if (*at++ != '/') return false;
    }
    return false;
  }

  void add_index(ObjPiece::Part part, size_t corner, int index) {
    LargeVector<int>& indices = piece_.corners[part];
    indices.resize(corner, ObjPiece::kNothing);
    if (index > 0) {
      indices.push_back(index - 1);
      return;
    }
    const size_t so_far = part == ObjPiece::position ? piece_.positions.size()
                          : part == ObjPiece::uv     ? piece_.uvs.size()
                                                     : piece_.normals.size();
    piece_.relative[part].push_back(static_cast<uint32_t>(corner));
    indices.push_back(static_cast<int>(static_cast<int64_t>(so_far) + index));
  }

  void count_unused(const std::string& what) {
    const auto [found, is_new] = kinds_.try_emplace(what, piece_.unused.size());
    if (!is_new)
      ++piece_.unused[found->second].count;
    else if (kinds_.size() <= kMostKinds)
      piece_.unused.push_back({what, records_.line() - lines_before_, 1});
    else
      kinds_.erase(found);
  }

  Records records_;
  int lines_before_;
  ObjPiece& piece_;
  std::unordered_map<std::string, size_t> kinds_;  ///< which of piece_.unused each is
};

}  // namespace

void read_obj_piece(std::string_view text, const std::string& path, int lines_before,
                    const std::stop_token& stop, ObjPiece& piece) {
  PieceReader(text, path, lines_before, stop, piece).read();
}

int line_of_obj_face(std::string_view text, size_t face, int lines_before) {
  Records records(text, "", {}, lines_before);
  size_t seen = 0;
  while (records.next())
    if (records.keyword() == "f" && records.has_more() && seen++ == face) return records.line();
  return 0;
}

}  // namespace rayfarm
