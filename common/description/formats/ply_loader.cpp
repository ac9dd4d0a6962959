// PLY, in text and in bytes.
#include "common/description/formats/mesh_loaders.h"
#include "common/description/formats/ply_header.h"
#include "common/description/formats/text_pieces.h"
#include "common/files/read_file.h"

namespace rayfarm {

void load_ply_mesh(SceneDescription& scene, uint32_t object, const MeshRequest& request,
                   const LoadOptions& options) {
  const FileText file = read_large_file(request.path, limits::kFileBytes, options.stop);
  scene.files.push_back(request.path);
  if (!file.text().starts_with("ply")) refuse_wide_text(request.path, file.text());
  const MeshTables tables = read_ply_header(scene, file.text(), request.path);
  scene.objects[object].primitives.push_back(
      {read_mesh_tables(scene, tables, request, borders_of_pieces(tables.body.size()), options),
       request.material, request.place});
}

}  // namespace rayfarm
