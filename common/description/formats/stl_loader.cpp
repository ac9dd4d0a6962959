// STL, in text and in bytes. Its facets share no vertices: equal points become one.
#include <bit>
#include <cstring>

#include "common/description/formats/mesh_faces.h"
#include "common/description/formats/mesh_normals.h"
#include "common/description/formats/point_merger.h"
#include "common/description/formats/stl_mesh.h"
#include "common/description/formats/stl_piece.h"
#include "common/description/formats/text_pieces.h"
#include "common/files/read_file.h"

namespace rayfarm {
namespace {

constexpr size_t kHeadBytes = 84, kFacetBytes = 50;
constexpr size_t kFacetsPerLook = 1 << 12;

/// What a file holds that is not used.
struct StlCounts {
  uint64_t too_small = 0;  ///< facets of fewer than three corners
  uint64_t turned = 0;     ///< facets whose normal says that they are seen from behind
  uint64_t attributes = 0;
};

uint32_t little_endian(const char* bytes, size_t count) {
  uint32_t value = 0;
  for (size_t i = count; i-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[i]);
  return value;
}
glm::vec3 vector_at(const char* bytes) {
  return {std::bit_cast<float>(little_endian(bytes, 4)), std::bit_cast<float>(little_endian(bytes + 4, 4)),
          std::bit_cast<float>(little_endian(bytes + 8, 4))};
}

/// Facets that the file's head tells of.
uint32_t facets_told(std::string_view bytes) {
  return bytes.size() < kHeadBytes ? 0 : little_endian(bytes.data() + kHeadBytes - 4, 4);
}

std::string_view without_mark(std::string_view text) {
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  return text;
}

/// Text begins with `solid`; so do some files of bytes, whose size or contents tell them apart.
bool is_text(std::string_view bytes) {
  const uint64_t told_bytes = kHeadBytes + uint64_t{kFacetBytes} * facets_told(bytes);
  if (bytes.size() >= kHeadBytes && told_bytes == bytes.size()) return false;
  std::string_view begin = without_mark(bytes).substr(0, 1024);
  begin.remove_prefix(std::min(begin.find_first_not_of(" \t\r\n"), begin.size()));
  std::string word(begin.substr(0, 5));
  for (char& c : word) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return (word == "solid" || word == "facet") && begin.find('\0') == std::string_view::npos;
}

class StlMesh {
 public:
  StlMesh(MeshShape& mesh, const std::stop_token& stop) : mesh_(mesh), stop_(stop), points_(mesh.positions) {}

  void add(std::span<const glm::vec3> points, const glm::vec3& normal) {
    if (facets_++ % kFacetsPerLook == 0) throw_if_stopped(stop_);
    if (points.size() < 3) {
      ++counts.too_small;
      return;
    }
    const Vec3 a(points[0]), b(points[1]), c(points[2]);
    counts.turned += points.size() == 3 && glm::dot(glm::cross(b - a, c - a), Vec3(normal)) < 0;
    corners_.clear();
    for (const glm::vec3& p : points) corners_.push_back({points_.add(p)});
    add_face(mesh_, corners_);
  }

  StlCounts counts;

 private:
  MeshShape& mesh_;
  const std::stop_token& stop_;
  PointMerger points_;
  std::vector<FaceCorner> corners_;
  size_t facets_ = 0;
};

void read_bytes(SceneDescription& scene, std::string_view bytes, const MeshRequest& request, StlMesh& mesh) {
  const SourcePlace place{request.path};
  if (bytes.size() < kHeadBytes)
    throw InputError(
        place, fmt::format("an STL file begins with `solid`, or with {} bytes that tell how many facets "
                           "follow; this one has {}",
                           kHeadBytes, bytes.size()));
  const uint64_t told = facets_told(bytes), room = (bytes.size() - kHeadBytes) / kFacetBytes;
  if (told > room) refuse_wide_text(request.path, bytes);
  if (told > room)
    throw InputError(place,
                     fmt::format("the file tells of {} facets, but ends after {}; it was cut off, or is none "
                                 "of STL",
                                 told, room));
  const size_t end = kHeadBytes + told * kFacetBytes;
  for (size_t i = 0, at = kHeadBytes; at < end; ++i, at += kFacetBytes) {
    const char* const facet = bytes.data() + at;
    const std::array<glm::vec3, 3> points{vector_at(facet + 12), vector_at(facet + 24),
                                          vector_at(facet + 36)};
    for (const glm::vec3& p : points)
      if (!is_position(p))
        throw InputError(
            place, fmt::format("facet {} of {}, at byte {}: a vertex is not finite or beyond {:g}", i + 1,
                               told, at, limits::kCoordinate));
    mesh.counts.attributes += little_endian(facet + 48, 2) != 0;
    mesh.add(points, vector_at(facet));
  }
  if (end < bytes.size())
    scene.notes.add(place, fmt::format("{} bytes behind the last facet are not used", bytes.size() - end));
  if (bytes.substr(0, 80).find("COLOR=") != std::string_view::npos)
    scene.notes.add(place, "the colour in the head (`COLOR=`) is not used");
}

void read_text(SceneDescription& scene, std::string_view text, const MeshRequest& request,
               std::span<const size_t> borders, const LoadOptions& options, StlMesh& mesh) {
  const std::vector<std::string_view> texts = cut_text(text, borders, may_begin_facet);
  std::vector<StlPiece> pieces =
      read_pieces<StlPiece>(texts, options.progress, [&](std::string_view piece_text, StlPiece& piece) {
        read_stl_piece(piece_text, request.path, options.stop, piece);
      });
  bool is_open = false;
  for (StlPiece& piece : pieces) {
    if (piece.is_broken) {
      StlPiece whole;
      read_stl_piece(text, request.path, options.stop, whole);  // throws, knowing what stands before
      throw std::logic_error("a broken part of an STL file is none in the whole");
    }
    if (piece.is_closed || piece.is_open) is_open = piece.is_open;
    size_t begin = 0;
    for (size_t f = 0; f < piece.sides.size(); begin += piece.sides[f++])
      mesh.add(std::span(piece.points).subspan(begin, piece.sides[f]), piece.normals[f]);
    piece = {};
  }
  if (is_open)
    scene.notes.add({request.path}, "no `endsolid` stands behind the last facet; the file may be cut off");
}

}  // namespace

MeshShape read_stl_mesh(SceneDescription& scene, std::string_view bytes, const MeshRequest& request,
                        std::span<const size_t> borders, const LoadOptions& options) {
  MeshShape mesh;
  mesh.smoothing = request.smoothing;
  StlMesh reader(mesh, options.stop);
  if (is_text(bytes)) {
    read_text(scene, without_mark(bytes), request, borders, options, reader);
  } else {
    count_opened(options.progress, bytes.size());
    read_bytes(scene, bytes, request, reader);
    count_read(options.progress, bytes.size());
  }
  const auto note = [&](uint64_t count, const char* what) {
    if (count > 0) scene.notes.add({request.path}, fmt::format("{}, {} times", what, count));
  };
  note(reader.counts.too_small, "a facet of fewer than three corners is not used");
  note(reader.counts.turned,
       "a facet's normal points the other way than the order of its corners, which counts");
  note(reader.counts.attributes, "a facet's attribute, which some programs take for a colour, is not used");
  check_faces(mesh, request.path);
  add_asked_normals(mesh, request, options.stop);
  return mesh;
}

void load_stl_mesh(SceneDescription& scene, uint32_t object, const MeshRequest& request,
                   const LoadOptions& options) {
  const FileText file = read_large_file(request.path, limits::kFileBytes, options.stop);
  scene.files.push_back(request.path);
  scene.objects[object].primitives.push_back(
      {read_stl_mesh(scene, file.text(), request, borders_of_pieces(file.text().size()), options),
       request.material, request.place});
}

}  // namespace rayfarm
