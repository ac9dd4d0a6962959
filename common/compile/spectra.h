#pragma once
// Colours of the description that are spectra.
#include "common/description/scene_description.h"
#include "common/scene/scene.h"

namespace rayfarm {

/// Those of the material or light of this number.
void add_spectra(SceneArrays<GrowingArray>& arrays, std::span<const SpectrumDescription> spectra,
                 size_t owner);

}  // namespace rayfarm
