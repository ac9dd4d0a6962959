#include "common/compile/compile.h"

#include <cmath>
#include <map>
#include <numbers>

#include "common/compile/darkness.h"
#include "common/compile/luminaires.h"
#include "common/hierarchy/pose.h"
#include "common/hierarchy/structurer.h"
#include "common/lighting/environment.h"
#include "common/lighting/light_choice.h"
#include "common/materials/scattering.h"

namespace rayfarm {
namespace {

/// The scene's arrays while they grow.
struct SceneArrays {
  std::vector<SceneHeader> header{1};
  std::vector<VolumeNode> nodes;
  std::vector<TriangleBlock> triangle_blocks;
  std::vector<SphereBlock> sphere_blocks;
  std::vector<PrimitiveId> leaf_primitives;
  std::vector<SphereRecord> spheres;
  std::vector<Polygon> polygons;
  std::vector<Vec3> polygon_points, polygon_normals;
  std::vector<Quadric> quadrics;
  std::vector<Vec4> quadric_planes;
  std::vector<TriangleShading> triangle_shading;
  std::vector<glm::vec3> normals;
  std::vector<glm::vec2> triangle_uvs;
  std::vector<Texture> textures;
  std::vector<uint16_t> texels;
  std::vector<Material> materials;
  std::vector<Light> lights;
  std::vector<GoniometricDiagram> goniometric_diagrams;
  std::vector<double> goniometric_values;
  std::vector<double> environment_shares;
  std::vector<double> light_shares;
  std::vector<LuminaireTriangle> luminaire_triangles;
  std::vector<CurveRecord> curves;
  std::vector<double> key_frames;
  std::vector<Vec4> key_values;
  std::vector<TransformStepRecord> steps;
  std::vector<ObjectNode> object_nodes;
  std::vector<Part> parts;
  std::vector<Instance> instances;
  std::vector<uint32_t> leaf_instances;
  std::vector<VolumeNode> object_part_nodes;
  std::vector<InstancePose> poses;

  Scene view() const {
    return {header,
            nodes,
            triangle_blocks,
            sphere_blocks,
            leaf_primitives,
            spheres,
            polygons,
            polygon_points,
            polygon_normals,
            quadrics,
            quadric_planes,
            triangle_shading,
            normals,
            triangle_uvs,
            textures,
            texels,
            materials,
            lights,
            goniometric_diagrams,
            goniometric_values,
            environment_shares,
            light_shares,
            luminaire_triangles,
            curves,
            key_frames,
            key_values,
            steps,
            object_nodes,
            parts,
            instances,
            leaf_instances,
            object_part_nodes,
            poses};
  }
};

Box sphere_box(const SphereRecord& s) {
  return {s.center - Vec3(s.radius), s.center + Vec3(s.radius)};
}

/// The primitives of one part, for the builder.
class PartSource : public PrimitiveSource {
 public:
  PartSource(const SceneArrays& arrays, const PartPrimitives& part) : arrays_(arrays), part_(part) {}
  size_t size() const override { return part_.ids.size(); }

  Box bounds(uint32_t primitive) const override {
    if (part_.triangle_of[primitive] != kNone) {
      Box box;
      for (const Vec3& v : triangle(primitive)) box.grow(v);
      return box;
    }
    const PrimitiveId id = part_.ids[primitive];
    switch (id.kind()) {
      case PrimitiveKind::triangle:
        break;
      case PrimitiveKind::sphere:
        return sphere_box(arrays_.spheres[id.index()]);
      case PrimitiveKind::polygon: {
        Box box;
        for (const Vec3& p : points(id)) box.grow(p);
        return box;
      }
      case PrimitiveKind::quadric:
        return arrays_.quadrics[id.index()].bounds;
    }
    return {};
  }

  Box clipped(uint32_t primitive, const Box& cell) const override {
    if (part_.triangle_of[primitive] != kNone) return clipped_bounds(triangle(primitive), cell);
    const PrimitiveId id = part_.ids[primitive];
    switch (id.kind()) {
      case PrimitiveKind::triangle:
        break;
      case PrimitiveKind::sphere: {
        const SphereRecord& s = arrays_.spheres[id.index()];
        const Vec3 nearest = glm::clamp(s.center, cell.lo, cell.hi) - s.center;
        if (glm::dot(nearest, nearest) > s.radius * s.radius * (1 + 1e-12)) return {};
        return intersection(sphere_box(s), cell);
      }
      case PrimitiveKind::polygon:
        return clipped_bounds(points(id), cell);
      case PrimitiveKind::quadric:
        return intersection(arrays_.quadrics[id.index()].bounds, cell);
    }
    return {};
  }

 private:
  std::array<Vec3, 3> triangle(uint32_t primitive) const {
    const TriangleVertices& t = part_.triangles[part_.triangle_of[primitive]];
    return {Vec3(t[0]), Vec3(t[1]), Vec3(t[2])};
  }
  std::span<const Vec3> points(PrimitiveId id) const {
    const Polygon& p = arrays_.polygons[id.index()];
    return std::span(arrays_.polygon_points).subspan(p.first_point, p.point_count);
  }
  const SceneArrays& arrays_;
  const PartPrimitives& part_;
};

/// The triangles of a small convex polygon, which are tested eight at a time; empty if it has to be tested as
/// it is. Triangles are stored in float: a polygon whose corners that would move by a visible part of its
/// size stays whole.
std::vector<TriangleVertices> triangle_fan(std::span<const Vec3> points, const Vec3& normal) {
  constexpr size_t kMostPoints = 8;
  constexpr double kMostMove = 2e-7;  // of the polygon's size
  const size_t n = points.size();
  if (n > kMostPoints) return {};
  Box box;
  for (const Vec3& p : points) box.grow(p);
  const double most = kMostMove * max_component(box.extent());
  for (size_t i = 0; i < n; ++i) {
    const Vec3 &a = points[i], &b = points[(i + 1) % n], &c = points[(i + 2) % n];
    if (!(glm::dot(glm::cross(b - a, c - b), normal) > 0)) return {};
    if (max_magnitude(Vec3(glm::vec3(a)) - a) > most) return {};
  }
  std::vector<TriangleVertices> fan;
  for (size_t i = 1; i + 1 < n; ++i) {
    fan.push_back({glm::vec3(points[0]), glm::vec3(points[i]), glm::vec3(points[i + 1])});
    const Vec3 a(fan.back()[0]), b(fan.back()[1]), c(fan.back()[2]);
    if (max_magnitude(glm::cross(b - a, c - a)) == 0) return {};
  }
  return fan;
}

class InstanceSource : public PrimitiveSource {
 public:
  explicit InstanceSource(const std::vector<InstancePose>& poses) : poses_(poses) {}
  size_t size() const override { return poses_.size(); }
  Box bounds(uint32_t i) const override { return poses_[i].bounds; }
  Box clipped(uint32_t i, const Box& cell) const override { return intersection(poses_[i].bounds, cell); }

 private:
  const std::vector<InstancePose>& poses_;
};

/// How often long loops ask whether to stop.
constexpr size_t kPrimitivesPerLook = 1 << 14;

class Compiler {
 public:
  Compiler(const SceneDescription& description, const BuildOptions& options)
      : description_(description), options_(options), part_of_(description.objects.size(), kNone) {}

  CompiledScene compile() {
    add_head();
    const std::vector<uint32_t> fixed = fixed_objects();
    add_part(description_.root, fixed);
    std::vector<bool> is_added(description_.objects.size());
    for (const uint32_t object : fixed) is_added[object] = true;
    for (uint32_t object = 0; object < description_.objects.size(); ++object)
      if (!is_added[object]) add_part(object, std::span(&object, 1));
    expand(description_.root, kNone, {});
    build_object_part();
    if (!arrays_.triangle_uvs.empty()) arrays_.triangle_uvs.resize(3 * arrays_.triangle_shading.size());
    add_luminaires();
    weigh_lights();
    CompiledScene result;
    result.block = encode_scene(arrays_.view());
    result.scene = decode_scene(result.block.bytes());
    result.notes = description_.notes;
    if (dropped_.count > 0)
      result.notes.add(
          description_.source(dropped_.first),
          fmt::format("{} polygon{} or triangle{} without area, or whose parts cancel each other, "
                      "{} left out; cut what crosses itself into several",
                      dropped_.count, dropped_.count == 1 ? "" : "s", dropped_.count == 1 ? "" : "s",
                      dropped_.count == 1 ? "is" : "are"));
    luminaires_.add_notes(description_, result.notes);
    note_turned_lamps(description_, result.scene, luminaire_places_, result.notes);
    note_turned_spots(description_, result.scene, result.notes);
    if (!result.scene.instances.empty() && is_dark(result.scene, {}))
      result.notes.add(description_.source(),
                       "nothing lights the scene, so pictures of it are black: it has no lights, nothing "
                       "luminous, no background or environment, and no material shows ambient light; add "
                       "`lights`, or a material with a `luminaire`");
    return result;
  }

 private:
  uint32_t add_curve(const Curve& curve) {
    const auto first = static_cast<uint32_t>(arrays_.key_frames.size());
    arrays_.key_frames.insert(arrays_.key_frames.end(), curve.frames.begin(), curve.frames.end());
    arrays_.key_values.insert(arrays_.key_values.end(), curve.values.begin(), curve.values.end());
    arrays_.curves.push_back(
        {static_cast<uint32_t>(curve.interpolation), first, static_cast<uint32_t>(curve.frames.size())});
    return static_cast<uint32_t>(arrays_.curves.size() - 1);
  }

  void add_head() {
    SceneHeader& head = arrays_.header[0];
    const ViewDescription& view = description_.view;
    head.view.location = add_curve(view.location);
    head.view.direction = add_curve(view.direction);
    if (view.look_at) head.view.look_at = add_curve(*view.look_at);
    head.view.up = add_curve(view.up);
    head.view.field_of_view = add_curve(view.field_of_view);
    head.view.focus = add_curve(view.focus);
    head.view.aspect = view.aspect;
    head.view.lens_radius = view.lens_radius;
    head.background = description_.background;
    head.ambient = description_.ambient;
    arrays_.lights = description_.lights;
    for (const DiagramDescription& diagram : description_.diagrams) {
      arrays_.goniometric_diagrams.push_back(diagram);
      arrays_.goniometric_diagrams.back().first_value =
          static_cast<uint32_t>(arrays_.goniometric_values.size());
      arrays_.goniometric_values.insert(arrays_.goniometric_values.end(), diagram.values.begin(),
                                        diagram.values.end());
    }
    for (const MaterialDescription& m : description_.materials) arrays_.materials.push_back(m);
    for (const TextureDescription& t : description_.textures) add_texture(t);
    if (description_.environment) {
      head.environment = add_texture(*description_.environment);
      head.environment_turn = description_.environment_turn;
      arrays_.lights.push_back({.kind = LightKind::environment});
    }
  }

  uint32_t add_texture(const TextureDescription& t) {
    arrays_.textures.push_back(t);
    arrays_.textures.back().first_texel = static_cast<uint32_t>(arrays_.texels.size() / 3);
    arrays_.texels.insert(arrays_.texels.end(), t.texels.begin(), t.texels.end());
    return static_cast<uint32_t>(arrays_.textures.size() - 1);
  }

  void drop(const Place& place) {
    if (dropped_.count++ == 0) dropped_.first = place;
  }

  void add_triangle(PartPrimitives& part, const TriangleVertices& v, const TriangleShading& shading,
                    const Place& place) {
    const Vec3 a(v[0]), b(v[1]), c(v[2]);
    if (max_magnitude(glm::cross(b - a, c - a)) == 0) {
      drop(place);
      return;
    }
    const PrimitiveId id =
        make_primitive_id(PrimitiveKind::triangle, static_cast<uint32_t>(arrays_.triangle_shading.size()));
    part.add_triangle(id, v);
    arrays_.triangle_shading.push_back(shading);
    if (is_luminous(shading.material))
      luminaires_.add_triangles({id, place, shading.material}, std::span(&v, 1));
  }

  void add(PartPrimitives& part, const PrimitiveDescription& p, const SphereShape& sphere) {
    const PrimitiveId id =
        make_primitive_id(PrimitiveKind::sphere, static_cast<uint32_t>(arrays_.spheres.size()));
    part.add(id);
    arrays_.spheres.push_back({sphere.center, sphere.radius, p.material, 0});
    if (is_luminous(p.material)) luminaires_.add_sphere({id, p.place, p.material});
  }

  void add_quadric(PartPrimitives& part, const PrimitiveDescription& p, Quadric quadric,
                   std::span<const Vec4> planes) {
    const std::optional<Box> bounds = quadric_bounds(quadric, planes);
    if (!bounds)
      throw InputError(
          description_.source(p.place),
          "the quadric reaches to infinity; add planes ([nx, ny, nz, d] keeps n·p <= d) that bound it");
    if (bounds->is_empty())
      throw InputError(description_.source(p.place),
                       "nothing is left of the quadric: it has no real points between its planes");
    quadric.bounds = *bounds;
    quadric.first_plane = static_cast<uint32_t>(arrays_.quadric_planes.size());
    quadric.plane_count = static_cast<uint32_t>(planes.size());
    quadric.material = p.material;
    arrays_.quadric_planes.insert(arrays_.quadric_planes.end(), planes.begin(), planes.end());
    part.add(make_primitive_id(PrimitiveKind::quadric, static_cast<uint32_t>(arrays_.quadrics.size())));
    arrays_.quadrics.push_back(quadric);
    if (is_luminous(p.material)) luminaires_.add_quadric(p.place);
  }

  void add(PartPrimitives& part, const PrimitiveDescription& p, const ConeShape& cone) {
    std::array<Vec4, 2> planes;
    const Quadric quadric = make_cone(cone.base, cone.base_radius, cone.apex, cone.apex_radius, planes);
    add_quadric(part, p, quadric, planes);
  }

  void add(PartPrimitives& part, const PrimitiveDescription& p, const QuadricShape& shape) {
    const Quadric about_origin = make_quadric(shape.coefficients, Vec3(0));
    const std::optional<Box> bounds = quadric_bounds(about_origin, shape.planes);
    const Vec3 center = bounds && !bounds->is_empty() ? bounds->center() : Vec3(0);
    add_quadric(part, p, make_quadric(shape.coefficients, center), shape.planes);
  }

  void add(PartPrimitives& part, const PrimitiveDescription& p, const PolygonShape& shape) {
    const auto smoothing = static_cast<uint32_t>(shape.normals.empty() ? Smoothing::flat : shape.smoothing);
    if (shape.points.size() == 3) {  // triangles have a faster test and less to store
      TriangleShading shading{p.material, smoothing, {kNone, kNone, kNone}};
      if (!shape.normals.empty() && shape.smoothing != Smoothing::flat)
        for (size_t i = 0; i < 3; ++i) {
          shading.normals[i] = static_cast<uint32_t>(arrays_.normals.size());
          arrays_.normals.emplace_back(normalized(shape.normals[i]));
        }
      add_triangle(part, {glm::vec3(shape.points[0]), glm::vec3(shape.points[1]), glm::vec3(shape.points[2])},
                   shading, p.place);
      return;
    }
    Polygon polygon;
    polygon.normal = normalized(newell_normal(shape.points));
    if (max_magnitude(polygon.normal) == 0) {
      drop(p.place);
      return;
    }
    Vec3 center(0);
    for (const Vec3& q : shape.points) center += q;
    center /= static_cast<double>(shape.points.size());
    polygon.distance = glm::dot(polygon.normal, center);
    polygon.first_point = static_cast<uint32_t>(arrays_.polygon_points.size());
    polygon.point_count = static_cast<uint32_t>(shape.points.size());
    polygon.smoothing = smoothing;
    polygon.material = p.material;
    polygon.drop_axis = largest_axis(polygon.normal);
    arrays_.polygon_points.insert(arrays_.polygon_points.end(), shape.points.begin(), shape.points.end());
    if (smoothing != static_cast<uint32_t>(Smoothing::flat)) {
      polygon.first_normal = static_cast<uint32_t>(arrays_.polygon_normals.size());
      for (const Vec3& normal : shape.normals) arrays_.polygon_normals.push_back(normalized(normal));
    }
    const PrimitiveId id =
        make_primitive_id(PrimitiveKind::polygon, static_cast<uint32_t>(arrays_.polygons.size()));
    arrays_.polygons.push_back(polygon);
    const std::vector<TriangleVertices> fan = triangle_fan(shape.points, polygon.normal);
    for (const TriangleVertices& triangle : fan) part.add_triangle(id, triangle);
    if (fan.empty()) part.add(id);
    if (!is_luminous(p.material)) return;
    const Luminous luminous{id, p.place, p.material};
    if (fan.empty())
      luminaires_.add_polygon(luminous, polygon, shape.points);
    else
      luminaires_.add_triangles(luminous, fan);
  }

  void add(PartPrimitives& part, const PrimitiveDescription& p, const MeshShape& mesh) {
    const auto first_normal = static_cast<uint32_t>(arrays_.normals.size());
    for (const glm::vec3& n : mesh.normals) arrays_.normals.emplace_back(normalized(Vec3(n)));
    for (size_t i = 0; i < mesh.triangles.size(); ++i) {
      if (i % kPrimitivesPerLook == 0) throw_if_stopped(options_.stop);
      const glm::uvec3& t = mesh.triangles[i];
      TriangleShading shading{mesh.materials.empty() ? p.material : mesh.materials[i],
                              static_cast<uint32_t>(Smoothing::flat),
                              {kNone, kNone, kNone}};
      if (mesh.smoothing != Smoothing::flat && !mesh.triangle_normals.empty() &&
          mesh.triangle_normals[i].x != kNone) {
        shading.smoothing = static_cast<uint32_t>(mesh.smoothing);
        for (size_t k = 0; k < 3; ++k)
          shading.normals[k] = first_normal + mesh.triangle_normals[i][static_cast<int>(k)];
      }
      const size_t before = arrays_.triangle_shading.size();
      add_triangle(part, {mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]}, shading, p.place);
      if (mesh.triangle_uvs.empty() || arrays_.triangle_shading.size() == before) continue;
      arrays_.triangle_uvs.resize(3 * before, glm::vec2(0));  // of meshes before that have none
      for (int k = 0; k < 3; ++k) arrays_.triangle_uvs.push_back(mesh.uvs[mesh.triangle_uvs[i][k]]);
    }
  }

  /// The root and the objects that stand once in the scene, with no transform on the way to them: their
  /// primitives never move against each other, so they are one part.
  std::vector<uint32_t> fixed_objects() const {
    std::vector<uint32_t> uses(description_.objects.size());
    for (const ObjectDescription& object : description_.objects)
      for (const ChildDescription& child : object.children) ++uses[child.object];
    std::vector<uint32_t> fixed{description_.root};
    for (size_t i = 0; i < fixed.size(); ++i)  // grows while it is read
      for (const ChildDescription& child : description_.objects[fixed[i]].children)
        if (child.transform.empty() && uses[child.object] == 1) fixed.push_back(child.object);
    return fixed;
  }

  bool is_luminous(uint32_t material) const { return is_luminaire(arrays_.materials[material]); }

  void add_luminaires() {
    arrays_.luminaire_triangles = luminaires_.triangles();
    arrays_.header[0].first_luminaire = static_cast<uint32_t>(arrays_.lights.size());
    for (uint32_t i = 0; i < arrays_.instances.size(); ++i)
      for (const Luminous& luminous : luminous_of_[arrays_.instances[i].part]) {
        if (luminaire_places_.size() == limits::kLuminaires)
          throw InputError(
              description_.source(luminous.place),
              fmt::format("the scene has more than {} luminous primitives, each of which is a light; make "
                          "lamps of fewer (a sphere, a large polygon), or use fewer copies of them",
                          limits::kLuminaires));
        Light light{.kind = LightKind::luminaire, .instance = i, .primitive = luminous.id};
        light.first_triangle = luminous.first_triangle;
        light.triangle_count = luminous.triangle_count;
        light.material = luminous.material;
        arrays_.lights.push_back(light);
        luminaire_places_.push_back(luminous.place);
      }
  }

  void weigh_lights() {
    Box bounds;
    for (const InstancePose& pose : arrays_.poses) bounds.grow(pose.bounds);
    SceneHeader& head = arrays_.header[0];
    const double radius = bounds.is_empty() ? 1 : std::max(1e-150, 0.5 * glm::length(bounds.extent()));
    head.far_away = 4 * (radius + bounds.magnitude());
    if (head.environment != kNone)
      arrays_.environment_shares =
          make_environment_shares(arrays_.textures[head.environment], arrays_.texels);
    arrays_.light_shares = make_light_shares(arrays_.view(), radius);
  }

  /// Makes the primitives of `objects` one part, which moves with `owner`.
  void add_part(uint32_t owner, std::span<const uint32_t> objects) {
    throw_if_stopped(options_.stop);
    PartPrimitives primitives;
    for (const uint32_t object : objects)
      for (const PrimitiveDescription& p : description_.objects[object].primitives)
        std::visit([&](const auto& shape) { add(primitives, p, shape); }, p.shape);
    if (arrays_.triangle_shading.size() > limits::kPrimitives)
      throw InputError(description_.source(description_.objects[owner].place),
                       "the scene has too many triangles");
    if (primitives.ids.empty()) return;

    Part part;
    part.first_triangle_block = static_cast<uint32_t>(arrays_.triangle_blocks.size());
    part.first_sphere_block = static_cast<uint32_t>(arrays_.sphere_blocks.size());
    part.first_leaf_primitive = static_cast<uint32_t>(arrays_.leaf_primitives.size());
    const PartSource source(arrays_, primitives);
    LeafArrays leaves{arrays_.nodes, arrays_.triangle_blocks, arrays_.sphere_blocks, arrays_.leaf_primitives};
    part.root = build_hierarchy(
        source, options_,
        [&](std::span<const PrimitiveReference> r) {
          throw_if_stopped(options_.stop);
          return pack_leaf(r, primitives, arrays_.spheres, leaves);
        },
        arrays_.nodes);
    part.triangle_block_count =
        static_cast<uint32_t>(arrays_.triangle_blocks.size()) - part.first_triangle_block;
    part.sphere_block_count = static_cast<uint32_t>(arrays_.sphere_blocks.size()) - part.first_sphere_block;
    part.leaf_primitive_count =
        static_cast<uint32_t>(arrays_.leaf_primitives.size()) - part.first_leaf_primitive;
    const std::array<uint32_t*, 4> counts{&part.triangle_count, &part.sphere_count, &part.polygon_count,
                                          &part.quadric_count};  // in the order of PrimitiveKind
    PrimitiveId previous = kNoPrimitive;
    for (uint32_t i = 0; i < primitives.ids.size(); ++i) {
      part.bounds.grow(source.bounds(i));
      const PrimitiveId id = primitives.ids[i];
      if (id == previous) continue;  // another triangle of the same polygon
      previous = id;
      ++*counts[static_cast<size_t>(id.kind())];
    }
    luminous_of_.push_back(luminaires_.take());
    part_of_[owner] = static_cast<uint32_t>(arrays_.parts.size());
    arrays_.parts.push_back(part);
  }

  void expand(uint32_t object, uint32_t parent, std::span<const TransformStep> transform) {
    ObjectNode node;
    node.parent = parent;
    node.first_step = static_cast<uint32_t>(arrays_.steps.size());
    node.step_count = static_cast<uint32_t>(transform.size());
    for (const TransformStep& step : transform) {
      arrays_.steps.push_back(
          {static_cast<uint32_t>(step.kind), curve_of(step.curve), step.axis, step.matrix});
      if (step.curve.is_animated()) arrays_.header[0].is_animated = 1;
    }
    const auto index = static_cast<uint32_t>(arrays_.object_nodes.size());
    arrays_.object_nodes.push_back(node);
    if (part_of_[object] != kNone) arrays_.instances.push_back({index, part_of_[object]});
    if (index % kPrimitivesPerLook == 0) throw_if_stopped(options_.stop);
    for (const ChildDescription& child : description_.objects[object].children)
      expand(child.object, index, child.transform);
  }

  /// Shared objects repeat their curves in every copy; each is stored once.
  uint32_t curve_of(const Curve& curve) {
    const auto found = curve_ids_.find(&curve);
    if (found != curve_ids_.end()) return found->second;
    return curve_ids_[&curve] = add_curve(curve);
  }

  void build_object_part() {
    const Scene scene = arrays_.view();
    const double frame = description_.frames ? (*description_.frames)[0] : 0;
    try {
      arrays_.poses = pose_instances(scene, frame);
    } catch (const std::domain_error& e) {
      throw InputError({description_.files.at(0)}, fmt::format("at frame {}: {}", frame, e.what()));
    }
    const LeafMaker make_leaf = [&](std::span<const PrimitiveReference> references) {
      const auto first = static_cast<uint32_t>(arrays_.leaf_instances.size());
      for (const PrimitiveReference& r : references) arrays_.leaf_instances.push_back(r.primitive);
      return make_child(ChildKind::instances, first, static_cast<uint32_t>(references.size()));
    };
    arrays_.header[0].object_root =
        build_hierarchy(InstanceSource(arrays_.poses), {.max_primitives = 1, .stop = options_.stop},
                        make_leaf, arrays_.object_part_nodes);
  }

  const SceneDescription& description_;
  BuildOptions options_;
  SceneArrays arrays_;
  std::vector<uint32_t> part_of_;
  Luminaires luminaires_;
  std::vector<std::vector<Luminous>> luminous_of_;  ///< by part
  std::vector<Place> luminaire_places_;
  std::map<const Curve*, uint32_t> curve_ids_;
  struct {
    size_t count = 0;
    Place first;
  } dropped_;  ///< what no ray can hit
};

}  // namespace

CompiledScene compile(const SceneDescription& description, const BuildOptions& options) {
  return Compiler(description, options).compile();
}

}  // namespace rayfarm
