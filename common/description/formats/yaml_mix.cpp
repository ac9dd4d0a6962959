#include "common/description/formats/yaml_mix.h"

#include <fmt/core.h>

#include "common/description/formats/yaml_materials.h"
#include "common/description/formats/yaml_textures.h"
#include "common/materials/scattering.h"

namespace rayfarm {
namespace {

/// The bodies of dielectrics that the material may be the surface of.
void find_dielectrics(const std::vector<MaterialDescription>& materials, uint32_t material,
                      std::vector<uint32_t>& found) {
  const MaterialDescription& m = materials[material];
  if (m.kind == MaterialKind::mix)
    for (const uint32_t part : m.parts) find_dielectrics(materials, part, found);
  if (has_inside(m) && std::find(found.begin(), found.end(), material) == found.end())
    found.push_back(material);
}

uint32_t find_part(const YamlValue& value, YamlDocument& document) {
  const uint32_t part = find_material(value, document, "; a mix names materials that stand above it");
  const MaterialDescription& m = document.scene().materials[part];
  if (m.is_pierced)
    value.fail(
        fmt::format("'{}' has opacity or one side only, which can't be mixed: a mix decides what is there, "
                    "not whether anything is; give surfaces with holes a material of their own",
                    m.name));
  if (m.kind == MaterialKind::principled && is_luminaire(m))
    value.fail(fmt::format("'{}' shines, and what shines can't be mixed: a lamp shines all over its surface",
                           m.name));
  if (m.kind == MaterialKind::luminaire)
    value.fail(
        fmt::format("'{}' is a luminaire, which can't be mixed: a lamp shines all over its surface; "
                    "make lamp and surroundings objects of their own",
                    m.name));
  return part;
}

}  // namespace

void read_mix(const YamlValue& value, MaterialDescription& mix, YamlDocument& document) {
  YamlMap map(value);
  for (const char* key : {"a", "b", "by"})
    if (!map.has(key))
      value.fail("a mix needs `a`, `b` and `by`: two materials, and the texture that says where each is");
  const YamlValue first = map.require("a"), second = map.require("b");
  SceneDescription& scene = document.scene();
  mix.parts = {find_part(first, document), find_part(second, document)};
  mix.texture = find_texture(map.require("by"), document);
  map.finish();
  std::vector<uint32_t> dielectrics;
  for (const uint32_t part : mix.parts) find_dielectrics(scene.materials, part, dielectrics);
  if (dielectrics.size() > 1)
    second.fail(
        fmt::format("'{}' and '{}' are two dielectrics, but a body has one inside; mix one with "
                    "materials that let nothing in",
                    scene.materials[dielectrics[0]].name, scene.materials[dielectrics[1]].name));
  if (mix.parts[0] == mix.parts[1])
    scene.notes.add(scene.source(value.place()),
                    fmt::format("'{}' is a mix of '{}' with itself: its texture does nothing", mix.name,
                                scene.materials[mix.parts[0]].name));
}

}  // namespace rayfarm
