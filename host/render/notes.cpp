#include "host/render/notes.h"

#include <fmt/core.h>

#include <algorithm>

#include "common/lighting/item_buffers.h"
#include "common/lighting/running_pixel.h"
#include "common/lighting/self_hits.h"
#include "common/lighting/zones/zone_shapes.h"
#include "common/materials/scattering.h"
#include "host/instrument/missing_subpolygons.h"

namespace rayfarm {

std::vector<std::string> name_frames_outside(const RenderOptions& options, const SceneDescription& scene) {
  if (!scene.frames) return {};
  const auto [first, last] = *scene.frames;
  const std::vector<FrameNumber> frames = choose_frames(options, scene);
  const auto is_outside = [first = first, last = last](FrameNumber frame) {
    return frame.value() < first || frame.value() > last;
  };
  const auto count = std::count_if(frames.begin(), frames.end(), is_outside);
  if (count == 0) return {};
  const FrameNumber example = *std::find_if(frames.begin(), frames.end(), is_outside);
  return {fmt::format(
      "--frames: {} of {} frame{} lie{} outside of the scene's, {} to {} (the first such is {}): before its "
      "first key and after its last what moves stands still",
      count, frames.size(), frames.size() == 1 ? "" : "s", count == 1 ? "s" : "", first, last,
      example.value())};
}

std::vector<std::string> name_limits(const RenderOptions& options, const SubpolygonGrid& grid,
                                     int processors) {
  // On demand they are pieces of work, of which any number will do.
  const int each = options.subpolygons_per_processor;
  if (options.policy == AssignmentPolicy::on_demand && each == kSubpolygonsPerProcessor) return {};
  const std::string note = tell_missing_subpolygons(grid, processors, each, options.least_side());
  return note.empty() ? std::vector<std::string>{} : std::vector{note};
}

std::vector<std::string> name_streaming(const RenderOptions& options, const FarmHostOptions& job) {
  if (!job.is_streamed()) return {};
  const auto mib = [](size_t bytes) { return static_cast<double>(bytes) / (1 << 20); };
  std::vector<std::string> notes{
      fmt::format("pictures of {:.2f} MiB leave for their files row by row of subpolygons, as {:.2f} MiB are "
                  "left to pixels in the making (--frame-memory); there are no previews of them",
                  mib(job.picture_bytes()), mib(job.frame_bytes))};
  if (2 * job.band_bytes() > job.frame_bytes)
    notes.push_back(fmt::format(
        "two of these rows are always in memory, and take {:.2f} MiB{}", mib(2 * job.band_bytes()),
        job.journals.found.empty() ? "" : ": the picture is cut as an earlier run cut it"));
  if (options.policy == AssignmentPolicy::interleaved)
    notes.emplace_back(
        "--assign interleaved: subpolygons are handed out on demand, as nodes would not wait until there "
        "is memory for theirs");
  return notes;
}

namespace {
bool has_lighting_tree(LightingModel model) {
  return model == LightingModel::whitted || model == LightingModel::thesis;
}
void name_idle_zone_options(const RenderSettings& s, std::vector<std::string>& notes) {
  const ZoneSettings &zones = s.zones, usual;
  if (!has_zones(s.lighting)) {
    if (!(zones == usual))
      notes.emplace_back(
          "options of zones (--zone-..., --gather-rays, --shoot, --form-factors, --hemicube) belong to "
          "--lighting radiosity "
          "and zonal, and do nothing here");
    return;
  }
  if (zones.gather_rays != usual.gather_rays && zones.view != ZoneView::gather)
    notes.emplace_back("--gather-rays belongs to --zone-view gather, and does nothing here");
  const bool has_factors = zones.form_factors != usual.form_factors,
             has_hemicube = zones.hemicube_cells != usual.hemicube_cells;
  if (s.lighting == LightingModel::zonal) {
    if (has_factors || has_hemicube)
      notes.emplace_back("--form-factors and --hemicube belong to --lighting radiosity, and do nothing here");
    return;
  }
  if (zones.shooting != usual.shooting || zones.tolerance != usual.tolerance)
    notes.emplace_back("--shoot and --zone-tolerance belong to --lighting zonal, and do nothing here");
  if (has_hemicube && !has_factors)
    notes.emplace_back("--hemicube belongs to --form-factors hemicube, and does nothing here");
  if (zones.rays != usual.rays && has_factors)
    notes.emplace_back("--zone-rays belongs to --form-factors rays, and does nothing here: --hemicube does");
}

/// True if some of what the material scatters is not spread by Lambert's law.
bool is_shiny(const Material& material) {
  if (material.kind == MaterialKind::mix) return false;  // its parts are materials
  for (const bool is_front : {true, false}) {
    Lobes lobes;
    scatter(material,
            {Vec3(0, 0, 1), Vec3(0, 0, 1), is_front, is_front ? material.index : 1 / material.index}, lobes);
    for (const Lobe& lobe : lobes)
      if (lobe.spread != Lobe::Spread::diffuse && lobe.attenuation != Color(0)) return true;
  }
  return false;
}

}  // namespace

std::vector<std::string> name_idle_options(const RenderOptions& options, bool is_one_process) {
  std::vector<std::string> notes;
  name_idle_zone_options(options.settings, notes);
  const RenderSettings& s = options.settings;
  const RenderSettings usual;
  if (s.lighting != LightingModel::thesis &&
      (s.diffuse_rays != usual.diffuse_rays || s.diffuse_reach != usual.diffuse_reach ||
       s.diffuse_contrast != usual.diffuse_contrast || s.diffuse_jitter ||
       s.diffuse_bands != usual.diffuse_bands || s.diffuse_set != usual.diffuse_set))
    notes.emplace_back("the --diffuse options belong to --lighting thesis, and do nothing here");
  const bool is_local = s.lighting == LightingModel::phong || s.lighting == LightingModel::torrance_sparrow;
  if (is_local && (options.max_depth || options.max_reflections || options.max_transmissions))
    notes.emplace_back(
        "--max-depth, --max-reflections and --max-transmissions belong to models that follow light beyond "
        "what the eye sees (path, thesis, whitted), and do nothing here");
  if ((is_local || follows_paths(s.lighting)) && s.min_weight != usual.min_weight)
    notes.emplace_back("--min-weight belongs to --lighting thesis and whitted, and does nothing here");
  if (!has_lighting_tree(s.lighting) && (s.reflected_rays > 1 || s.transmitted_rays > 1))
    notes.emplace_back(
        "--reflected-rays and --transmitted-rays belong to --lighting whitted and thesis, and do nothing "
        "here");
  if (follows_paths(s.lighting) && s.glass_shadows != GlassShadows::blocked)
    notes.emplace_back(
        "--glass-shadows does nothing in --lighting path, radiosity and zonal, which follow light through "
        "glass");
  if (s.ambient_colour != AmbientColour::surface &&
      (s.lighting == LightingModel::thesis || follows_paths(s.lighting)))
    notes.emplace_back(
        "--ambient-colour belongs to --lighting phong, torrance-sparrow and whitted, and does nothing here");
  if (options.passes > 1 && options.frame_memory_GiB != RenderOptions().frame_memory_GiB)
    notes.emplace_back(
        "--frame-memory does nothing beside --passes, as each pass goes on from the whole of the one before");
  if (options.passes > 1 && s.sampling != SamplingPattern::sobol)
    notes.emplace_back(
        "--passes: of other patterns than --sampling sobol the first samples lie in a part of each pixel, "
        "and "
        "so pictures before the last are off by less than a pixel");
  if (s.noise > 0 && !follows_paths(s.lighting) && s.shutter == 0)
    notes.emplace_back(fmt::format(
        "--noise takes {} samples of every pixel at least, which pays where light is found by chance or eyes "
        "have a lens; for edges alone --adaptive needs one",
        NoiseTarget::kBatch));
  if (options.policy == AssignmentPolicy::on_demand && !options.rotates)
    notes.emplace_back("--no-rotation belongs to --assign interleaved, and does nothing here");
  if (options.policy == AssignmentPolicy::on_demand && options.sets != SetPattern::lattice)
    notes.emplace_back("--sets belongs to --assign interleaved, and does nothing here");
  if (s.item_radius_px != usual.item_radius_px && s.item_buffer == ItemBuffer::none)
    notes.emplace_back("--item-radius belongs to --item-buffer, and does nothing here");
  if (s.item_buffer == ItemBuffer::trusted)
    notes.emplace_back(
        "--item-buffer trusted: the picture may differ from an ordinary one; --item-buffer checked counts "
        "where");
  if (s.light_cells > 0 && follows_paths(s.lighting))
    notes.emplace_back(
        "--light-buffer does nothing in --lighting path, radiosity and zonal, whose shadow rays go to a "
        "source at "
        "random");
  if (s.light_cells > 0 && !follows_paths(s.lighting) && s.self_hit == SelfHit::medium)
    notes.emplace_back(
        "--light-buffer does nothing with --self-hit medium: what is seen from a light says nothing of what "
        "its shadow rays are in");
  if (options.local_nodes > 0 && !is_one_process)
    notes.emplace_back("--local-nodes does nothing under mpirun: every rank but the host is a node");
  return notes;
}

std::vector<std::string> name_idle_spectra(const RenderSettings& settings, const Scene& scene) {
  const bool has_spectra = std::any_of(
      scene.spectral_colors.begin(), scene.spectral_colors.end(),
      [](const SpectralColor& c) { return c.field != SpectralField::n && c.field != SpectralField::k; });
  if (settings.colour != ColourModel::rgb || !has_spectra) return {};
  return {
      "the scene gives colours as spectra, of which --colour rgb takes the red, green and blue; --colour "
      "spectral computes with the spectra themselves"};
}

std::vector<std::string> name_idle_options(const RenderSettings& s, const SceneDescription& scene) {
  const auto have = [&scene](auto is_one) {
    return std::any_of(scene.materials.begin(), scene.materials.end(), is_one);
  };
  std::vector<std::string> notes;
  if (s.lighting == LightingModel::radiosity) {
    std::string shiny;
    for (const MaterialDescription& material : scene.materials)
      if (is_shiny(material)) shiny += fmt::format("{}'{}'", shiny.empty() ? "" : ", ", material.name);
    if (!shiny.empty())
      notes.push_back(fmt::format(
          "--lighting radiosity has no mirrors, glass and highlights: zones get no light by way of these "
          "materials, though pictures show them: {}; --lighting zonal follows it",
          shiny));
    if (!scene.media.empty())
      notes.emplace_back(
          "--lighting radiosity: media scatter light straight from sources alone, and do not weaken what "
          "zones send each other; --lighting zonal follows both");
  }
  if (has_zones(s.lighting)) {
    if (have([](const Material& m) { return m.kind == MaterialKind::principled; }))
      notes.emplace_back(
          "zones, and their pictures, take principled materials by the coefficients nearest to them, with "
          "lobes "
          "cosⁿ in place of microfacets; --lighting path shows them as they are");
    if (have([](const Material& m) { return m.is_pierced != 0; }))
      notes.emplace_back(
          "zones get no light through surfaces with opacity, which are whole for them; pictures show what is "
          "behind");
  }
  if (has_lighting_tree(s.lighting)) {
    if (s.reflected_rays > 1 && !have([](const Material& m) {
          return m.exponent > 0 && m.reflect + m.transmit > 0 && has_reflected_rays(m);
        }))
      notes.emplace_back("--reflected-rays does nothing here: no material that reflects has an `exponent`");
    if (s.transmitted_rays > 1 && !have([](const Material& m) { return m.exponent > 0 && m.transmit > 0; }))
      notes.emplace_back(
          "--transmitted-rays does nothing here: no material that transmits has an `exponent`");
  }
  if (s.glass_shadows != GlassShadows::blocked && !follows_paths(s.lighting) &&
      !have([](const Material& m) { return m.transmit > 0; }))
    notes.emplace_back("--glass-shadows does nothing here: no material transmits light");
  return notes;
}

std::vector<std::string> name_fit(const RenderOptions& options, const RenderSettings& settings,
                                  const ViewDescription& view) {
  const double height_px = settings.width_px / view.aspect;
  const bool is_same = std::abs(height_px - settings.height_px) <= 1;
  if (options.fit && is_same && settings.fit != Fit::width)
    return {fmt::format("--fit {} does nothing here: the image has the view's aspect",
                        kFitWords[static_cast<size_t>(settings.fit)])};
  if (options.fit || !options.size_px || is_same) return {};
  return {
      fmt::format("--size {}x{} is of another aspect than the view, {:g} in width over height: it is seen in "
                  "its whole width, and "
                  "{} above and below; --fit crop or letterbox, or --size {}x{:.0f}, would keep it",
                  settings.width_px, settings.height_px, view.aspect,
                  settings.height_px < height_px ? "less" : "more", settings.width_px, height_px)};
}

std::vector<std::string> name_open_objects(const RenderSettings& settings, const SceneDescription& scene,
                                           std::span<const uint32_t> open) {
  std::vector<std::string> notes;
  if (settings.self_hit != SelfHit::medium) return notes;
  if (!open.empty()) {
    const ObjectDescription& first = scene.objects[open.front()];
    notes.push_back(fmt::format(
        "--self-hit medium: {} of {} objects hold{} polygons or quadrics that enclose nothing ({}'{}'): what "
        "is not closed is seen from its front alone, and lets light through from its back; --self-hit bound "
        "has no such limit",
        open.size(), scene.objects.size(), open.size() == 1 ? "s" : "",
        open.size() == 1 ? "" : "the first is ",
        first.name.empty() ? to_string(scene.source(first.place)) : first.name));
  }
  std::string sheets;
  for (const MaterialDescription& material : scene.materials)
    if (is_sheet(material)) sheets += fmt::format("{}'{}'", sheets.empty() ? "" : ", ", material.name);
  if (!sheets.empty())
    notes.push_back(
        fmt::format("--self-hit medium: translucent sheets and mixes of materials have no one inside; rays "
                    "leave these by "
                    "a bound on rounding, as with --self-hit bound: {}",
                    sheets));
  return notes;
}

std::vector<std::string> name_idle_items(const RenderSettings& s, const Scene& scene) {
  std::vector<std::string> notes;
  if (s.item_buffer != ItemBuffer::none && !has_one_eye(scene, s))
    notes.emplace_back(
        "--item-buffer does nothing here: through a lens, of a view that is not a perspective one or has "
        "bars, "
        "`near` or `far`, or while the shutter is open on what moves, eye rays do not go from one point "
        "through a "
        "plane");
  if (s.light_cells == 0 || follows_paths(s.lighting)) return notes;
  if (is_blurred(scene, s)) {
    notes.emplace_back("--light-buffer does nothing here: things move while the shutter is open");
    return notes;
  }
  if (scene.lights.empty()) notes.emplace_back("--light-buffer does nothing here: the scene has no lights");
  const auto serves = [&](const Light& light) { return has_item_map(light); };
  const auto with_place =
      static_cast<size_t>(std::count_if(scene.lights.begin(), scene.lights.end(), serves));
  if (with_place < scene.lights.size())
    notes.push_back(fmt::format(
        "--light-buffer: {} of {} light{} no one point to be seen from (luminous bodies and environments), "
        "and "
        "{} shadow rays are traced as always",
        scene.lights.size() - with_place, scene.lights.size(), scene.lights.size() == 1 ? " has" : "s have",
        scene.lights.size() - with_place == 1 ? "its" : "their"));
  if (const size_t most = LightItems::most_lights(s.light_cells);
      with_place > 0 && scene.lights.size() > most)
    notes.push_back(
        fmt::format("--light-buffer {}: there is room for the maps of {} lights of {}; the others' shadow "
                    "rays are traced as "
                    "always",
                    s.light_cells, most, scene.lights.size()));
  return notes;
}

std::vector<std::string> name_idle_shading(const RenderSettings& settings, const Scene& scene) {
  std::vector<std::string> notes;
  const auto scatters = [](const ParticipatingMedium& medium) { return medium.scattering != Color(0); };
  if (!follows_paths(settings.lighting) && std::any_of(scene.media.begin(), scene.media.end(), scatters))
    notes.emplace_back(
        "`media` weaken what rays of this lighting model bring, and show no light that they scatter; `path` "
        "and `zonal` do");
  if (has_zones(settings.lighting) && is_blurred(scene, settings))
    notes.emplace_back(
        "things move while the shutter is open: zones keep the light of the moment when it opens, for the "
        "whole "
        "frame");
  if (has_zones(settings.lighting)) {
    const auto without =
        std::count_if(scene.quadrics.begin(), scene.quadrics.end(),
                      [&](const Quadric& quadric) { return !find_axis(quadric, scene.planes_of(quadric)); });
    if (without > 0)
      notes.push_back(
          fmt::format("{} of {} quadrics have no zones (planes and saddles that are given as such): light "
                      "straight from sources that they reflect does not reach zones",
                      without, scene.quadrics.size()));
  }
  const auto is_gouraud = [](const auto& polygon) {
    return polygon.smoothing == static_cast<uint32_t>(Smoothing::gouraud);
  };
  const auto any = [&](const auto& polygons) {
    return std::any_of(polygons.begin(), polygons.end(), is_gouraud);
  };
  if (follows_paths(settings.lighting) &&
      (any(scene.triangle_shading) || any(scene.polygons) || any(scene.mesh_faces)))
    notes.emplace_back(
        "`smooth: gouraud` belongs to the classical lighting models; `path` and models with zones "
        "interpolate the normals");
  return notes;
}

}  // namespace rayfarm
