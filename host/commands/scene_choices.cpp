#include "host/commands/scene_choices.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "common/description/formats/mesh_loaders.h"
#include "common/errors/input_error.h"
#include "common/files/read_file.h"
#include "common/image/image_file.h"
#include "host/commands/render_words.h"
#include "host/process/exit_code.h"
#include "host/render/choices.h"

namespace rayfarm {
namespace {

/// A command line that nobody typed.
class RenderLine {
 public:
  RenderLine() : line_("rayfarm", "", "") {
    Verb verb;
    verb.name = kName;
    Options options = line_.add(std::move(verb));
    add_render_options(options, options_);
  }

  RenderOptions& read(const std::vector<std::string>& words) {
    line_.read(words);
    return options_;
  }
  bool has_given(const std::string& name) const { return line_.is_given(kName, "--" + name); }
  OptionKind kind_of(const std::string& name) const { return line_.kind_of(kName, "--" + name); }
  std::vector<std::string> names_for_scenes() const { return line_.names_for_scenes(kName); }

  static constexpr const char* kName = "render";

 private:
  RenderOptions options_;
  CommandLine line_;
};

std::string word_of(const RenderChoice& choice) {
  return fmt::format("--{}={}", choice.name, choice.value);
}

/// Throws InputError where an option of the scene is none, or can't have its value.
void check_each(const SceneDescription& scene) {
  const RenderLine known;
  for (const RenderChoice& choice : scene.render) {
    const auto fail = [&](const std::string& problem) {
      throw InputError(scene.source(choice.place), problem);
    };
    const std::vector<std::string> names = known.names_for_scenes();
    switch (known.kind_of(choice.name)) {
      case OptionKind::for_scenes:
        break;
      case OptionKind::for_users:
        fail(
            fmt::format("`{}` is for whoever renders the scene to choose, on the command line; `render` has "
                        "what the picture looks like ({})",
                        choice.name, fmt::join(names, ", ")));
        break;
      case OptionKind::none:
        fail(fmt::format("unknown option '{}' in render (known: {}){}", choice.name, fmt::join(names, ", "),
                         suggestion(choice.name, names)));
    }
    try {
      RenderLine().read({RenderLine::kName, "scene", "-o", "picture.png", word_of(choice)});
    } catch (const UsageError& e) {
      fail(e.what());
    }
  }
}

/// The options of the command line with those of the scene that it leaves open.
/// `problem`: what was wrong without the scene's.
RenderOptions join(const std::vector<std::string>& words, const SceneDescription& scene,
                   const std::string& problem = "") {
  check_each(scene);
  RenderLine typed;
  typed.read(words);
  std::vector<std::string> all{words.front()};
  for (const RenderChoice& choice : scene.render)
    if (!typed.has_given(choice.name)) all.push_back(word_of(choice));
  all.insert(all.end(), words.begin() + 1, words.end());
  try {
    RenderLine line;
    RenderOptions options = line.read(all);
    check_render(options);
    for (const RenderChoice& choice : scene.render)
      if (choice.name == "crop" && !typed.has_given("crop")) options.crop_place = scene.source(choice.place);
    return options;
  } catch (const UsageError& e) {
    if (e.what() == problem) throw JobError(kUsageError, problem);
    throw InputError(scene.source(scene.render.front().place),
                     fmt::format("with what `render` asks for: {}", e.what()));
  }
}

/// True if the scene may have a `render` block, or is a mesh, for which one is made.
bool may_choose(const std::string& path) {
  if (find_mesh_format(path)) return true;
  const std::string extension = extension_of(path);
  if (extension != ".yaml" && extension != ".yml") return false;
  try {
    const std::string text = read_file(path, limits::kYamlFileBytes);
    return text.find("render") != std::string::npos || text.find("include") != std::string::npos;
  } catch (const IoError&) {
    return false;  // who loads it tells
  }
}

}  // namespace

void check_until_scene_is_known(RenderOptions& options, const std::vector<std::string>& words) {
  check_output(options);
  std::string problem;
  try {
    check_render(options);
  } catch (const UsageError& e) {
    if (!may_choose(options.scene)) throw;
    problem = e.what();  // unless the scene adds what is missing
  }
  options.adopt = [typed = options, words, problem](const SceneDescription& scene) {
    if (!scene.render.empty()) return join(words, scene, problem);
    if (!problem.empty()) throw JobError(kUsageError, problem);
    return typed;
  };
}

void check_scene_choices(const SceneDescription& scene) {
  if (scene.render.empty()) return;
  choose_settings(join({RenderLine::kName, "scene", "-o", "picture.png"}, scene), scene);
}

}  // namespace rayfarm
