#pragma once
// Scenes that unit tests make, and random rays through them.
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <random>
#include <string>

#include "common/compile/compile.h"
#include "common/image/image_file.h"
#include "common/scene/render_settings.h"

namespace rayfarm::test {

inline std::string write_temporary(const std::string& name, const std::string& text) {
  const auto folder = std::filesystem::temp_directory_path() / ("rayfarm-unit-" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  const std::string path = (folder / name).string();
  std::ofstream(path) << text;
  return path;
}

inline std::string view_text() {
  return "view: {location: [0, 0, 5], look_at: [0, 0, 0]}\n";
}

inline SceneDescription load_yaml(const std::string& text) {
  return load_scene(write_temporary("scene.yaml", text));
}

/// The message of the InputError that loading and compiling the text ends in; "" if there is none.
inline std::string error_of(const std::string& text, const std::string& name = "scene.yaml") {
  try {
    compile(load_scene(write_temporary(name, text)));
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

/// What is noted, a line each.
inline std::string notes_of(const CompiledScene& compiled) {
  std::string all;
  for (const std::string& line : compiled.notes.lines()) all += line + "\n";
  return all;
}
inline std::string notes_of(const std::string& text) {
  return notes_of(compile(load_yaml(text)));
}

/// All pixels of an image, height × width × 3, as its file holds them.
inline std::vector<float> read_pixels(const std::string& path) {
  ImageReader reader(path, 1 << 20);
  std::vector<float> pixels;
  for (int y = 0; y < reader.height_px(); ++y) {
    const auto row = reader.next_row();
    pixels.insert(pixels.end(), row.begin(), row.end());
  }
  return pixels;
}

/// Writes an image of all directions whose texels `radiance` gives for (column, row), and returns its name.
inline std::string write_environment(int width, int height, const std::function<float(int, int)>& radiance) {
  Image image;
  image.width_px = width;
  image.height_px = height;
  image.window = {0, 0, width, height};
  image.layout = make_pixel_layout(PixelFormat::float32);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < 3; ++c) {
        const float value = radiance(x, y);
        std::byte bytes[4];
        std::memcpy(bytes, &value, 4);
        image.pixels.insert(image.pixels.end(), bytes, bytes + 4);
      }
  const std::string path = write_temporary("sky.exr", "");
  write_image(path, image, {});
  return path;
}

/// Materials and a scene: a body that moves, glass, and a ball that shines.
inline std::string bodies_in_motion() {
  return R"(materials: {m: {lambertian: [0.7, 0.5, 0.3]}, glass: {dielectric: flint}, lamp: {luminaire: {emission: 3}}}
scene:
  - {material: m, transform: {translate: {0: [-1, 0, 0], 1: [-0.6, 0, 0]}}, sphere: {center: [0, 0, 0], radius: 0.8}}
  - {material: glass, sphere: {center: [0.8, 0, 0.5], radius: 0.7}}
  - {material: lamp, sphere: {center: [0, 1.6, 0], radius: 0.4}}
)";
}

/// Of a whole small picture whose float pixels tests compare.
inline RenderSettings picture_settings(int width_px, int height_px, LightingModel model) {
  RenderSettings settings;
  settings.width_px = width_px;
  settings.height_px = height_px;
  settings.crop = {0, 0, width_px, height_px};
  settings.lighting = model;
  settings.pixel_format = PixelFormat::float32;
  return settings;
}

inline double uniform(std::mt19937& random, double low, double high) {
  // Not std::uniform_real_distribution: its sequence is the library's own.
  return low + (high - low) * (static_cast<double>(random()) / 4294967296.0);
}

inline Vec3 random_point(std::mt19937& random, double size) {
  const double x = uniform(random, -size, size), y = uniform(random, -size, size);
  return {x, y, uniform(random, -size, size)};
}

/// A description with one object of every primitive kind, many of them, scaled by `scale`.
inline SceneDescription make_mixed_scene(uint32_t seed, double scale, size_t count) {
  std::mt19937 random(seed);
  SceneDescription scene;
  scene.files = {"mixed"};
  scene.materials.emplace_back("default");
  scene.objects.push_back({"root", {}, {}, {}});
  auto& primitives = scene.objects[0].primitives;
  for (size_t i = 0; i < count; ++i) {
    const Vec3 p = random_point(random, scale);
    const double r = scale * uniform(random, 0.02, 0.15);
    switch (i % 5) {
      case 0:
        primitives.push_back({SphereShape{p, r}, 0, {}});
        break;
      case 1:
        primitives.push_back({ConeShape{p, p + random_point(random, 3 * r), r, 0.4 * r}, 0, {}});
        break;
      case 2: {  // a planar pentagon, concave
        const Vec3 u = random_point(random, r), v = glm::cross(u, random_point(random, 1));
        const Vec3 w = v * (glm::length(u) / std::max(1e-30, glm::length(v)));
        primitives.push_back(
            {PolygonShape{{p + u, p + w, p - u, p - 0.2 * u - 0.3 * w, p - 0.5 * w}, {}, Smoothing::flat},
             0,
             {}});
        break;
      }
      default:
        primitives.push_back(
            {PolygonShape{
                 {p, p + random_point(random, 2 * r), p + random_point(random, 2 * r)}, {}, Smoothing::flat},
             0,
             {}});
    }
  }
  return scene;
}

}  // namespace rayfarm::test
