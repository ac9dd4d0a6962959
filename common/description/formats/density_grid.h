#pragma once
// Densities of a medium from files: plain numbers, or NRRD (teem.sourceforge.net/nrrd/format.html), a text of
// fields before such numbers or beside them.
#include <array>
#include <string>
#include <vector>

#include "common/errors/stop.h"
#include "common/memory/large_vector.h"

namespace rayfarm {

enum class DensityType : uint32_t { uint8, uint16, float32 };

/// How numbers lie in a file, x fastest.
struct DensityLayout {
  std::array<uint32_t, 3> cells{};
  DensityType type = DensityType::uint8;
  bool is_big_endian = false;
};

struct DensityGrid {
  std::array<uint32_t, 3> cells{};
  LargeVector<float> values;         ///< x fastest; whole numbers without sign have become 0 to 1
  std::vector<std::string> files;    ///< that were read
  std::vector<std::string> ignored;  ///< fields of the file that say what is not used here
};

/// A file of numbers alone. Throws InputError, also if it has another length than the layout says or a
/// density is negative or no number, and IoError.
DensityGrid load_raw_densities(const std::string& path, const DensityLayout& layout,
                               const std::stop_token& stop = {});

/// The same from NRRD of three axes, encoding raw, with its data attached or in a file beside it; throws
/// InputError for other kinds, and if there are more than `most_cells`.
DensityGrid load_nrrd(const std::string& path, uint64_t most_cells, const std::stop_token& stop = {});

}  // namespace rayfarm
