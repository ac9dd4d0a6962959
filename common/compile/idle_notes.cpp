#include "common/compile/idle_notes.h"

#include "common/hierarchy/ray_coherence.h"
#include "common/scene/references.h"

namespace rayfarm {
namespace {

/// What a scene says that is none of its objects' business.
void add_notes_of_unused_keys(const SceneDescription& description, Notes& notes) {
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

void add_notes_of_idle(const SceneDescription& description, const BuildOptions& options, Purpose purpose,
                       const Scene& scene, size_t built, const InUse& in_use, Notes& notes) {
  add_notes_of_built(description, options, notes);
  add_notes_of_idle_options(description, options, purpose, scene, built, in_use, notes);
  add_notes_of_tracing(description, options, purpose, scene, notes);
  if (purpose == Purpose::library) add_notes_of_unused_keys(description, notes);
}

}  // namespace rayfarm
