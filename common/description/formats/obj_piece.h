#pragma once
// A piece of an OBJ file, from one line's beginning to another's, read without the pieces before it: every
// number and corner is looked at, and what depends on the whole file is left for later.
#include <array>
#include <string_view>
#include <vector>

#include "common/description/formats/records.h"
#include "common/description/scene_description.h"

namespace rayfarm {

struct ObjPiece {
  /// What corners name.
  enum Part { position, uv, normal };
  static constexpr int kNothing = -1;
  static constexpr int kBeforeFirst = -2;  ///< counted back beyond the file's beginning

  LargeVector<glm::vec3> positions, normals;
  /// Of positions up to the last that has one, as they are written; empty if none has.
  LargeVector<glm::vec3> colors;
  static constexpr glm::vec3 kNoColor{-1};
  float largest_color = 0;  ///< of all their numbers
  LargeVector<glm::vec2> uvs;
  LargeVector<uint32_t> sides;  ///< of each face, those of fewer than three among them; none has 0
  /// By part, one a corner, counted from 0; empty if no corner of the piece names any.
  std::array<LargeVector<int>, 3> corners;
  /// By part: which of `corners` are counted from the beginning of the piece instead. May be below 0.
  std::array<LargeVector<uint32_t>, 3> relative;
  size_t first_bad_position = SIZE_MAX;  ///< infinite, or beyond limits::kCoordinate

  /// What holds for all that follows.
  struct Setting {
    enum Kind { material, library, name, smoothing };
    Kind kind = material;
    size_t faces_before = 0;  ///< in the piece
    std::string text;
    int line = 0, column = 0;  ///< from the beginning of the piece
  };
  std::vector<Setting> settings;
  /// Records of a kind that is not used, by the first of them.
  struct Unused {
    std::string what;
    int line = 0;
    size_t count = 0;
  };
  std::vector<Unused> unused;
  int lines = 0;  ///< in the piece
  /// It ends where a record is wrong: reading it again with `lines_before` right says which.
  bool is_broken = false;
};

/// Reads `text`, the lines of the file `path` behind `lines_before` others. Throws Stopped, and InputError
/// for the first record that is wrong.
void read_obj_piece(std::string_view text, const std::string& path, int lines_before,
                    const std::stop_token& stop, ObjPiece& piece);

/// The line of a piece's face, for an error's place; `lines_before` it stand in the file.
int line_of_obj_face(std::string_view text, size_t face, int lines_before);

}  // namespace rayfarm
