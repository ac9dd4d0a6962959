#include "host/experiments/hierarchies/hierarchies_experiment.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <filesystem>

#include "host/experiments/hierarchies/growth.h"
#include "host/experiments/hierarchies/heat_map.h"
#include "host/experiments/hierarchies/hierarchies_page.h"
#include "host/experiments/hierarchies/hierarchy_plots.h"
#include "host/experiments/page.h"
#include "host/files/text_file.h"
#include "host/process/exit_code.h"

namespace rayfarm {
namespace {

constexpr std::array<const char*, 3> kImages{"beach_house.yaml", "primitives.yaml", "plant.yaml"};
/// Of the thesis's regular hierarchies, along an axis.
constexpr std::array<std::array<uint32_t, 3>, 3> kCells{{{23, 25, 27}, {7, 8, 9}, {15, 16, 17}}};
constexpr std::array<const char*, 3> kScenesOfToday{"mesh70k", "mesh1m", "instances"};

struct Setting {
  const char* hierarchy;
  std::string setting;
  uint32_t cut;  ///< as HierarchyRow's
  BuildOptions build;
  bool has_spheres_everywhere = false;  ///< a sphere about each object, simple ones too
  bool has_volumes_below = false;       ///< and in it the thesis's volumes
};

BuildOptions volumes_to_the_letter(uint32_t cut) {
  return {.hierarchy = Hierarchy::thesis,
          .max_primitives = cut,
          .thesis = {.volumes = ThesisVolumes::spheres, .clip = ThesisClip::always}};
}

/// Of an image, from 0: cuts as in Table 4.5, and as many cells as it had.
std::vector<Setting> make_settings(size_t image) {
  std::vector<Setting> settings;
  for (size_t i = 0; i < kThesisCuts.size(); ++i) {
    const uint32_t cells = kCells[image][i];
    settings.push_back({"regular",
                        fmt::format("{}³ cells", cells),
                        static_cast<uint32_t>(kThesisCuts[i]),
                        {.hierarchy = Hierarchy::regular, .cells = cells}});
  }
  const auto add_cuts = [&](Hierarchy hierarchy, std::initializer_list<uint32_t> cuts) {
    for (const uint32_t cut : cuts)
      settings.push_back({kHierarchyWords[static_cast<size_t>(hierarchy)],
                          fmt::format("{}", cut),
                          cut,
                          {.hierarchy = hierarchy, .max_primitives = cut}});
  };
  add_cuts(Hierarchy::adaptive, {25, 15, 10});
  add_cuts(Hierarchy::thesis, {25, 15, 10});
  for (const bool is_below_objects : {false, true})  // to the letter
    for (const int cut : kThesisCuts) {
      BuildOptions build = volumes_to_the_letter(static_cast<uint32_t>(cut));
      if (is_below_objects) build.hierarchy = Hierarchy::object;
      settings.push_back({is_below_objects ? "object/volume" : "thesis, spheres", fmt::format("{}", cut),
                          static_cast<uint32_t>(cut), build, is_below_objects, is_below_objects});
    }
  add_cuts(Hierarchy::sah, {25, 15, 8});
  settings.push_back({"object", "a sphere each", 0, {.hierarchy = Hierarchy::object}, true});
  settings.push_back({"object", "best volumes", 0, {.hierarchy = Hierarchy::object}});
  settings.push_back({"object",
                      "best volumes, all",
                      0,
                      {.hierarchy = Hierarchy::object, .objects = {.order = ObjectOrder::all}}});
  settings.push_back({"brute", "", 0, {.hierarchy = Hierarchy::brute}});
  return settings;
}

/// As the thesis has it: every object node has a bounding volume.
SceneDescription with_spheres(SceneDescription scene) {
  for (ObjectDescription& object : scene.objects) object.bound = {BoundChoice::sphere};
  return scene;
}

/// As the thesis has it: each object stands in a sphere, and has a hierarchy of volumes of its own.
SceneDescription with_volumes_below(SceneDescription scene, uint32_t cut) {
  scene = with_spheres(std::move(scene));
  scene.structures.push_back({volumes_to_the_letter(cut), {}});
  for (const ChildDescription& child : scene.objects[scene.root].children)
    scene.objects[child.object].structure = static_cast<uint32_t>(scene.structures.size() - 1);
  return scene;
}

/// Adaptive at 25, of all depths that tell it from the deepest.
std::vector<DepthStep> measure_depths(const SceneDescription& scene, const PictureRays& rays,
                                      const SceneFacts& facts) {
  std::vector<DepthStep> steps;
  for (uint32_t depth = 2; depth <= 9; ++depth)
    steps.push_back(
        {depth,
         run_hierarchy(scene, {.hierarchy = Hierarchy::adaptive, .max_primitives = 25, .octree_depth = depth},
                       rays, facts, {.builds = 1, .passes = 0})});
  return steps;
}

ImageStudy measure_image(int image, const std::string& path, int side_px,
                         const std::filesystem::path& scratch, std::vector<HierarchyRow>& rows) {
  constexpr Effort kEffort{.builds = 5, .passes = 5};
  const SceneDescription scene = load_scene(path);
  const SceneDescription spheres = with_spheres(scene);
  const PictureRays rays = record_rays(scene, side_px);
  ImageStudy study;
  study.facts = look_at_scene(scene, kEffort.builds);
  study.kinds = rays.counts;
  study.rays = rays.size();
  HierarchyRun profiled;
  for (const Setting& s : make_settings(static_cast<size_t>(image - 1))) {
    fmt::print(stderr, "hierarchies: image {}, {} {}\n", image, s.hierarchy, s.setting);
    rows.push_back({image, fmt::format("Image {}", image), s.hierarchy, s.setting, s.cut,
                    run_hierarchy(s.has_volumes_below        ? with_volumes_below(scene, s.cut)
                                  : s.has_spheres_everywhere ? spheres
                                                             : scene,
                                  s.build, rays, study.facts, kEffort)});
    if (s.hierarchy == std::string("thesis") && s.cut == 15) profiled = rows.back().run;
  }
  study.cuts = measure_cuts(rows.back().scene, scene, every_nth(rays, 4), study.facts);
  study.depths = measure_depths(scene, every_nth(rays, 8), study.facts);
  study.update = measure_update(scene);
  study.profile = measure_profile(path, rays, side_px, profiled, scratch);
  return study;
}

/// How many cells along an axis the thesis's regular hierarchy of an image has at 25; 0 for other scenes.
uint32_t cells_of(const std::string& scene) {
  const auto image =
      std::find(kImages.begin(), kImages.end(), std::filesystem::path(scene).filename().string());
  return image == kImages.end() ? 0 : kCells[static_cast<size_t>(image - kImages.begin())][0];
}

int draw_pictures(const ExperimentOptions& options) {
  constexpr int kUsualWidth_px = 256;
  const std::filesystem::path folder = make_page_folder(options.output),
                              scenes = std::filesystem::path(options.scenes) / "hierarchies";
  std::vector<std::string> files{options.scene};
  if (options.scene.empty()) {
    files.clear();
    for (const char* image : kImages) files.push_back((scenes / image).string());
  }
  for (const std::string& scene : files)
    fmt::print("{}\n", draw_tests(scene, folder.string(),
                                  options.width_px > 0 ? options.width_px : kUsualWidth_px, cells_of(scene)));
  return kComplete;
}

}  // namespace

int run_hierarchies_experiment(const ExperimentOptions& options) {
  if (options.is_picture_of_tests) return draw_pictures(options);
  constexpr int kPicture_px = 128, kFewPixels_px = 32;
  constexpr uint32_t kManyPrimitives = 1'000'000, kFewPrimitives = 1'000;
  const std::filesystem::path folder = make_page_folder(options.output),
                              scenes = std::filesystem::path(options.scenes) / "hierarchies";
  HierarchyStudy study;
  if (options.width_px > 0) study.side_px = options.width_px;
  for (size_t i = 0; i < kImages.size(); ++i)
    study.images.push_back(measure_image(static_cast<int>(i + 1), (scenes / kImages[i]).string(),
                                         study.side_px, folder, study.rows));
  // Small pictures are trials of the experiment itself.
  study.growth = measure_growth(std::min(study.side_px, 128),
                                study.side_px > kFewPixels_px ? kManyPrimitives : kFewPrimitives);
  for (const char* name : kScenesOfToday) {
    const std::filesystem::path file = folder / "scenes" / (std::string(name) + ".yaml");
    if (!std::filesystem::exists(file)) {
      study.missing.push_back(file.string());
      fmt::print(
          stderr,
          "rayfarm: there is no {}, so the page is without it; deploy/reproduce hierarchies writes it\n",
          file.string());
      continue;
    }
    for (HierarchyRow& row : measure_scene_of_today(name, file.string(), study.side_px))
      study.rows.push_back(std::move(row));
  }
  study.peer = read_peer_times(folder / "embree.csv");
  for (const char* image : kImages)
    draw_tests((scenes / image).string(), folder.string(), std::min(study.side_px, kPicture_px),
               cells_of(image));
  const Table table = hierarchies_table(study.rows);
  write_text_file((folder / "hierarchies.csv").string(), format_tables({table}, TableFormat::csv));
  write_text_file((folder / "hierarchies.json").string(), format_tables({table}, TableFormat::json));
  write_plots(folder, study);
  write_text_file((folder / "README.md").string(), hierarchies_page(study));
  fmt::print("{}\n", (folder / "README.md").string());
  return kComplete;
}

}  // namespace rayfarm
