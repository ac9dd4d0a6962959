"""Writes tube.gltf: a skinned tube with a texture and colours of vertices, a ball that a morph target pulls out of shape,
panes of glass and of coloured film, a floor, a camera that moves, and lamps. All of it is made of numbers here."""
import math
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[2] / "scenes" / "models"))
from gltf_writer import Writer, grid, moved, picture, turn  # noqa: E402

writer = Writer()
accessor, view = writer.accessor, writer.view

# A tube about y from 0 to 3, on two bones: the upper one stands at 1.5.
SIDES, RINGS = 12, 8
round_ = lambda values: [float(f"{v:.5f}") for v in values]
points, triangles = grid(SIDES, RINGS, lambda u, v: round_((0.4 * math.cos(-2 * math.pi * u), 3 * v, 0.4 * math.sin(-2 * math.pi * u))))
normals = [round_((p[0] / 0.4, 0, p[2] / 0.4)) for p in points]
share = lambda y: min(max((y - 1) / 1, 0), 1)
tube = {"attributes": {
    "POSITION": accessor(points, "VEC3"), "NORMAL": accessor(normals, "VEC3"),
    "TEXCOORD_0": accessor(grid(SIDES, RINGS, lambda u, v: (3 * u, 1 - 2 * v))[0], "VEC2"),
    "TEXCOORD_1": accessor(grid(SIDES, RINGS, lambda u, v: (2 * v, u))[0], "VEC2"),
    "COLOR_0": accessor([(255, int(255 - 50 * p[1]), 255, 255) for p in points], "VEC4", 5121, True),
    "JOINTS_0": accessor([(0, 1, 0, 0) for _ in points], "VEC4", 5121),
    "WEIGHTS_0": accessor([(1 - share(p[1]), share(p[1]), 0, 0) for p in points], "VEC4")},
    "indices": accessor(triangles, "SCALAR", 5123), "material": 0}
inverse = accessor([moved(0, 0, 0), moved(0, -1.5, 0)], "MAT4")

# A ball and what it becomes.
ball_points, ball_triangles = grid(12, 8, lambda u, v: round_(
    (math.sin(math.pi * v) * math.sin(2 * math.pi * u), -math.cos(math.pi * v), math.sin(math.pi * v) * math.cos(2 * math.pi * u))))
ball = {"attributes": {"POSITION": accessor(ball_points, "VEC3"), "NORMAL": accessor(ball_points, "VEC3")},
        "indices": accessor(ball_triangles, "SCALAR", 5123), "material": 1,
        "targets": [{"POSITION": accessor([round_((0, max(p[1], 0) ** 2, 0)) for p in ball_points], "VEC3")}]}

# A square in x and y from -1 to 1.
square = {"POSITION": accessor([(-1, -1, 0), (1, -1, 0), (-1, 1, 0), (1, 1, 0)], "VEC3"),
          "TEXCOORD_0": accessor([(0, 1), (1, 1), (0, 0), (1, 0)], "VEC2")}
plane = lambda material: {"primitives": [{"attributes": square, "mode": 5, "material": material}]}

times = accessor([0, 1], "SCALAR")
bend = accessor([turn((0, 0, 1), -20), turn((0, 0, 1), 50)], "VEC4")
pull = accessor([0, 0, 0, 0, 1, 0], "SCALAR")
slide = accessor([(0, 0, 0), (0.5, 0, 0)], "VEC3")

checks = view(picture(8, 8, lambda x, y: (230, 60 + 20 * y, 40, 255) if (x // 2 + y // 2) % 2 else (240, 230, 210, 255)))
hole = view(picture(8, 8, lambda x, y: (60, 160, 80, 255 if (x - 3.5) ** 2 + (y - 3.5) ** 2 > 5 else 0)))
model = {
    "extensionsUsed": ["KHR_lights_punctual", "KHR_texture_transform", "KHR_materials_clearcoat",
                       "KHR_materials_transmission", "KHR_materials_volume", "KHR_materials_ior"],
    "extensions": {"KHR_lights_punctual": {"lights": [
        {"type": "directional", "intensity": 2.5, "color": [1, 0.95, 0.85]}, {"type": "point", "intensity": 12},
        {"type": "spot", "intensity": 40, "color": [0.5, 0.7, 1], "spot": {"innerConeAngle": 0.2, "outerConeAngle": 0.4}}]}},
    "images": [{"bufferView": checks, "mimeType": "image/png"}, {"bufferView": hole, "mimeType": "image/png"}],
    "samplers": [{"magFilter": 9728, "wrapS": 33648}],
    "textures": [{"source": 0, "sampler": 0}, {"source": 1}],
    "materials": [
        {"pbrMetallicRoughness": {"baseColorTexture": {"index": 0, "extensions": {"KHR_texture_transform": {
            "rotation": 0.3, "scale": [0.5, 0.5]}}}, "metallicFactor": 0, "roughnessFactor": 0.4,
            "metallicRoughnessTexture": {"index": 1, "texCoord": 1}},
         "extensions": {"KHR_materials_clearcoat": {"clearcoatFactor": 0.5}}},
        {"pbrMetallicRoughness": {"baseColorFactor": [0.9, 0.7, 0.3, 1], "roughnessFactor": 0.3}},
        {"pbrMetallicRoughness": {"baseColorFactor": [0.6, 0.6, 0.6, 1], "metallicFactor": 0}},
        {"pbrMetallicRoughness": {"baseColorTexture": {"index": 1}, "metallicFactor": 0}, "alphaMode": "MASK", "doubleSided": True},
        {"pbrMetallicRoughness": {"baseColorFactor": [0.2, 0.3, 0.9, 0.4], "metallicFactor": 0}, "alphaMode": "BLEND"},
        {"pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 0},
         "extensions": {"KHR_materials_transmission": {"transmissionFactor": 1}, "KHR_materials_ior": {"ior": 1.4},
                        "KHR_materials_volume": {"thicknessFactor": 1, "attenuationColor": [0.6, 0.9, 0.7], "attenuationDistance": 1}}}],
    "meshes": [{"primitives": [tube]}, {"primitives": [ball], "weights": [0]}, plane(2), plane(3), plane(4),
               {"primitives": [dict(ball, material=5, targets=[])]}],
    "skins": [{"joints": [1, 2], "inverseBindMatrices": inverse}],
    "cameras": [{"type": "perspective", "perspective": {"yfov": 0.8, "aspectRatio": 1.3333333, "znear": 0.1}}],
    "nodes": [
        {"mesh": 0, "skin": 0}, {"children": [2], "translation": [-1.2, 0, 0]}, {"translation": [0, 1.5, 0]},
        {"mesh": 1, "translation": [1.2, 0.7, -0.5], "scale": [0.7, 0.7, 0.7]},
        {"mesh": 2, "rotation": turn((1, 0, 0), -90), "scale": [5, 5, 1]},
        {"mesh": 3, "translation": [2.3, 1, -1.5], "rotation": turn((0, 1, 0), -30)},
        {"mesh": 4, "translation": [0.2, 0.8, 1], "scale": [0.5, 0.8, 1]},
        {"mesh": 5, "translation": [-0.2, 0.45, 1.7], "scale": [0.45, 0.45, 0.45]},
        {"children": [9]}, {"camera": 0, "translation": [0, 1.8, 6.5], "rotation": turn((1, 0, 0), -6)},
        {"rotation": turn((1, 0, 0), -55), "extensions": {"KHR_lights_punctual": {"light": 0}}},
        {"translation": [3, 4, 3], "extensions": {"KHR_lights_punctual": {"light": 1}}},
        {"translation": [-3, 5, 2], "rotation": turn((0.5657, 0.1, 0.4), -75), "extensions": {"KHR_lights_punctual": {"light": 2}}}],
    "scenes": [{"nodes": [0, 1, 3, 4, 5, 6, 7, 8, 10, 11, 12]}],
    "animations": [{"samplers": [{"input": times, "output": bend}, {"input": times, "output": pull, "interpolation": "CUBICSPLINE"},
                                 {"input": times, "output": slide}],
                    "channels": [{"sampler": 0, "target": {"node": 2, "path": "rotation"}},
                                 {"sampler": 1, "target": {"node": 3, "path": "weights"}},
                                 {"sampler": 2, "target": {"node": 8, "path": "translation"}}]}]}
for mesh in model["meshes"]:
    for primitive in mesh["primitives"]:
        if primitive.get("targets") == []:
            del primitive["targets"]
writer.write(HERE / "tube.gltf", model)
