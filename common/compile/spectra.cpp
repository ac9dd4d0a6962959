#include "common/compile/spectra.h"

namespace rayfarm {

void add_spectra(SceneArrays<GrowingArray>& arrays, std::span<const SpectrumDescription> spectra,
                 size_t owner) {
  for (const SpectrumDescription& s : spectra) {
    arrays.spectral_colors.push_back({s.field, static_cast<uint32_t>(owner),
                                      static_cast<uint32_t>(arrays.spectrum_nodes.size()),
                                      static_cast<uint32_t>(s.nodes.size())});
    arrays.spectrum_nodes.insert(arrays.spectrum_nodes.end(), s.nodes.begin(), s.nodes.end());
  }
}

}  // namespace rayfarm
