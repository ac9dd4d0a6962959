#include "common/compile/compile.h"

#include <deque>

#include "common/compile/corners.h"
#include "common/compile/darkness.h"
#include "common/compile/deforming.h"
#include "common/compile/idle_notes.h"
#include "common/compile/libraries.h"
#include "common/compile/lights.h"
#include "common/compile/materials.h"
#include "common/compile/media.h"
#include "common/compile/object_groups.h"
#include "common/compile/objects.h"
#include "common/compile/parts.h"
#include "common/compile/shapes.h"
#include "common/compile/spectra.h"
#include "common/compile/textures.h"
#include "common/errors/input_error.h"
#include "common/hierarchy/cells.h"

namespace rayfarm {
namespace {

void add_view(SceneArrays<GrowingArray>& arrays, const SceneDescription& description) {
  ViewRecord& record = arrays.header[0].view;
  const ViewDescription& view = description.view;
  record.location = add_curve(arrays, view.location);
  record.direction = add_curve(arrays, view.direction);
  if (view.look_at) record.look_at = add_curve(arrays, *view.look_at);
  record.up = add_curve(arrays, view.up);
  record.field_of_view = add_curve(arrays, view.field_of_view);
  record.focus = add_curve(arrays, view.focus);
  record.width = add_curve(arrays, view.width);
  record.projection = view.projection;
  record.shift = view.shift;
  record.near = view.near;
  record.far = view.far;
  record.aspect = view.aspect;
  record.lens_radius = view.lens_radius;
}

/// Those of lights, background and media.
void add_own_spectra(SceneArrays<GrowingArray>& arrays, const SceneDescription& description,
                     Purpose purpose) {
  if (purpose == Purpose::library) return;  // they stay behind with what they are of
  for (const SpectrumDescription& s : description.spectra) add_spectra(arrays, std::span(&s, 1), s.index);
}

/// Leaves of a mesh only what its triangles are built from.
void give_up_corners(MeshShape& mesh) {
  mesh.normals = {};
  mesh.uvs = mesh.second_uvs = {};
  mesh.colors = {};
  mesh.materials = {};
  mesh.triangle_normals = mesh.triangle_uvs = {};
  mesh.polygons = {};
}

template <typename GiveUp>
void for_each_mesh(ObjectDescription& object, GiveUp give_up) {
  for (PrimitiveDescription& p : object.primitives)
    if (auto* mesh = std::get_if<MeshShape>(&p.shape)) give_up(*mesh);
}

/// The parts of a scene as they are made.
class PartCompiler {
 public:
  /// `spent`: the description, if it may be given up, or null.
  PartCompiler(SceneArrays<GrowingArray>& arrays, const SceneDescription& description,
               SceneDescription* spent, const BuildOptions& options, Purpose purpose)
      : arrays_(arrays),
        description_(description),
        spent_(spent),
        options_(options),
        purpose_(purpose),
        shapes_(arrays, luminaires_, description, options.stop),
        libraries_(description.libraries.size()),
        in_use_{std::vector<bool>(description.structures.size()),
                std::vector<bool>(description.objects.size())},
        part_of_(description.objects.size(), kNone) {}

  void add_all() {
    const auto parts = objects_by_parts(description_, purpose_ == Purpose::library);
    add_deforming(parts);
    for (const std::vector<FixedObject>& part : parts)
      if (!is_deforming(part[0].object)) add(part);
    fill_corners(arrays_, arrays_);
  }

  const Luminaires& luminaires() const { return luminaires_; }
  std::span<const std::vector<Luminous>> luminous_of() const { return luminous_of_; }  ///< by part
  std::span<const uint32_t> part_of() const { return part_of_; }                       ///< by object
  /// Of the scene's own part, if objects arrange it.
  std::span<const PlacedObject> placed() const { return placed_; }
  InUse& in_use() { return in_use_; }
  size_t built() const { return built_; }  ///< primitives that were given to the builder
  void add_notes(Notes& notes) const {
    shapes_.add_notes(notes);
    if (structured_ > 0 || (!deforming_.empty() && options_.hierarchy != Hierarchy::sah))
      notes.add(
          description_.source(description_.objects[deforming_[0]].place),
          "what changes its shape from frame to frame has volumes by the surface area heuristic (`sah`), "
          "whatever hierarchy was asked for: they can be refitted");
    luminaires_.add_notes(description_, notes);
    for (size_t i = 0; i < in_use_.structures.size(); ++i)
      if (!in_use_.structures[i])
        notes.add(
            description_.source(description_.structures[i].place),
            "this structure arranges nothing: it acts on shapes and meshes that stand here and do not move "
            "against each other; what moves, and what is used several times, has a structure of its own");
  }

 private:
  bool is_deforming(uint32_t object) const {
    return std::binary_search(deforming_.begin(), deforming_.end(), object);
  }

  /// Those of objects that change their shape.
  void add_deforming(std::span<const std::vector<FixedObject>> parts) {
    for (const std::vector<FixedObject>& part : parts) {
      const ObjectDescription& object = description_.objects[part[0].object];
      if (!changes_shape(description_, object)) continue;
      if (purpose_ == Purpose::library)
        throw InputError(
            description_.source(object.place),
            fmt::format("'{}' changes its shape from frame to frame (by a skin or morph targets), and a "
                        "file of compiled objects can't hold that; use the scene itself",
                        object.name));
      deforming_.push_back(part[0].object);
      if (object.structure == kNone) continue;
      in_use_.structures[object.structure] = true;
      ++structured_;
    }
    std::sort(deforming_.begin(), deforming_.end());
    add_deforming_parts(arrays_, description_, deforming_, options_, part_of_, [&](uint32_t object) {
      for (const PrimitiveDescription& p : description_.objects[object].primitives)
        if (shines(std::get<MeshShape>(p.shape), p.material)) luminaires_.add_deforming(p.place);
      if (spent_) for_each_mesh(spent_->objects[object], [](MeshShape& mesh) { mesh = {}; });
    });
    for (const DeformingPart& part : arrays_.deforming_parts) built_ += part.triangle_count;
    luminous_of_.resize(arrays_.parts.size());
  }

  bool shines(const MeshShape& mesh, uint32_t material) const {
    const auto is_luminous = [&](uint32_t m) {
      return is_luminaire(arrays_.materials[m]) && !arrays_.materials[m].is_no_lamp;
    };
    return mesh.materials.empty() ? is_luminous(material)
                                  : std::any_of(mesh.materials.begin(), mesh.materials.end(), is_luminous);
  }

  /// Makes the primitives of `objects` one part, which moves with the first.
  void add(const std::vector<FixedObject>& objects) {
    const uint32_t owner = objects[0].object;
    throw_if_stopped(options_.stop);
    if (const std::optional<BuiltPart>& built = description_.objects[owner].built) {
      part_of_[owner] = place(built->library, description_.objects[owner].place) + built->part;
      return;
    }
    // An object with a structure of its own is a collection in the one that it is in.
    std::vector<PrimitiveGroup> groups{{.structure = description_.objects[owner].structure, .owner = owner}};
    std::vector<size_t> group_of(objects.size());
    for (size_t i = 0; i < objects.size(); ++i) {
      const ObjectDescription& object = description_.objects[objects[i].object];
      group_of[i] = group_of[objects[i].parent];
      if (object.structure != kNone && object.structure != groups[group_of[i]].structure) {
        groups.push_back({.parent = group_of[i],
                          .structure = object.structure,
                          .owner = objects[i].object,
                          .owner_in = objects[objects[i].parent].object});
        group_of[i] = groups.size() - 1;
      }
      add(groups[group_of[i]], objects[i].object, objects[objects[i].parent].object);
    }
    if (arrays_.triangle_shading.size() > limits::kPrimitives ||
        arrays_.face_corners.size() > limits::kFaceCorners)
      throw InputError(description_.source(description_.objects[owner].place),
                       "the scene has too many triangles or corners of faces");
    if (std::all_of(groups.begin(), groups.end(),
                    [](const PrimitiveGroup& g) { return g.primitives.ids.empty(); }))
      return;
    for (const PrimitiveGroup& g : groups) built_ += g.primitives.ids.size();
    part_of_[owner] = static_cast<uint32_t>(arrays_.parts.size());
    const bool is_placed = owner == description_.root && purpose_ == Purpose::pictures &&
                           groups[0].structure == kNone && options_.hierarchy == Hierarchy::object;
    try {
      arrays_.parts.push_back(
          build_part(arrays_, groups, description_, options_, in_use_, is_placed ? &placed_ : nullptr));
    } catch (const TooManyCells& e) {
      throw InputError(description_.source(description_.objects[owner].place), e.what());
    }
    luminous_of_.push_back(luminaires_.take());
    if (spent_)
      for (const FixedObject& o : objects)
        for_each_mesh(spent_->objects[o.object], [](MeshShape& mesh) {
          mesh.positions = {};
          mesh.triangles = {};
          mesh.deformation = nullptr;
        });
    still_.clear();
  }

  /// Adds what is described of an object to the group: one object of it, but of what stands in the scene
  /// itself each shape.
  void add(PrimitiveGroup& group, uint32_t object, uint32_t parent) {
    const auto count = [&] { return static_cast<uint32_t>(group.primitives.ids.size()); };
    GroupObject described{object, object == group.owner ? kNone : parent, count(), 0};
    const bool are_apart = object == description_.root && purpose_ == Purpose::pictures;
    for (const PrimitiveDescription& p : description_.objects[object].primitives) {
      const auto* mesh = std::get_if<MeshShape>(&p.shape);
      if (mesh && mesh->deformation)
        shapes_.add(group.primitives, still_.emplace_back(make_still(description_, p)));
      else
        shapes_.add(group.primitives, p);
      if (!are_apart) continue;
      described.count = count() - described.first;
      group.objects.push_back(described);
      described.first = count();
    }
    described.count = count() - described.first;
    if (!are_apart || group.objects.empty()) group.objects.push_back(described);
    if (spent_) for_each_mesh(spent_->objects[object], give_up_corners);
  }

  /// Adds a library's parts when the first of them is met; returns where they begin.
  uint32_t place(uint32_t library, const Place& place) {
    std::optional<uint32_t>& first_part = libraries_[library];
    if (first_part) return *first_part;
    const Scene& more = description_.libraries[library].scene;
    if (more.triangle_shading.size() > limits::kPrimitives - arrays_.triangle_shading.size() ||
        more.face_corners.size() > limits::kFaceCorners - arrays_.face_corners.size())
      throw InputError(description_.source(place),
                       "the scene has too many triangles or corners of faces, those of part files counted");
    PlacedLibrary placed = append_library(arrays_, description_.libraries[library], place, luminaires_);
    for (std::vector<Luminous>& luminous : placed.luminous_of) luminous_of_.push_back(std::move(luminous));
    first_part = placed.first_part;
    return *first_part;
  }

  SceneArrays<GrowingArray>& arrays_;
  const SceneDescription& description_;
  SceneDescription* spent_;
  const BuildOptions& options_;
  Purpose purpose_;
  Luminaires luminaires_;
  ShapeCompiler shapes_;
  size_t built_ = 0;
  std::vector<std::optional<uint32_t>> libraries_;  ///< where the parts of each begin, once they are there
  InUse in_use_;
  std::vector<uint32_t> deforming_;  ///< objects, in order
  size_t structured_ = 0;            ///< of them, that ask for a structure
  std::deque<PrimitiveDescription>
      still_;  ///< meshes whose skin or targets never change, until they are built
  std::vector<PlacedObject> placed_;
  std::vector<uint32_t> part_of_;
  std::vector<std::vector<Luminous>> luminous_of_;
};

CompiledScene compile_scene(const SceneDescription& description, SceneDescription* spent,
                            const BuildOptions& options, Purpose purpose) {
  SceneArrays<GrowingArray> arrays;
  arrays.header.resize(1);
  arrays.header[0].background = description.background;
  arrays.header[0].ambient = description.ambient;
  if (purpose == Purpose::pictures) {
    arrays.header[0].has_last_hit = options.has_last_hit ? 1 : 0;
    arrays.header[0].ray_coherence = glm::radians(options.ray_coherence);
  }
  for (const TextureDescription& t : description.textures) add_texture(arrays, t);
  add_materials(arrays, description);
  add_own_spectra(arrays, description, purpose);
  add_listed_lights(arrays, description);
  if (purpose == Purpose::library)
    arrays.lights.clear();
  else
    add_media(arrays, description);
  PartCompiler parts(arrays, description, spent, options, purpose);
  parts.add_all();
  LightPlaces places;
  ObjectTree tree(arrays, description, parts.part_of(), options.stop);
  places.in_objects = tree.expand();
  add_view(arrays, description);  // the last curves: all else is the same whoever looks
  build_object_part(arrays, description, options.stop);
  if (options.hierarchy == Hierarchy::object && purpose == Purpose::pictures)
    arrays.header[0].object_tree = build_scene_objects(arrays, description, tree.objects(), parts.placed(),
                                                       options.objects, parts.in_use());
  if (purpose == Purpose::pictures) add_environment(arrays, description);
  places.luminaires = add_luminaires(arrays, description, parts.luminaires(), parts.luminous_of());
  weigh_lights(arrays);

  CompiledScene result;
  result.block = encode_scene(std::move(arrays));
  result.scene = decode_scene(result.block.bytes());
  result.objects.assign(tree.objects().begin(), tree.objects().end());
  result.notes = description.notes;
  parts.add_notes(result.notes);
  add_notes_of_idle(description, options, purpose, result.scene, parts.built(), parts.in_use(), result.notes);
  if (purpose == Purpose::pictures) add_notes_of_darkness(description, result.scene, places, result.notes);
  return result;
}

}  // namespace

CompiledScene compile(const SceneDescription& description, const BuildOptions& options, Purpose purpose) {
  return compile_scene(description, nullptr, options, purpose);
}

CompiledScene compile_away(SceneDescription& description, const BuildOptions& options, Purpose purpose) {
  return compile_scene(description, &description, options, purpose);
}

}  // namespace rayfarm
