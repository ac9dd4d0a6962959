#include "host/render/zones_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <string_view>

#include "common/errors/input_error.h"
#include "common/files/read_file.h"
#include "common/files/sha256.h"
#include "common/files/whole_file.h"
#include "host/process/exit_code.h"
#include "host/render/output_pattern.h"
#include "host/render/settings_lines.h"
#include "protocol/messages.h"

namespace rayfarm {
namespace {

/// The first line, which says what the file is: the number is the format's.
constexpr std::string_view kMagic = "rayfarm-zones 2\n";
/// Longer than any header.
constexpr size_t kMostHeaderBytes = 1 << 16;

[[noreturn]] void refuse(int code, const std::string& file, const std::string& problem,
                         const std::string& what_to_do) {
  throw JobError(code, fmt::format("--zones {}: {}; {}", file, problem, what_to_do));
}

[[noreturn]] void refuse_damaged(const std::string& file, const std::string& problem) {
  refuse(kSceneError, file, problem, "remove it, and it is made anew");
}

std::span<const std::byte> bytes_of(std::string_view text) {
  return std::as_bytes(std::span(text));
}

/// Of all that is seen, whoever looks at it. The curves of the view are the last, and so are their keys.
std::string hash_without_view(const Scene& scene) {
  const uint32_t curves = scene.head().view.location;
  const auto& [interpolation, first_key, key_count, first_value] = scene.curves[curves];
  std::string hashes;
  for_each_array(scene, [&]<typename T>(const char* name, std::span<const T> array) {
    if constexpr (std::is_same_v<T, SceneHeader>) {
      SceneHeader header = array.front();
      header.view = {};
      hashes += sha256(std::as_bytes(std::span(&header, 1)));
      return;
    }
    if (std::is_same_v<T, CurveRecord>)
      array = array.first(curves);
    else if (array.data() == static_cast<const void*>(scene.key_frames.data()))
      array = array.first(first_key);
    else if (array.data() == static_cast<const void*>(scene.key_values.data()))
      array = array.first(first_value);
    hashes += fmt::format("{} {} ", name, sha256(std::as_bytes(array)));
  });
  return sha256(bytes_of(hashes));
}

}  // namespace

RenderSettings settings_of_zones(const RenderSettings& settings) {
  const RenderSettings usual;
  RenderSettings s = settings;
  s.width_px = usual.width_px;
  s.height_px = usual.height_px;
  s.crop = usual.crop;
  s.fit = usual.fit;
  s.pixel_format = usual.pixel_format;
  s.sampling = usual.sampling;
  s.samples = usual.samples;
  s.subpixels = usual.subpixels;
  s.filter = usual.filter;
  s.exposure_stops = usual.exposure_stops;
  s.shutter = usual.shutter;
  s.adaptive_contrast = usual.adaptive_contrast;
  s.noise = usual.noise;
  s.diffuse_rays = usual.diffuse_rays;
  s.diffuse_reach = usual.diffuse_reach;
  s.diffuse_contrast = usual.diffuse_contrast;
  s.diffuse_jitter = usual.diffuse_jitter;
  s.diffuse_bands = usual.diffuse_bands;
  s.diffuse_set = usual.diffuse_set;
  s.reflected_rays = usual.reflected_rays;
  s.transmitted_rays = usual.transmitted_rays;
  s.ambient_colour = usual.ambient_colour;
  s.item_buffer = usual.item_buffer;
  s.item_radius_px = usual.item_radius_px;
  s.light_cells = usual.light_cells;
  s.min_weight = usual.min_weight;
  s.glass_shadows = usual.glass_shadows;
  const bool is_matrix = s.lighting == LightingModel::radiosity;
  if (is_matrix) {
    s.zones.shooting = usual.zones.shooting;
    s.zones.tolerance = usual.zones.tolerance;
  }
  if (is_matrix && s.zones.form_factors == FormFactors::hemicube) s.zones.rays = usual.zones.rays;
  if (!is_matrix || s.zones.form_factors == FormFactors::rays)
    s.zones.hemicube_cells = usual.zones.hemicube_cells;
  if (!is_matrix) s.zones.form_factors = usual.zones.form_factors;
  s.zones.view = usual.zones.view;
  s.zones.gather_rays = usual.zones.gather_rays;
  s.zones.batch = usual.zones.batch;
  s.zones.most_GiB = usual.zones.most_GiB;
  return s;
}

ZonesFile::ZonesFile(std::string name, const Scene& scene, const RenderSettings& settings, bool has_poses)
    : name_(std::move(name)), has_poses_(has_poses) {
  const RenderSettings s = settings_of_zones(settings);
  lines_ = {{"version", RAYFARM_VERSION}, {"scene", hash_without_view(scene)}};
  const Lines of_settings = rayfarm::lines_of(s);
  lines_.insert(lines_.end(), of_settings.begin(), of_settings.end());
}

std::string ZonesFile::file_of(FrameNumber frame) const {
  return file_of_frame(name_, frame);
}

ZonesFile::Lines ZonesFile::lines_of(FrameNumber frame) const {
  Lines lines = lines_;
  lines.insert(lines.begin() + 2, {"frame", has_poses_ ? fmt::format("{}", frame.value()) : "any"});
  return lines;
}

std::optional<Bytes> ZonesFile::read(FrameNumber frame) const {
  const std::string file = file_of(frame);
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) return std::nullopt;
  const std::string text = read_file(file, kMostHeaderBytes + kMostPhaseDataBytes);
  const std::string_view all = text;
  const std::string_view magic = kMagic.substr(0, kMagic.find(' ') + 1);
  if (!all.starts_with(magic))
    refuse(kUsageError, file, "this is no file of zones, and would be replaced", "choose another name");
  if (!all.starts_with(kMagic))
    refuse(kUsageError, file, "it is of another version of Rayfarm", "remove it, or name another file");
  const size_t end = all.substr(0, kMostHeaderBytes).find("\n\n");
  if (end == std::string_view::npos) refuse_damaged(file, "it is cut off, or damaged");
  std::string_view header = all.substr(kMagic.size(), end + 1 - std::min(end + 1, kMagic.size()));
  const std::string_view payload = all.substr(end + 2);
  const auto next_line = [&](std::string_view name) {
    const size_t stop = header.find('\n'), space = header.find(' ');
    if (stop == std::string_view::npos || space > stop || header.substr(0, space) != name)
      refuse_damaged(file,
                     fmt::format("it is damaged: its header has no '{}' where that should stand", name));
    const std::string_view value = header.substr(space + 1, stop - space - 1);
    header.remove_prefix(stop + 1);
    return value;
  };
  std::string differences;
  const auto lines = lines_of(frame);
  for (const auto& [name, value] : lines)
    if (next_line(name) != value && (name != "settings" || differences.empty()))
      differences += (differences.empty() ? "" : ", ") + name_difference(name);
  const std::string_view length = next_line("length"), hash = next_line("sha256");
  uint64_t bytes = 0;
  const auto [stop, error] = std::from_chars(length.data(), length.data() + length.size(), bytes);
  if (error != std::errc{} || stop != length.data() + length.size() || !header.empty())
    refuse_damaged(file, "it is damaged: its header can't be read");
  if (payload.size() < bytes)
    refuse_damaged(file, fmt::format("it is cut off: {} of {} bytes are there", payload.size(), bytes));
  if (payload.size() > bytes || sha256(bytes_of(payload)) != hash)
    refuse_damaged(file, "it is damaged: its bytes are not those that were written");
  if (!differences.empty())
    refuse(kUsageError, file, "it is of " + differences, "remove it, or name another file");
  const auto solution = bytes_of(payload);
  return Bytes(solution.begin(), solution.end());
}

void ZonesFile::write(FrameNumber frame, std::span<const std::byte> solution) const {
  std::string header(kMagic);
  for (const auto& [name, value] : lines_of(frame)) header += fmt::format("{} {}\n", name, value);
  header += fmt::format("length {}\nsha256 {}\n\n", solution.size(), sha256(solution));
  write_whole_file(file_of(frame), [&](std::FILE* out) {
    std::fwrite(header.data(), 1, header.size(), out);  // what fails shows in the file's own mark
    std::fwrite(solution.data(), 1, solution.size(), out);
  });
}

}  // namespace rayfarm
