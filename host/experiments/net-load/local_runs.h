#pragma once
// Renders of the experiment in this process; their files lie in a folder of their own.
#include <filesystem>
#include <string>

#include "host/experiments/renders.h"
#include "host/render/render_options.h"
#include "host/render/run_render.h"

namespace rayfarm {

/// `--node-timeout` of all runs: on nets that are full a heartbeat waits long.
inline constexpr int kPatience_s = 120;

class LocalRuns {
 public:
  /// Makes the folder.
  LocalRuns(std::filesystem::path folder, const RunRender& render);

  std::filesystem::path file(const std::string& name) const { return folder_ / name; }
  /// A quiet render of `width_px` × 3/4 `width_px` pixels, with statistics and a cost map beside the picture.
  RenderOptions job(const std::string& scene, const std::string& name, int width_px) const;
  /// Throws RenderFailed if the job fails.
  void render(const RenderOptions& job) const;

 private:
  std::filesystem::path folder_;
  const RunRender& render_;
};

/// All rays of a job, by its statistics file.
double count_rays(const std::string& stats);

/// Tells on stderr what is being done.
void tell_net_load(const std::string& what);

}  // namespace rayfarm
