#include "common/description/formats/obj_piece.h"

#include <charconv>
#include <cmath>
#include <unordered_map>

namespace rayfarm {
namespace {

/// `fo` is what faces were in early versions.
bool is_face(std::string_view key) {
  return key == "f" || key == "fo";
}

/// In a file of rubbish every line is of another kind.
constexpr size_t kMostKinds = 4096;

class PieceReader {
 public:
  PieceReader(std::string_view text, const std::string& path, int lines_before, const std::stop_token& stop,
              ObjPiece& piece)
      : records_(text, path, stop, lines_before), lines_before_(lines_before), piece_(piece) {}

  void read() {
    while (records_.next()) {
      read_record();
      if (records_.take_stray_exponent()) count_unused("an exponent whose sign stands before its `e`");
    }
    piece_.lines = records_.lines() - lines_before_;
  }

 private:
  void read_record() {
    const std::string_view key = records_.keyword();
    std::array<float, 7> v{};
    if (key == "v") {
      read_vertex(read_numbers(3, v), v);
    } else if (is_face(key)) {
      read_face();
    } else if (key == "vn") {
      read_numbers(3, v);
      piece_.normals.emplace_back(v[0], v[1], v[2]);
      if (v[0] == 0 && v[1] == 0 && v[2] == 0)
        count_unused("a normal without a direction, at which faces are flat,");
    } else if (key == "vt") {
      read_numbers(1, v);
      piece_.uvs.emplace_back(v[0], v[1]);
    } else if (key == "usemtl") {
      add_setting(ObjPiece::Setting::material);
    } else if (key == "mtllib") {
      add_setting(ObjPiece::Setting::library);
    } else if (key == "s") {
      add_setting(ObjPiece::Setting::smoothing);
    } else if (key == "g" || key == "o") {
      add_setting(ObjPiece::Setting::name);
    } else {
      count_unused(fmt::format("`{}`", key.substr(0, 40)));
    }
  }

  void add_setting(ObjPiece::Setting::Kind kind) {
    ObjPiece::Setting setting{kind, piece_.sides.size(), records_.rest()};
    const SourcePlace place = records_.place();
    setting.line = place.line - lines_before_;
    setting.column = place.column;
    if (kind == ObjPiece::Setting::material || kind == ObjPiece::Setting::library) {
      piece_.settings.push_back(std::move(setting));
      return;
    }
    // Of those that no face comes between the last counts: a file may consist of nothing else.
    size_t& last = kind == ObjPiece::Setting::name ? last_name_ : last_smoothing_;
    if (last < piece_.settings.size() && piece_.settings[last].faces_before == setting.faces_before) {
      piece_.settings[last].text = std::move(setting.text);
      return;
    }
    last = piece_.settings.size();
    piece_.settings.push_back(std::move(setting));
  }

  /// Place, perhaps a weight; or place and colour, perhaps with an alpha.
  void read_vertex(size_t count, const std::array<float, 7>& v) {
    const Vec3 p(v[0], v[1], v[2]);
    if (!(max_magnitude(p) <= limits::kCoordinate) && piece_.first_bad_position == SIZE_MAX)
      piece_.first_bad_position = piece_.positions.size();
    if (count >= 6) {
      piece_.colors.resize(piece_.positions.size(), ObjPiece::kNoColor);
      piece_.colors.emplace_back(v[3], v[4], v[5]);
      piece_.largest_color = std::max({piece_.largest_color, v[3], v[4], v[5]});
    }
    if ((count == 4 && v[3] != 1) || count == 5) count_unused("what stands behind a vertex's coordinates");
    piece_.positions.emplace_back(v[0], v[1], v[2]);
  }

  /// At least `least` numbers, of which the first are kept. Returns how many there are.
  template <size_t kMost>
  size_t read_numbers(size_t least, std::array<float, kMost>& kept) {
    size_t count = 0;
    for (; count < least || records_.has_number(); ++count) {
      const float number = records_.float_number();
      if (!std::isfinite(number)) records_.fail("the number is beyond what a mesh holds (3.4e38)");
      if (count < kMost) kept[count] = number;
    }
    return count;
  }

  void read_face() {
    uint32_t count = 0;
    for (std::string_view word; !(word = records_.word()).empty() && word.front() != '#'; ++count)
      if (!read_corner(word))
        records_.fail(fmt::format("expected a corner like 1, 1/2, 1//3 or 1/2/3, counted from 1, found '{}'",
                                  word.substr(0, 40)));
    if (count > 0) piece_.sides.push_back(count);
    if (count < 3) count_unused("a face of fewer than three corners");
  }

  /// Corners are `v`, `v/vt`, `v//vn` or `v/vt/vn`, whole numbers other than 0; what is empty between slashes
  /// is not there.
  bool read_corner(std::string_view word) {
    const char* at = word.data();
    const char* const end = at + word.size();
    const size_t corner = piece_.corners[ObjPiece::position].size();
    for (const ObjPiece::Part part : {ObjPiece::position, ObjPiece::uv, ObjPiece::normal}) {
      LargeVector<int>& indices = piece_.corners[part];
      if (at == end || (*at == '/' && part != ObjPiece::position)) {
        if (!indices.empty()) indices.push_back(ObjPiece::kNothing);  // where some corners name one
      } else {
        if (*at == '+' && end - at > 1 && at[1] != '-') ++at;
        int index = 0;
        const auto [stop, error] = std::from_chars(at, end, index);
        if (error != std::errc{} || index == 0) return false;
        at = stop;
        if (indices.size() < corner) indices.resize(corner, ObjPiece::kNothing);
        if (index < 0) {
          piece_.relative[part].push_back(static_cast<uint32_t>(corner));
          index = static_cast<int>(static_cast<int64_t>(count_of(part)) + index) + 1;
        }
        indices.push_back(index - 1);
      }
      if (at != end && (*at++ != '/' || part == ObjPiece::normal)) return false;
    }
    return true;
  }

  size_t count_of(ObjPiece::Part part) const {
    return part == ObjPiece::position ? piece_.positions.size()
           : part == ObjPiece::uv     ? piece_.uvs.size()
                                      : piece_.normals.size();
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
  size_t last_name_ = SIZE_MAX, last_smoothing_ = SIZE_MAX;  ///< of piece_.settings
  std::unordered_map<std::string, size_t> kinds_;            ///< which of piece_.unused each is
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
    if (is_face(records.keyword()) && records.has_more() && !records.peek().starts_with('#') &&
        seen++ == face)
      return records.line();
  return 0;
}

}  // namespace rayfarm
