#include "common/compile/compile.h"

#include "common/compile/corners.h"
#include "common/compile/darkness.h"
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
#include "common/hierarchy/ray_coherence.h"
#include "common/scene/references.h"

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

/// The parts of a scene as they are made.
class PartCompiler {
 public:
  PartCompiler(SceneArrays<GrowingArray>& arrays, const SceneDescription& description,
               const BuildOptions& options, Purpose purpose)
      : arrays_(arrays),
        description_(description),
        options_(options),
        purpose_(purpose),
        shapes_(arrays, luminaires_, description, options.stop),
        libraries_(description.libraries.size()),
        in_use_{std::vector<bool>(description.structures.size()),
                std::vector<bool>(description.objects.size())},
        part_of_(description.objects.size(), kNone) {}

  void add_all() {
    for (const std::vector<FixedObject>& part : objects_by_parts(description_, purpose_ == Purpose::library))
      add(part);
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
    luminaires_.add_notes(description_, notes);
    for (size_t i = 0; i < in_use_.structures.size(); ++i)
      if (!in_use_.structures[i])
        notes.add(
            description_.source(description_.structures[i].place),
            "this structure arranges nothing: it acts on shapes and meshes that stand here and do not move "
            "against each other; what moves, and what is used several times, has a structure of its own");
  }

 private:
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
  }

  /// Adds what is described of an object to the group: one object of it, but of what stands in the scene
  /// itself each shape.
  void add(PrimitiveGroup& group, uint32_t object, uint32_t parent) {
    const auto count = [&] { return static_cast<uint32_t>(group.primitives.ids.size()); };
    GroupObject described{object, object == group.owner ? kNone : parent, count(), 0};
    const bool are_apart = object == description_.root && purpose_ == Purpose::pictures;
    for (const PrimitiveDescription& p : description_.objects[object].primitives) {
      shapes_.add(group.primitives, p);
      if (!are_apart) continue;
      described.count = count() - described.first;
      group.objects.push_back(described);
      described.first = count();
    }
    described.count = count() - described.first;
    if (!are_apart || group.objects.empty()) group.objects.push_back(described);
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
  const BuildOptions& options_;
  Purpose purpose_;
  Luminaires luminaires_;
  ShapeCompiler shapes_;
  size_t built_ = 0;
  std::vector<std::optional<uint32_t>> libraries_;  ///< where the parts of each begin, once they are there
  InUse in_use_;
  std::vector<PlacedObject> placed_;
  std::vector<uint32_t> part_of_;
  std::vector<std::vector<Luminous>> luminous_of_;
};

/// What a scene says that is none of its objects' business.
void add_notes_of_idle(const SceneDescription& description, Notes& notes) {
  std::string idle;
  const auto list = [&idle](bool is_there, const char* key) {
    if (is_there) idle += fmt::format("{}`{}`", idle.empty() ? "" : ", ", key);
  };
  list(description.has_view, "view");
  list(!description.lights.empty(), "lights");
  list(description.environment.has_value(), "environment");
  list(description.background != Color(0), "background");
  list(description.ambient != Color(1), "ambient");
  list(!description.media.empty(), "media");
  if (!idle.empty())
    notes.add(
        description.source(),
        fmt::format(
            "{}: left out, as they belong to a scene and not to its objects (a light that belongs to an "
            "object is `light:` in its tree)",
            idle));
}

/// True if no option of octrees was given.
bool is_usual_octree(const BuildOptions& options) {
  const BuildOptions usual;
  return options.octree_data == usual.octree_data && options.octree_next == usual.octree_next &&
         options.octree_build == usual.octree_build && options.octree_depth == usual.octree_depth &&
         options.octree_hash == usual.octree_hash;
}

/// What options can't change.
void add_notes_of_built(const SceneDescription& description, const BuildOptions& options, Notes& notes) {
  const BuildOptions usual;
  if (description.libraries.empty() ||
      (options.hierarchy == usual.hierarchy && options.max_primitives == usual.max_primitives &&
       options.quality == usual.quality && options.cells == usual.cells && is_usual_octree(options) &&
       !options.has_mailbox && options.thesis == usual.thesis && options.objects == usual.objects))
    return;
  notes.add({description.libraries[0].path},
            "its volumes stay as they were built; how hierarchies are built acts on the rest of the scene");
}

/// Of several elements, itself or where a chain of single ones ends.
bool is_group(const SceneDescription& description, const ObjectDescription& object) {
  const ObjectDescription* o = &object;
  while (o->primitives.empty() && o->children.size() == 1) o = &description.objects[o->children[0].object];
  return o->children.size() + (o->primitives.empty() ? 0 : 1) > 1;
}

/// Bounding volumes that no hierarchy has.
void add_notes_of_idle_bounds(const SceneDescription& description, const BuildOptions& options,
                              const InUse& in_use, Notes& notes) {
  std::vector<const ObjectDescription*> idle, idle_groups, idle_users;
  for (size_t i = 0; i < description.objects.size(); ++i) {
    const ObjectDescription& object = description.objects[i];
    if (object.bound.empty()) continue;
    const BuildOptions& own =
        object.structure == kNone ? options : description.structures[object.structure].build;
    const bool is_of_objects = own.hierarchy == Hierarchy::object;
    if (is_of_objects && own.objects.clusters != Clusters::groups && is_group(description, object))
      idle_groups.push_back(&object);
    else if (!in_use.bounds[i])
      (is_of_objects || options.hierarchy == Hierarchy::object ? idle_users : idle).push_back(&object);
  }
  const auto add = [&](const std::vector<const ObjectDescription*>& objects, const char* what,
                       const char* why) {
    if (!objects.empty())
      notes.add(description.source(objects[0]->bound_place),
                fmt::format("`bound` of {} {}{} changes nothing here: {}", objects.size(), what,
                            objects.size() == 1 ? "" : "s", why));
  };
  add(idle, "object", "it belongs to an `object` hierarchy");
  add(idle_groups, "group", "the scene's groups were not asked for as clusters");
  add(idle_users, "object",
      "what it has is used in several places or moves by itself, and has the volumes of the objects that are "
      "used; or a group of one has the volumes of its element; or it has nothing");
}

/// How rays are traced, where that changes nothing.
void add_notes_of_tracing(const SceneDescription& description, const BuildOptions& options, Purpose purpose,
                          const Scene& scene, Notes& notes) {
  if (purpose == Purpose::library) {
    if (options.has_last_hit || options.ray_coherence > 0)
      notes.add(description.source(),
                "`--last-hit` and `--ray-coherence` act while pictures are traced, and change nothing here");
    return;
  }
  if (options.ray_coherence == 0) return;
  const std::vector<Candidate> candidates = candidates_of(scene);
  const auto wholes =
      std::count_if(candidates.begin(), candidates.end(), [](const Candidate& c) { return c.is_whole; });
  if (candidates.empty())
    notes.add(
        description.source(),
        fmt::format("`--ray-coherence` changes nothing here: it lists primitives that never move, {} of them "
                    "at most, and in an `object` hierarchy at most {} that never move against each other",
                    kMostCandidates, kMostPrimitivesApart));
  else if (wholes > 0)
    notes.add(
        description.source(),
        fmt::format("of `--ray-coherence`: {} part{} of more than {} primitives that never move against "
                    "each other {} listed as {}, in which rays are searched in the usual way",
                    wholes, wholes == 1 ? "" : "s", kMostPrimitivesApart, wholes == 1 ? "is" : "are",
                    wholes == 1 ? "a whole" : "wholes"));
}

/// Options of hierarchies that are not the one that was asked for.
void add_notes_of_idle_options(const SceneDescription& description, const BuildOptions& options,
                               Purpose purpose, const Scene& scene, size_t built, const InUse& in_use,
                               Notes& notes) {
  const BuildOptions usual;
  const Hierarchy h = options.hierarchy;
  if (h != Hierarchy::sah && options.quality != usual.quality)
    notes.add(description.source(),
              "a fast or a high build belongs to volumes by the surface area heuristic (`sah`), and changes "
              "nothing here");
  if (h != Hierarchy::sah && h != Hierarchy::thesis && h != Hierarchy::adaptive &&
      options.max_primitives != usual.max_primitives)
    notes.add(description.source(),
              "how many primitives a volume holds changes nothing here, as there are no volumes");
  if (h != Hierarchy::regular && options.cells != usual.cells)
    notes.add(description.source(),
              "a number of cells belongs to a `regular` hierarchy, and changes nothing here");
  if (h != Hierarchy::object && !(options.objects == usual.objects))
    notes.add(
        description.source(),
        "how objects are bounded, clustered and sorted belongs to an `object` hierarchy, and changes nothing "
        "here");
  if (h == Hierarchy::object && options.objects.bounds_for == BoundsFor::eye &&
      (options.objects.bounds != BoundChoice::best || purpose == Purpose::library))
    notes.add(description.source(),
              "what the eye sees of bounding volumes changes nothing here: it chooses the `best` of a scene");
  add_notes_of_idle_bounds(description, options, in_use, notes);
  if (h != Hierarchy::adaptive && !is_usual_octree(options))
    notes.add(description.source(),
              "options of octrees belong to an `adaptive` hierarchy, and change nothing here");
  if (h == Hierarchy::adaptive && options.octree_data != OctreeData::hash &&
      options.octree_hash != usual.octree_hash)
    notes.add(description.source(),
              "the places of a hash table change nothing here, as pointers lead to the data");
  if (h != Hierarchy::thesis && !(options.thesis == usual.thesis))
    notes.add(
        description.source(),
        "how volumes are bounded, clipped and centred belongs to a `thesis` hierarchy, and changes nothing "
        "here");
  const bool has_octants = h == Hierarchy::thesis && options.thesis.volumes == ThesisVolumes::spheres;
  if (h != Hierarchy::regular && h != Hierarchy::adaptive && !has_octants && options.has_mailbox)
    notes.add(
        description.source(),
        "a mailbox belongs to cells (`regular`, `adaptive`) and to the spheres of `thesis`, and changes "
        "nothing here");
  // Of what is arranged otherwise, part files and structures, nobody knows here how often it is referred to.
  if (h == Hierarchy::sah && options.quality == BuildQuality::high && description.libraries.empty() &&
      description.structures.empty() && built > 0 && count_references(scene) == built)
    notes.add(description.source(),
              "a high build gains nothing here, and its volumes are those of a fast one: no primitive lies "
              "so large across "
              "the others that it pays to divide it among volumes");
}

}  // namespace

CompiledScene compile(const SceneDescription& description, const BuildOptions& options, Purpose purpose) {
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
  PartCompiler parts(arrays, description, options, purpose);
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
  add_notes_of_built(description, options, result.notes);
  add_notes_of_idle_options(description, options, purpose, result.scene, parts.built(), parts.in_use(),
                            result.notes);
  add_notes_of_tracing(description, options, purpose, result.scene, result.notes);
  if (purpose == Purpose::library)
    add_notes_of_idle(description, result.notes);
  else
    add_notes_of_darkness(description, result.scene, places, result.notes);
  return result;
}

}  // namespace rayfarm
