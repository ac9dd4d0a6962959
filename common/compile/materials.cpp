#include "common/compile/materials.h"

#include "common/compile/spectra.h"
#include "common/lighting/principled_surface.h"

namespace rayfarm {
namespace {

/// So far away that a texture shows its mean.
constexpr double kFar = 1e6;

}  // namespace

void add_materials(SceneArrays<GrowingArray>& arrays, const SceneDescription& description) {
  arrays.principled.assign(description.principled.begin(), description.principled.end());
  SurfacePatch mean;
  mean.p = Vec3(0.5);
  mean.width = kFar;
  mean.sets.fill({.uv = Vec2(0.5), .width = kFar});
  for (const MaterialDescription& m : description.materials) {
    add_spectra(arrays, m.spectra, arrays.materials.size());
    Material& material = arrays.materials.emplace_back(m);
    if (material.kind != MaterialKind::principled) continue;
    if (!arrays.principled[material.principled].has_coefficients)
      set_nearest_coefficients(eval_principled_point(view_of(arrays), m, mean), material);
    material.color = m.color;  // which the texture multiplies where rays meet it
    if (material.is_pierced) arrays.header[0].has_holes = 1;
  }
}

}  // namespace rayfarm
