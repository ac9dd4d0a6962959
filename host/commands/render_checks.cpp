#include "host/commands/render_checks.h"

#include <fmt/core.h>

#include "common/lighting/running_pixel.h"
#include "common/sampling/sampler.h"
#include "host/commands/command_line.h"

namespace rayfarm {
namespace {

void check_noise(const RenderSettings& s) {
  if (!(s.noise > 0)) return;
  if (s.sampling != SamplingPattern::sobol)
    throw UsageError(
        "--noise ends a pixel's samples before the last, and only the first of --sampling sobol are spread "
        "over all of the pixel; leave one of them out");
  if (s.samples <= NoiseTarget::kBatch)
    throw UsageError(fmt::format(
        "--noise takes at least {} samples of each pixel and chooses where --samples goes on; set --samples "
        "to more than that",
        NoiseTarget::kBatch));
  if (s.adaptive_contrast > 0)
    throw UsageError(
        "--noise and --adaptive both choose where samples are taken; leave one of them out: --adaptive suits "
        "phong, torrance-sparrow, whitted and thesis without a lens, --noise what is found by chance");
  if (s.lighting == LightingModel::thesis && s.diffuse_set == DiffuseSet::fixed)
    throw UsageError(
        "--diffuse-set fixed shares its directions out over all samples in order, of which --noise takes the "
        "first alone; leave one of them out");
}

void check_passes(const RenderOptions& o) {
  if (o.passes == 1) return;
  const RenderSettings& s = o.settings;
  if (s.sampling == SamplingPattern::corners || s.adaptive_contrast > 0)
    throw UsageError(
        "--passes takes some of each pixel's samples at a time; --sampling corners has none, and --adaptive "
        "chooses pixels by the first alone: leave one of them out");
  if (s.samples < static_cast<uint32_t>(o.passes))
    throw UsageError(
        fmt::format("--passes {} needs a sample of each pixel for each pass; set --samples to {} or more",
                    o.passes, o.passes));
  if (o.policy == AssignmentPolicy::interleaved)
    throw UsageError(
        "--assign interleaved lets nodes go on by themselves, and a pass goes on from what the host holds; "
        "leave out --passes, or take --assign on-demand");
  if (o.wire == Wire::pixel)
    throw UsageError(
        "--wire pixel has no room for what a pass goes on from; leave out --passes, or take --wire block");
}

}  // namespace

void check_combinations(const RenderOptions& o) {
  const RenderSettings& s = o.settings;
  if (s.sampling == SamplingPattern::poisson && s.samples > Sampler::kMostPoissonSamples)
    throw UsageError(fmt::format("--sampling poisson lays out at most {} samples; use sobol for more",
                                 Sampler::kMostPoissonSamples));
  if (s.sampling == SamplingPattern::corners && s.filter != FilterKind::box)
    throw UsageError("--sampling corners weighs all rays that touch a pixel alike; leave --filter at box");
  if (s.sampling == SamplingPattern::corners && s.shutter > 0)
    throw UsageError("--sampling corners takes one ray per corner, too few for --shutter");
  if (s.sampling == SamplingPattern::corners && s.samples != 1)
    throw UsageError(
        "--sampling corners takes one ray per corner; leave --samples at 1, and cut pixels with --subpixels "
        "for more");
  if (o.subpixels && s.sampling != SamplingPattern::corners)
    throw UsageError(
        "--subpixels are cut to send rays through their corners: give --sampling corners, too; other "
        "patterns take --samples");
  if (s.adaptive_contrast > 0 && s.sampling == SamplingPattern::corners)
    throw UsageError(
        "--adaptive adds samples to pixels, and --sampling corners takes none; leave one of them out");
  if (s.adaptive_contrast > 0 && s.samples < 2)
    throw UsageError("--adaptive chooses where more than one sample is taken; set --samples");
  if (s.adaptive_contrast > 0 && follows_paths(s.lighting))
    throw UsageError(
        "--adaptive compares the first samples of neighbouring pixels, which differ everywhere where "
        "light is found by chance: it suits phong, torrance-sparrow, whitted and thesis, not path, radiosity "
        "and zonal");
  check_noise(s);
  check_passes(o);
  if (!o.time_factors.empty() && !(o.ray_time_s > 0))
    throw UsageError("--processor-times are factors on --processor-time; give that, too");
  if (o.wire == Wire::pixel && o.pixel_format && *o.pixel_format != PixelFormat::rgb8)
    throw UsageError("--wire pixel carries three bytes of colour; use --pixel-format rgb8 or --wire block");
}

}  // namespace rayfarm
