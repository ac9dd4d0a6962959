#include <fmt/core.h>

#include <filesystem>
#include <utility>

#include "host/commands/commands.h"
#include "host/commands/compile_and_look.h"
#include "host/commands/hierarchy_options.h"
#include "host/commands/load_options.h"
#include "host/commands/scene_choices.h"
#include "host/process/console.h"
#include "host/process/exit_code.h"

namespace rayfarm {
namespace {

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

int check(const std::string& path, const LoadOptions& load, const BuildOptions& build) {
  const SceneDescription scene = load_scene(path, load);
  check_scene_choices(scene);
  const CompiledScene compiled = compile_and_look(scene, build);
  for (const std::string& file : scene.files) fmt::print("{}\n", file);
  list_files_outside(scene);
  const size_t warnings = compiled.notes.lines().size();
  if (warnings == 0)
    say("{}: no problems found\n", path);
  else
    say("{}: {} warning{}\n", path, warnings, warnings == 1 ? "" : "s");
  return kComplete;
}

}  // namespace

void add_check_command(CommandLine& line) {
  const auto path = std::make_shared<std::string>();
  const auto load = std::make_shared<LoadOptions>();
  const auto build = std::make_shared<BuildOptions>();
  Verb verb;
  verb.name = "check";
  verb.help = "validate a scene and list every file it uses";
  verb.examples = {{"rayfarm check scene.yaml", "all that is wrong with it, by line and column"}};
  verb.run = [path, load, build](const Renders&) { return check(*path, *load, *build); };
  Options options = line.add(std::move(verb));
  options.text("SCENE", *path, kSceneKinds).required();
  add_load_options(options, *load);
  options.begin_group("Hierarchy");
  add_hierarchy_options(options, *build);
}

}  // namespace rayfarm
