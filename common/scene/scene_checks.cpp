#include "common/scene/scene_checks.h"

#include <cmath>

#include "common/materials/presets.h"
#include "common/scene/animation.h"
#include "common/scene/hierarchy_records.h"
#include "common/scene/scene_block.h"
#include "common/shapes/polygon.h"

namespace rayfarm {
namespace {

void require(bool holds, const char* what) {
  if (!holds) throw SceneBlockError(what);
}

/// Ranges of an array that belong to one owner each: they fit, and all of them are no longer than the array.
class OwnRanges {
 public:
  OwnRanges(size_t size, const char* what) : size_(size), left_(size), what_(what) {}
  void take(uint64_t first, uint64_t count) {
    require(first <= size_ && count <= size_ - first && count <= left_, what_);
    left_ -= count;
  }

 private:
  size_t size_, left_;
  const char* what_;
};

bool exists(const Scene& s, PrimitiveId id, PrimitiveKind kind) {
  const std::array<size_t, 5> counts{s.triangle_shading.size(), s.spheres.size(), s.polygons.size(),
                                     s.quadrics.size(),
                                     s.mesh_faces.size()};  // in the order of PrimitiveKind
  return id.kind() == kind && id.index() < counts[static_cast<size_t>(kind)];
}

/// Trees of nodes whose leaves lie in the arrays.
class TreeChecks {
 public:
  TreeChecks(const Scene& s, std::span<const VolumeNode> nodes)
      : nodes_(nodes),
        levels_(nodes.size(), 0),
        triangle_blocks_(s.triangle_blocks.size(), "a leaf's triangles"),
        sphere_blocks_(s.sphere_blocks.size(), "a leaf's spheres"),
        leaf_primitives_(s.leaf_primitives.size(), "a leaf's primitives"),
        leaf_instances_(s.leaf_instances.size(), "a leaf's instances") {}

  /// Roots first, then all that is below them.
  void check_root(const ChildRef& root, bool of_objects) { check(root, of_objects, 1); }
  void check_nodes(bool of_objects) {
    const VolumeNode unused = make_empty_node();
    for (size_t i = 0; i < nodes_.size(); ++i) {
      require(levels_[i] > 0, "a node that is nobody's child");
      for (size_t slot = 0; slot < 8; ++slot) {
        const ChildRef& child = nodes_[i].children[slot];
        // Children stand after their parents, so a walk always ends.
        require(child.kind() != ChildKind::inner || child.first > i, "a node's child");
        check(child, of_objects, levels_[i] + 1);
        if (child.kind() == ChildKind::empty)  // its box must let no ray in
          for (size_t end = 0; end < 2; ++end)
            for (size_t axis = 0; axis < 3; ++axis)
              require(nodes_[i].planes[end][axis][slot] == unused.planes[end][axis][slot],
                      "an unused child's box");
      }
    }
  }

 private:
  void check(const ChildRef& child, bool of_objects, int level) {
    const ChildKind kind = child.kind();
    require(kind <= ChildKind::inner || (kind == ChildKind::instances) == of_objects,
            "a leaf in the wrong part of the hierarchy");
    switch (kind) {
      case ChildKind::empty:
        require(child.first == 0 && child.count() == 0, "an unused child");
        return;
      case ChildKind::inner:
        // One parent each, or the ways down would multiply; and no more levels than a traverser can remember.
        require(child.first < nodes_.size() && levels_[child.first] == 0 && level < kMostHierarchyLevels,
                "a node's child");
        levels_[child.first] = level;
        return;
      case ChildKind::triangles:
        return triangle_blocks_.take(child.first, child.count());
      case ChildKind::spheres:
        return sphere_blocks_.take(child.first, child.count());
      case ChildKind::mixed:
        return leaf_primitives_.take(child.first, child.count());
      case ChildKind::instances:
        return leaf_instances_.take(child.first, child.count());
    }
    require(false, "a child's kind");
  }

  std::span<const VolumeNode> nodes_;
  std::vector<int> levels_;  ///< of each node; 0: not met yet
  OwnRanges triangle_blocks_, sphere_blocks_, leaf_primitives_, leaf_instances_;
};

void check_hierarchy(const Scene& s) {
  TreeChecks volumes(s, s.nodes), fixed(s, s.fixed_nodes), moving(s, s.moving_nodes);
  OwnRanges triangles(s.triangle_blocks.size(), "a part's triangles"),
      spheres(s.sphere_blocks.size(), "a part's spheres"),
      primitives(s.leaf_primitives.size(), "a part's primitives");
  for (const Part& part : s.parts) {
    require(part.structure <= Structure::list, "a part's structure");
    volumes.check_root(part.root, false);
    triangles.take(part.first_triangle_block, part.triangle_block_count);
    spheres.take(part.first_sphere_block, part.sphere_block_count);
    primitives.take(part.first_leaf_primitive, part.leaf_primitive_count);
  }
  volumes.check_nodes(false);
  fixed.check_root(s.head().fixed_root, true);
  fixed.check_nodes(true);
  moving.check_root(s.head().moving_root, true);
  moving.check_nodes(true);
  for (const uint32_t i : s.leaf_instances) require(i < s.instances.size(), "a leaf's instance");
}

/// What the leaves hold. A lane without a primitive holds numbers that no test accepts.
void check_leaves(const Scene& s) {
  for (const TriangleBlock& block : s.triangle_blocks)
    for (size_t lane = 0; lane < 8; ++lane) {
      const PrimitiveId p = block.primitives[lane];
      if (p != kNoPrimitive) {
        require(exists(s, p, PrimitiveKind::triangle) || exists(s, p, PrimitiveKind::polygon) ||
                    exists(s, p, PrimitiveKind::face),
                "a triangle");
        continue;
      }
      for (const auto& vertex : block.vertices)
        for (const auto& axis : vertex) require(std::isnan(axis[lane]), "an unused triangle");
    }
  for (const SphereBlock& block : s.sphere_blocks)
    for (size_t lane = 0; lane < 8; ++lane) {
      if (block.spheres[lane] != kNone) {
        require(block.spheres[lane] < s.spheres.size(), "a sphere");
        continue;
      }
      for (const auto& axis : block.center) require(std::isnan(axis[lane]), "an unused sphere");
      require(std::isnan(block.radius[lane]), "an unused sphere");
    }
  for (const PrimitiveId p : s.leaf_primitives)
    require(exists(s, p, PrimitiveKind::polygon) || exists(s, p, PrimitiveKind::quadric),
            "a leaf's primitive");
}

void check_primitives(const Scene& s) {
  const auto material = [&](uint32_t m) { require(m < s.materials.size(), "a material"); };
  const auto smoothing = [](uint32_t value) {
    require(value <= static_cast<uint32_t>(Smoothing::gouraud), "a polygon's smoothing");
  };
  for (const TriangleShading& t : s.triangle_shading) {
    material(t.material);
    smoothing(t.smoothing);
    const bool has_normals = t.normals[0] != kNone;
    for (const uint32_t n : t.normals)
      require(has_normals ? n < s.normals.size() : n == kNone, "a triangle's normals");
  }
  require(s.triangle_uvs.empty() || s.triangle_uvs.size() == 3 * s.triangle_shading.size(),
          "the triangles' coordinates");
  for (const SphereRecord& sphere : s.spheres) material(sphere.material);
  OwnRanges points(s.polygon_points.size(), "a polygon's points"),
      normals(s.polygon_normals.size(), "a polygon's normals"),
      planes(s.quadric_planes.size(), "a quadric's planes");
  for (const Polygon& p : s.polygons) {
    material(p.material);
    smoothing(p.smoothing);
    require(p.point_count >= 3 && p.drop_axis < 3, "a polygon");
    points.take(p.first_point, p.point_count);
    if (p.first_normal != kNone) normals.take(p.first_normal, p.point_count);
  }
  OwnRanges corners(s.face_corners.size(), "a face's corners"),
      corner_normals(s.face_normals.size(), "a face's normals");
  for (const MeshFace& f : s.mesh_faces) {
    material(f.material);
    smoothing(f.smoothing);
    require(f.corner_count >= 3, "a face");
    corners.take(f.first_corner, f.corner_count);
    if (f.first_normal != kNone) corner_normals.take(f.first_normal, f.corner_count);
  }
  for (const uint32_t c : s.face_corners) require(c < s.mesh_points.size(), "a face's corner");
  for (const uint32_t n : s.face_normals) require(n < s.normals.size(), "a face's normal");
  require(s.face_uvs.empty() || s.face_uvs.size() == s.face_corners.size(), "the faces' coordinates");
  for (const Quadric& q : s.quadrics) {
    material(q.material);
    planes.take(q.first_plane, q.plane_count);
  }
}

/// Cumulative shares rise from 0 or more to 1.
void check_shares(std::span<const double> shares, const char* what) {
  double below = 0;
  for (const double share : shares) {
    require(share >= below && share <= 1, what);
    below = share;
  }
}

void check_lights(const Scene& s) {
  const uint32_t first_luminaire = s.head().first_luminaire;
  require(s.light_shares.size() == s.lights.size() && first_luminaire <= s.lights.size(), "the lights");
  check_shares(s.light_shares, "the lights' shares");
  for (const GoniometricDiagram& d : s.goniometric_diagrams) {
    const size_t size = s.goniometric_values.size();
    require(d.vertical_count >= 2 && d.horizontal_count >= 1 && d.vertical_count <= size &&
                d.horizontal_count <= size / d.vertical_count && d.first_value <= size &&
                values_of(d.vertical_count, d.horizontal_count) <= size - d.first_value,
            "a goniometric diagram");
  }
  for (size_t i = 0; i < s.lights.size(); ++i) {
    const Light& light = s.lights[i];
    require(light.diagram == kNone || light.diagram < s.goniometric_diagrams.size(), "a light's diagram");
    require(light.object_node == kNone || light.object_node < s.object_nodes.size(), "a light's place");
    require(light.moving == kNone ||
                (light.moving < s.object_lights.size() && s.object_lights[light.moving].light == i),
            "a light's place");
    require(light.kind <= LightKind::luminaire &&
                (light.kind == LightKind::luminaire) == (i >= first_luminaire) &&
                (light.kind != LightKind::environment ||
                 (s.head().environment != kNone && i + 1 == first_luminaire && light.object_node == kNone &&
                  light.moving == kNone)),
            "a light's kind");
    if (light.kind != LightKind::luminaire) continue;
    require(light.material < s.materials.size(), "a light's material");
    require(light.instance < s.instances.size(), "a light's instance");
    const bool has_triangles = exists(s, light.primitive, PrimitiveKind::polygon) ||
                               exists(s, light.primitive, PrimitiveKind::triangle) ||
                               exists(s, light.primitive, PrimitiveKind::face);
    const size_t triangles = s.luminaire_triangles.size();
    require((exists(s, light.primitive, PrimitiveKind::sphere) && light.triangle_count == 0) ||
                (has_triangles && light.triangle_count >= 1 && light.first_triangle <= triangles &&
                 light.triangle_count <= triangles - light.first_triangle),
            "a light's primitive");
  }
}

void check_textures(const Scene& s) {
  OwnRanges texels(s.texels.size() / 3, "an image's texels");
  for (const Texture& t : s.textures) {
    require(t.kind <= TextureKind::array && t.octaves <= 32, "a texture's kind");
    if (t.kind < TextureKind::image) continue;
    const uint32_t depth_px = t.kind == TextureKind::array ? t.depth_px : 1;
    require(t.width_px > 0 && t.height_px > 0 && depth_px > 0 && t.levels > 0 && t.levels <= 32,
            "an image's size");
    const size_t size = s.texels.size() / 3;
    size_t end = t.first_texel;
    for (uint32_t level = 0; level < t.levels; ++level) {
      const size_t width = std::max(1u, t.width_px >> level), height = std::max(1u, t.height_px >> level),
                   depth = std::max(1u, depth_px >> level);
      require(end <= size && width <= (size - end) / height && depth <= (size - end) / (width * height),
              "an image's texels");
      end += width * height * depth;
    }
    texels.take(t.first_texel, end - t.first_texel);
  }
  const uint32_t environment = s.head().environment;
  if (environment == kNone) return;
  const uint32_t end = s.head().first_luminaire;
  require(end > 0 && s.lights[end - 1].kind == LightKind::environment, "the environment's place");
  require(environment < s.textures.size() && s.textures[environment].kind == TextureKind::image,
          "the environment");
  const size_t width = s.textures[environment].width_px, height = s.textures[environment].height_px;
  require(s.environment_shares.size() == height * (width + 1), "the environment's shares");
  for (size_t row = 0; row < height; ++row)
    check_shares(s.environment_shares.subspan(height + row * width, width), "the environment's shares");
  check_shares(s.environment_shares.first(height), "the environment's shares");
}

void check_materials(const Scene& s) {
  for (size_t i = 0; i < s.materials.size(); ++i) {
    const Material& m = s.materials[i];
    require(m.kind <= MaterialKind::mix && m.reflections <= Reflections::none, "a material's kind");
    if (m.kind == MaterialKind::mix)  // its parts stand before it, so a chain of mixes always ends
      require(m.texture != kNone && m.parts[0] < i && m.parts[1] < i, "a mix");
    require(std::isfinite(m.exponent) && m.exponent >= 0, "a material's exponent");
    for (int c = 0; c < 3; ++c)
      require(std::isfinite(m.interior[c]) && m.interior[c] >= 0 && m.filter[c] >= 0 && m.filter[c] <= 1,
              "a material's interior");
    require((m.texture == kNone || m.texture < s.textures.size()) &&
                (m.bump == kNone || m.bump < s.textures.size()),
            "a material's texture");
    require(m.diagram == kNone || m.diagram < s.goniometric_diagrams.size(), "a material's diagram");
    require(m.metal == kNone || m.metal < conductor_names().size(), "a material's metal");
  }
}

void check_spectra(const Scene& s) {
  OwnRanges own(s.spectrum_nodes.size(), "a spectrum");
  for (const SpectralColor& c : s.spectral_colors) {
    require(c.field <= SpectralField::ambient, "a spectrum's place");
    const size_t owners = c.field < SpectralField::light    ? s.materials.size()
                          : c.field == SpectralField::light ? s.lights.size()
                                                            : 1;
    require(c.index < owners, "a spectrum's owner");
    require(c.node_count > 0, "a spectrum");
    own.take(c.first_node, c.node_count);
    const auto nodes = s.spectrum_of(c);
    for (size_t i = 0; i < nodes.size(); ++i)  // not NaN, and rising
      require(std::isfinite(nodes[i].wavelength_nm) && std::isfinite(nodes[i].value) && nodes[i].value >= 0 &&
                  (i == 0 || nodes[i - 1].wavelength_nm < nodes[i].wavelength_nm),
              "a spectrum");
  }
}

void check_motion(const Scene& s) {
  const auto curve = [&](uint32_t c) { require(c < s.curves.size(), "a curve"); };
  const ViewRecord& view = s.head().view;
  for (const uint32_t c : {view.location, view.direction, view.up, view.field_of_view, view.focus}) curve(c);
  if (view.look_at != kNone) curve(view.look_at);
  require(s.key_frames.size() == s.key_values.size(), "the keys");
  OwnRanges keys(s.key_frames.size(), "a curve's keys"), steps(s.steps.size(), "an object's transform");
  for (const CurveRecord& c : s.curves) {
    require(c.key_count > 0 && c.interpolation <= static_cast<uint32_t>(Interpolation::step), "a curve");
    keys.take(c.first_key, c.key_count);
    const auto frames = s.key_frames.subspan(c.first_key, c.key_count);
    for (size_t i = 0; i < frames.size(); ++i)  // not NaN, and rising
      require(std::isfinite(frames[i]) && (i == 0 || frames[i - 1] < frames[i]), "a curve's keys");
  }
  for (const TransformStepRecord& step : s.steps) {
    curve(step.curve);
    require(step.kind <= static_cast<uint32_t>(TransformKind::matrix), "a transform's kind");
  }
  for (size_t i = 0; i < s.object_nodes.size(); ++i) {
    const ObjectNode& node = s.object_nodes[i];
    require(node.parent == kNone || node.parent < i, "an object's parent");
    if (node.visible != kNone) curve(node.visible);
    steps.take(node.first_step, node.step_count);
  }
  require(s.poses.size() == s.instances.size(), "the poses");
  for (const Instance& i : s.instances)
    require(i.object_node < s.object_nodes.size() && i.part < s.parts.size() &&
                (i.moving == kNone || i.moving < s.moving_instances.size()),
            "an instance");
  require(!s.moving_instances.empty() || s.head().moving_root.kind() == ChildKind::empty,
          "boxes over what moves where nothing does");
  for (size_t m = 0; m < s.moving_instances.size(); ++m)
    require(s.moving_instances[m] < s.instances.size() && s.instances[s.moving_instances[m]].moving == m,
            "a moving instance");
  for (size_t i = 0; i < s.object_lights.size(); ++i) {
    const ObjectLight& place = s.object_lights[i];
    require(place.light < s.lights.size(), "an object's light");
    const Light& light = s.lights[place.light];
    require(place.object_node < s.object_nodes.size() && light.object_node == place.object_node &&
                (light.moving == kNone || light.moving == i),
            "an object's light");
  }
}

}  // namespace

void check_scene(const Scene& scene) {
  require(scene.header.size() == 1, "the header");
  check_motion(scene);
  check_hierarchy(scene);
  check_leaves(scene);
  check_primitives(scene);
  check_materials(scene);
  check_spectra(scene);
  check_lights(scene);
  check_textures(scene);
}

}  // namespace rayfarm
