#include "common/compile/deforming.h"

#include <stdexcept>

#include "common/compile/corners.h"
#include "common/compile/objects.h"
#include "common/errors/input_error.h"
#include "common/hierarchy/deformed_parts.h"

namespace rayfarm {
namespace {

const DeformationDescription* deformation_of(const PrimitiveDescription& primitive) {
  const auto* mesh = std::get_if<MeshShape>(&primitive.shape);
  return mesh ? mesh->deformation.get() : nullptr;
}

bool moves(const SkeletonDescription& skeleton, uint32_t bone) {
  for (; bone != kNone; bone = skeleton.bones[bone].parent)
    for (const TransformStep& step : skeleton.bones[bone].transform)
      if (step.curve.is_animated()) return true;
  return false;
}

bool changes(const SceneDescription& description, const DeformationDescription& deformation) {
  for (const DeformationDescription::Target& target : deformation.targets)
    if (target.weight.is_animated()) return true;
  if (deformation.skeleton == kNone) return false;
  const SkeletonDescription& skeleton = description.skeletons[deformation.skeleton];
  return std::any_of(deformation.joints.begin(), deformation.joints.end(),
                     [&](const DeformationDescription::Joint& joint) { return moves(skeleton, joint.bone); });
}

double first_frame(const SceneDescription& description) {
  return description.frames ? (*description.frames)[0] : 0;
}

void deform_first(const SceneArrays<GrowingArray>& arrays, const SceneDescription& description,
                  const Place& place, DeformedVertices& vertices) {
  try {
    deform(view_of(arrays), first_frame(description), vertices);
  } catch (const std::domain_error& e) {
    throw InputError(description.source(place),
                     fmt::format("at frame {}: {}", first_frame(description), e.what()));
  }
}

/// Of a mesh whose vertices begin at `first_vertex`.
void add_triangles(SceneArrays<GrowingArray>& arrays, const PrimitiveDescription& primitive,
                   const MeshShape& mesh, uint32_t first_vertex) {
  const bool is_smooth = mesh.smoothing != Smoothing::flat && !mesh.triangle_normals.empty();
  const auto smoothing = static_cast<uint32_t>(is_smooth ? mesh.smoothing : Smoothing::flat);
  for (size_t i = 0; i < mesh.triangles.size(); ++i) {
    const glm::uvec3 corners = first_vertex + mesh.triangles[i];
    TriangleShading shading{
        mesh.materials.empty() ? primitive.material : mesh.materials[i], smoothing, {kNone, kNone, kNone}};
    if (is_smooth) shading.normals = {corners.x, corners.y, corners.z};
    const size_t before = 3 * arrays.triangle_shading.size();
    arrays.deforming_triangles.push_back(corners);
    arrays.triangle_shading.push_back(shading);
    const auto position = [&](size_t k) { return mesh.triangles[i][static_cast<int>(k)]; };
    if (!mesh.triangle_uvs.empty())
      add_corners(arrays.triangle_uvs, before, kNoUv, mesh.uvs, 3,
                  [&](size_t k) { return mesh.triangle_uvs[i][static_cast<int>(k)]; });
    add_corners(arrays.second_uvs, before, kNoUv, mesh.second_uvs, 3, position);
    add_corners(arrays.triangle_colors, before, kWhiteVertex, mesh.colors, 3, position);
    if (!mesh.colors.empty()) arrays.materials[shading.material].is_colored = 1;
  }
}

}  // namespace

bool changes_shape(const SceneDescription& description, const ObjectDescription& object) {
  return std::any_of(object.primitives.begin(), object.primitives.end(), [&](const PrimitiveDescription& p) {
    const DeformationDescription* const deformation = deformation_of(p);
    return deformation && changes(description, *deformation);
  });
}

uint32_t VertexCompiler::first_bone_of(uint32_t skeleton) {
  const auto [known, is_new] =
      first_bones_.try_emplace(skeleton, static_cast<uint32_t>(arrays_.bones.size()));
  if (!is_new) return known->second;
  for (const SkeletonDescription::Bone& described : description_.skeletons[skeleton].bones) {
    Bone bone{described.parent == kNone ? kNone : known->second + described.parent,
              static_cast<uint32_t>(arrays_.steps.size()), static_cast<uint32_t>(described.transform.size())};
    arrays_.bones.push_back(bone);
    for (const TransformStep& step : described.transform)
      arrays_.steps.push_back(
          {static_cast<uint32_t>(step.kind), add_curve(arrays_, step.curve), step.axis, step.matrix});
  }
  return known->second;
}

void VertexCompiler::add(const MeshShape& mesh) {
  static const DeformationDescription none;
  const DeformationDescription& d = mesh.deformation ? *mesh.deformation : none;
  const auto first_joint = static_cast<uint32_t>(arrays_.joints.size());
  if (d.skeleton != kNone) {
    const uint32_t first_bone = first_bone_of(d.skeleton);
    for (const DeformationDescription::Joint& joint : d.joints)
      arrays_.joints.push_back({joint.bone_from_mesh, first_bone + joint.bone, 0});
  }
  // What the targets do is sorted by vertex, and stays in the order of targets.
  const size_t count = mesh.positions.size();
  std::vector<uint32_t> place(count + 1, 0);
  for (const DeformationDescription::Target& target : d.targets)
    for (const DeformationDescription::Delta& delta : target.deltas) ++place[delta.vertex + 1];
  const auto first_delta = static_cast<uint32_t>(arrays_.morph_deltas.size());
  place[0] = first_delta;
  for (size_t i = 0; i < count; ++i) place[i + 1] += place[i];
  arrays_.morph_deltas.resize(place[count]);
  make_room(arrays_.deforming_vertices, count + 1);
  for (size_t i = 0; i < count; ++i) {
    arrays_.deforming_vertices.push_back({mesh.positions[i],
                                          mesh.normals.empty() ? glm::vec3(0) : mesh.normals[i], place[i],
                                          static_cast<uint32_t>(arrays_.joint_weights.size())});
    for (size_t k = i * d.influences; k < (i + 1) * d.influences; ++k)
      if (d.weights[k] > 0) arrays_.joint_weights.push_back({first_joint + d.joint_of[k], d.weights[k]});
  }
  for (const DeformationDescription::Target& target : d.targets) {
    const auto index = static_cast<uint32_t>(arrays_.morph_weights.size());
    arrays_.morph_weights.push_back(add_curve(arrays_, target.weight));
    for (const DeformationDescription::Delta& delta : target.deltas)
      arrays_.morph_deltas[place[delta.vertex]++] = {index, delta.position, delta.normal};
  }
}

void VertexCompiler::finish() {
  arrays_.deforming_vertices.push_back({glm::vec3(0), glm::vec3(0),
                                        static_cast<uint32_t>(arrays_.morph_deltas.size()),
                                        static_cast<uint32_t>(arrays_.joint_weights.size())});
}

PrimitiveDescription make_still(const SceneDescription& description, const PrimitiveDescription& primitive) {
  PrimitiveDescription still = primitive;
  auto& mesh = std::get<MeshShape>(still.shape);
  SceneArrays<GrowingArray> arrays;
  VertexCompiler vertices(arrays, description);
  vertices.add(mesh);
  vertices.finish();
  DeformedVertices at_rest;
  deform_first(arrays, description, primitive.place, at_rest);
  mesh.positions = std::move(at_rest.positions);
  if (!mesh.normals.empty()) mesh.normals = std::move(at_rest.normals);
  mesh.deformation = nullptr;
  return still;
}

void add_deforming_parts(SceneArrays<GrowingArray>& arrays, const SceneDescription& description,
                         std::span<const uint32_t> objects, const BuildOptions& options,
                         std::span<uint32_t> part_of, const std::function<void(uint32_t)>& is_stored) {
  if (objects.empty()) return;
  VertexCompiler vertices(arrays, description);
  for (const uint32_t object : objects) {
    throw_if_stopped(options.stop);
    const auto first_triangle = static_cast<uint32_t>(arrays.deforming_triangles.size());
    for (const PrimitiveDescription& p : description.objects[object].primitives) {
      const auto* mesh = std::get_if<MeshShape>(&p.shape);
      if (!mesh || !mesh->polygons.sides.empty())
        throw InputError(
            description.source(p.place),
            "an object that changes its shape consists of meshes of triangles; put this into an object "
            "of its own");
      const auto first_vertex = static_cast<uint32_t>(arrays.deforming_vertices.size());
      vertices.add(*mesh);
      add_triangles(arrays, p, *mesh, first_vertex);
    }
    is_stored(object);
    if (arrays.deforming_triangles.size() > limits::kPrimitives)
      throw InputError(description.source(description.objects[object].place),
                       "the scene has too many triangles");
    const auto count = static_cast<uint32_t>(arrays.deforming_triangles.size()) - first_triangle;
    if (count == 0) continue;
    part_of[object] = static_cast<uint32_t>(arrays.deforming_parts.size());
    arrays.deforming_parts.push_back({first_triangle, count});
  }
  vertices.finish();
  DeformedVertices first;
  deform_first(arrays, description, description.objects[objects[0]].place, first);
  const Scene scene = view_of(arrays);
  for (DeformingPart& shape : arrays.deforming_parts)
    arrays.parts.push_back(
        build_deformed_part(scene, first, options, shape, {arrays.nodes, arrays.triangle_blocks}));
  arrays.normals = std::move(first.normals);
}

}  // namespace rayfarm
