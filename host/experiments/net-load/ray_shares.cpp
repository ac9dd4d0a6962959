#include "host/experiments/net-load/ray_shares.h"

#include <fmt/core.h>

#include "common/compile/compile.h"
#include "common/hierarchy/walk_counts.h"
#include "common/lighting/moments.h"
#include "host/files/json.h"

namespace rayfarm {

VolumeTypes count_volume_types(const std::string& scene, int width_px, int height_px) {
  BuildOptions build;
  build.hierarchy = Hierarchy::thesis;
  build.max_primitives = 15;
  const CompiledScene compiled = compile(load_scene(scene), build);
  RenderSettings settings;
  settings.width_px = width_px;
  settings.height_px = height_px;
  Moments moments(compiled.scene);
  const Moment& moment = moments.at(0, settings).front();
  VolumeTypes types;
  for (int y = 0; y < height_px; ++y)
    for (int x = 0; x < width_px; ++x) {
      WalkCounts counts;
      const Hit hit =
          closest_hit_counted(compiled.scene, moment.pose, moment.camera.ray(x + 0.5, y + 0.5), counts);
      const size_t type = counts.leaves == 0 ? 2 : counts.leaves == 1 && hit.is_hit() ? 1 : 3;
      ++types.eye_rays[type - 1];
    }
  return types;
}

std::vector<RayShares> measure_ray_shares(const LocalRuns& runs, const std::string& scenes, int width_px) {
  const std::filesystem::path folder(scenes), images = folder / "hierarchies";
  const std::pair<const char*, std::string> cases[] = {{"Image 1", (images / "beach_house.yaml").string()},
                                                       {"Image 2", (images / "primitives.yaml").string()},
                                                       {"Image 3", (images / "plant.yaml").string()},
                                                       {"marina.yaml", (folder / "marina.yaml").string()}};
  std::vector<RayShares> all;
  for (const auto& [name, scene] : cases) {
    tell_net_load(fmt::format("rays of {}", name));
    RenderOptions job = runs.job(scene, fmt::format("rays-{}", all.size() + 1), width_px);
    runs.render(job);
    all.push_back({name, read_ray_counts(JsonView::read_file(job.stats)),
                   count_volume_types(scene, width_px, width_px * 3 / 4)});
  }
  return all;
}

namespace {
double share(uint64_t part, uint64_t whole) {
  return whole > 0 ? 100 * static_cast<double>(part) / static_cast<double>(whole) : 0;
}
uint64_t eye_rays(const VolumeTypes& types) {
  return types.eye_rays[0] + types.eye_rays[1] + types.eye_rays[2];
}
}  // namespace

std::string ray_shares_text(const std::vector<RayShares>& shares) {
  std::string text =
      "\n## Rays\n\nWhat a pixel takes, by kinds, in Whitted's model with one sample a pixel; Images 1 to 3 "
      "of the thesis are rebuilt in `scenes/hierarchies/`. The last columns are the "
      "types of "
      "Figure 4.6, of eye rays in the thesis's hierarchy with at most 15 primitives in a volume: 1 strikes "
      "in the "
      "first full volume that it tests, 2 tests none (there are no empty volumes in this hierarchy, only the "
      "space "
      "between), 3 tests others in vain. Where a room or a sky encloses all, no ray is of type 2. \"There "
      "need not be many occurrences of ray type 3 to justify the "
      "use of the "
      "object/volume hierarchy.\"\n\n![shares of rays](rays.svg)\n\n| scene | rays a pixel |";
  for (const char* kind : kRayKindNames) text += fmt::format(" {} |", kind);
  text += " type 1 | type 2 | type 3 |\n|---|---:|";
  for (size_t i = 0; i < kRayKinds + 3; ++i) text += "---:|";
  text += "\n";
  for (const RayShares& s : shares) {
    const uint64_t primary = s.kinds[RayKind::primary], total = s.kinds.total();
    text += fmt::format("| {} | {:.2f} |", s.scene, primary > 0 ? double(total) / double(primary) : 0);
    for (const uint64_t rays : s.kinds.by_kind) text += fmt::format(" {:.1f} % |", share(rays, total));
    for (const uint64_t rays : s.types.eye_rays)
      text += fmt::format(" {:.1f} % |", share(rays, eye_rays(s.types)));
    text += "\n";
  }
  return text;
}

std::string ray_shares_data(const std::vector<RayShares>& shares) {
  std::string data = "# scene, shares of kinds in %, shares of the types of eye rays in %\n";
  for (const RayShares& s : shares) {
    data += fmt::format("\"{}\"", s.scene);
    for (const uint64_t rays : s.kinds.by_kind) data += fmt::format(" {:.2f}", share(rays, s.kinds.total()));
    for (const uint64_t rays : s.types.eye_rays)
      data += fmt::format(" {:.2f}", share(rays, eye_rays(s.types)));
    data += "\n";
  }
  return data;
}

}  // namespace rayfarm
