#include "common/scene/scene_checks.h"

#include <cmath>

#include "common/materials/presets.h"
#include "common/scene/animation.h"
#include "common/scene/check_tools.h"
#include "common/scene/deformation_checks.h"
#include "common/scene/hierarchy_checks.h"
#include "common/shapes/polygon.h"

namespace rayfarm {
namespace {

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
  require(s.second_uvs.empty() || s.second_uvs.size() == 3 * s.triangle_shading.size(),
          "the triangles' second coordinates");
  require(s.triangle_colors.empty() || s.triangle_colors.size() == 3 * s.triangle_shading.size(),
          "the triangles' colours");
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
  require(s.face_colors.empty() || s.face_colors.size() == s.face_corners.size(), "the faces' colours");
  for (const Quadric& q : s.quadrics) {
    material(q.material);
    planes.take(q.first_plane, q.plane_count);
    require(q.is_patch == 0 || (q.is_patch == 1 && q.plane_count == 4), "a bilinear patch");
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
    require(t.kind <= TextureKind::array && t.octaves <= 32 && t.wraps[0] <= TextureWrap::mirror &&
                t.wraps[1] <= TextureWrap::mirror,
            "a texture's kind");
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
    require(m.kind <= MaterialKind::principled && m.reflections <= Reflections::none, "a material's kind");
    if (m.kind == MaterialKind::mix)  // its parts stand before it, so a chain of mixes always ends
      require(m.texture != kNone && m.parts[0] < i && m.parts[1] < i, "a mix");
    require(std::isfinite(m.exponent) && m.exponent >= 0, "a material's exponent");
    require(std::isfinite(m.zone_size) && m.zone_size >= 0, "the size of a material's zones");
    for (int c = 0; c < 3; ++c)
      require(std::isfinite(m.interior[c]) && m.interior[c] >= 0 && m.filter[c] >= 0 && m.filter[c] <= 1,
              "a material's interior");
    require((m.texture == kNone || m.texture < s.textures.size()) &&
                (m.bump == kNone || m.bump < s.textures.size()),
            "a material's texture");
    require((m.kind == MaterialKind::principled) == (m.principled != kNone) &&
                (m.principled == kNone || m.principled < s.principled.size()) &&
                (m.principled != kNone || (!m.is_solid && !m.is_pierced && !m.is_unlit)),
            "a material's parameters");
    require(m.diagram == kNone || m.diagram < s.goniometric_diagrams.size(), "a material's diagram");
    require(m.metal == kNone || m.metal < conductor_names().size(), "a material's metal");
  }
  for (const PrincipledMaterial& m : s.principled) {
    require(m.ior >= 1e-3 && m.ior <= 1e3 && m.cutoff >= 0 && m.cutoff <= 1, "a principled material");
    for (const PrincipledSource& source : m.sources)
      require((source.texture == kNone || source.texture < s.textures.size()) &&
                  source.channel <= TextureChannel::color && source.uv_set <= 1 && is_finite(source.factor) &&
                  is_finite(source.u_row) && is_finite(source.v_row),
              "a principled material's texture");
  }
}

void check_spectra(const Scene& s) {
  OwnRanges own(s.spectrum_nodes.size(), "a spectrum");
  for (const SpectralColor& c : s.spectral_colors) {
    require(c.field <= SpectralField::scattering, "a spectrum's place");
    const size_t owners = c.field < SpectralField::light         ? s.materials.size()
                          : c.field == SpectralField::light      ? s.lights.size()
                          : c.field >= SpectralField::absorption ? s.media.size()
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

void check_media(const Scene& s) {
  require(s.media.size() <= kMostMedia, "the number of media");
  OwnRanges densities(s.medium_densities.size(), "a medium's densities"),
      majorants(s.medium_majorants.size(), "a medium's majorants");
  for (const ParticipatingMedium& m : s.media) {
    require(is_finite(m.box.lo) && is_finite(m.box.hi) && m.box.lo.x < m.box.hi.x &&
                m.box.lo.y < m.box.hi.y && m.box.lo.z < m.box.hi.z,
            "a medium's box");
    require(m.asymmetry > -1 && m.asymmetry < 1, "a medium's asymmetry");
    for (int c = 0; c < 3; ++c)
      require(m.absorption[c] >= 0 && m.scattering[c] >= 0, "a medium's coefficients");
    double most = 1;
    if (m.has_grid()) {
      const size_t size = s.medium_densities.size();
      require(m.cells[0] <= size && m.cells[1] > 0 && m.cells[2] > 0 && m.cells[1] <= size / m.cells[0] &&
                  m.cells[2] <= size / m.cells[0] / m.cells[1],
              "a medium's grid");
      for (int axis = 0; axis < 3; ++axis)
        require(m.box.extent()[axis] / m.cells[static_cast<size_t>(axis)] > 0, "a medium's cells");
      densities.take(m.first_density, m.cell_count());
      majorants.take(m.first_majorant, m.block_count());
      most = 0;
      for (const float d : s.medium_densities.subspan(m.first_density, m.cell_count())) {
        require(std::isfinite(d) && d >= 0, "a medium's density");
        most = std::max<double>(most, d);
      }
      for (const float majorant : s.medium_majorants.subspan(m.first_majorant, m.block_count()))
        require(majorant >= 0 && majorant <= most, "a medium's majorant");
    }
    require(greatest_optical_depth(m, most) <= kMostOpticalDepth, "how much light a medium takes");
  }
}

void check_motion(const Scene& s) {
  const auto curve = [&](uint32_t c) { require(c < s.curves.size(), "a curve"); };
  const ViewRecord& view = s.head().view;
  for (const uint32_t c :
       {view.location, view.direction, view.up, view.field_of_view, view.focus, view.width})
    curve(c);
  require(view.projection <= Projection::fisheye && std::isfinite(view.shift[0]) &&
              std::isfinite(view.shift[1]) && view.near >= 0 && view.near < view.far && view.aspect > 0,
          "the view");
  if (view.look_at != kNone) curve(view.look_at);
  OwnRanges keys(s.key_frames.size(), "a curve's keys"), values(s.key_values.size(), "a curve's values"),
      steps(s.steps.size(), "an object's transform");
  for (const CurveRecord& c : s.curves) {
    require(c.key_count > 0 && c.interpolation <= static_cast<uint32_t>(Interpolation::cubic_rotation),
            "a curve");
    keys.take(c.first_key, c.key_count);
    values.take(c.first_value, c.value_count());
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
  for (size_t i = 0; i < s.bones.size(); ++i) {
    require(s.bones[i].parent == kNone || s.bones[i].parent < i, "a bone's parent");
    steps.take(s.bones[i].first_step, s.bones[i].step_count);
  }
  for (const uint32_t weight : s.morph_weights) curve(weight);
  require(s.poses.size() == s.instances.size(), "the poses");
  for (size_t i = 0; i < s.poses.size(); ++i) {
    const bool is_deformed = s.instances[i].part < s.deforming_parts.size();
    require(
        s.poses[i].is_deformed == (is_deformed ? 1 : 0) && (!is_deformed || s.instances[i].moving != kNone),
        "an instance of what changes its shape");
  }
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
  constexpr double kLeastHalfAngle = 1e-3, kRightAngle = 1.5707963267948966;  // so that cells can be counted
  const double half_angle = scene.head().ray_coherence;
  require(scene.head().has_last_hit <= 1 &&
              (half_angle == 0 || (half_angle >= kLeastHalfAngle && half_angle < kRightAngle)),
          "how rays are traced");
  check_motion(scene);
  check_hierarchy(scene);
  check_leaves(scene);
  check_primitives(scene);
  check_deformation(scene);
  check_materials(scene);
  check_spectra(scene);
  check_lights(scene);
  check_textures(scene);
  check_media(scene);
}

}  // namespace rayfarm
