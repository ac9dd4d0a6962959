// Meshes that stand in a file several times: those that nodes have of their own, as they bend them, and
// copies that a node lists.
#include <fmt/core.h>

#include "common/description/formats/gltf/nodes.h"

namespace rayfarm {
namespace {

double bytes_of(const Curve& curve) {
  return static_cast<double>(sizeof(Curve) + curve.frames.size() * sizeof(double) +
                             curve.values.size() * sizeof(Vec4));
}

/// A mesh that bends takes three times what it takes as it is read until it is compiled: measured, 216 bytes
/// a triangle of a grid with normals, coordinates and two joints a vertex, of which 69 are read.
constexpr double kBytesPerByteRead = 3;

/// What a node needs for a mesh of its own as it is read, without its joints and the curves of its weights.
double bytes_of(const MeshShape& mesh) {
  const auto bytes = [](const auto& values) {
    return static_cast<double>(values.size() * sizeof(values[0]));
  };
  double sum = bytes(mesh.positions) + bytes(mesh.triangles) + bytes(mesh.normals) +
               bytes(mesh.triangle_normals) + bytes(mesh.uvs) + bytes(mesh.triangle_uvs) +
               bytes(mesh.second_uvs) + bytes(mesh.colors);
  if (!mesh.deformation) return sum;
  sum +=
      bytes(mesh.deformation->joint_of) + bytes(mesh.deformation->weights) + bytes(mesh.deformation->targets);
  for (const DeformationDescription::Target& target : mesh.deformation->targets) sum += bytes(target.deltas);
  return sum;
}

}  // namespace

void GltfNodes::count_copies() {
  for (const uint32_t node : order_) {
    const GltfValue value = file_.item("nodes", node);
    const uint32_t mesh = value.index("mesh", file_.count("meshes")),
                   skin = value.index("skin", file_.count("skins"));
    if (mesh == kNone || (skin == kNone && file_.morph_targets(mesh) == 0)) continue;
    ++copies_[{mesh, skin != kNone}].nodes;
    // Each primitive has the joints and the curves of the weights.
    double bytes = 0;
    if (skin != kNone)
      bytes += static_cast<double>(file_.item("skins", skin).at("joints").size() *
                                   sizeof(DeformationDescription::Joint));
    if (const GltfMotion* const motion = animation_.find(node))
      for (const Curve& curve : motion->weights) bytes += bytes_of(curve);
    file_.take_copies(value, kBytesPerByteRead * bytes *
                                 static_cast<double>(file_.item("meshes", mesh).at("primitives").size()));
  }
}

void GltfNodes::take_copies(const GltfValue& node, std::span<const PrimitiveDescription> primitives,
                            size_t more) const {
  double bytes = 0;
  for (const PrimitiveDescription& primitive : primitives)
    bytes += bytes_of(std::get<MeshShape>(primitive.shape));
  file_.take_copies(node, kBytesPerByteRead * bytes * static_cast<double>(more));
}

std::vector<std::vector<TransformStep>> GltfNodes::copies_of(const GltfValue& node) const {
  const auto extension = node.extension("EXT_mesh_gpu_instancing");
  if (!extension) return {{}};
  const GltfValue attributes = extension->at("attributes");
  std::vector<Affine> places;
  const auto apply = [&](const char* key, TransformKind kind, size_t parts) {
    const uint32_t index = attributes.index(key, file_.count("accessors"));
    if (index == kNone) return;
    const GltfAccessor accessor(file_, index);
    accessor.expect_components({parts});
    if (places.empty() && accessor.count() <= limits::kInstances) {
      file_.take_elements(attributes, accessor.count());
      places.resize(accessor.count());
    }
    if (places.size() != accessor.count())
      attributes.at(key).fail("it makes too many copies, or others than the attribute beside it");
    const LargeVector<float> values = accessor.all<float>();
    for (size_t i = 0; i < places.size(); ++i) {
      Vec4 value(0);
      for (size_t c = 0; c < parts; ++c)
        value[static_cast<int>(c)] = static_cast<double>(values[parts * i + c]);
      if (!is_finite(Vec3(value)) || !std::isfinite(value.w))
        attributes.at(key).fail(fmt::format("copy {} has numbers that are none", i));
      value = kind == TransformKind::scale    ? nonzero_scale(value)
              : kind == TransformKind::orient ? unit_quaternion(value)
                                              : value;
      places[i] = eval_transform(kind, value, {}, {}) * places[i];
    }
  };
  apply("SCALE", TransformKind::scale, 3);
  apply("ROTATION", TransformKind::orient, 4);
  apply("TRANSLATION", TransformKind::translate, 3);
  std::vector<std::vector<TransformStep>> copies;
  for (const Affine& place : places)
    copies.push_back({{TransformKind::matrix, constant_curve(Vec4(0)), {}, place}});
  return copies;
}

}  // namespace rayfarm
