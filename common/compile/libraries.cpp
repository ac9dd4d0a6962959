#include "common/compile/libraries.h"

#include "common/compile/corners.h"
#include "common/errors/input_error.h"
#include "common/scene/array_offsets.h"

namespace rayfarm {
namespace {

template <ArrayName name, typename T>
void append(GrowingArray<T>& array, std::span<const T> more, const ArrayOffsets& offsets) {
  const size_t before = array.size();
  array.insert(array.end(), more.begin(), more.end());
  for (size_t i = before; i < array.size(); ++i) shift_element<name>(array[i], offsets);
}

/// A library's lamps, by part: those of the first instance of each.
std::vector<std::vector<Luminous>> find_lamps(const Scene& library, const Place& place,
                                              const ArrayOffsets& offsets) {
  std::vector<uint32_t> first_instance(library.parts.size(), kNone);
  for (uint32_t i = 0; i < library.instances.size(); ++i) {
    uint32_t& first = first_instance[library.instances[i].part];
    if (first == kNone) first = i;
  }
  std::vector<std::vector<Luminous>> lamps(library.parts.size());
  for (const Light& light : library.lights.subspan(library.head().first_luminaire)) {
    const uint32_t part = library.instances[light.instance].part;
    if (first_instance[part] != light.instance) continue;
    Luminous lamp{light.primitive, place, light.material + offsets.materials,
                  light.first_triangle + offsets.luminaire_triangles, light.triangle_count};
    shift(lamp.id, offsets);
    lamps[part].push_back(lamp);
  }
  return lamps;
}

}  // namespace

PlacedLibrary append_library(SceneArrays<GrowingArray>& arrays, const LibraryDescription& library,
                             const Place& place, Luminaires& luminaires) {
  const Scene& more = library.scene;
  arrays.luminaire_triangles = luminaires.triangles();
  ArrayOffsets offsets = offsets_behind(arrays);
  offsets.materials = library.first_material;
  offsets.textures = library.first_texture;
  offsets.goniometric_diagrams = library.first_diagram;
  fill_corners(arrays, more);
#define RAYFARM_ARRAY(element, name, role)              \
  if constexpr (ArrayRole::role == ArrayRole::geometry) \
    append<ArrayName::name>(arrays.name, more.name, offsets);
#include "common/scene/scene_arrays.inc"
#undef RAYFARM_ARRAY
  luminaires.take_over(std::move(arrays.luminaire_triangles));
  return {offsets.parts, find_lamps(more, place, offsets)};
}

}  // namespace rayfarm
