#pragma once
// Seeds of files that hold values at points in space, and scenes that read them.
#include <fmt/core.h>

#include <string>
#include <tuple>
#include <vector>

namespace rayfarm::fuzz {

inline constexpr const char* kYamlArray =
    "view: {location: [0, 0, 5], look_at: [0, 0, 0]}\ntextures: {t: {kind: array, file: in.npy, scale: "
    "0.3}}\n"
    "materials: {m: {color: 1, texture: t, bump: {texture: t, height: 0.1}}}\n"
    "scene: [{material: m, sphere: {center: [0, 0, 0], radius: 1}}]\n";
inline std::vector<std::string> npy_seeds() {
  std::vector<std::string> seeds;
  for (const auto& [kind, shape, bytes] : {std::tuple("<f4', 'fortran_order': False", "(2, 3, 2)", 48),
                                           {"|u1', 'fortran_order': True", "(2, 2, 1, 3)", 12}}) {
    const std::string header = fmt::format("{{'descr': '{}, 'shape': {}, }}\n", kind, shape);
    seeds.push_back(std::string("\x93NUMPY\x01\0", 8) + static_cast<char>(header.size()) + '\0' + header +
                    std::string(static_cast<size_t>(bytes), '\0'));
  }
  return seeds;
}

inline constexpr const char* kRawGrid = "file: in.raw, size: [2, 3, 1], type: float32, endian: big";
inline constexpr const char* kNrrd =
    "NRRD0004\n# a comment\ntype: uint8\ndimension: 3\nsizes: 2 2 2\nencoding: raw\n";
inline std::string yaml_medium(const std::string& grid) {
  return "view: {location: [0, 0, 5], look_at: [0, 0, 0]}\nlights: [{position: [1, 2, 3]}]\nmedia:\n"
         "  - {box: {min: [-1, -1, -1], max: [1, 1, 1]}, scattering: [1, 2, 0.5], absorption: 0.1, g: 0.4, "
         "grid: "
         "{" +
         grid + "}}\nscene: [{sphere: {center: [0, 0, 0], radius: 0.5}}]\n";
}

}  // namespace rayfarm::fuzz
