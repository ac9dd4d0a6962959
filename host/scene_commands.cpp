#include "host/scene_commands.h"

#include <fmt/core.h>

#include <cmath>
#include <filesystem>
#include <utility>

#include "common/compile/compile.h"
#include "common/compile/darkness.h"
#include "host/console.h"
#include "host/exit_code.h"

namespace rayfarm {
namespace {

/// What a render of the first frame would refuse, or could not show: compile, and look through the camera.
CompiledScene compile_and_look(const SceneDescription& scene) {
  CompiledScene compiled = compile(scene);
  const int frame = scene.frames ? (*scene.frames)[0] : 0;
  const auto [width, height] = scene.view.size_px();
  try {
    if (const auto problem = nothing_in_view(compiled.scene, frame, width, height))
      compiled.notes.add(scene.source(), fmt::format("at frame {}: {}", frame, *problem));
  } catch (const std::domain_error& e) {
    throw InputError({scene.files.at(0)}, fmt::format("at frame {}: {}", frame, e.what()));
  }
  RenderSettings paths;
  paths.lighting = LightingModel::path;
  if (is_dark(compiled.scene, paths) && !is_dark(compiled.scene, {}))
    compiled.notes.add(
        scene.source(),
        "`--lighting path` shows the scene black: it leaves ambient light out, and nothing else "
        "lights the scene");
  for (const std::string& note : compiled.notes.lines()) say("rayfarm: {}\n", note);
  return compiled;
}

void print_tree(const SceneDescription& scene, uint32_t object, size_t depth, size_t& lines_left) {
  if (lines_left == 0) return;
  if (--lines_left == 0) {
    fmt::print("  …\n");
    return;
  }
  const ObjectDescription& o = scene.objects[object];
  fmt::print("  {:{}}{}{}{}\n", "", 2 * depth, o.name,
             o.primitives.empty()
                 ? ""
                 : fmt::format(": {} primitive{}", o.primitives.size(), o.primitives.size() == 1 ? "" : "s"),
             o.children.empty()
                 ? ""
                 : fmt::format(" ({} child{})", o.children.size(), o.children.size() == 1 ? "" : "ren"));
  for (const ChildDescription& child : o.children) print_tree(scene, child.object, depth + 1, lines_left);
}

std::string megabytes(size_t bytes) {
  return fmt::format("{:.2f} MiB", static_cast<double>(bytes) / (1 << 20));
}

/// Files that would be missed where the scene's folder alone is copied to.
void list_files_outside(const SceneDescription& scene) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::weakly_canonical(fs::absolute(scene.files.at(0))).parent_path();
  bool is_first = true;
  for (const std::string& file : scene.files) {
    const fs::path there = fs::weakly_canonical(fs::absolute(file)).lexically_relative(folder);
    if (there.empty() || *there.begin() != "..") continue;
    if (std::exchange(is_first, false)) say("outside of the scene's folder:\n");
    say("  {}\n", file);
  }
}

}  // namespace

int run_check(const std::string& path) {
  const SceneDescription scene = load_scene(path);
  const CompiledScene compiled = compile_and_look(scene);
  for (const std::string& file : scene.files) fmt::print("{}\n", file);
  list_files_outside(scene);
  const size_t warnings = compiled.notes.lines().size();
  if (warnings == 0)
    say("{}: no problems found\n", path);
  else
    say("{}: {} warning{}\n", path, warnings, warnings == 1 ? "" : "s");
  return kComplete;
}

int run_info(const std::string& path) {
  const SceneDescription scene = load_scene(path);
  const CompiledScene compiled = compile_and_look(scene);
  const Scene& s = compiled.scene;
  fmt::print("files\n");
  for (const std::string& file : scene.files) fmt::print("  {}\n", file);
  fmt::print("counts\n  triangles {}, spheres {}, polygons {}, quadrics {} (stored once each)\n",
             s.triangle_shading.size(), s.spheres.size(), s.polygons.size(), s.quadrics.size());
  fmt::print("  parts {}, instances {}, object nodes {}, lights {}, materials {}\n", s.parts.size(),
             s.instances.size(), s.object_nodes.size(), s.lights.size(), s.materials.size());
  if (scene.frames)
    fmt::print("  frames {} to {}{}\n", (*scene.frames)[0], (*scene.frames)[1],
               !s.moving_instances.empty() ? ", objects move" : "");
  Box box;
  for (const InstancePose& pose : s.poses) box.grow(pose.bounds);
  if (!box.is_empty())
    fmt::print("bounds\n  x {:g} to {:g}, y {:g} to {:g}, z {:g} to {:g}\n", box.lo.x, box.hi.x, box.lo.y,
               box.hi.y, box.lo.z, box.hi.z);
  fmt::print("object tree\n");
  size_t lines = 60;
  print_tree(scene, scene.root, 0, lines);
  fmt::print("memory (the block that load data carries)\n");
  for_each_array(s, [&]<typename T>(const char* name, std::span<const T> array) {
    if (array.size_bytes() >= 1024)
      fmt::print("  {:<18} {:>10} × {:>3} bytes  {:>12}\n", name, array.size(), sizeof(T),
                 megabytes(array.size_bytes()));
  });
  fmt::print("  {:<18} {:>30}\n", "in all", megabytes(compiled.block.size));
  return kComplete;
}

int run_compare(const CompareOptions& options) {
  constexpr uint64_t kMostPixels = uint64_t{65536} * 65536;  // of any picture that can be rendered
  ImageReader a(options.a, kMostPixels), b(options.b, kMostPixels);
  if (holds_linear_light(options.a) != holds_linear_light(options.b))
    say("rayfarm: one file holds linear light, the other sRGB: their numbers are compared as they are\n");
  if (a.width_px() != b.width_px() || a.height_px() != b.height_px()) {
    fmt::print("the sizes differ: {}×{} and {}×{}\n", a.width_px(), a.height_px(), b.width_px(),
               b.height_px());
    return kRenderFailure;
  }
  const size_t pixels = static_cast<size_t>(a.width_px()) * static_cast<size_t>(a.height_px());
  size_t differing = 0;
  double largest = 0, squares = 0;
  for (int y = 0; y < a.height_px(); ++y) {
    const std::span<const float> row_a = a.next_row(), row_b = b.next_row();
    for (size_t i = 0; i < row_a.size(); i += 3) {
      bool differs = false;
      for (size_t c = i; c < i + 3; ++c) {
        const double p = static_cast<double>(row_a[c]), q = static_cast<double>(row_b[c]);
        const double d = p == q ? 0 : std::abs(p - q);
        if (!(d <= options.tolerance)) differs = true;  // a NaN differs
        largest = std::max(largest, std::isnan(d) ? INFINITY : d);
        squares += d * d;
      }
      differing += differs ? 1 : 0;
    }
  }
  const double share = static_cast<double>(differing) / static_cast<double>(pixels);
  fmt::print("{} of {} pixels differ by more than {:g} ({:.4f} %); largest difference {:g}; RMSE {:g}\n",
             differing, pixels, options.tolerance, 100 * share, largest,
             std::sqrt(squares / (3 * static_cast<double>(pixels))));
  return share <= options.share ? kComplete : kRenderFailure;
}

}  // namespace rayfarm
