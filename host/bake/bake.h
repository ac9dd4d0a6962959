#pragma once
// The light of zones, written for other programs: as colours of vertices, or as an image of all zones.
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/compile/compile.h"
#include "common/lighting/zones/baked_light.h"
#include "common/scene/render_settings.h"
#include "host/bake/atlas_file.h"
#include "host/bake/bake_options.h"

namespace rayfarm {

/// True if `path` ends in an extension that can be baked: .glb or .exr.
bool is_bakable(const std::string& path);

class Bake {
 public:
  /// To `path`. All must outlive it. Throws InputError if nothing in the scene keeps light in zones at
  /// `frame`, what ZoneScene does, and std::runtime_error if it would not go into one file.
  Bake(const std::string& path, const std::string& scene_file, const SceneDescription& description,
       const CompiledScene& compiled, const RenderSettings& settings, int frame);

  /// What will not be in the file, or not as it looks.
  std::vector<std::string> notes() const;
  /// Writes the file, which appears when it is whole, and tells what is in it: a line. Throws IoError, and
  /// std::runtime_error if the solution is of other zones.
  std::string write(std::span<const std::byte> solution, const BakeOptions& options,
                    const std::map<std::string, std::string>& attributes) const;

 private:
  std::string write_vertices(const BakedLight& light, double stops,
                             const std::map<std::string, std::string>& attributes) const;
  std::string write_texels(const BakedLight& light,
                           const std::map<std::string, std::string>& attributes) const;
  std::string object_name(uint32_t instance) const;
  std::string material_name(uint32_t material) const;

  std::string path_;
  const SceneDescription& description_;
  const CompiledScene& compiled_;
  RenderSettings settings_;
  int frame_;
  ZoneScene zones_;
  std::optional<AtlasLayout> layout_;  ///< of an .exr
};

}  // namespace rayfarm
