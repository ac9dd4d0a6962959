#pragma once
// Skins and morph targets of a primitive of a glTF mesh.
#include "common/description/formats/gltf/accessor.h"
#include "common/description/scene_description.h"

namespace rayfarm {

/// What changes the shape of a mesh where a node uses it.
struct GltfDeformer {
  uint32_t skeleton = kNone;
  std::vector<DeformationDescription::Joint> joints;  ///< none: it has no skin
  std::vector<Curve> weights;                         ///< of morph targets
  /// Of a mesh that another node has, too: what it is made of is counted already (GltfFile::take_elements).
  bool is_copy = false;
};

/// Vertices of a primitive that its triangles use, if those are few.
struct GltfUsedVertices {
  std::vector<uint32_t> vertices;            ///< in rising order; empty: all
  size_t count = 0;                          ///< of them
  uint32_t place_of(uint32_t vertex) const;  ///< kNone: it is not used
};

/// What is said once of all deformations of a file.
struct GltfDeformationNotes {
  size_t bad_weights = 0, without_joints = 0, other_targets = 0;
  void add_to(Notes& notes, const SourcePlace& place) const;
};

/// Of a primitive with `count` vertices; null if it has neither joints nor targets. Throws InputError.
std::shared_ptr<const DeformationDescription> read_deformation(const GltfFile& file,
                                                               const GltfValue& primitive, size_t count,
                                                               const GltfUsedVertices& used,
                                                               const GltfDeformer& deformer, bool has_normals,
                                                               GltfDeformationNotes& notes);

}  // namespace rayfarm
