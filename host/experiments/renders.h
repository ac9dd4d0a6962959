#pragma once
// The renders that experiments are made of.
#include "common/lighting/ray_counts.h"
#include "host/files/json.h"
#include "host/render/render_options.h"
#include "host/render/run_render.h"

namespace rayfarm {

/// A render of an experiment failed, or was interrupted: the experiment ends with its exit code.
struct RenderFailed {
  int code;
};

/// Throws RenderFailed.
void render_or_throw(const RunRender& render, const RenderOptions& job);

/// The rays of a job, by its statistics. Throws IoError.
RayCounts read_ray_counts(const JsonView& stats);

}  // namespace rayfarm
