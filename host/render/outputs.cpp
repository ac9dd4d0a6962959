#include "host/render/outputs.h"

#include <unistd.h>

#include <array>
#include <filesystem>
#include <utility>

#include "common/errors/input_error.h"
#include "common/files/sha256.h"
#include "common/scene/settings_codec.h"
#include "host/process/exit_code.h"

namespace rayfarm {
namespace {

namespace fs = std::filesystem;

struct Output {
  const char* option;
  std::string file;
};

std::vector<Output> outputs_of(const RenderOptions& options) {
  std::vector<Output> outputs{{"-o", options.output}};
  if (!options.stats.empty()) outputs.push_back({"--stats", options.stats});
  // What is there is read, and its folder may be anybody's.
  std::error_code ignored;
  if (!options.zones_file.empty() && !fs::is_regular_file(options.zones_file, ignored))
    outputs.push_back({"--zones", options.zones_file});
  if (!options.cost_map.empty()) outputs.push_back({"--cost-map", options.cost_map});
  return outputs;
}

fs::path folder_of(const std::string& file) {
  const fs::path folder = fs::path(file).parent_path();
  return folder.empty() ? "." : folder;
}

[[noreturn]] void refuse(const Output& output, const std::string& problem) {
  throw JobError(kUsageError, fmt::format("{} {}: {}", output.option, output.file, problem));
}

/// The attributes that tell whether a file is this job's picture, and what it is of if they differ.
constexpr std::array<std::pair<const char*, const char*>, 3> kIdentifying{
    {{"rayfarm/version", "another version of Rayfarm"},
     {"rayfarm/scene", "another scene"},
     {"rayfarm/settings", "other settings"}}};

}  // namespace

void check_outputs(const RenderOptions& options) {
  const std::vector<Output> outputs = outputs_of(options);
  std::error_code ignored;
  for (const Output& output : outputs) {
    const fs::path folder = folder_of(output.file), parent = folder_of(folder.string());
    const bool is_there = fs::is_directory(folder, ignored);
    if (!is_there && fs::exists(folder, ignored))
      refuse(output, fmt::format("'{}' is not a folder", folder.string()));
    if (!is_there && !fs::is_directory(parent, ignored))
      refuse(output,
             fmt::format("there is no folder '{}', nor one to make it in; make it first", folder.string()));
    const fs::path& needed = is_there ? folder : parent;
    if (access(needed.c_str(), W_OK) != 0)
      refuse(output,
             fmt::format("the folder '{}' can't be written to; check its permissions", needed.string()));
    if (fs::is_directory(output.file, ignored)) refuse(output, "is a folder; name a file");
    for (const Output& other : outputs)
      if (&other != &output &&
          fs::weakly_canonical(other.file, ignored) == fs::weakly_canonical(output.file, ignored))
        refuse(output,
               fmt::format("{} names the same file; each output needs a name of its own", other.option));
    if (fs::equivalent(output.file, options.scene, ignored))
      refuse(output, "is the scene itself, which would be replaced; choose another name");
  }
}

void check_outputs_are_no_inputs(const RenderOptions& options, const std::vector<std::string>& pictures,
                                 const std::vector<std::string>& inputs) {
  std::vector<Output> outputs = outputs_of(options);
  for (const std::string& file : pictures) outputs.push_back({"-o", file});
  std::error_code ignored;
  for (const Output& output : outputs) {
    if (!fs::exists(output.file, ignored)) continue;
    for (const std::string& input : inputs)
      if (fs::equivalent(output.file, input, ignored))
        refuse(output, "the scene is made of this file, which would be replaced; choose another name");
  }
}

void make_output_folders(const RenderOptions& options) {
  for (const Output& output : outputs_of(options)) {
    std::error_code error;
    fs::create_directory(folder_of(output.file), error);
    if (error) refuse(output, fmt::format("its folder can't be made: {}", error.message()));
  }
}

std::map<std::string, std::string> make_attributes(const RenderSettings& settings,
                                                   std::span<const std::byte> scene_block) {
  return {{"rayfarm/version", RAYFARM_VERSION},
          {"rayfarm/seed", fmt::format("{}", settings.seed)},
          {"rayfarm/samples", fmt::format("{}", settings.samples)},
          {"rayfarm/scene", sha256(scene_block)},
          {"rayfarm/settings", sha256(encode_settings(settings))}};
}

std::string why_not_finished(const std::string& file, const RenderSettings& settings, FrameNumber frame,
                             const std::map<std::string, std::string>& attributes) {
  try {
    const ImageInfo info = read_image_info(file);
    const auto attribute = [&](const std::string& name) {
      const auto found = info.attributes.find(name);
      return found == info.attributes.end() ? std::string() : found->second;
    };
    if (info.window.width() != settings.crop.width() || info.window.height() != settings.crop.height())
      return fmt::format("has {}×{} pixels, not {}×{}", info.window.width(), info.window.height(),
                         settings.crop.width(), settings.crop.height());
    for (const auto& [name, another] : kIdentifying) {
      const std::string value = attribute(name);
      if (value.empty()) return "does not say how it was rendered";
      if (value != attributes.at(name)) return fmt::format("is of {}", another);
    }
    if (const std::string pass = attribute("rayfarm/pass"); !pass.empty())
      return fmt::format("is of pass {}, and not finished", pass);
    if (attribute("rayfarm/frame") != fmt::format("{}", frame.value())) return "is of another frame";
    check_image_whole(file);
  } catch (const IoError& e) {
    return fmt::format("is not a whole picture ({})", e.what());
  }
  return {};
}

}  // namespace rayfarm
