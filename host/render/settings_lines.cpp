#include "host/render/settings_lines.h"

#include <fmt/core.h>

#include "common/files/sha256.h"
#include "common/scene/settings_codec.h"

namespace rayfarm {

std::vector<std::pair<std::string, std::string>> lines_of(const RenderSettings& s) {
  std::vector<std::pair<std::string, std::string>> lines;
  const auto add = [&]<typename T>(const char* option, const T& value) {
    if constexpr (std::is_enum_v<T>)
      lines.emplace_back(option, fmt::format("{}", static_cast<int>(value)));
    else
      lines.emplace_back(option, fmt::format("{}", value));
  };
  add("--size", fmt::format("{}x{}", s.width_px, s.height_px));
  add("--crop", fmt::format("{},{},{},{}", s.crop.x0, s.crop.x1, s.crop.y0, s.crop.y1));
  add("--fit", s.fit);
  add("--exposure", s.exposure_stops);
  add("--pixel-format", s.pixel_format);
  add("--lighting", s.lighting);
  add("--colour", s.colour);
  add("--seed", s.seed);
  add("--sampling", s.sampling);
  add("--samples", s.samples);
  add("--subpixels", fmt::format("{}x{}", s.subpixels.columns, s.subpixels.rows));
  add("--filter", s.filter);
  add("--shutter", s.shutter);
  add("--adaptive", s.adaptive_contrast);
  add("--noise", s.noise);
  add("--max-depth", s.max_depth);
  add("--max-reflections", s.max_reflections);
  add("--max-transmissions", s.max_transmissions);
  add("--min-weight", s.min_weight);
  add("--diffuse-rays", s.diffuse_rays);
  add("--reflected-rays", s.reflected_rays);
  add("--transmitted-rays", s.transmitted_rays);
  add("--glass-shadows", s.glass_shadows);
  add("--item-buffer", s.item_buffer);
  add("--light-buffer", s.light_cells);
  add("--self-hit", s.self_hit);
  add("--zone-size", s.zones.size);
  add("--zone-rays", s.zones.rays);
  add("--zone-samples", s.zones.samples);
  add("--zone-tolerance", s.zones.tolerance);
  add("--zone-primary", s.zones.primary);
  add("--zone-view", s.zones.view);
  add("--gather-rays", s.zones.gather_rays);
  add("--shoot", s.zones.shooting);
  add("--form-factors", s.zones.form_factors);
  add("--hemicube", s.zones.hemicube_cells);
  add("settings", sha256(encode_settings(s)));
  return lines;
}

std::string name_difference(const std::string& line) {
  if (line == "version") return "another version of Rayfarm";
  if (line == "build") return "another build of Rayfarm";
  if (line == "scene") return "another scene, or one whose primitives are arranged otherwise (--hierarchy)";
  if (line == "frame") return "another frame, and things move in this scene";
  if (line == "settings") return "other settings";
  return "another " + line;
}

}  // namespace rayfarm
