// Wavefront OBJ. The text is cut into pieces at lines' ends, which all cores read; the mesh is the same
// however it is cut.
#include <algorithm>

#include "common/description/formats/mesh_faces.h"
#include "common/description/formats/mesh_loaders.h"
#include "common/description/formats/mesh_normals.h"
#include "common/description/formats/obj_mesh.h"
#include "common/description/formats/obj_records.h"
#include "common/description/formats/text_pieces.h"
#include "common/image/pixel_format.h"
#include "common/parallel/parallel_for.h"

namespace rayfarm {
namespace {

/// How often long loops ask whether to stop.
constexpr size_t kFacesPerLook = 1 << 12;

/// Colours of vertices are written as they are shown, in sRGB (Blender, MeshLab): from 0 to 1, or to 255.
VertexColor decoded_color(const glm::vec3& c, double white) {
  if (c == ObjPiece::kNoColor) return kWhiteVertex;
  const Vec3 shown = glm::clamp(Vec3(c) / white, 0.0, 1.0);
  return make_vertex_color({decode_srgb(shown.x), decode_srgb(shown.y), decode_srgb(shown.z)});
}

/// Joins the pieces of one file to a mesh.
class MeshJoiner {
 public:
  MeshJoiner(std::span<const std::string_view> texts, const std::string& path, const std::stop_token& stop,
             bool is_smoothing_asked_for, FileText* file, MeshShape& mesh)
      : texts_(texts),
        path_(path),
        stop_(stop),
        is_smoothing_asked_for_(is_smoothing_asked_for),
        file_(file),
        mesh_(mesh),
        beginnings_(texts.size() + 1) {}

  void read(ReadProgress* progress) {
    pieces_ = read_pieces<ObjPiece>(texts_, progress, [&](std::string_view text, ObjPiece& piece) {
      read_obj_piece(text, path_, 0, stop_, piece);
      if (file_) file_->give_back(text);
    });
  }

  /// Reads materials, and throws for the first record that is wrong.
  void add_to(ObjRecords& records) {
    for (size_t i = 0; i < pieces_.size(); ++i) {
      beginnings_[i].line = records.lines();
      records.add(pieces_[i]);
      if (!pieces_[i].is_broken) continue;
      ObjPiece again;
      if (file_) file_->read_again(texts_[i]);
      read_obj_piece(texts_[i], path_, beginnings_[i].line, stop_, again);  // throws, knowing its line
      throw InputError({path_}, "the file changed while it was read");
    }
    records.add_notes();
  }

  /// Beside the mesh: the smoothing groups of its faces, if it is smooth and has no normals.
  SmoothingGroups join(const ObjRecords& records) {
    for (size_t i = 0; i < pieces_.size(); ++i) {
      const ObjPiece& piece = pieces_[i];
      if (piece.first_bad_position != SIZE_MAX)
        throw InputError({path_}, fmt::format("vertex {} is not finite or beyond {:g}",
                                              beginnings_[i].position + piece.first_bad_position + 1,
                                              limits::kCoordinate));
      const int line = beginnings_[i + 1].line;
      Beginning& next = beginnings_[i + 1] = beginnings_[i];
      next.line = line;
      next.position += piece.positions.size();
      next.normal += piece.normals.size();
      next.uv += piece.uvs.size();
      next.face += piece.sides.size();
      for (const uint32_t n : piece.sides) {
        next.faces.triangle += n == 3;
        next.faces.polygon += n > 3;
        next.faces.polygon_corner += n > 3 ? n : 0;
      }
    }
    const Beginning& all = beginnings_.back();
    if (!is_smoothing_asked_for_)
      mesh_.smoothing = all.normal > 0 || records.is_smooth() ? Smoothing::phong : Smoothing::flat;
    const bool has_groups = mesh_.smoothing != Smoothing::flat && all.normal == 0 && records.has_smoothing();
    mesh_.positions.resize(all.position);
    mesh_.normals.resize(all.normal);
    float largest_color = 0;
    for (const ObjPiece& piece : pieces_) {
      largest_color = std::max(largest_color, piece.largest_color);
      if (!piece.colors.empty()) mesh_.colors.resize(all.position, kWhiteVertex);
    }
    const double white = largest_color > 2 ? 255 : 1;
    mesh_.uvs.resize(all.uv + (all.uv > 0), glm::vec2(0));  // the last: of corners that have none
    resize_faces(mesh_, all.faces);
    mesh_.materials.resize(all.faces.triangle);
    mesh_.polygons.materials.resize(all.faces.polygon);
    SmoothingGroups groups;
    if (has_groups) {
      groups.triangles.resize(all.faces.triangle);
      groups.polygons.resize(all.faces.polygon);
    }
    parallel_for(pieces_.size(), [&](size_t i) {
      ObjPiece& piece = pieces_[i];
      const Beginning& at = beginnings_[i];
      std::copy(piece.positions.begin(), piece.positions.end(),
                mesh_.positions.begin() + offset(at.position));
      std::copy(piece.normals.begin(), piece.normals.end(), mesh_.normals.begin() + offset(at.normal));
      std::copy(piece.uvs.begin(), piece.uvs.end(), mesh_.uvs.begin() + offset(at.uv));
      if (!piece.colors.empty())
        std::transform(piece.colors.begin(), piece.colors.end(), mesh_.colors.begin() + offset(at.position),
                       [white](const glm::vec3& c) { return decoded_color(c, white); });
      join_faces(i, records, groups);
      piece = {};
    });
    return groups;
  }

 private:
  /// Where a piece's first elements stand among all.
  struct Beginning {
    int line = 0;
    size_t position = 0, normal = 0, uv = 0, face = 0;
    FacePlace faces;
  };
  static ptrdiff_t offset(size_t n) { return static_cast<ptrdiff_t>(n); }

  /// Indices that count from the piece's beginning count from the file's.
  static void make_absolute(ObjPiece& piece, ObjPiece::Part part, size_t before) {
    for (const uint32_t corner : piece.relative[part]) {
      int& index = piece.corners[part][corner];
      const int64_t absolute = index + static_cast<int64_t>(before);
      index = absolute < 0 ? ObjPiece::kBeforeFirst : static_cast<int>(absolute);
    }
  }

  /// The value of each face, for faces in rising order.
  class RunsFrom {
   public:
    RunsFrom(std::span<const ObjRecords::Run> runs, size_t face)
        : run_(std::upper_bound(runs.begin(), runs.end(), face,
                                [](size_t f, const ObjRecords::Run& r) { return f < r.first_face; }) -
               1),
          end_(runs.end()) {}
    uint32_t at(size_t face) {
      while (run_ + 1 != end_ && (run_ + 1)->first_face <= face) ++run_;
      return run_->value;
    }

   private:
    std::span<const ObjRecords::Run>::iterator run_, end_;
  };

  void join_faces(size_t i, const ObjRecords& records, SmoothingGroups& groups) {
    ObjPiece& piece = pieces_[i];
    const Beginning &at = beginnings_[i], &all = beginnings_.back();
    make_absolute(piece, ObjPiece::position, at.position);
    make_absolute(piece, ObjPiece::normal, at.normal);
    make_absolute(piece, ObjPiece::uv, at.uv);
    const auto index = [&piece](ObjPiece::Part part, size_t corner) {
      const LargeVector<int>& indices = piece.corners[part];
      return indices.empty() ? ObjPiece::kNothing : indices[corner];
    };
    const auto exists = [](int n, size_t count) { return n >= 0 && static_cast<size_t>(n) < count; };
    RunsFrom materials(records.materials(), at.face), smoothing(records.smoothing(), at.face);
    FacePlace place = at.faces;
    std::vector<FaceCorner> corners;
    size_t first = 0;  // corner of the face
    for (size_t face = 0; face < piece.sides.size(); first += piece.sides[face++]) {
      if (face % kFacesPerLook == 0) throw_if_stopped(stop_);
      const size_t sides = piece.sides[face];
      const auto fail = [&](const std::string& problem) {
        if (file_) file_->read_again(texts_[i]);
        throw InputError({path_, line_of_obj_face(texts_[i], face, at.line)}, problem);
      };
      if (sides > limits::kPolygonPoints)
        fail(fmt::format("a face has at most {} corners", limits::kPolygonPoints));
      corners.clear();
      for (size_t corner = first; corner < first + sides; ++corner) {
        const int v = index(ObjPiece::position, corner), n = index(ObjPiece::normal, corner),
                  uv = index(ObjPiece::uv, corner);
        if (v < 0 || n == ObjPiece::kBeforeFirst || uv == ObjPiece::kBeforeFirst)
          fail("the face counts back beyond the file's first vertex, texture coordinate or normal");
        if (!exists(v, all.position) || (n >= 0 && !exists(n, all.normal)))
          fail(fmt::format(
              "the face names vertex {} and normal {}, but the file has {} vertices and {} normals", v + 1,
              n + 1, all.position, all.normal));
        corners.push_back({static_cast<uint32_t>(v), n >= 0 ? static_cast<uint32_t>(n) : ~0u,
                           static_cast<uint32_t>(exists(uv, all.uv) ? static_cast<size_t>(uv) : all.uv)});
      }
      if (sides < 3) continue;
      (sides == 3 ? mesh_.materials[place.triangle] : mesh_.polygons.materials[place.polygon]) =
          materials.at(at.face + face);
      if (LargeVector<uint32_t>& group = sides == 3 ? groups.triangles : groups.polygons; !group.empty())
        group[sides == 3 ? place.triangle : place.polygon] = smoothing.at(at.face + face);
      set_face(mesh_, place, corners);
    }
  }

  std::span<const std::string_view> texts_;
  const std::string& path_;
  const std::stop_token& stop_;
  bool is_smoothing_asked_for_;
  FileText* file_;
  MeshShape& mesh_;
  std::vector<ObjPiece> pieces_;
  std::vector<Beginning> beginnings_;  ///< of each piece, and of the end
};

}  // namespace

MeshShape read_obj_mesh(SceneDescription& scene, std::string_view text, const MeshRequest& request,
                        std::span<const size_t> borders, const LoadOptions& options, FileText* file) {
  const std::vector<std::string_view> pieces = cut_text(text, borders, may_begin_record);
  MeshShape mesh;
  mesh.smoothing = request.smoothing;
  MeshJoiner joiner(pieces, request.path, options.stop, request.is_smoothing_asked_for, file, mesh);
  joiner.read(options.progress);
  ObjRecords records(scene, request.path, request.material, options.stop);
  joiner.add_to(records);
  const SmoothingGroups groups = joiner.join(records);
  mesh.names = records.names();
  check_faces(mesh, request.path);
  if (mesh.normals.empty() && !records.has_smoothing()) {
    add_asked_normals(mesh, request, options.stop);
    return mesh;
  }
  if (mesh.smoothing == Smoothing::flat || !mesh.normals.empty()) return mesh;
  if (!records.is_smooth())
    scene.notes.add({request.path}, "`smooth` is not used: the file says `s off`, its faces are flat");
  smooth_normals(mesh, groups, options.stop);
  return mesh;
}

void load_obj_mesh(SceneDescription& scene, uint32_t object, const MeshRequest& request,
                   const LoadOptions& options) {
  FileText file = read_large_text_file(request.path, limits::kFileBytes, options.stop);
  scene.files.push_back(request.path);
  MeshShape mesh =
      read_obj_mesh(scene, file.text(), request, borders_of_pieces(file.text().size()), options, &file);
  scene.objects[object].primitives.push_back({std::move(mesh), request.material, request.place});
}

}  // namespace rayfarm
