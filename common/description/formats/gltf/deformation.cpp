#include "common/description/formats/gltf/deformation.h"

#include <fmt/core.h>

namespace rayfarm {
namespace {

/// JOINTS_0 to JOINTS_7: glTF's files have up to two.
constexpr size_t kMostSets = 8;

void read_skin(const GltfFile& file, const GltfValue& primitive, size_t count, const GltfUsedVertices& used,
               const GltfDeformer& deformer, GltfDeformationNotes& notes, DeformationDescription& d) {
  const GltfValue attributes = primitive.at("attributes");
  size_t sets = 0;
  while (sets < kMostSets && attributes.has(fmt::format("JOINTS_{}", sets).c_str())) ++sets;
  if (sets == 0) {
    ++notes.without_joints;
    return;
  }
  d.skeleton = deformer.skeleton;
  d.joints = deformer.joints;
  d.influences = static_cast<uint32_t>(4 * sets);
  d.joint_of.resize(used.count * d.influences);
  d.weights.resize(used.count * d.influences);
  if (!deformer.is_copy) file.take_elements(primitive, used.count * sets);
  for (size_t set = 0; set < sets; ++set) {
    const std::string joints_key = fmt::format("JOINTS_{}", set),
                      weights_key = fmt::format("WEIGHTS_{}", set);
    LargeVector<uint32_t> joints(4 * used.count);
    LargeVector<float> weights(4 * used.count);
    GltfAccessor::of_vertices(file, attributes, joints_key.c_str(), count, {4})
        .read(std::span<uint32_t>(joints), used.vertices);
    GltfAccessor::of_vertices(file, attributes, weights_key.c_str(), count, {4})
        .read(std::span<float>(weights), used.vertices);
    for (size_t i = 0; i < used.count; ++i)
      for (size_t k = 0; k < 4; ++k) {
        float& weight = weights[4 * i + k];
        uint32_t& joint = joints[4 * i + k];
        if (!(weight >= 0) || !std::isfinite(weight)) {
          weight = 0;
          ++notes.bad_weights;
        }
        if (weight == 0) joint = 0;
        if (joint >= d.joints.size())
          attributes.at(joints_key.c_str())
              .fail(fmt::format("a vertex names joint {}, but its skin has {}, counted from 0", joint,
                                d.joints.size()));
        d.joint_of[i * d.influences + 4 * set + k] = joint;
        d.weights[i * d.influences + 4 * set + k] = weight;
      }
  }
  for (size_t i = 0; i < used.count; ++i) {
    float* const weights = &d.weights[i * d.influences];
    if (std::any_of(weights, weights + d.influences, [](float w) { return w > 0; })) continue;
    weights[0] = 1;  // of the skin's first joint
    ++notes.bad_weights;
  }
}

struct Change {
  uint32_t vertex;
  glm::vec3 by;
};

/// Those of a target that are not zero, in the vertices' order.
std::vector<Change> read_changes(const GltfFile& file, const GltfAccessor& accessor,
                                 const GltfUsedVertices& used, bool is_copy) {
  std::vector<Change> changes;
  const auto add = [&](size_t vertex, const float* v) {
    const glm::vec3 by(v[0], v[1], v[2]);
    if (!is_finite(Vec3(by)) || max_magnitude(Vec3(by)) > limits::kCoordinate)
      accessor.value().fail("it has numbers that are none, or too large");
    if (by != glm::vec3(0)) changes.push_back({static_cast<uint32_t>(vertex), by});
  };
  if (accessor.is_mostly_zero()) {
    const std::vector<uint32_t> vertices = accessor.replaced();
    const std::vector<float> values = accessor.replacements();
    for (size_t i = 0; i < vertices.size(); ++i)
      if (const uint32_t place = used.place_of(vertices[i]); place != kNone) add(place, &values[3 * i]);
  } else {
    LargeVector<float> values(3 * used.count);
    accessor.read(std::span<float>(values), used.vertices);
    for (size_t i = 0; i < used.count; ++i) add(i, &values[3 * i]);
  }
  if (!is_copy) file.take_elements(accessor.value(), changes.size());
  return changes;
}

void read_targets(const GltfFile& file, const GltfValue& primitive, size_t count,
                  const GltfUsedVertices& used, const GltfDeformer& deformer, bool has_normals,
                  GltfDeformationNotes& notes, DeformationDescription& d) {
  const auto targets = primitive.find("targets");
  if (!targets) return;
  if (targets->size() != deformer.weights.size())
    targets->fail(fmt::format("it has {} targets, but the mesh's first primitive has {}", targets->size(),
                              deformer.weights.size()));
  for (size_t t = 0; t < targets->size(); ++t) {
    const GltfValue target = (*targets)[t];
    std::vector<Change> positions, normals;
    for (const std::string& key : target.keys()) {
      if (key == "POSITION" || (key == "NORMAL" && has_normals))
        (key == "POSITION" ? positions : normals) = read_changes(
            file, GltfAccessor::of_vertices(file, target, key.c_str(), count, {3}), used, deformer.is_copy);
      else if (key != "NORMAL" && key != "TANGENT")
        ++notes.other_targets;
    }
    DeformationDescription::Target& result = d.targets.emplace_back();
    result.weight = deformer.weights[t];
    for (size_t p = 0, n = 0; p < positions.size() || n < normals.size();) {
      const uint32_t vertex = std::min(p < positions.size() ? positions[p].vertex : kNone,
                                       n < normals.size() ? normals[n].vertex : kNone);
      DeformationDescription::Delta& delta = result.deltas.emplace_back();
      delta.vertex = vertex;
      if (p < positions.size() && positions[p].vertex == vertex) delta.position = positions[p++].by;
      if (n < normals.size() && normals[n].vertex == vertex) delta.normal = normals[n++].by;
    }
  }
}

}  // namespace

void GltfDeformationNotes::add_to(Notes& notes, const SourcePlace& place) const {
  const auto add = [&](size_t number, const char* what) {
    if (number > 0) notes.add(place, fmt::format(fmt::runtime(what), number));
  };
  add(bad_weights, "{} weights of joints that are no numbers, below 0, or all 0, replaced");
  add(without_joints, "{} primitives stand in a skin without JOINTS_0, and move with nothing");
  add(other_targets, "{} morph targets change colours or texture coordinates, which stay as they are");
}

std::shared_ptr<const DeformationDescription> read_deformation(const GltfFile& file,
                                                               const GltfValue& primitive, size_t count,
                                                               const GltfUsedVertices& used,
                                                               const GltfDeformer& deformer, bool has_normals,
                                                               GltfDeformationNotes& notes) {
  auto d = std::make_shared<DeformationDescription>();
  if (!deformer.joints.empty()) read_skin(file, primitive, count, used, deformer, notes, *d);
  read_targets(file, primitive, count, used, deformer, has_normals, notes, *d);
  if (d->skeleton == kNone && d->targets.empty()) return nullptr;
  return d;
}

}  // namespace rayfarm
