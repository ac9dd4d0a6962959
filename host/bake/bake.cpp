#include "host/bake/bake.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "common/errors/input_error.h"
#include "common/image/image_file.h"
#include "common/lighting/zones/zone_mesh.h"
#include "common/math/portable_math.h"
#include "common/scene/camera.h"
#include "host/bake/glb_file.h"

namespace rayfarm {
namespace {

/// Colours of vertices as they are counted.
struct Exposed {
  double factor = 1;
  uint64_t vertices = 0, clipped = 0;
  double brightest = 0;

  glm::vec4 operator()(const Color& radiance) {
    const Color c = factor * radiance;
    const double most = max_component(c);
    ++vertices;
    clipped += most > 1 ? 1 : 0;
    brightest = std::max(brightest, most);
    return {glm::vec3(glm::clamp(c, Color(0), Color(1))), 1};
  }
};

/// Which sides of a grid are in the file: those that shine. What has no light at all is seen from its front.
std::vector<uint32_t> sides_of(const BakedLight& light, const ZoneGrid& grid) {
  std::vector<uint32_t> sides;
  for (uint32_t side = 0; side < 2; ++side)
    if (light.is_lit(grid, side)) sides.push_back(side);
  if (sides.empty()) sides.push_back(0);
  return sides;
}

/// Adds a side's vertices that triangles name.
void add_side(const ZoneMesh& mesh, const BakedLight& light, const ZoneGrid& grid, uint32_t side,
              Exposed& exposed, GlbSurface& surface) {
  std::vector<uint32_t> numbers(mesh.vertices.size(), kNone);
  for (const std::array<uint32_t, 3>& triangle : mesh.triangles)
    for (const size_t i : side == 0 ? std::array<size_t, 3>{0, 1, 2} : std::array<size_t, 3>{0, 2, 1}) {
      uint32_t& number = numbers[triangle[i]];
      if (number == kNone) {
        number = static_cast<uint32_t>(surface.positions.size());
        const ZoneMesh::Vertex& vertex = mesh.vertices[triangle[i]];
        surface.positions.emplace_back(vertex.p);
        surface.colors.push_back(exposed(light.at(grid, vertex.place, side)));
      }
      surface.indices.push_back(number);
    }
}

std::string listed(std::vector<std::string> names) {
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  std::string text;
  for (const std::string& name : names) text += fmt::format("{}'{}'", text.empty() ? "" : ", ", name);
  return text;
}

GlbCamera camera_of(const Scene& scene, const RenderSettings& settings, int frame) {
  const Camera camera = make_camera(scene, frame, settings.width_px, settings.height_px);
  const double width = settings.width_px * glm::length(camera.per_x),
               height = settings.height_px * glm::length(camera.per_y);
  GlbCamera result{camera.location, camera.right, camera.up, 2 * std::atan(0.5 * height), width / height};
  result.near = scene.head().far_away * 1e-5;
  return result;
}

}  // namespace

bool is_bakable(const std::string& path) {
  const std::string extension = extension_of(path);
  return extension == ".glb" || extension == ".exr";
}

Bake::Bake(const std::string& path, const std::string& scene_file, const SceneDescription& description,
           const CompiledScene& compiled, const RenderSettings& settings, int frame)
    : path_(path),
      description_(description),
      compiled_(compiled),
      settings_(settings),
      frame_(frame),
      zones_(compiled.scene, settings, frame) {
  const auto keeps_any = [](const ZoneGrid& grid) { return grid.store.is_any(); };
  const std::span<const ZoneGrid> grids = zones_.map().grids();
  if (std::none_of(grids.begin(), grids.end(), keeps_any))
    throw InputError({scene_file},
                     fmt::format("at frame {} there is nothing to bake: no surface keeps light in zones "
                                 "(mirrors, glass, saddles and planes given as quadrics do not)",
                                 frame));
  if (extension_of(path_) == ".exr") layout_ = lay_out_atlas(zones_.map());
}

std::vector<std::string> Bake::notes() const {
  std::vector<std::string> notes, dark, clear, without;
  for (const ZoneGrid& grid : zones_.map().grids()) {
    if (grid.primitive == kNoPrimitive || grid.store.is_any()) continue;
    (grid.shape == ZoneShape::none                                         ? without
     : is_clear(compiled_.scene, compiled_.scene.materials[grid.material]) ? clear
                                                                           : dark)
        .push_back(material_name(grid.material));
  }
  if (!dark.empty())
    notes.push_back(
        fmt::format("{} surfaces reflect as mirrors alone, and keep no light: they are black ({})",
                    dark.size(), listed(dark)));
  if (!clear.empty())
    notes.push_back(fmt::format(
        "{} surfaces of glass keep no light: they are left out of a .glb, and black in an atlas ({})",
        clear.size(), listed(clear)));
  if (!without.empty())
    notes.push_back(
        fmt::format("{} quadrics are saddles or planes, which have no zones: they are left out ({})",
                    without.size(), listed(without)));
  if (const size_t media = compiled_.scene.media.size(); media > 0)
    notes.push_back(
        fmt::format("{} {} left out: only surfaces can be baked, with the light that came through", media,
                    media == 1 ? "medium is" : "media are"));
  if (has_poses(compiled_.scene))
    notes.push_back(fmt::format("things move, come or go: this is their light at frame {}", frame_));
  return notes;
}

std::string Bake::object_name(uint32_t instance) const {
  const uint32_t object = compiled_.objects[compiled_.scene.instances[instance].object_node];
  const std::string& name = description_.objects[object].name;
  if (!name.empty()) return name;
  return object == description_.root ? "scene" : fmt::format("object {}", object);
}

std::string Bake::material_name(uint32_t material) const {
  const std::string& name = description_.materials[material].name;
  return name.empty() ? fmt::format("material {}", material) : name;
}

std::string Bake::write(std::span<const std::byte> solution, const BakeOptions& options,
                        const std::map<std::string, std::string>& attributes) const {
  const BakedLight light(zones_, decode_zone_solution(solution, zones_.passes(), zones_.slot_count()));
  return layout_ ? write_texels(light, attributes)
                 : write_vertices(light, options.exposure_stops.value_or(0), attributes);
}

std::string Bake::write_vertices(const BakedLight& light, double stops,
                                 const std::map<std::string, std::string>& attributes) const {
  GlbScene file;
  for (uint32_t i = 0; i < description_.materials.size(); ++i) file.materials.push_back(material_name(i));
  Exposed exposed{portable_exp2(stops)};
  // A mesh for each object's surfaces of a material, as instances and materials rise.
  std::map<std::pair<uint32_t, uint32_t>, std::vector<const ZoneGrid*>> groups;
  for (const ZoneGrid& grid : zones_.map().grids()) {
    if (grid.shape == ZoneShape::none) continue;
    if (!grid.store.is_any() && is_clear(compiled_.scene, compiled_.scene.materials[grid.material])) continue;
    groups[{grid.instance, grid.material}].push_back(&grid);
  }
  uint64_t triangles = 0;
  for (const auto& [key, grids] : groups) {
    GlbMesh mesh{fmt::format("{}: {}", object_name(key.first), material_name(key.second)), key.second, {}};
    std::array<GlbSurface, 2> surfaces;
    for (const ZoneGrid* grid : grids) {
      const ZoneMesh cells = mesh_of(zones_.map(), *grid);
      for (const uint32_t side : sides_of(light, *grid))
        add_side(cells, light, *grid, side, exposed, surfaces[side]);
    }
    for (GlbSurface& surface : surfaces) {
      if (surface.indices.empty()) continue;
      for (const glm::vec3& p : surface.positions)
        if (!std::isfinite(p.x + p.y + p.z))
          throw IoError(
              fmt::format("{}: '{}' is farther away than single precision tells", path_, mesh.name));
      triangles += surface.indices.size() / 3;
      mesh.surfaces.push_back(std::move(surface));
    }
    if (!mesh.surfaces.empty()) file.meshes.push_back(std::move(mesh));
  }
  file.camera = camera_of(compiled_.scene, settings_, frame_);
  for (const auto& [name, value] : attributes) file.about[name.substr(name.find('/') + 1)] = value;
  file.about["exposure_stops"] = stops;
  write_glb(path_, file);
  std::string text = fmt::format("{} triangles with {} vertices in {} meshes", triangles, exposed.vertices,
                                 file.meshes.size());
  if (exposed.clipped > 0)
    text += fmt::format("; {} vertices are brighter than 1 and clipped, --exposure {:.2f} holds all",
                        exposed.clipped, std::floor(100 * (stops - std::log2(exposed.brightest))) / 100);
  return text;
}

std::string Bake::write_texels(const BakedLight& light,
                               const std::map<std::string, std::string>& attributes) const {
  AtlasNames names;
  for (uint32_t i = 0; i < compiled_.scene.instances.size(); ++i) names.objects.push_back(object_name(i));
  for (uint32_t i = 0; i < description_.materials.size(); ++i) names.materials.push_back(material_name(i));
  write_atlas(path_, zones_.map(), light, *layout_, names, attributes);
  return fmt::format("{} × {} texels, {} primitives", layout_->width, layout_->height,
                     layout_->rectangles.size());
}

}  // namespace rayfarm
