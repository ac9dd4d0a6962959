#include <fmt/core.h>

#include "common/description/formats/gltf/animation.h"
#include "common/description/primitive_counts.h"
#include "common/description/scene_bounds.h"
#include "common/hierarchy/bounding_tree.h"
#include "common/hierarchy/frame_state.h"
#include "common/hierarchy/storage.h"
#include "common/lighting/zones/zone_scene.h"
#include "common/scene/references.h"
#include "host/commands/commands.h"
#include "host/commands/compile_and_look.h"
#include "host/commands/hierarchy_options.h"
#include "host/commands/load_options.h"
#include "host/commands/zone_options.h"
#include "host/process/exit_code.h"

namespace rayfarm {
namespace {

std::string amount(uint64_t count, const char* what) {
  return count == 0 ? "" : fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

std::string text_of(const PrimitiveCounts& counts) {
  std::string text;
  for (const std::string& kind : {amount(counts.polygons, "polygon"), amount(counts.spheres, "sphere"),
                                  amount(counts.quadrics, "quadric")})
    if (!kind.empty()) text += (text.empty() ? "" : ", ") + kind;
  return text;
}

/// Of parts of the print-out that name one thing a line.
constexpr size_t kMostLines = 60;

/// False when it has said that the rest is left out.
bool take_line(size_t& lines_left) {
  if (lines_left == 0) return false;
  if (--lines_left == 0) fmt::print("  …\n");
  return lines_left > 0;
}

std::string text_of(const Box& box) {
  return fmt::format("x {:g} to {:g}, y {:g} to {:g}, z {:g} to {:g}", box.lo.x, box.hi.x, box.lo.y, box.hi.y,
                     box.lo.z, box.hi.z);
}

/// Of objects and groups in a mesh's file.
void print_names(const MeshShape& mesh, size_t depth, size_t& lines_left) {
  for (const NamedFaces& name : mesh.names) {
    if (!take_line(lines_left)) return;
    fmt::print("  {:{}}{}: faces {}\n", "", 2 * depth, name.name, name.faces);
  }
}

void print_tree(const SceneDescription& scene, const std::vector<Box>& bounds, uint32_t object, size_t depth,
                size_t& lines_left) {
  if (!take_line(lines_left)) return;
  const ObjectDescription& o = scene.objects[object];
  fmt::print("  {:{}}{}{}{}{}\n", "", 2 * depth, o.name,
             o.primitives.empty() && !o.built ? "" : ": " + text_of(count_primitives(scene, o)),
             o.children.empty()
                 ? ""
                 : fmt::format(" ({} child{})", o.children.size(), o.children.size() == 1 ? "" : "ren"),
             bounds[object].is_empty() ? "" : "; " + text_of(bounds[object]));
  for (const PrimitiveDescription& p : o.primitives)
    if (const auto* mesh = std::get_if<MeshShape>(&p.shape)) print_names(*mesh, depth + 1, lines_left);
  for (const ChildDescription& child : o.children)
    print_tree(scene, bounds, child.object, depth + 1, lines_left);
}

/// What `--clip` and `--camera` may ask for.
void print_clips_and_cameras(const SceneDescription& scene, double fps) {
  const auto of_file = [&](const std::string& file) {
    return file == scene.files.at(0) ? "" : fmt::format(", of {}", file);
  };
  const auto quoted = [](const std::string& name) {
    return name.empty() ? std::string("without a name") : fmt::format("'{}'", name);
  };
  if (!scene.clips.empty()) fmt::print("clips (--clip takes the name or the number)\n");
  size_t lines = kMostLines;
  for (const ClipDescription& clip : scene.clips) {
    if (!take_line(lines)) break;
    fmt::print("  {} {}: {}{}{}\n", clip.number, quoted(clip.name),
               clip.last_s ? fmt::format("{:g} s, frames 0 to {} at {:g} a second", *clip.last_s,
                                         last_frame_of(*clip.last_s * fps), fps)
                           : "the file does not tell how long",
               clip.is_played ? ", the one that plays" : "", of_file(clip.file));
  }
  if (!scene.cameras.empty()) fmt::print("cameras (--camera takes the name or the number)\n");
  lines = kMostLines;
  for (const CameraDescription& camera : scene.cameras) {
    if (!take_line(lines)) break;
    fmt::print("  {} {}{}{}\n", camera.number, quoted(camera.name), camera.is_view ? ": the view" : "",
               of_file(camera.file));
  }
}

/// Their colours are the factors of textures, where they have some.
void print_materials(const SceneDescription& scene) {
  fmt::print("materials\n");
  size_t lines = kMostLines;
  for (const MaterialDescription& m : scene.materials) {
    if (!take_line(lines)) return;
    std::vector<uint32_t> textures;
    const auto add = [&](uint32_t texture) {
      if (texture != kNone && std::find(textures.begin(), textures.end(), texture) == textures.end())
        textures.push_back(texture);
    };
    add(m.texture);
    add(m.bump);
    if (m.kind == MaterialKind::principled)
      for (const PrincipledSource& source : scene.principled[m.principled].sources) add(source.texture);
    std::string names;
    for (const uint32_t texture : textures)
      names += (names.empty() ? "; " : ", ") + scene.textures[texture].name;
    fmt::print("  {}: {}, colour {:.3g} {:.3g} {:.3g}{}{}\n", m.name,
               kMaterialKindWords[static_cast<size_t>(m.kind)], m.color.x, m.color.y, m.color.z,
               m.emission == Color(0)
                   ? ""
                   : fmt::format(", shines {:.3g} {:.3g} {:.3g}", m.emission.x, m.emission.y, m.emission.z),
               names);
  }
}

void print_textures(const SceneDescription& scene) {
  if (scene.textures.empty()) return;
  fmt::print("textures\n");
  size_t lines = kMostLines;
  for (const TextureDescription& t : scene.textures) {
    if (!take_line(lines)) return;
    std::string size;
    if (t.kind == TextureKind::image) size = fmt::format(" {}×{}", t.width_px, t.height_px);
    if (t.kind == TextureKind::array) size = fmt::format(" {}×{}×{}", t.width_px, t.height_px, t.depth_px);
    fmt::print("  {}: {}{}\n", t.name, kTextureKindWords[static_cast<size_t>(t.kind)], size);
  }
}

std::string megabytes(size_t bytes) {
  return fmt::format("{:.2f} MiB", static_cast<double>(bytes) / (1 << 20));
}

/// How often volumes refer to primitives, and to how many.
void print_references(const Scene& scene) {
  std::vector<uint32_t> references;
  for_each_reference(scene, [&](PrimitiveId id) { references.push_back(id.bits); });
  if (references.empty()) return;
  const size_t count = references.size();
  std::sort(references.begin(), references.end());
  references.erase(std::unique(references.begin(), references.end()), references.end());
  fmt::print("  references of volumes to primitives {}, {:.3f} each\n", count,
             static_cast<double>(count) / static_cast<double>(references.size()));
}

/// What frames make of meshes that change their shape.
void print_shapes(const Scene& scene) {
  if (scene.deforming_parts.empty()) return;
  fmt::print(
      "  parts that change their shape {}: triangles {}, vertices {}, bones {}, morph targets {}; a process "
      "holds "
      "{} of them for a frame\n",
      scene.deforming_parts.size(), scene.deforming_triangles.size(), scene.deforming_vertices.size() - 1,
      scene.bones.size(), scene.morph_weights.size(), megabytes(deformed_bytes(scene)));
}

/// What cells weigh as the thesis counts it.
void print_cells(const Scene& scene) {
  const GridStorage grids = storage_of_grids(scene);
  if (!scene.grids.empty())
    fmt::print("  cells of `regular` {}, of them {} empty, pointers {}: {} bytes by the thesis's Table 4.5\n",
               grids.empty_cells + grids.full_cells, grids.empty_cells, grids.pointers, grids.bytes());
  const OctreeStorage octrees = storage_of_octrees(scene);
  if (!scene.octrees.empty())
    fmt::print("  nodes of `adaptive` {}, pointers {}: {} bytes by the thesis's Table 4.5\n", octrees.nodes,
               octrees.pointers, octrees.bytes());
  const auto growing = std::count_if(scene.octrees.begin(), scene.octrees.end(), [](const Octree& octree) {
    return octree.build == OctreeBuild::tracing;
  });
  if (growing > 0)
    fmt::print("  {} of these octrees {} built while rays are traced, and counted here as before the first\n",
               growing, growing == 1 ? "is" : "are");
  const OctantStorage octants = storage_of_octants(scene);
  if (!scene.octant_trees.empty())
    fmt::print(
        "  spheres of `thesis` {} about interior volumes, {} about leaves, pointers {}, at most {} in a "
        "leaf: {} bytes "
        "by the thesis's Table 4.5\n",
        octants.interior, octants.leaves, octants.pointers, octants.longest_list, octants.bytes());
}

void print_media(const Scene& scene) {
  if (scene.media.empty()) return;
  const auto grids = std::count_if(scene.media.begin(), scene.media.end(),
                                   [](const ParticipatingMedium& medium) { return medium.has_grid(); });
  fmt::print("  media {}, of them {} with a grid: {} cells, {} bytes with the majorants of their blocks\n",
             scene.media.size(), grids, scene.medium_densities.size(),
             scene.medium_densities.size_bytes() + scene.medium_majorants.size_bytes());
}

/// What `--lighting zonal` would make of the scene.
void print_zones(const Scene& scene, const ZoneSettings& settings, int frame) {
  RenderSettings zonal;
  zonal.lighting = LightingModel::zonal;
  zonal.zones = settings;
  fmt::print("zones (of --lighting zonal, with --zone-size {})\n",
             settings.size > 0 ? fmt::format("{:g}", settings.size) : "chosen");
  try {
    const ZoneScene zones(scene, zonal, frame);
    const ZoneMap& map = zones.map();
    uint64_t primitives = 0, without = 0, kept_by_direction = 0;
    for (const ZoneGrid& grid : map.grids()) {
      if (grid.primitive == kNoPrimitive) continue;
      ++primitives;
      if (!grid.store.is_any()) ++without;
      if (grid.store.direction_cells > 0) kept_by_direction += grid.cell_count;
    }
    fmt::print("  size {:g}, zones of surfaces {} with two sides each, of media {}\n", map.size(),
               map.cell_count(), zones.media().cell_count());
    fmt::print("  of primitives, each copy counted, {}; zones of {} keep nothing\n", primitives, without);
    fmt::print("  sums of power {}; zones that keep light by direction {}\n", zones.slot_count(),
               kept_by_direction);
    fmt::print("  memory on the host, at the most {}\n", megabytes(zones.most_bytes()));
  } catch (const std::runtime_error& e) {
    fmt::print("  none: {}\n", e.what());
  }
}

int print_info(const std::string& path, const LoadOptions& load, const BuildOptions& build,
               const ZoneSettings& zones) {
  const SceneDescription scene = load_scene(path, load);
  const CompiledScene compiled = compile_and_look(scene, build);
  const Scene& s = compiled.scene;
  fmt::print("files\n");
  for (const std::string& file : scene.files) fmt::print("  {}\n", file);
  const size_t triangles = s.triangle_shading.size(), others = s.polygons.size() + s.mesh_faces.size();
  fmt::print(
      "counts\n  polygons {} (triangles {}, of more corners {}), spheres {}, quadrics {}, stored once\n",
      triangles + others, triangles, others, s.spheres.size(), s.quadrics.size());
  const PrimitiveCounts copies = count_copies(scene);
  fmt::print("  polygons {}, spheres {}, quadrics {}, each copy counted\n", copies.polygons, copies.spheres,
             copies.quadrics);
  fmt::print("  parts {}, instances {}, object nodes {}, lights {}, materials {}\n", s.parts.size(),
             s.instances.size(), s.object_nodes.size(), s.lights.size(), s.materials.size());
  print_shapes(s);
  print_media(s);
  print_references(s);
  if (s.head().object_tree != kNone) {
    const ObjectSizes sizes = sizes_of(s, s.bounding_trees[s.head().object_tree]);
    fmt::print("  nodes of objects and groups {}, pointers {}; by the thesis's formula {} bytes\n",
               sizes.nodes, sizes.pointers, sizes.bytes());
  }
  print_cells(s);
  const bool moves = std::any_of(s.steps.begin(), s.steps.end(), [&](const TransformStepRecord& step) {
    return s.curves[step.curve].key_count > 1;
  });
  if (scene.frames)
    fmt::print("  frames {} to {}{}{}{}\n", (*scene.frames)[0], (*scene.frames)[1],
               moves ? ", objects move" : "", s.deforming_parts.empty() ? "" : ", shapes change",
               has_changing_links(s) ? ", objects come and go" : "");
  print_clips_and_cameras(scene, load.fps);
  Box box;
  for (const InstancePose& pose : s.poses)
    if (!pose.is_hidden) box.grow(pose.bounds);
  if (!box.is_empty()) fmt::print("bounds\n  {}\n", text_of(box));
  if (!scene.render.empty()) fmt::print("render, where the command line says nothing else\n");
  for (const RenderChoice& choice : scene.render) fmt::print("  {} {}\n", choice.name, choice.value);
  print_zones(s, zones, scene.frames ? (*scene.frames)[0] : 0);
  print_materials(scene);
  print_textures(scene);
  fmt::print("object tree\n");
  size_t lines = kMostLines;
  print_tree(scene, bounds_of_objects(scene), scene.root, 0, lines);
  fmt::print("memory (the block that load data carries)\n");
  for_each_array(s, [&]<typename T>(const char* name, std::span<const T> array) {
    if (array.size_bytes() >= 1024)
      fmt::print("  {:<18} {:>10} × {:>3} bytes  {:>12}\n", name, array.size(), sizeof(T),
                 megabytes(array.size_bytes()));
  });
  fmt::print("  {:<18} {:>30}\n", "in all", megabytes(compiled.block.size));
  return kComplete;
}

}  // namespace

void add_info_command(CommandLine& line) {
  const auto path = std::make_shared<std::string>();
  const auto load = std::make_shared<LoadOptions>();
  const auto build = std::make_shared<BuildOptions>();
  const auto zones = std::make_shared<ZoneSettings>();
  Verb verb;
  verb.name = "info";
  verb.help = "print counts, clips, cameras, bounds, zones, materials, textures, objects and memory";
  verb.examples = {
      {"rayfarm info model.obj", "how many polygons it has, how large it is, and what it takes"}};
  verb.run = [path, load, build, zones](const Renders&) { return print_info(*path, *load, *build, *zones); };
  Options options = line.add(std::move(verb));
  options.text("SCENE", *path, kSceneKinds).required();
  add_load_options(options, *load);
  options.begin_group("Hierarchy");
  add_hierarchy_options(options, *build);
  options.begin_group("Zones");
  add_zone_size_options(options, *zones);
}

}  // namespace rayfarm
