#include "common/scene/settings_codec.h"

#include <fmt/core.h>

#include <cereal/archives/portable_binary.hpp>
#include <cmath>
#include <sstream>

namespace rayfarm {

void check_settings(const RenderSettings& settings) {
  const PixelRect& crop = settings.crop;
  const auto is_size = [](int pixels) { return pixels >= 1 && pixels <= 65536; };
  if (!is_size(settings.width_px) || !is_size(settings.height_px) || crop.x0 < 0 || crop.y0 < 0 ||
      crop.x0 >= crop.x1 || crop.y0 >= crop.y1 || crop.x1 > settings.width_px || crop.y1 > settings.height_px)
    throw SettingsError("the picture has no such size or crop");
  if (settings.fit > Fit::letterbox || settings.lighting > LightingModel::zonal ||
      settings.sampling > SamplingPattern::corners || settings.filter > FilterKind::mitchell ||
      settings.colour > ColourModel::spectral || settings.glass_shadows > GlassShadows::none ||
      settings.ambient_colour > AmbientColour::light || settings.pixel_format > PixelFormat::float32 ||
      settings.diffuse_bands > DiffuseBands::cone || settings.diffuse_set > DiffuseSet::fixed ||
      settings.item_buffer > ItemBuffer::checked || settings.self_hit > SelfHit::medium)
    throw SettingsError("a choice among the settings does not exist");
  if (!settings.colour_nodes_nm.empty() &&
      (settings.colour != ColourModel::spectral || !are_colour_nodes(settings.colour_nodes_nm)))
    throw SettingsError(
        fmt::format("the wavelengths of colour must rise from {:g} to {:g} nm, be no more than {}, and tell "
                    "red, green and blue apart: one each below 490, about 545 and above 600 at least",
                    kFirstWavelength_nm, kLastWavelength_nm, kMostColourNodes));
  const auto is_cut = [](uint32_t parts) { return parts >= 1 && parts <= Subpixels::kMost; };
  const auto is_of_lobe = [](uint32_t rays) { return rays >= 1 && rays <= kMostLobeRays; };
  if (!is_cut(settings.subpixels.columns) || !is_cut(settings.subpixels.rows) || settings.samples < 1 ||
      settings.samples > kMostSamples || settings.diffuse_rays < 1 || !is_of_lobe(settings.reflected_rays) ||
      !is_of_lobe(settings.transmitted_rays) || settings.max_depth < 1 || settings.max_depth > kMostDepth ||
      settings.max_reflections >= kMostDepth || settings.max_transmissions >= kMostDepth ||
      !(std::abs(settings.exposure_stops) <= kMostExposure_stops) || !std::isfinite(settings.shutter) ||
      !std::isfinite(settings.diffuse_reach) || !std::isfinite(settings.diffuse_contrast) ||
      !(settings.min_weight >= 0) || !(settings.shutter >= 0) || !(settings.adaptive_contrast >= 0) ||
      !(settings.noise >= 0 && settings.noise <= 1) || !(settings.diffuse_reach >= 0) ||
      !(settings.diffuse_contrast >= 0))
    throw SettingsError("a number among the settings is out of range");
  if (!(settings.item_radius_px >= kLeastItemRadius_px && settings.item_radius_px <= kMostItemRadius_px))
    throw SettingsError(fmt::format("corners tell of samples {:g} to {:g} pixels away (--item-radius)",
                                    kLeastItemRadius_px, kMostItemRadius_px));
  if (settings.light_cells != 0 &&
      (settings.light_cells < kLeastLightCells || settings.light_cells > kMostLightCells))
    throw SettingsError(
        fmt::format("a light's map of items has {} to {} points along a side, or there is none "
                    "(--light-buffer 0)",
                    kLeastLightCells, kMostLightCells));
  if (settings.item_buffer != ItemBuffer::none && crop.area() > kMostItemPoints)
    throw SettingsError(fmt::format(
        "an item buffer keeps 12 bytes for each corner of a pixel: it serves {} pixels at most, and "
        "these are {}; leave out --item-buffer, or render parts (--crop)",
        kMostItemPoints, crop.area()));
  const ZoneSettings& zones = settings.zones;
  if (zones.view > ZoneView::gather || zones.form_factors > FormFactors::hemicube ||
      zones.primary > ZonePrimary::shot || zones.shooting > ZoneShooting::one)
    throw SettingsError("a choice among the settings of zones does not exist");
  if (!(zones.size == 0 || (zones.size >= 1e-12 && zones.size <= 1e12)) || zones.rays < 1 ||
      zones.rays > kMostZoneRays || zones.samples < 1 || zones.samples > 65536 || zones.batch < 1 ||
      zones.batch > 1 << 20 || !(zones.tolerance >= 1e-9 && zones.tolerance <= 1) ||
      zones.hemicube_cells < 2 || zones.hemicube_cells > 4096 || zones.gather_rays < 1 ||
      zones.gather_rays > kMostGatherRays || !(zones.most_GiB >= 0.001 && zones.most_GiB <= 1024))
    throw SettingsError("a number among the settings of zones is out of range");
  if (const uint64_t directions = diffuse_directions_of(settings); directions > kMostDiffuseDirections)
    throw SettingsError(fmt::format(
        "the diffuse rays of all samples of a pixel are laid out at once: {} × {} are {}, more than "
        "{}; lower --diffuse-rays, --samples or --subpixels",
        settings.diffuse_rays, samples_that_share_directions(settings), directions, kMostDiffuseDirections));
}

std::vector<std::byte> encode_settings(const RenderSettings& settings) {
  std::ostringstream out;
  {
    cereal::PortableBinaryOutputArchive archive(out);
    archive(settings);
  }
  const std::string text = out.str();
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

RenderSettings decode_settings(std::span<const std::byte> bytes) {
  std::istringstream in(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  RenderSettings settings;
  try {
    cereal::PortableBinaryInputArchive archive(in);  // reads a byte, too
    archive(settings);
  } catch (const cereal::Exception& e) {
    throw SettingsError(fmt::format("the settings can't be read ({})", e.what()));
  }
  check_settings(settings);
  return settings;
}

}  // namespace rayfarm
