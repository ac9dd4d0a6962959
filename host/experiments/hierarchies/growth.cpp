#include "host/experiments/hierarchies/growth.h"

#include <fmt/core.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "common/errors/input_error.h"

namespace rayfarm {
namespace {

struct Choice {
  const char* setting;
  BuildOptions build;
};

/// Each as it is without further options, and adaptive without its hash table.
std::vector<Choice> make_choices() {
  return {{"", {.hierarchy = Hierarchy::brute}},
          {"", {.hierarchy = Hierarchy::object}},
          {"", {.hierarchy = Hierarchy::regular}},
          {"", {.hierarchy = Hierarchy::adaptive}},
          {"pointers", {.hierarchy = Hierarchy::adaptive, .octree_data = OctreeData::pointers}},
          {"", {.hierarchy = Hierarchy::thesis}},
          {"", {}}};
}

/// Tests that a pass may make where rays test all primitives.
constexpr double kMostTests = 3e7;
constexpr size_t kFewestRays = 32;

const char* word(Hierarchy hierarchy) {
  return kHierarchyWords[static_cast<size_t>(hierarchy)];
}

bool is_list(Hierarchy hierarchy) {
  return hierarchy == Hierarchy::brute || hierarchy == Hierarchy::object;
}

/// As many as end soon.
PictureRays rays_for(Hierarchy hierarchy, const PictureRays& rays, size_t primitives) {
  if (!is_list(hierarchy)) return rays;
  const auto most =
      std::max(kFewestRays, static_cast<size_t>(kMostTests / static_cast<double>(primitives + 1)));
  return rays.size() > most ? every_nth(rays, (rays.size() + most - 1) / most) : rays;
}

size_t primitives_of(const CompiledScene& compiled) {
  const Scene& s = compiled.scene;
  size_t count = 0;
  for (const Instance& instance : s.instances) count += s.parts[instance.part].primitive_count();
  return count;
}

GrowthPoint point_of(const std::string& scene, const std::string& hierarchy, double number,
                     const HierarchyRun& run) {
  return {scene,          hierarchy,      number, run.primitives_per_ray(), run.volumes_per_ray(),
          run.ns_per_ray, run.build_cpu_s};
}

}  // namespace

std::vector<GrowthPoint> measure_cuts(const std::string& name, const SceneDescription& scene,
                                      const PictureRays& rays, const SceneFacts& facts) {
  std::vector<GrowthPoint> points;
  for (const Hierarchy hierarchy : {Hierarchy::adaptive, Hierarchy::thesis, Hierarchy::sah})
    for (uint32_t cut = 1; cut <= 64; cut *= 2)
      points.push_back(point_of(name, word(hierarchy), cut,
                                run_hierarchy(scene, {.hierarchy = hierarchy, .max_primitives = cut}, rays,
                                              facts, {.builds = 1, .passes = 3})));
  return points;
}

SceneDescription make_terrain(uint32_t n) {
  SceneDescription scene;
  scene.has_view = true;
  scene.view.location = constant_curve(Vec4(-1.4, 0.9, 1.7, 0));
  scene.view.look_at = constant_curve(Vec4(0, 0, 0, 0));
  scene.view.aspect = 1;
  Light light;
  light.position = Vec3(-3, 4, 1);
  scene.lights.push_back(light);
  scene.materials.emplace_back("ground");
  MeshShape mesh;
  const auto place = [&](uint32_t i) { return 2 * static_cast<float>(i) / static_cast<float>(n) - 1; };
  for (uint32_t row = 0; row <= n; ++row)
    for (uint32_t column = 0; column <= n; ++column) {
      const float x = place(column), z = place(row);
      float height = 0;
      for (float octave = 1; octave < 40; octave *= 2.1f)
        height +=
            0.13f / octave * std::sin(5 * octave * x + octave) * std::cos(6 * octave * z - 2 * octave * x);
      mesh.positions.push_back({x, height, z});
    }
  for (uint32_t row = 0; row < n; ++row)
    for (uint32_t column = 0; column < n; ++column) {
      const uint32_t a = row * (n + 1) + column, b = a + 1, c = a + n + 1, d = c + 1;
      mesh.triangles.push_back({a, c, b});
      mesh.triangles.push_back({b, c, d});
    }
  ObjectDescription ground;
  ground.name = "ground";
  ground.primitives.push_back({std::move(mesh), 0, {}});
  scene.objects.push_back(std::move(ground));
  return scene;
}

std::vector<GrowthPoint> measure_growth(int side_px, uint32_t most_primitives) {
  std::vector<GrowthPoint> points;
  for (const uint32_t n : {22u, 71u, 224u, 707u}) {
    if (2 * n * n > most_primitives) break;
    fmt::print(stderr, "hierarchies: ground of {} triangles\n", 2 * n * n);
    const SceneDescription scene = make_terrain(n);
    const PictureRays rays = record_rays(scene, side_px);
    const SceneFacts facts = look_at_scene(scene, 1);
    for (const auto& [setting, build] : make_choices())
      points.push_back(point_of(
          "ground", std::string(word(build.hierarchy)) + (*setting ? "-" : "") + setting, 2.0 * n * n,
          run_hierarchy(scene, build, rays_for(build.hierarchy, rays, size_t{2} * n * n), facts,
                        {.builds = 1, .passes = 3})));
  }
  return points;
}

std::vector<HierarchyRow> measure_scene_of_today(const std::string& name, const std::string& path,
                                                 int side_px) {
  const SceneDescription scene = load_scene(path);
  const PictureRays rays = record_rays(scene, side_px);
  const SceneFacts facts = look_at_scene(scene, 1);
  const size_t primitives = primitives_of(compile(scene, {.hierarchy = Hierarchy::brute}));
  std::vector<HierarchyRow> rows;
  for (const auto& [setting, build] : make_choices()) {
    fmt::print(stderr, "hierarchies: {}, {} {}\n", name, word(build.hierarchy), setting);
    rows.push_back({0, name, word(build.hierarchy), setting, 0,
                    run_hierarchy(scene, build, rays_for(build.hierarchy, rays, primitives), facts,
                                  {.builds = 1, .passes = 3})});
  }
  return rows;
}

std::vector<PeerTime> read_peer_times(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::vector<PeerTime> times;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    if (number == 1 || line.empty()) continue;  // the columns' names
    PeerTime time;
    std::istringstream cells(line);
    std::string rays, ours, theirs;
    std::getline(cells, time.scene, ',');
    std::getline(cells, rays, ',');
    std::getline(cells, ours, ',');
    std::getline(cells, theirs, ',');
    char *end_of_ours = nullptr, *end_of_theirs = nullptr;
    time.rayfarm_ns = std::strtod(ours.c_str(), &end_of_ours);
    time.peer_ns = std::strtod(theirs.c_str(), &end_of_theirs);
    if (!(time.rayfarm_ns > 0) || !(time.peer_ns > 0) || *end_of_ours != '\0' || *end_of_theirs != '\0')
      throw InputError(
          {file.string(), number, 1},
          "this is not a row of scene, rays and two times; let tests/bench/same_rays write the file again, "
          "or take it away");
    times.push_back(time);
  }
  return times;
}

}  // namespace rayfarm
