#pragma once
// A piece of an STL file's text, read without the pieces before it.
#include <string>
#include <string_view>

#include "common/description/scene_description.h"

namespace rayfarm {

struct StlPiece {
  LargeVector<glm::vec3> points;   ///< of all facets
  LargeVector<uint32_t> sides;     ///< of each facet
  LargeVector<glm::vec3> normals;  ///< of each facet, as the file has it
  bool is_closed = false;          ///< there is an `endsolid`
  bool is_open = false;            ///< there is a facet that none follows
  /// It ends where a line is wrong: reading the whole file says which.
  bool is_broken = false;
};

/// True if a facet may begin at a place of a text.
bool may_begin_facet(std::string_view text, size_t at);

/// Reads `text`, of the file `path`; it begins with a facet unless it is the file's first piece. Throws
/// Stopped, and InputError for the first line that is wrong, counted from the piece's beginning.
void read_stl_piece(std::string_view text, const std::string& path, const std::stop_token& stop,
                    StlPiece& piece);

}  // namespace rayfarm
