#include "common/scene/scene_block.h"

#include <fmt/core.h>

#include <cereal/archives/portable_binary.hpp>
#include <cereal/types/string.hpp>
#include <cereal/types/vector.hpp>
#include <cstring>
#include <new>
#include <sstream>

#include "common/materials/presets.h"
#include "common/scene/animation.h"

namespace rayfarm {
namespace {

constexpr size_t kAlignment = 64;
constexpr uint64_t kMagic = 0x31304d5241465952ULL;  // "RYFARM01" in memory

struct Prefix {
  uint64_t magic = kMagic;
  uint64_t total_bytes = 0;
  uint64_t table_offset = 0;
  uint64_t table_bytes = 0;
};

struct ArrayEntry {
  std::string name;
  uint64_t offset = 0, count = 0, stride = 0;
  template <typename Archive>
  void serialize(Archive& archive) {
    archive(name, offset, count, stride);
  }
};

size_t aligned(size_t n) {
  return (n + kAlignment - 1) / kAlignment * kAlignment;
}

[[noreturn]] void damaged(const std::string& what) {
  throw SceneBlockError("the scene block is damaged: " + what);
}

void require(bool holds, const char* what) {
  if (!holds) damaged(what);
}

bool range_fits(uint64_t first, uint64_t count, size_t size) {
  return first <= size && count <= size - first;
}

bool exists(const Scene& s, PrimitiveId id, PrimitiveKind kind) {
  const std::array<size_t, 4> counts{s.triangle_shading.size(), s.spheres.size(), s.polygons.size(),
                                     s.quadrics.size()};  // in the order of PrimitiveKind
  return id.kind() == kind && id.index() < counts[static_cast<size_t>(kind)];
}

void check_child(const Scene& s, const ChildRef& child, size_t node_count, size_t parent) {
  switch (child.kind()) {
    case ChildKind::empty:
      return;
    case ChildKind::inner:
      // Children stand after their parents, so a walk always ends.
      require(child.first < node_count && (parent == kNone || child.first > parent), "a node's child");
      return;
    case ChildKind::triangles:
      require(range_fits(child.first, child.count(), s.triangle_blocks.size()), "a leaf's triangles");
      return;
    case ChildKind::spheres:
      require(range_fits(child.first, child.count(), s.sphere_blocks.size()), "a leaf's spheres");
      return;
    case ChildKind::mixed:
      require(range_fits(child.first, child.count(), s.leaf_primitives.size()), "a leaf's primitives");
      return;
    case ChildKind::instances:
      require(range_fits(child.first, child.count(), s.leaf_instances.size()), "a leaf's instances");
      return;
  }
  damaged("a child's kind");
}

void check_nodes(const Scene& s, std::span<const VolumeNode> nodes, bool of_objects) {
  for (size_t i = 0; i < nodes.size(); ++i)
    for (const ChildRef& child : nodes[i].children) {
      check_child(s, child, nodes.size(), i);
      const ChildKind kind = child.kind();
      require(kind == ChildKind::empty || kind == ChildKind::inner ||
                  (kind == ChildKind::instances) == of_objects,
              "a leaf in the wrong part of the hierarchy");
    }
}

void check_indices(const Scene& s) {
  require(s.header.size() == 1, "the header");
  const auto material = [&](uint32_t m) { require(m < s.materials.size(), "a material"); };
  const auto curve = [&](uint32_t c) { require(c < s.curves.size(), "a curve"); };
  const ViewRecord& view = s.head().view;
  for (const uint32_t c : {view.location, view.direction, view.up, view.field_of_view, view.focus}) curve(c);
  if (view.look_at != kNone) curve(view.look_at);
  require(s.key_frames.size() == s.key_values.size(), "the keys");
  require(s.light_shares.size() == s.lights.size() && s.head().first_luminaire <= s.lights.size(),
          "the lights");
  for (const GoniometricDiagram& d : s.goniometric_diagrams)
    require(d.vertical_count >= 2 && d.horizontal_count >= 1 &&
                range_fits(d.first_value, values_of(d.vertical_count, d.horizontal_count),
                           s.goniometric_values.size()),
            "a goniometric diagram");
  for (size_t i = 0; i < s.lights.size(); ++i) {
    const Light& light = s.lights[i];
    require(light.diagram == kNone || light.diagram < s.goniometric_diagrams.size(), "a light's diagram");
    require(light.kind <= LightKind::luminaire &&
                (light.kind == LightKind::luminaire) == (i >= s.head().first_luminaire) &&
                (light.kind != LightKind::environment || s.head().environment != kNone),
            "a light's kind");
    if (light.kind != LightKind::luminaire) continue;
    material(light.material);
    require(light.instance < s.instances.size(), "a light's instance");
    const bool has_corners = exists(s, light.primitive, PrimitiveKind::polygon) ||
                             exists(s, light.primitive, PrimitiveKind::triangle);
    require(exists(s, light.primitive, PrimitiveKind::sphere) ||
                (has_corners && light.vertex_count >= 3 &&
                 range_fits(light.first_vertex, light.vertex_count, s.luminaire_vertices.size())),
            "a light's primitive");
  }
  for (const Texture& t : s.textures) {
    require(t.kind <= TextureKind::image && t.octaves <= 32, "a texture's kind");
    if (t.kind != TextureKind::image) continue;
    require(t.width_px > 0 && t.height_px > 0 && t.levels > 0 && t.levels <= 32, "an image's size");
    size_t texels = 0;
    for (uint32_t level = 0; level < t.levels; ++level)
      texels += size_t{std::max(1u, t.width_px >> level)} * std::max(1u, t.height_px >> level);
    require(range_fits(t.first_texel, texels, s.texels.size() / 3), "an image's texels");
  }
  if (const uint32_t environment = s.head().environment; environment != kNone) {
    const uint32_t end = s.head().first_luminaire;
    require(end > 0 && s.lights[end - 1].kind == LightKind::environment, "the environment's place");
    require(environment < s.textures.size() && s.textures[environment].kind == TextureKind::image,
            "the environment");
    const Texture& image = s.textures[environment];
    require(s.environment_shares.size() == size_t{image.height_px} * (size_t{image.width_px} + 1),
            "the environment's shares");
  }
  require(s.triangle_uvs.empty() || s.triangle_uvs.size() == 3 * s.triangle_shading.size(),
          "the triangles' coordinates");
  for (const Material& m : s.materials) {
    require(m.kind <= MaterialKind::luminaire, "a material's kind");
    require((m.texture == kNone || m.texture < s.textures.size()) &&
                (m.bump == kNone || m.bump < s.textures.size()),
            "a material's texture");
    require(m.metal == kNone || m.metal < conductor_names().size(), "a material's metal");
  }
  for (const CurveRecord& c : s.curves)
    require(c.key_count > 0 && range_fits(c.first_key, c.key_count, s.key_frames.size()) &&
                c.interpolation <= static_cast<uint32_t>(Interpolation::spherical_rotation),
            "a curve's keys");
  for (const TransformStepRecord& step : s.steps) {
    curve(step.curve);
    require(step.kind <= static_cast<uint32_t>(TransformKind::matrix), "a transform's kind");
  }
  for (size_t i = 0; i < s.object_nodes.size(); ++i) {
    const ObjectNode& node = s.object_nodes[i];
    require(node.parent == kNone || node.parent < i, "an object's parent");
    require(range_fits(node.first_step, node.step_count, s.steps.size()), "an object's transform");
  }
  check_nodes(s, s.nodes, false);
  check_nodes(s, s.object_part_nodes, true);
  for (const Part& part : s.parts) {
    check_child(s, part.root, s.nodes.size(), kNone);
    require(part.root.kind() != ChildKind::instances, "a part's root");
    require(range_fits(part.first_triangle_block, part.triangle_block_count, s.triangle_blocks.size()) &&
                range_fits(part.first_sphere_block, part.sphere_block_count, s.sphere_blocks.size()) &&
                range_fits(part.first_leaf_primitive, part.leaf_primitive_count, s.leaf_primitives.size()),
            "a part's primitives");
  }
  check_child(s, s.head().object_root, s.object_part_nodes.size(), kNone);
  const ChildKind root = s.head().object_root.kind();
  require(root == ChildKind::empty || root == ChildKind::inner || root == ChildKind::instances,
          "the object part's root");
  require(s.poses.size() == s.instances.size(), "the poses");
  for (const Instance& i : s.instances)
    require(i.object_node < s.object_nodes.size() && i.part < s.parts.size(), "an instance");
  for (const uint32_t i : s.leaf_instances) require(i < s.instances.size(), "a leaf's instance");
  for (const TriangleBlock& block : s.triangle_blocks)
    for (const PrimitiveId p : block.primitives)
      require(
          p == kNoPrimitive || exists(s, p, PrimitiveKind::triangle) || exists(s, p, PrimitiveKind::polygon),
          "a triangle");
  for (const SphereBlock& block : s.sphere_blocks)
    for (const uint32_t i : block.spheres) require(i == kNone || i < s.spheres.size(), "a sphere");
  for (const PrimitiveId p : s.leaf_primitives)
    require(exists(s, p, PrimitiveKind::polygon) || exists(s, p, PrimitiveKind::quadric),
            "a leaf's primitive");
  for (const TriangleShading& t : s.triangle_shading) {
    material(t.material);
    for (const uint32_t n : t.normals) require(n == kNone || n < s.normals.size(), "a triangle's normal");
  }
  for (const SphereRecord& sphere : s.spheres) material(sphere.material);
  for (const Polygon& p : s.polygons) {
    material(p.material);
    require(p.point_count >= 3 && range_fits(p.first_point, p.point_count, s.polygon_points.size()) &&
                p.drop_axis < 3,
            "a polygon");
    require(p.first_normal == kNone || range_fits(p.first_normal, p.point_count, s.polygon_normals.size()),
            "a polygon's normals");
  }
  for (const Quadric& q : s.quadrics) {
    material(q.material);
    require(range_fits(q.first_plane, q.plane_count, s.quadric_planes.size()), "a quadric's planes");
  }
}

}  // namespace

Vec4 Scene::eval(uint32_t curve, double frame) const {
  const CurveRecord& c = curves[curve];
  return eval_curve(static_cast<Interpolation>(c.interpolation), key_frames.subspan(c.first_key, c.key_count),
                    key_values.subspan(c.first_key, c.key_count), frame);
}

SceneBlock encode_scene(const Scene& scene) {
  std::vector<ArrayEntry> table;
  size_t end = aligned(sizeof(Prefix));
  for_each_array(scene, [&]<typename T>(const char* name, std::span<const T> array) {
    static_assert(std::is_trivially_copyable_v<T> && alignof(T) <= kAlignment);
    table.push_back({name, end, array.size(), sizeof(T)});
    end = aligned(end + array.size_bytes());
  });
  std::ostringstream out;
  {
    cereal::PortableBinaryOutputArchive archive(out);
    archive(table);
  }
  const std::string table_bytes = out.str();
  const Prefix prefix{kMagic, aligned(end + table_bytes.size()), end, table_bytes.size()};
  SceneBlock block;
  block.size = prefix.total_bytes;
  block.data.reset(static_cast<std::byte*>(std::aligned_alloc(kAlignment, block.size)));
  if (!block.data) throw std::bad_alloc();
  std::memset(block.data.get(), 0, block.size);  // gaps too: equal scenes are equal bytes
  std::memcpy(block.data.get(), &prefix, sizeof prefix);
  size_t i = 0;
  for_each_array(scene, [&]<typename T>(const char*, std::span<const T> array) {
    if (!array.empty()) std::memcpy(block.data.get() + table[i].offset, array.data(), array.size_bytes());
    ++i;
  });
  std::memcpy(block.data.get() + prefix.table_offset, table_bytes.data(), table_bytes.size());
  return block;
}

Scene decode_scene(std::span<const std::byte> bytes) {
  Prefix prefix;
  if (bytes.size() < sizeof prefix) damaged("it is too short");
  std::memcpy(&prefix, bytes.data(), sizeof prefix);
  if (prefix.magic != kMagic) damaged("it doesn't begin with Rayfarm's mark");
  if (prefix.total_bytes != bytes.size()) damaged("its size is not what it says");
  if (reinterpret_cast<uintptr_t>(bytes.data()) % kAlignment != 0) damaged("it is not aligned");
  if (!range_fits(prefix.table_offset, prefix.table_bytes, bytes.size())) damaged("its table is outside");
  constexpr uint64_t kMostTableBytes = 1 << 16;
  if (prefix.table_bytes > kMostTableBytes) damaged("its table is too long");

  std::vector<ArrayEntry> table;
  try {
    std::istringstream in(
        std::string(reinterpret_cast<const char*>(bytes.data() + prefix.table_offset), prefix.table_bytes));
    cereal::PortableBinaryInputArchive archive(in);
    // Counts are checked before cereal allocates for them: a damaged length must not ask for all memory.
    cereal::size_type count = 0;
    archive(cereal::make_size_tag(count));
    if (count > 1000) damaged("its table has too many entries");
    for (cereal::size_type i = 0; i < count; ++i) {
      ArrayEntry entry;
      cereal::size_type length = 0;
      archive(cereal::make_size_tag(length));
      if (length > 100) damaged("a name in its table is too long");
      entry.name.resize(length);
      archive(cereal::binary_data(entry.name.data(), length));
      archive(entry.offset, entry.count, entry.stride);
      table.push_back(entry);
    }
  } catch (const cereal::Exception& e) {
    damaged(fmt::format("its table can't be read ({})", e.what()));
  }

  Scene scene;
  size_t i = 0;
  for_each_array(scene, [&]<typename T>(const char* name, std::span<const T>& array) {
    if (i >= table.size() || table[i].name != name) damaged(fmt::format("the array '{}' is missing", name));
    const ArrayEntry& entry = table[i++];
    if (entry.stride != sizeof(T) || entry.offset % kAlignment != 0 || entry.count > bytes.size() ||
        !range_fits(entry.offset, entry.count * sizeof(T), bytes.size()))
      damaged(fmt::format("the array '{}' lies outside", name));
    array = {reinterpret_cast<const T*>(bytes.data() + entry.offset), entry.count};
  });
  check_indices(scene);
  return scene;
}

}  // namespace rayfarm
