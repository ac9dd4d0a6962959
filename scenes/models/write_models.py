"""Writes vase.glb, a turned and painted vase with three textures, and anemone.glb, whose tentacles hang on bones that
move. All of it is made of numbers here."""
import math
import pathlib

from gltf_writer import Writer, grid, moved, picture, turn

HERE = pathlib.Path(__file__).parent


def vase():
    writer = Writer()
    # Radius and height, from the foot up, over the lip, and down inside.
    profile = [(0.02, 0), (0.42, 0), (0.46, 0.03), (0.40, 0.09), (0.36, 0.16), (0.46, 0.36), (0.66, 0.66), (0.78, 0.98), (0.76, 1.28),
               (0.60, 1.58), (0.38, 1.80), (0.29, 1.98), (0.28, 2.16), (0.36, 2.34), (0.47, 2.42), (0.48, 2.45), (0.45, 2.45),
               (0.33, 2.34), (0.25, 2.16), (0.26, 1.98), (0.34, 1.80), (0.56, 1.56)]
    COLUMNS, STEPS = 96, 4

    def curve(t):  # Catmull and Rom's through the points
        i = min(int(t), len(profile) - 2)
        f = t - i
        p = [profile[max(0, min(len(profile) - 1, i + k))] for k in (-1, 0, 1, 2)]
        return [0.5 * (2 * p[1][a] + (p[2][a] - p[0][a]) * f + (2 * p[0][a] - 5 * p[1][a] + 4 * p[2][a] - p[3][a]) * f * f +
                       (3 * p[1][a] - p[0][a] - 3 * p[2][a] + p[3][a]) * f ** 3) for a in (0, 1)]

    rows = STEPS * (len(profile) - 1)
    at = [curve(i / STEPS) for i in range(rows + 1)]
    length = [0]
    for a, b in zip(at, at[1:]):
        length.append(length[-1] + math.dist(a, b))

    def ring(u, v):
        r, y = at[round(v * rows)]
        angle = -2 * math.pi * u
        return [r * math.cos(angle), y, r * math.sin(angle)]

    def normal(u, v):
        i = round(v * rows)
        a, b = at[max(0, i - 1)], at[min(rows, i + 1)]
        dr, dy = b[0] - a[0], b[1] - a[1]
        angle, n = -2 * math.pi * u, math.hypot(dr, dy)
        return [dy / n * math.cos(angle), -dr / n, dy / n * math.sin(angle)]

    points, triangles = grid(COLUMNS, rows, ring)
    coordinates = grid(COLUMNS, rows, lambda u, v: (u, 1 - length[round(v * rows)] / length[-1]))[0]
    primitive = {"attributes": {"POSITION": writer.accessor(points, "VEC3"),
                                "NORMAL": writer.accessor(grid(COLUMNS, rows, normal)[0], "VEC3"),
                                "TEXCOORD_0": writer.accessor(coordinates, "VEC2")},
                 "indices": writer.accessor(triangles, "SCALAR", 5123), "material": 0}

    SIZE = 512
    # Bands by height: glaze, gilt lines, scales, a frieze of rosettes.
    def pattern(x, y):
        u, v = x / SIZE, 1 - y / SIZE  # v runs up
        gilt = any(abs(v - line) < 0.004 for line in (0.115, 0.155, 0.30, 0.335, 0.48, 0.515, 0.60))
        if gilt:
            return "gilt"
        if 0.335 < v < 0.48:  # twelve rosettes
            a, b = (u * 12) % 1 - 0.5, (v - 0.4075) / 0.145
            r, angle = math.hypot(a, b * 0.9), math.atan2(b, a)
            if r < 0.09:
                return "gilt"
            return "petal" if r < 0.27 + 0.12 * math.cos(6 * angle) else "ground"
        if 0.155 < v < 0.30:  # scales
            row = (v - 0.155) / 0.029
            a = (u * 28 + 0.5 * (int(row) % 2)) % 1 - 0.5
            return "scale" if math.hypot(a, (row % 1) - 0.1) < 0.52 else "edge"
        if 0.515 < v < 0.60:  # a running wave
            return "petal" if math.sin(2 * math.pi * (u * 24 + 1.6 * (v - 0.515) / 0.085)) > 0.2 else "ground"
        return "ground" if v < 0.62 else "inside"

    colours = {"gilt": (232, 178, 92), "petal": (238, 232, 214), "ground": (18, 46, 92), "scale": (40, 120, 138),
               "edge": (14, 58, 84), "inside": (206, 190, 160)}
    roughness = {"gilt": 70, "petal": 110, "ground": 60, "scale": 60, "edge": 90, "inside": 150}

    def bump(x, y):  # scales and petals stand out a little
        height = lambda i, j: {"scale": 0.6, "petal": 0.5, "gilt": 1.0}.get(pattern(i % SIZE, min(SIZE - 1, max(0, j))), 0.0)
        dx, dy = height(x + 1, y) - height(x - 1, y), height(x, y - 1) - height(x, y + 1)
        n = math.sqrt(dx * dx * 0.36 + dy * dy * 0.36 + 1)
        return [round(127.5 + 127.5 * c) for c in (-0.6 * dx / n, -0.6 * dy / n, 1 / n)] + [255]

    images = [picture(SIZE, SIZE, lambda x, y: (*colours[pattern(x, y)], 255)),
              picture(SIZE, SIZE, lambda x, y: (0, roughness[pattern(x, y)], 255 if pattern(x, y) == "gilt" else 0, 255)),
              picture(SIZE, SIZE, bump)]
    writer.write(HERE / "vase.glb", {
        "extensionsUsed": ["KHR_materials_clearcoat"],
        "images": [{"bufferView": writer.view(image), "mimeType": "image/png"} for image in images],
        "textures": [{"source": 0}, {"source": 1}, {"source": 2}],
        "materials": [{"name": "glaze", "doubleSided": True, "pbrMetallicRoughness": {
            "baseColorTexture": {"index": 0}, "metallicRoughnessTexture": {"index": 1}},
            "normalTexture": {"index": 2, "scale": 0.5},
            "extensions": {"KHR_materials_clearcoat": {"clearcoatFactor": 0.6, "clearcoatRoughnessFactor": 0.05}}}],
        "meshes": [{"name": "vase", "primitives": [primitive]}], "nodes": [{"name": "vase", "mesh": 0}],
        "scenes": [{"nodes": [0]}], "scene": 0})


def anemone():
    writer = Writer()
    BONES, SIDES, RINGS, LENGTH = 5, 12, 24, 1.7
    radius = lambda v: 0.13 * (1 - 0.55 * v) if v < 0.93 else 0.13 * 0.4885 * math.sqrt(max(0, 1 - ((v - 0.93) / 0.07) ** 2))
    ring = lambda u, v: [radius(v) * math.cos(-2 * math.pi * u), LENGTH * v, radius(v) * math.sin(-2 * math.pi * u)]
    points, triangles = grid(SIDES, RINGS, ring)
    normals = grid(SIDES, RINGS, lambda u, v: [math.cos(-2 * math.pi * u), 0, math.sin(-2 * math.pi * u)] if v < 0.99 else [0, 1, 0])[0]

    def tint(v):
        mix = lambda a, b, t: [round(255 * (x + (y - x) * t)) for x, y in zip(a, b)]
        root, middle, tip = (0.10, 0.30, 0.16), (0.25, 0.62, 0.38), (0.95, 0.32, 0.55)
        return mix(root, middle, min(1, v / 0.5)) if v < 0.75 else mix(middle, tip, (v - 0.75) / 0.25)

    joints, weights = [], []
    for p in points:
        place = min(p[1] / LENGTH * BONES, BONES - 1e-6)
        low = int(place)
        share = max(0, place - low - 0.5) if low + 1 < BONES else 0
        joints.append((low, min(low + 1, BONES - 1), 0, 0))
        weights.append((1 - share, share, 0, 0))
    primitive = {"attributes": {
        "POSITION": writer.accessor(points, "VEC3"), "NORMAL": writer.accessor(normals, "VEC3"),
        "COLOR_0": writer.accessor([(*tint(p[1] / LENGTH), 255) for p in points], "VEC4", 5121, True),
        "JOINTS_0": writer.accessor(joints, "VEC4", 5121), "WEIGHTS_0": writer.accessor(weights, "VEC4")},
        "indices": writer.accessor(triangles, "SCALAR", 5123), "material": 0}
    step = LENGTH / BONES
    inverse = writer.accessor([moved(0, -step * i, 0) for i in range(BONES)], "MAT4")
    KEYS, SECONDS = 9, 4
    times = writer.accessor([SECONDS * k / (KEYS - 1) for k in range(KEYS)], "SCALAR")

    def bend(azimuth, amount, lean):
        """About the axis that leans what stands upright outward along the azimuth, and on sideways."""
        out = turn((math.sin(azimuth), 0, -math.cos(azimuth)), lean)
        side = turn((math.cos(azimuth), 0, math.sin(azimuth)), amount)
        (a, b, c, w), (x, y, z, v) = out, side
        return [w * x + a * v + b * z - c * y, w * y - a * z + b * v + c * x, w * z + a * y - b * x + c * v, w * v - a * x - b * y - c * z]

    nodes, skins, samplers, channels, roots = [], [], [], [], []
    golden = math.pi * (3 - math.sqrt(5))
    TENTACLES = 34
    for t in range(TENTACLES):
        spread, azimuth = math.sqrt((t + 0.5) / TENTACLES), t * golden
        first = len(nodes)
        for i in range(BONES):
            node = {"translation": [0.62 * spread * math.cos(azimuth), 0.55 - 0.12 * spread ** 2, 0.62 * spread * math.sin(azimuth)] if i == 0
                    else [0, step, 0]}
            if i + 1 < BONES:
                node["children"] = [first + i + 1]
            nodes.append(node)
            lean = (38 * spread if i == 0 else 9 * spread)
            keys = [bend(azimuth, (5 + 4 * i) * math.sin(2 * math.pi * k / (KEYS - 1) - 0.55 * i + 1.3 * math.sin(t)),
                         lean + (2 + 2 * i) * math.cos(2 * math.pi * k / (KEYS - 1) - 0.4 * i + 0.7 * t)) for k in range(KEYS)]
            samplers.append({"input": times, "output": writer.accessor(keys, "VEC4")})
            channels.append({"sampler": len(samplers) - 1, "target": {"node": first + i, "path": "rotation"}})
        skins.append({"joints": list(range(first, first + BONES)), "inverseBindMatrices": inverse})
        nodes.append({"mesh": 0, "skin": len(skins) - 1})
        roots += [first, len(nodes) - 1]
    # The column that they stand on.
    foot, around = grid(40, 10, lambda u, v: [(0.95 - 0.75 * math.sin(min(1, 1.1 * v) * math.pi / 2) * 0.25 - 0.9 * max(0, v - 0.8)) *
                                              math.cos(-2 * math.pi * u), 0.62 * min(1, 1.25 * v),
                                              (0.95 - 0.75 * math.sin(min(1, 1.1 * v) * math.pi / 2) * 0.25 - 0.9 * max(0, v - 0.8)) *
                                              math.sin(-2 * math.pi * u)])
    foot_normals = grid(40, 10, lambda u, v: [math.cos(-2 * math.pi * u), 0.25, math.sin(-2 * math.pi * u)] if v < 0.75 else [0, 1, 0])[0]
    column = {"attributes": {"POSITION": writer.accessor(foot, "VEC3"), "NORMAL": writer.accessor(foot_normals, "VEC3")},
              "indices": writer.accessor(around, "SCALAR", 5123), "material": 1}
    nodes.append({"mesh": 1})
    writer.write(HERE / "anemone.glb", {
        "extensionsUsed": ["KHR_materials_clearcoat"],
        "materials": [{"name": "tentacle", "doubleSided": True, "pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 0.4},
                       "extensions": {"KHR_materials_clearcoat": {"clearcoatFactor": 0.7, "clearcoatRoughnessFactor": 0.15}}},
                      {"name": "column", "doubleSided": True,
                       "pbrMetallicRoughness": {"baseColorFactor": [0.55, 0.16, 0.10, 1], "metallicFactor": 0, "roughnessFactor": 0.6}}],
        "meshes": [{"name": "tentacle", "primitives": [primitive]}, {"name": "column", "primitives": [column]}],
        "skins": skins, "nodes": nodes, "scenes": [{"nodes": roots + [len(nodes) - 1]}], "scene": 0,
        "animations": [{"name": "sway", "samplers": samplers, "channels": channels}]})


vase()
anemone()
