#include <fmt/core.h>

#include <filesystem>

#include "common/description/formats/mesh_loaders.h"
#include "common/description/formats/mesh_scene.h"
#include "common/image/image_file.h"
#include "host/commands/commands.h"
#include "host/files/text_file.h"
#include "host/process/console.h"
#include "host/process/exit_code.h"
#include "host/process/interrupt.h"

namespace rayfarm {
namespace {

struct ConvertOptions {
  std::string model, output;
  UpAxis up = UpAxis::usual;
  bool is_forced = false;
};

void check_options(const ConvertOptions& o) {
  if (!find_mesh_format(o.model))
    throw UsageError(fmt::format("{}: is no model that Rayfarm reads ({})", o.model, mesh_extensions()));
  const std::string extension = extension_of(o.output);
  if (extension != ".yaml" && extension != ".yml")
    throw UsageError(fmt::format("{}: the scene's name must end in .yaml", o.output));
  if (!o.is_forced && std::filesystem::exists(o.output))
    throw UsageError(fmt::format("{}: is there already; --force puts the new scene in its place", o.output));
}

/// The model's name, from the folder of the scene.
std::string name_from_scene(const ConvertOptions& o) {
  namespace fs = std::filesystem;
  const auto whole = [](const fs::path& path) { return fs::weakly_canonical(fs::absolute(path)); };
  const std::string name = whole(o.model).lexically_relative(whole(o.output).parent_path()).generic_string();
  if (name.find_first_of("\n\r") != std::string::npos)
    throw InputError({o.model}, "a scene can't name a file whose name has several lines");
  return name;
}

int convert(const ConvertOptions& o) try {
  const StopOnInterrupt stop;
  const std::string text =
      yaml_of_mesh_scene(o.model, name_from_scene(o), {.stop = stop.token(), .up = o.up});
  write_text_file(o.output, text);
  fmt::print("{}\n", o.output);
  return kComplete;
} catch (const Stopped&) {
  say("rayfarm: stopped before {} was written\n", o.output);
  return kStopped;
}

}  // namespace

void add_convert_command(CommandLine& line) {
  const auto o = std::make_shared<ConvertOptions>();
  Verb verb;
  verb.name = "convert";
  verb.help = "write a scene that shows a model as `render` does, to go on from";
  verb.examples = {
      {"rayfarm convert model.glb scene.yaml", "a view, lights and the model, to be changed by hand"}};
  verb.check = [o](const auto&) { check_options(*o); };
  verb.run = [o](const Renders&) { return convert(*o); };
  Options options = line.add(std::move(verb));
  options.text("MODEL", o->model, ".glb, .gltf, .obj, .off, .ply or .stl, which the scene will name")
      .required();
  options.text("SCENE", o->output, "the .yaml that is written").required();
  options.choice<UpAxis>("--up", o->up, {{"y", UpAxis::y}, {"z", UpAxis::z}},
                         "which axis of a mesh's file is up (default: z of .stl, else y)");
  options.flag("--force", o->is_forced, "in place of one that is there already");
}

}  // namespace rayfarm
