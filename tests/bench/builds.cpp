// The three ways to build a hierarchy, `--build fast|balanced|high`, against each other: what a build takes,
// and what single rays then cost. All walk the same rays in one process and one thread, in short chunks that
// alternate.
//
//   builds SCENE...           a table: references a primitive, seconds of the build (wall and CPU, best of
//                             three), expected cost; of primary, diffuse and shadow rays millions a second,
//                             and nodes + leaves that one visits
//   builds --costs SCENE...   what a ray, a node and a block of eight triangles take: fitted to the times and
//                             counts of walks through trees with leaves of at most 1, 2, 4 and 8
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <memory>
#include <numbers>
#include <random>

#include "common/compile/compile.h"
#include "common/hierarchy/walk_counts.h"
#include "common/lighting/surface.h"
#include "common/scene/camera.h"
#include "common/scene/references.h"
#include "protocol/clock.h"

namespace {

using namespace rayfarm;

constexpr int kImageSize_px = 256;
constexpr int kTile_px = 32;
constexpr size_t kChunk = 2048;   // rays
constexpr double kLeast_s = 0.4;  // that each set of rays is traced for

struct RaySet {
  const char* name;
  bool is_any_hit;
  std::vector<Ray> rays;
};

/// A hierarchy of a scene, and what was measured of it.
struct Tree {
  std::string name;
  CompiledScene compiled;
  std::unique_ptr<FrameState> state;
  double wall_s = 1e9, cpu_s = 1e9;             ///< of the build
  std::array<double, 3> best_s{1e9, 1e9, 1e9};  ///< by set of rays, one pass
};

Tree build(const std::string& name, const SceneDescription& description, const BuildOptions& options,
           int times) {
  Tree tree;
  tree.name = name;
  for (int i = 0; i < times; ++i) {
    const double wall = now_s(), cpu = cpu_s();
    tree.compiled = compile(description, options);
    tree.cpu_s = std::min(tree.cpu_s, cpu_s() - cpu);
    tree.wall_s = std::min(tree.wall_s, now_s() - wall);
  }
  tree.state = std::make_unique<FrameState>(tree.compiled.scene);
  return tree;
}

/// Primary rays in tiles, a diffuse ray from each hit, and a shadow ray from each to the first light.
std::vector<RaySet> make_rays(const Scene& scene, const Pose& pose) {
  std::vector<RaySet> sets{{"primary", false, {}}, {"diffuse", false, {}}, {"shadow", true, {}}};
  const Camera camera = make_camera(scene, 0, kImageSize_px, kImageSize_px);
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit;
  constexpr int kColumns = kImageSize_px / kTile_px;
  for (int tile = 0; tile < kColumns * kColumns; ++tile)
    for (int i = 0; i < kTile_px * kTile_px; ++i) {
      const Ray ray = camera.ray(tile % kColumns * kTile_px + i % kTile_px + 0.5,
                                 tile / kColumns * kTile_px + i / kTile_px + 0.5);
      sets[0].rays.push_back(ray);
      const Hit hit = closest_hit(scene, pose, ray);
      if (!hit.is_hit()) continue;
      const Surface surface = eval_surface(scene, pose, ray, hit);
      const Vec3 n = surface.geometric_normal;
      const Vec3 u = normalized(glm::cross(n, std::abs(n.x) < 0.5 ? Vec3(1, 0, 0) : Vec3(0, 1, 0)));
      const double phi = 2 * std::numbers::pi * unit(random), r2 = unit(random);
      const Vec3 direction =
          std::sqrt(r2) * (std::cos(phi) * u + std::sin(phi) * glm::cross(n, u)) + std::sqrt(1 - r2) * n;
      sets[1].rays.push_back({surface.ray_origin(direction), direction});
      if (scene.lights.empty()) continue;
      const Vec3 to_light = scene.lights[0].position - surface.p;
      if (!(glm::dot(n, to_light) > 0)) continue;
      const Vec3 origin = surface.ray_origin(to_light);
      sets[2].rays.push_back({origin, scene.lights[0].position - origin, 1});
    }
  return sets;
}

size_t trace(const Tree& tree, const RaySet& set, size_t begin, size_t end) {
  const Scene& scene = tree.compiled.scene;
  const Pose pose = tree.state->at(0);
  size_t hits = 0;
  for (size_t i = begin; i < end; ++i)
    hits +=
        set.is_any_hit ? any_hit(scene, pose, set.rays[i]) : closest_hit(scene, pose, set.rays[i]).is_hit();
  return hits;
}

/// Fills best_s; false if the trees do not agree in their hits.
bool measure(std::vector<Tree>& trees, const std::vector<RaySet>& sets) {
  for (size_t s = 0; s < sets.size(); ++s) {
    const double begin = now_s();
    do {
      std::vector<double> took_s(trees.size());
      std::vector<size_t> hits(trees.size());
      for (size_t first = 0; first < sets[s].rays.size(); first += kChunk)
        for (size_t t = 0; t < trees.size(); ++t) {
          const double start = thread_cpu_s();
          hits[t] += trace(trees[t], sets[s], first, std::min(sets[s].rays.size(), first + kChunk));
          took_s[t] += thread_cpu_s() - start;
        }
      for (size_t t = 0; t < trees.size(); ++t) {
        trees[t].best_s[s] = std::min(trees[t].best_s[s], took_s[t]);
        if (hits[t] != hits[0]) return false;
      }
    } while (now_s() - begin < kLeast_s * static_cast<double>(trees.size()));
  }
  return true;
}

/// What the surface area heuristic expects of lines through the parts' boxes, summed over parts: nodes and
/// blocks (or primitives that are tested one by one), each weighed as one.
double expected_cost(const Scene& scene) {
  double sum = 0;
  std::vector<std::pair<ChildRef, double>> stack;
  for (const Part& part : scene.parts) {
    if (part.collection.structure != Structure::volumes) continue;
    stack.emplace_back(part.collection.root, 1);
    while (!stack.empty()) {
      const auto [child, share] = stack.back();
      stack.pop_back();
      if (child.kind() == ChildKind::empty) continue;
      sum += share * (child.kind() == ChildKind::inner ? 1 : child.count());
      if (child.kind() != ChildKind::inner) continue;
      const VolumeNode& node = scene.nodes[child.first];
      const double area = bounds_of(node).area();
      for (size_t slot = 0; slot < 8; ++slot)
        if (node.children[slot].kind() != ChildKind::empty && area > 0)
          stack.emplace_back(node.children[slot], share * child_box(node, slot).area() / area);
    }
  }
  return sum;
}

void compare_builds(const std::string& path) {
  const SceneDescription description = load_scene(path);
  std::vector<Tree> trees;
  for (const auto& [name, quality] : {std::pair{"fast", BuildQuality::fast},
                                      {"balanced", BuildQuality::balanced},
                                      {"high", BuildQuality::high}})
    trees.push_back(build(name, description, {.quality = quality}, 3));
  const std::vector<RaySet> sets = make_rays(trees[0].compiled.scene, trees[0].state->at(0));
  if (!measure(trees, sets)) throw std::runtime_error("the trees do not hit the same");
  for (const Tree& tree : trees) {
    fmt::print("| {} | {} | {:.3f} | {:.3f} | {:.3f} | {:.2f} |", std::filesystem::path(path).stem().string(),
               tree.name,
               static_cast<double>(count_references(tree.compiled.scene)) /
                   static_cast<double>(count_references(trees[0].compiled.scene)),
               tree.wall_s, tree.cpu_s, expected_cost(tree.compiled.scene));
    for (size_t s = 0; s < sets.size(); ++s)
      fmt::print(" {:.3f} |", 1e-6 * static_cast<double>(sets[s].rays.size()) / tree.best_s[s]);
    for (const RaySet& set : sets) {
      WalkCounts counts;
      for (const Ray& ray : set.rays) {
        if (set.is_any_hit)
          any_hit_counted(tree.compiled.scene, tree.state->at(0), ray, counts);
        else
          closest_hit_counted(tree.compiled.scene, tree.state->at(0), ray, counts);
      }
      const auto rays = static_cast<double>(set.rays.size());
      fmt::print(" {:.1f}+{:.1f} |", static_cast<double>(counts.nodes) / rays,
                 static_cast<double>(counts.leaves) / rays);
    }
    fmt::print("\n");
    std::fflush(stdout);
  }
}

/// Least squares of three unknowns.
std::array<double, 3> solve(std::array<std::array<double, 4>, 3> m) {
  for (size_t i = 0; i < 3; ++i)
    for (size_t row = 0; row < 3; ++row) {
      if (row == i) continue;
      const double f = m[row][i] / m[i][i];
      for (size_t k = 0; k < 4; ++k) m[row][k] -= f * m[i][k];
    }
  return {m[0][3] / m[0][0], m[1][3] / m[1][1], m[2][3] / m[2][2]};
}

void fit_costs(const std::vector<std::string>& paths) {
  std::array<std::array<double, 4>, 3> closest{}, any{};  // normal equations
  for (const std::string& path : paths) {
    const SceneDescription description = load_scene(path);
    std::vector<Tree> trees;
    for (const uint32_t most : {1u, 2u, 4u, 8u}) {
      BuildOptions options;
      options.max_primitives = most;
      trees.push_back(build(fmt::format("{}", most), description, options, 1));
    }
    const std::vector<RaySet> sets = make_rays(trees[0].compiled.scene, trees[0].state->at(0));
    if (!measure(trees, sets)) throw std::runtime_error("the trees do not hit the same");
    for (const Tree& tree : trees)
      for (size_t s = 0; s < sets.size(); ++s) {
        WalkCounts counts;
        for (const Ray& ray : sets[s].rays) {
          if (sets[s].is_any_hit)
            any_hit_counted(tree.compiled.scene, tree.state->at(0), ray, counts);
          else
            closest_hit_counted(tree.compiled.scene, tree.state->at(0), ray, counts);
        }
        const auto rays = static_cast<double>(sets[s].rays.size());
        const std::array<double, 4> line{1, static_cast<double>(counts.nodes) / rays,
                                         static_cast<double>(counts.leaves) / rays,
                                         1e9 * tree.best_s[s] / rays};
        fmt::print("| {} | {} | {} | {:.2f} | {:.2f} | {:.0f} |\n",
                   std::filesystem::path(path).stem().string(), tree.name, sets[s].name, line[1], line[2],
                   line[3]);
        // Weighed by the time, so that errors are relative.
        auto& sums = sets[s].is_any_hit ? any : closest;
        for (size_t row = 0; row < 3; ++row)
          for (size_t column = 0; column < 4; ++column)
            sums[row][column] += line[row] * line[column] / (line[3] * line[3]);
      }
  }
  for (const auto& [name, sums] : {std::pair{"closest hit", closest}, {"any hit", any}}) {
    const std::array<double, 3> ns = solve(sums);
    fmt::print("{}: {:.1f} ns a ray, {:.1f} ns a node, {:.1f} ns a block; node / block {:.2f}\n", name, ns[0],
               ns[1], ns[2], ns[1] / ns[2]);
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> scenes;
  bool fits_costs = false;
  for (int i = 1; i < argc; ++i) {
    if (std::string(argv[i]) == "--costs")
      fits_costs = true;
    else
      scenes.emplace_back(argv[i]);
  }
  if (scenes.empty()) {
    fmt::print(stderr, "usage: builds [--costs] SCENE...\n");
    return 2;
  }
  try {
    if (fits_costs) {
      fit_costs(scenes);
    } else {
      fmt::print(
          "| scene | build | references | wall s | CPU s | cost | primary | diffuse | shadow | visits |  |  "
          "|\n"
          "|---|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n");
      for (const std::string& scene : scenes) compare_builds(scene);
    }
  } catch (const std::exception& e) {
    fmt::print(stderr, "builds: {}\n", e.what());
    return 1;
  }
  return 0;
}
