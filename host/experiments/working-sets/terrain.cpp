#include "host/experiments/working-sets/terrain.h"

#include <fmt/core.h>

#include <cmath>
#include <filesystem>

#include "host/files/text_file.h"

namespace rayfarm {

void write_terrain(const std::string& path, int cells) {
  const std::filesystem::path mesh = std::filesystem::path(path).replace_extension(".obj");
  std::string text = "# Hills.\n";
  for (int row = 0; row <= cells; ++row)
    for (int column = 0; column <= cells; ++column) {
      const double x = 20.0 * column / cells - 10, z = 20.0 * row / cells - 10;
      const double y =
          std::sin(x) * std::cos(0.8 * z) + 0.3 * std::sin(3.1 * x + z) + 0.08 * std::sin(9 * z - 7 * x);
      text += fmt::format("v {:.6g} {:.6g} {:.6g}\n", x, y, z);
    }
  for (int row = 0; row < cells; ++row)
    for (int column = 0; column < cells; ++column) {
      const int a = row * (cells + 1) + column + 1, b = a + cells + 1;
      text += fmt::format("f {} {} {}\nf {} {} {}\n", a, b, a + 1, a + 1, b, b + 1);
    }
  write_text_file(mesh.string(), text);
  write_text_file(
      path, fmt::format("view: {{location: [0, 5, 13], look_at: [0, -1, 0], field_of_view: 60, aspect: 1}}\n"
                        "lights: [{{position: [-30, 20, 10]}}]\n"
                        "materials: {{hills: {{color: [0.7, 0.65, 0.5], reflect: 0.2}}}}\n"
                        "scene: [{{material: hills, mesh: {{file: {}}}}}]\n",
                        mesh.filename().string()));
}

}  // namespace rayfarm
