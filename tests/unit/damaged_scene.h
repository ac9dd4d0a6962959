#pragma once
// For tests of scene blocks that were damaged.
#include <cstring>
#include <functional>

#include "common/scene/scene_block.h"
#include "tests/unit/test_scene.h"

namespace rayfarm::test {

inline SceneBlock copy_of(std::span<const std::byte> bytes) {
  SceneBlock block;
  block.size = bytes.size();
  block.data.reset(static_cast<std::byte*>(std::aligned_alloc(64, (bytes.size() + 63) / 64 * 64)));
  std::memcpy(block.data.get(), bytes.data(), bytes.size());
  return block;
}

/// A scene with something in every array.
inline CompiledScene compile_everything() {
  Image sky{4, 2, {0, 0, 4, 2}, make_pixel_layout(PixelFormat::rgb8), {}};
  for (int i = 0; i < 24; ++i) sky.pixels.push_back(static_cast<std::byte>(10 * i));
  write_image(write_temporary("sky.png", ""), sky, {});
  write_temporary("lamp.ies", "TILT=NONE\n1 1 1 2 1 1 1 0 0 0\n1 1 1\n0 180\n0\n5 7\n");
  write_temporary("mesh.obj",
                  "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 1 1 0 0 0 1\nv 0 1 0.2 1 1 0\nv 0 -1 0 1 1 1\nv 1 -1 0 1 "
                  "0 1\nvt 0 0\nvt 1 0\nvt 1 1\nf 1/1 2/2 3/3\n"
                  "f 1/1 3/3 4/2\nf 5/1 6/2 2/3 1/1\n");
  write_temporary("smoke.raw", "@ 0P");
  std::string text = R"(
view: {location: {0: [0, 0, 6], 4: [1, 0, 6]}, look_at: [0, 0, 0], lens: {radius: 0.01, focus: 6}}
environment: {file: sky.png}
textures: {image: {kind: image, file: sky.png}, boards: {kind: boards}, array: {kind: array, size: [3, 2, 2], values: [0, 1, 0, 1, 0, 1, 0, 1, 0.5, 0, 1, 1], scale: 0.2}}
materials:
  painted: {color: 0.7, reflect: 0.1, texture: image, bump: {texture: boards, height: 0.01}}
  gold: {conductor: gold}
  glass: {dielectric: glass}
  lamp: {luminaire: {emission: 3, ies: lamp.ies}}
  green: {lambertian: {spectrum: [[450, 0.1], [540, 0.8], [600, 0.2]]}}
  leaf: {principled: {base_color: boards, metallic: {texture: image, channel: b}, opacity: {texture: image, channel: r}, cutoff: 0.5}}
  dusty: {mix: {a: green, b: gold, by: array}}
  dustier: {mix: {a: dusty, b: painted, by: boards}}
lights: [{position: [2, 3, 4]}, {position: [0, 4, 0], ies: lamp.ies}]
media:
  - {box: {min: [-1, -1, -1], max: [1, 1, 1]}, absorption: 0.1, scattering: {spectrum: [[450, 0.3], [600, 0.1]]}, grid: {file: smoke.raw, size: [2, 2, 1], type: uint8}}
  - {box: {min: [1, -1, -1], max: [2, 1, 1]}, scattering: 0.2, g: 0.5}
objects: {pair: [{sphere: {center: [0, 0, 0], radius: 0.3}}, {sphere: {center: [1, 0, 0], radius: 0.3}}]}
frames: [0, 4]
scene:
  - {material: painted, mesh: {file: mesh.obj, smooth: phong}}
  - {material: lamp, polygon: {points: [[-1, 2, 0], [1, 2, 0], [1, 2, 1], [-1, 2, 1]]}}
  - {material: lamp, sphere: {center: [-2, 2, 0], radius: 0.2}}
  - {material: glass, quadric: {coefficients: [1, 1, 1, 0, 0, 0, 0, 0, 0, -0.2], planes: [[0, 1, 0, 0]]}}
  - polygon: {points: [[-3, -1, -3], [3, -1, -3], [3, -1, 3], [0, -1, 0], [-3, -1, 3]],
              normals: [[0, 1, 0], [0, 1, 0], [0, 1, 0], [0, 1, 0.1], [0, 1, 0]], smooth: gouraud}
  - {material: dustier, sphere: {center: [0, 0, 1], radius: 0.4}}
  - {material: gold, use: pair, transform: [{rotate: {axis: [0, 0, 1], degrees: {0: 0, 4: 90}}}, {translate: [0, 1, 0]}]}
  - {use: pair, transform: {translate: [0, -2, 0]}}
  - {use: pair, transform: {translate: [1, -2, 0]}, visible: {0: true, 3: false}}
  - {structure: {thesis: {volumes: spheres, max_primitives: 1}}, group: [{sphere: {center: [0, 0, -4], radius: 0.3}}, {sphere: {center: [1, 1, -4], radius: 0.3}}]}
  - {structure: {adaptive: {max_primitives: 1, depth: 4, build: tracing}}, group: [{sphere: {center: [0, 3, -3], radius: 0.3}}, {sphere: {center: [1, 3, -3], radius: 0.3}}]}
  - {structure: {adaptive: {max_primitives: 1, depth: 4}}, group: [{sphere: {center: [0, 0, -3], radius: 0.3}}, {sphere: {center: [1, 0, -3], radius: 0.3}}]}
  - {structure: {regular: {cells: 2}}, group: [{polygon: {points: [[0, 0, -2], [1, 0, -2], [1, 1, -2], [0, 1, -2]]}},
     {sphere: {center: [0, 0, -2], radius: 0.3}}, {structure: thesis, sphere: {center: [1, 1, -2], radius: 0.3}}]}
  - {structure: object, group: [{name: a, mesh: {file: mesh.obj}}, {name: b, sphere: {center: [2, 2, -2], radius: 0.3}}]}
  - {light: {position: [0, 3, 0], falloff: true}, transform: {translate: {0: [0, 0, 0], 4: [1, 0, 0]}}}
  - {use: pair, transform: {orient: {0: {axis: [0, 1, 0], degrees: 0}, 4: {axis: [0, 1, 0], degrees: 90}}}}
)";
  text += "  - {mesh: {file: " RAYFARM_SOURCE "/tests/golden/scenes/tube.gltf}, transform: {scale: 0.3}}\n";
  for (int i = 0; i < 12; ++i)
    text += fmt::format("  - {{sphere: {{center: [{}, {}, -1], radius: 0.2}}}}\n", i % 4 - 1.5, i / 4 - 1.5);
  return compile(load_yaml(text));
}

/// Expects that the scene is refused when `damage` has been done to the first element of an array for which
/// it returns true.
template <typename T>
void expect_refusal(const CompiledScene& compiled, std::span<const T> Scene::*array,
                    const std::function<bool(T&)>& damage, const char* what) {
  SceneBlock copy = copy_of(compiled.block.bytes());
  const std::span<const T> elements = decode_scene(copy.bytes()).*array;
  const auto damaged = std::find_if(elements.begin(), elements.end(),
                                    [&](const T& element) { return damage(const_cast<T&>(element)); });
  ASSERT_NE(damaged, elements.end()) << what;
  EXPECT_THROW(decode_scene(copy.bytes()), SceneBlockError) << what;
}

/// The same of one element, in a scene that is written anew.
template <typename T>
void expect_refusal_at(const CompiledScene& compiled, std::span<const T> Scene::*array,
                       const std::function<void(T&)>& damage, const char* what, size_t index = 0) {
  Scene scene = compiled.scene;
  std::vector<T> elements((scene.*array).begin(), (scene.*array).end());
  damage(elements[index]);
  scene.*array = elements;
  EXPECT_THROW(decode_scene(encode_scene(scene).bytes()), SceneBlockError) << what;
}

}  // namespace rayfarm::test
