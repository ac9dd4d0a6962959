#include "common/description/formats/yaml_media.h"

#include <fmt/core.h>

#include "common/description/formats/density_grid.h"
#include "common/description/formats/yaml_spectra.h"
#include "common/image/image_file.h"

namespace rayfarm {
namespace {

Box read_box_of(const YamlValue& value) {
  YamlMap map(value);
  const Box box{map.require("min").vector(), map.require("max").vector()};
  map.finish();
  if (!(box.lo.x < box.hi.x && box.lo.y < box.hi.y && box.lo.z < box.hi.z))
    value.fail("each coordinate of `min` must be below that of `max`");
  return box;
}

DensityLayout read_layout(YamlMap& map, uint64_t most_cells) {
  DensityLayout layout;
  const YamlValue size = map.require("size");
  const std::vector<YamlValue> axes = size.items();
  if (axes.size() != 3) size.fail("the size of a grid is [x, y, z], in cells");
  uint64_t left = most_cells;
  for (size_t axis = 0; axis < 3; ++axis) {
    layout.cells[axis] = static_cast<uint32_t>(axes[axis].whole_number_in(1, 1'000'000));
    if (layout.cells[axis] > left)
      size.fail(fmt::format("the grid has more cells than there is room for, {}", most_cells));
    left /= layout.cells[axis];
  }
  layout.type = static_cast<DensityType>(map.require("type").choice({"uint8", "uint16", "float32"}));
  if (auto v = map.find("endian")) layout.is_big_endian = v->choice({"little", "big"}) == 1;
  return layout;
}

void read_grid(const YamlValue& value, MediumDescription& medium, YamlDocument& document) {
  SceneDescription& scene = document.scene();
  uint64_t used = 0;
  for (const MediumDescription& other : scene.media) used += other.densities.size();
  const uint64_t most_cells = limits::kMediumCells - used;
  YamlMap map(value);
  const YamlValue file = map.require("file");
  const std::string path = document.path_of(file);
  const std::string extension = extension_of(path);
  DensityGrid grid;
  try {
    if (extension == ".raw") {
      grid = load_raw_densities(path, read_layout(map, most_cells), value.stop());
    } else if (extension == ".nrrd" || extension == ".nhdr") {
      for (const char* key : {"size", "type", "endian"})
        if (auto v = map.find(key))
          v->fail(fmt::format("the header of an NRRD file says the `{}` itself; leave it out here", key));
      grid = load_nrrd(path, most_cells, value.stop());
    } else {
      file.fail("densities are read from a .raw, .nrrd or .nhdr file");
    }
  } catch (const IoError& e) {
    file.fail(e.what());
  }
  map.finish();
  medium.cells = grid.cells;
  medium.densities = std::move(grid.values);
  scene.files.insert(scene.files.end(), grid.files.begin(), grid.files.end());
  if (grid.ignored.empty()) return;
  std::string names;
  for (const std::string& name : grid.ignored)
    names += fmt::format("{}`{}`", names.empty() ? "" : ", ", name);
  scene.notes.add({grid.files[0]}, names + " of the file: not used, as its cells fill the medium's box");
}

MediumDescription read_medium(const YamlValue& value, YamlDocument& document) {
  SceneDescription& scene = document.scene();
  YamlMap map(value);
  MediumDescription medium;
  medium.place = value.place();
  medium.box = read_box_of(map.require("box"));
  const auto color = [&](const char* key, SpectralField field, Color& target) {
    if (auto v = map.find(key)) target = read_color(*v, field, scene.spectra, scene.media.size());
  };
  color("absorption", SpectralField::absorption, medium.absorption);
  color("scattering", SpectralField::scattering, medium.scattering);
  if (auto v = map.find("g")) {
    medium.asymmetry = v->number_in(-0.99, 0.99);
    if (medium.scattering == Color(0)) v->fail("`g` says how light is scattered; give `scattering`, too");
  }
  if (auto v = map.find("grid")) read_grid(*v, medium, document);
  map.finish();
  if (medium.extinction() == Color(0))
    value.fail("a medium needs `absorption` or `scattering` above 0: what light loses per unit of length");
  double most = 1;
  if (medium.has_grid()) most = *std::max_element(medium.densities.begin(), medium.densities.end());
  if (const double depth = greatest_optical_depth(medium, most); depth > kMostOpticalDepth)
    value.fail(
        fmt::format("across its box the medium's optical depth (absorption + scattering, times density "
                    "and length) is up to {:.3g}, more than {:g}: that is a solid body",
                    depth, kMostOpticalDepth));
  return medium;
}

}  // namespace

void read_media(const YamlValue& value, YamlDocument& document) {
  SceneDescription& scene = document.scene();
  for (const YamlValue& item : value.items()) {
    if (scene.media.size() == kMostMedia)
      item.fail(fmt::format("a scene has no more than {} media", kMostMedia));
    document.shared.problems.keep([&] {
      MediumDescription medium = read_medium(item, document);
      for (const MediumDescription& other : scene.media) {
        const Box both = intersection(medium.box, other.box);
        if (both.lo.x < both.hi.x && both.lo.y < both.hi.y && both.lo.z < both.hi.z)
          item.fail(fmt::format(
              "the medium overlaps the one at {}: of two in one place nobody knows which scatters; make the "
              "boxes smaller (they may touch), or one medium of both",
              to_string(scene.source(other.place))));
      }
      scene.media.push_back(std::move(medium));
    });
  }
}

}  // namespace rayfarm
