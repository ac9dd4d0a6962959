#pragma once
// A piece of an NFF file, from one record's beginning to another's, read without the pieces before it.
#include <optional>
#include <string_view>
#include <vector>

#include "common/description/scene_description.h"

namespace rayfarm {

struct NffPiece {
  /// Of their materials as many `f` records stand before them in the piece: with none it is the last of the
  /// pieces before. Their lines are counted from the piece's first. Triangles in a row are one mesh.
  std::vector<PrimitiveDescription> primitives;
  std::vector<MaterialDescription> materials;  ///< without names
  std::vector<Light> lights;
  std::vector<bool> light_has_color;
  std::optional<ViewDescription> view;
  std::optional<Color> background;

  /// A record of which something may have to be told, which depends on those before it.
  enum class Kind { view, background, negative_radius };
  struct Mark {
    Kind kind = Kind::view;
    Place place;
  };
  std::vector<Mark> marks;  ///< of negative radii the first alone

  int lines = 0;
  /// It ends where a record is wrong: reading it again with what stands before it says which.
  bool is_broken = false;
};

/// What an error depends on beside the text.
struct NffBefore {
  int lines = 0;
  size_t lights = 0;
};

/// Reads `text`, which stands behind `before` in the file `path`. Throws Stopped, and InputError for the
/// first record that is wrong.
void read_nff_piece(std::string_view text, const std::string& path, const NffBefore& before,
                    const std::stop_token& stop, NffPiece& piece);

/// True if a line begins at text[at] whose first word begins a record: no record that is right has such a
/// word in it.
bool begins_nff_record(std::string_view text, size_t at);

}  // namespace rayfarm
