#include "host/experiments/images/images.h"

#include <fmt/core.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <vector>

#include "host/files/text_file.h"

namespace rayfarm {
namespace {

using Point = std::array<double, 3>;

Point operator+(const Point& a, const Point& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
Point operator*(double s, const Point& a) {
  return {s * a[0], s * a[1], s * a[2]};
}

/// Writes a scene object by object.
class Writer {
 public:
  explicit Writer(const std::string& head) : text_(head + "scene:\n") {}

  void begin(const std::string& name, const std::string& material) {
    text_ += fmt::format("  - name: {}\n    material: {}\n    group:\n", name, material);
  }
  void polygon(const std::vector<Point>& points) {
    text_ += "      - {polygon: {points: [";
    for (size_t i = 0; i < points.size(); ++i)
      text_ += fmt::format("{}[{:.9g}, {:.9g}, {:.9g}]", i == 0 ? "" : ", ", points[i][0], points[i][1],
                           points[i][2]);
    text_ += "]}}\n";
  }
  /// A rectangle by a corner and two edges.
  void rectangle(const Point& corner, const Point& a, const Point& b) {
    polygon({corner, corner + a, corner + a + b, corner + b});
  }
  /// `profile`: radius and height of rings about a vertical axis; between two of them stand `sectors`
  /// polygons.
  void lathe(const Point& base, const std::vector<std::array<double, 2>>& profile, int sectors) {
    const auto at = [&](size_t ring, int sector) {
      const double turn = 2 * std::numbers::pi * sector / sectors;
      const auto [radius, height] = profile[ring];
      return base + Point{radius * std::cos(turn), height, radius * std::sin(turn)};
    };
    for (size_t ring = 0; ring + 1 < profile.size(); ++ring)
      for (int s = 0; s < sectors; ++s) {
        if (profile[ring][0] == 0)
          polygon({at(ring, 0), at(ring + 1, s), at(ring + 1, s + 1)});
        else if (profile[ring + 1][0] == 0)
          polygon({at(ring, s), at(ring, s + 1), at(ring + 1, 0)});
        else
          polygon({at(ring, s), at(ring, s + 1), at(ring + 1, s + 1), at(ring + 1, s)});
      }
  }
  void write(const std::string& path) const { write_text_file(path, text_); }

 private:
  std::string text_;
};

/// Rings whose radius follows `radius(t)` and height `height(t)`, t from 0 to 1.
template <typename Radius, typename Height>
std::vector<std::array<double, 2>> rings(int bands, Radius radius, Height height) {
  std::vector<std::array<double, 2>> profile;
  for (int i = 0; i <= bands; ++i) {
    const double t = double(i) / bands;
    profile.push_back({radius(t), height(t)});
  }
  return profile;
}

void add_tables(Writer& w) {
  w.begin("centre table", "brown");  // 70
  w.lathe({0, 0, -2}, {{0.9, 0}, {0.25, 0.15}, {0.25, 0.9}, {1.5, 0.95}, {1.5, 1.05}, {0, 1.05}}, 14);
  const std::vector<std::array<double, 2>> side = rings(
      10, [](double t) { return t < 1 ? 0.5 - 0.35 * std::sin(std::numbers::pi * t) : 0; },
      [](double t) { return 0.9 * std::min(1.0, t / 0.9); });
  for (const auto& [name, x] : {std::pair{"left table", -4.2}, std::pair{"right table", 4.2}}) {
    w.begin(name, "white");  // 180 each
    w.lathe({x, 0, -3.5}, side, 18);
  }
}

void add_tableware(Writer& w) {
  w.begin("dish", "white");  // 360
  w.lathe({0.55, 1.05, -1.6},
          rings(
              10, [](double t) { return 0.42 * t; }, [](double t) { return 0.01 + 0.1 * t * t * t; }),
          36);
  w.begin("glass", "gold");  // 360
  w.lathe({-0.55, 1.05, -1.6},
          {{0.2, 0},
           {0.16, 0.03},
           {0.03, 0.06},
           {0.03, 0.3},
           {0.08, 0.34},
           {0.16, 0.4},
           {0.2, 0.5},
           {0.21, 0.6},
           {0.2, 0.7},
           {0.18, 0.8},
           {0.17, 0.86}},
          36);
  w.begin("bowl", "blue");  // 260
  w.lathe(
      {0, 1.05, -2.5},
      rings(
          10, [](double t) { return 0.12 + 0.4 * std::sin(1.6 * t); }, [](double t) { return 0.35 * t * t; }),
      26);
  w.begin("vase", "red");  // 80
  w.lathe({-4.2, 0.9, -3.5}, {{0.12, 0}, {0.3, 0.25}, {0.24, 0.55}, {0.08, 0.8}, {0.12, 0.95}, {0.2, 1.05}},
          16);
}

/// Eight frames of pictures and windows: each five bars across and down, in front of and beside each other.
void add_frames(Writer& w) {
  w.begin("frames", "brown");  // 80
  for (int i = 0; i < 8; ++i) {
    const double x = i < 4 ? -5.95 : 5.95, z = -0.8 - 1.3 * (i % 4), depth = i < 4 ? 0.06 : -0.06;
    for (int bar = 0; bar < 5; ++bar) {
      w.rectangle({x + depth, 1.2 + 0.28 * bar, z}, {0, 0.06, 0}, {0, 0, -1});
      w.rectangle({x + depth, 1.2, z - 0.24 * bar}, {0, 1.18, 0}, {0, 0, -0.06});
    }
  }
}

/// A title on the back wall: 67 strokes.
void add_title(Writer& w) {
  w.begin("title", "green");
  for (int i = 0; i < 67; ++i) {
    const double x = -3.3 + 0.1 * i, turn = 0.9 * i;
    const Point stroke = 0.16 * Point{std::cos(turn), std::sin(turn), 0};
    w.rectangle({x, 3.35, -5.93}, stroke, {-0.25 * stroke[1], 0.25 * stroke[0], 0});
  }
}

}  // namespace

void write_beach_house(const std::string& path) {
  Writer w(
      "# Image 1 of the thesis's chapter 4 (Table 4.3), rebuilt.\n"
      "view: {location: [0, 2.3, 5.4], look_at: [0, 1.5, -3], field_of_view: 62, aspect: 1}\n"
      "lights: [{position: [1, 3.6, 1]}]\n"
      "materials:\n"
      "  white: {color: 0.9}\n  blue: {color: [0.25, 0.4, 0.9], specular: 0.3}\n"
      "  sky: {color: [0.45, 0.65, 0.95], ambient: 0.9, diffuse: 0.1}\n  green: {color: [0.2, 0.6, 0.25]}\n"
      "  brown: {color: [0.5, 0.32, 0.18]}\n  tan: {color: [0.85, 0.75, 0.55]}\n  red: {color: [0.8, 0.15, "
      "0.12]}\n"
      "  water: {color: [0.15, 0.35, 0.7], reflect: 0.3}\n"
      "  gold: {color: [0.9, 0.7, 0.25], specular: 0.5, shininess: 60, reflect: 0.2}\n");
  w.begin("room", "white");  // 14: floor, ceiling, walls about a door in the back and a window at each side
  const double h = 4, x = 6, near = 6, far = -6;  // the viewer stands inside
  w.rectangle({-x, 0, far}, {2 * x, 0, 0}, {0, 0, near - far});
  w.rectangle({-x, h, far}, {2 * x, 0, 0}, {0, 0, near - far});
  w.rectangle({-x, 0, near}, {2 * x, 0, 0}, {0, h, 0});
  w.rectangle({-x, 0, far}, {x - 1.5, 0, 0}, {0, h, 0});
  w.rectangle({1.5, 0, far}, {x - 1.5, 0, 0}, {0, h, 0});
  w.rectangle({-1.5, 3, far}, {3, 0, 0}, {0, h - 3, 0});
  for (const double side : {-x, x}) {
    w.rectangle({side, 0, far}, {0, 0, near - far}, {0, 1, 0});
    w.rectangle({side, 2.8, far}, {0, 0, near - far}, {0, h - 2.8, 0});
    w.rectangle({side, 1, far}, {0, 0, 5.6}, {0, 1.8, 0});
    w.rectangle({side, 1, 2}, {0, 0, near - 2}, {0, 1.8, 0});
  }
  w.begin("sky", "sky");
  w.rectangle({-3000, -10, -2500}, {6000, 0, 0}, {0, 2000, 0});
  w.begin("grass", "green");
  w.rectangle({-80, -0.1, -30}, {160, 0, 0}, {0, 0, 60});
  w.begin("sand", "tan");
  w.rectangle({-400, -0.3, -70}, {800, 0, 0}, {0, 0, 40});
  w.rectangle({-400, -0.5, -90}, {800, 0, 0}, {0, 0.2, 20});
  w.begin("water", "water");
  for (int i = 0; i < 3; ++i) w.rectangle({-3000, -0.6, -890.0 - 800 * i}, {6000, 0, 0}, {0, 0, 800});
  add_tables(w);
  add_tableware(w);
  add_frames(w);
  add_title(w);
  w.write(path);
}

void write_plant(const std::string& path) {
  Writer w(
      "# Image 3 of the thesis's chapter 4 (Table 4.3), rebuilt.\n"
      "view: {location: [0, 2.6, 5.2], look_at: [0, 1.75, 0], field_of_view: 46, aspect: 1}\n"
      "lights: [{position: [2.5, 5, 4]}]\n"
      "materials:\n  green: {color: [0.2, 0.6, 0.25], specular: 0.3, shininess: 30, reflect: 0.15}\n"
      "  brown: {color: [0.5, 0.3, 0.16]}\n  black: {color: 0.05}\n  white: {color: 0.9}\n");
  constexpr double kPi = std::numbers::pi;
  for (int leaf = 0; leaf < 8; ++leaf) {  // 294 each: 14 across, 21 along
    w.begin(fmt::format("leaf {}", leaf + 1), "green");
    const double turn = 2 * kPi * (leaf + 0.3 * (leaf % 2)) / 8, rise = 1.2 + 0.22 * (leaf % 4);
    const Point out{std::cos(turn), 0, std::sin(turn)}, aside{-out[2], 0, out[0]};
    const auto at = [&](int along, int across) {
      const double t = along / 21.0, u = across / 7.0 - 1;
      const double width = 0.5 * std::pow(std::sin(kPi * (0.04 + 0.92 * t)), 0.7);
      return Point{0, 1.3 + rise * (1.7 * t - 1.25 * t * t) - 0.12 * u * u, 0} + (0.1 + 1.5 * t) * out +
             width * u * aside;
    };
    for (int along = 0; along < 21; ++along)
      for (int across = 0; across < 14; ++across) {  // two triangles would be flat; the table has polygons
        const Point a = at(along, across), b = at(along + 1, across), c = at(along, across + 1);
        w.polygon({a, b, b + c + -1.0 * a, c});
      }
  }
  w.begin("pot", "brown");  // 280
  w.lathe({0, 0, 0},
          {{0, 0.01},
           {0.5, 0.01},
           {0.55, 0.3},
           {0.62, 0.6},
           {0.68, 0.85},
           {0.7, 1},
           {0.8, 1},
           {0.8, 1.15},
           {0.7, 1.15},
           {0.68, 1},
           {0.66, 0.9}},
          28);
  w.begin("dirt", "black");  // 36
  w.lathe({0, 0, 0}, {{0.67, 0.95}, {0, 1.0}}, 36);
  w.begin("stem", "green");  // 36
  w.lathe({0, 0, 0}, {{0.12, 0.95}, {0.1, 1.15}, {0.08, 1.4}, {0, 1.55}}, 12);
  w.begin("corner", "white");  // 4: a floor and walls near by
  w.rectangle({-3, 0, -2}, {6, 0, 0}, {0, 0, 8});
  w.rectangle({-3, 0, -2}, {6, 0, 0}, {0, 6, 0});
  w.rectangle({-3, 0, -2}, {0, 0, 8}, {0, 6, 0});
  w.rectangle({3, 0, -2}, {0, 0, 8}, {0, 6, 0});
  w.write(path);
}

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
