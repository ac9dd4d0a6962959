#include "common/compile/compile.h"

#include "common/compile/darkness.h"
#include "common/compile/lights.h"
#include "common/compile/objects.h"
#include "common/compile/parts.h"
#include "common/compile/shapes.h"
#include "common/compile/spectra.h"
#include "common/compile/textures.h"
#include "common/errors/input_error.h"

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
  record.aspect = view.aspect;
  record.lens_radius = view.lens_radius;
}

void add_materials(SceneArrays<GrowingArray>& arrays, const SceneDescription& description) {
  for (const MaterialDescription& m : description.materials) {
    add_spectra(arrays, m.spectra, arrays.materials.size());
    arrays.materials.push_back(m);
  }
  for (const SpectrumDescription& s : description.spectra) add_spectra(arrays, std::span(&s, 1), s.index);
}

/// The parts of a scene as they are made.
class PartCompiler {
 public:
  PartCompiler(SceneArrays<GrowingArray>& arrays, const SceneDescription& description,
               const BuildOptions& options)
      : arrays_(arrays),
        description_(description),
        options_(options),
        shapes_(arrays, luminaires_, description, options.stop),
        part_of_(description.objects.size(), kNone) {}

  void add_all() {
    const std::vector<uint32_t> fixed = fixed_objects(description_);
    add(description_.root, fixed);
    std::vector<bool> is_added(description_.objects.size());
    for (const uint32_t object : fixed) is_added[object] = true;
    for (uint32_t object = 0; object < description_.objects.size(); ++object)
      if (!is_added[object]) add(object, std::span(&object, 1));
    if (!arrays_.triangle_uvs.empty()) arrays_.triangle_uvs.resize(3 * arrays_.triangle_shading.size());
    if (!arrays_.face_uvs.empty()) arrays_.face_uvs.resize(arrays_.face_corners.size());
  }

  const Luminaires& luminaires() const { return luminaires_; }
  std::span<const std::vector<Luminous>> luminous_of() const { return luminous_of_; }  ///< by part
  std::span<const uint32_t> part_of() const { return part_of_; }                       ///< by object
  void add_notes(Notes& notes) const {
    shapes_.add_notes(notes);
    luminaires_.add_notes(description_, notes);
  }

 private:
  /// Makes the primitives of `objects` one part, which moves with `owner`.
  void add(uint32_t owner, std::span<const uint32_t> objects) {
    throw_if_stopped(options_.stop);
    PartPrimitives primitives;
    for (const uint32_t object : objects)
      for (const PrimitiveDescription& p : description_.objects[object].primitives)
        shapes_.add(primitives, p);
    if (arrays_.triangle_shading.size() > limits::kPrimitives ||
        arrays_.face_corners.size() > limits::kFaceCorners)
      throw InputError(description_.source(description_.objects[owner].place),
                       "the scene has too many triangles or corners of faces");
    if (primitives.ids.empty()) return;
    part_of_[owner] = static_cast<uint32_t>(arrays_.parts.size());
    arrays_.parts.push_back(build_part(arrays_, primitives, options_));
    luminous_of_.push_back(luminaires_.take());
  }

  SceneArrays<GrowingArray>& arrays_;
  const SceneDescription& description_;
  const BuildOptions& options_;
  Luminaires luminaires_;
  ShapeCompiler shapes_;
  std::vector<uint32_t> part_of_;
  std::vector<std::vector<Luminous>> luminous_of_;
};

}  // namespace

CompiledScene compile(const SceneDescription& description, const BuildOptions& options) {
  SceneArrays<GrowingArray> arrays;
  arrays.header.resize(1);
  arrays.header[0].background = description.background;
  arrays.header[0].ambient = description.ambient;
  add_view(arrays, description);
  add_materials(arrays, description);
  for (const TextureDescription& t : description.textures) add_texture(arrays, t);
  add_listed_lights(arrays, description);
  PartCompiler parts(arrays, description, options);
  parts.add_all();
  LightPlaces places;
  places.in_objects = ObjectTree(arrays, description, parts.part_of(), options.stop).expand();
  build_object_part(arrays, description, options.stop);
  add_environment(arrays, description);
  places.luminaires = add_luminaires(arrays, description, parts.luminaires(), parts.luminous_of());
  weigh_lights(arrays);

  CompiledScene result;
  result.block = encode_scene(view_of(arrays));
  result.scene = decode_scene(result.block.bytes());
  result.notes = description.notes;
  parts.add_notes(result.notes);
  add_notes_of_darkness(description, result.scene, places, result.notes);
  return result;
}

}  // namespace rayfarm
