"""glTF files made to have what few real ones have together: mirrored, sheared and deep nodes, skins and targets with normals,
strips and fans, two sets of coordinates, moved textures of odd sizes, colours of vertices, alpha that cuts."""
import base64
import json
import math
import struct
import zlib


def png(width, height, color):
    """`color(x, y)`: four numbers up to 255."""
    rows = b"".join(b"\0" + b"".join(bytes(color(x, y)) for x in range(width)) for y in range(height))
    chunk = lambda kind, data: struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 6, 0, 0, 0)) + \
        chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


def uri(data, kind="application/octet-stream"):
    return f"data:{kind};base64,{base64.b64encode(data).decode()}"


class Maker:
    def __init__(self):
        self.json = {"asset": {"version": "2.0"}, "accessors": [], "bufferViews": [], "meshes": [], "nodes": [], "materials": [],
                     "skins": [], "samplers": [], "extensionsUsed": ["KHR_texture_transform"]}
        self.bytes = b""

    def accessor(self, rows, code=5126, kind=None, normalized=False):
        form = {5120: "b", 5121: "B", 5122: "h", 5123: "H", 5126: "f"}[code]
        rows = [row if isinstance(row, (list, tuple)) else [row] for row in rows]
        size = len(rows[0]) * struct.calcsize(form)
        stride = (size + 3) // 4 * 4 if len(rows[0]) > 1 else size
        data = b"".join(struct.pack("<" + form * len(row), *row).ljust(stride, b"\0") for row in rows)
        self.bytes = self.bytes.ljust((len(self.bytes) + 3) // 4 * 4, b"\0")
        self.json["bufferViews"].append({"buffer": 0, "byteOffset": len(self.bytes), "byteLength": len(data)} |
                                        ({"byteStride": stride} if len(rows[0]) > 1 else {}))
        self.bytes += data
        self.json["accessors"].append({
            "bufferView": len(self.json["bufferViews"]) - 1, "componentType": code, "count": len(rows), "normalized": normalized,
            "type": kind or {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4"}[len(rows[0])]})
        return len(self.json["accessors"]) - 1

    def add(self, what, value):
        self.json[what].append(value)
        return len(self.json[what]) - 1

    def write(self, path):
        self.json["buffers"] = [{"byteLength": len(self.bytes), "uri": uri(self.bytes)}]
        path.write_text(json.dumps({key: value for key, value in self.json.items() if value != []}))
        return path


def sheet(columns=12, rows=9):
    """A wavy sheet, 2 wide and 1.5 high: points, normals, coordinates from 0 to 1, triangles that face +z."""
    points, normals, uvs, faces = [], [], [], []
    for k in range(rows + 1):
        for i in range(columns + 1):
            u, v = i / columns, k / rows
            x, y = 2 * u - 1, 1.5 * v - 0.75
            points.append([x, y, 0.2 * math.sin(3 * x) + 0.1 * y * y])
            slope = [-0.6 * math.cos(3 * x), -0.2 * y, 1]
            length = math.sqrt(sum(c * c for c in slope))
            normals.append([c / length for c in slope])
            uvs.append([u, 1 - v])
            if i < columns and k < rows:
                a = k * (columns + 1) + i
                faces += [a, a + 1, a + columns + 2, a, a + columns + 2, a + columns + 1]
    return points, normals, uvs, faces


def spotted(x, y):
    return [40 * (x % 5) + 30, 60 * (y % 4) + 20, (97 * x + 61 * y) % 256, 255 if (x * x + 3 * y) % 7 > 2 else 60]


def write_textured(path):
    """Mirrored, sheared nodes over one mesh whose texture is moved, turned, wrapped, and cuts holes; its back is not seen."""
    m = Maker()
    points, normals, uvs, faces = sheet()
    m.json["images"] = [{"uri": uri(png(13, 9, spotted), "image/png")}]
    m.json["textures"] = [{"source": 0, "sampler": 0}, {"source": 0, "sampler": 1}]
    m.add("samplers", {"wrapS": 33648, "wrapT": 33071})
    m.add("samplers", {"magFilter": 9728})
    moved = {"offset": [-0.25, 0.5], "rotation": 0.7, "scale": [0.7, 0.5], "texCoord": 1}
    m.add("materials", {"pbrMetallicRoughness": {"baseColorFactor": [0.9, 0.7, 0.8, 0.9], "baseColorTexture": {
        "index": 0, "texCoord": 0, "extensions": {"KHR_texture_transform": moved}}}, "alphaMode": "MASK", "alphaCutoff": 0.4})
    m.add("materials", {"pbrMetallicRoughness": {"baseColorTexture": {"index": 1, "texCoord": 1}}, "doubleSided": True})
    colors = [[200 - 5 * (i % 13), 255 - 20 * (i // 13), 120 + 9 * (i % 13), 255] for i in range(len(points))]
    attributes = {"POSITION": m.accessor(points), "NORMAL": m.accessor(normals), "TEXCOORD_0": m.accessor([[0.5, 0.5]] * len(points)),
                  "TEXCOORD_1": m.accessor([[round(65535 * c) for c in uv] for uv in uvs], 5123, normalized=True),
                  "COLOR_0": m.accessor(colors, 5121, normalized=True)}
    order = m.accessor(faces, 5121)
    for material in (0, 1):
        m.add("meshes", {"primitives": [{"attributes": attributes, "indices": order, "material": material}]})
    half = math.sqrt(0.5)
    m.json["scenes"] = [{"nodes": [0, 3, 4]}]
    m.add("nodes", {"scale": [1, 2, 0.7], "children": [1, 2]})
    m.add("nodes", {"mesh": 0, "rotation": [0, 0, math.sin(0.3), math.cos(0.3)], "translation": [-1, 0.4, 0.2]})
    m.add("nodes", {"mesh": 1, "rotation": [math.sin(0.4) * half, math.sin(0.4) * half, 0, math.cos(0.4)], "scale": [-1, 1, 1],
                    "translation": [0.9, 0.4, -0.4]})
    m.add("nodes", {"mesh": 0, "scale": [-1, 1, -1], "translation": [-0.2, -0.9, 0.6]})  # its back, but for the mirror
    # By columns, with a negative determinant.
    m.add("nodes", {"mesh": 1, "matrix": [0.8, 0.1, 0.3, 0, 0.2, -0.9, 0, 0, 0.1, 0.2, 1.1, 0, 0, 1.9, 0.1, 1]})
    return m.write(path)


def write_packed(path):
    """Small integers for numbers (KHR_mesh_quantization), a sparse accessor, alpha of vertices that is all or nothing, and
    another scene than the first, 80 nodes deep."""
    m = Maker()
    m.json["extensionsUsed"] = m.json["extensionsRequired"] = ["KHR_mesh_quantization"]
    points, normals, uvs, faces = sheet()
    m.json["images"] = [{"uri": uri(png(5, 3, spotted), "image/png")}]
    m.json["textures"] = [{"source": 0}]
    m.add("materials", {"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}, "doubleSided": True})
    m.add("materials", {"pbrMetallicRoughness": {"baseColorFactor": [0.3, 0.9, 0.4, 1]}, "alphaMode": "BLEND", "doubleSided": True})
    changed = [20, 47, 88]
    values = [round(2000 * c) + by for i in changed for c, by in zip(points[i], (90, -70, 60))]
    place = m.accessor([[round(2000 * c) for c in p] for p in points], 5122)
    m.json["accessors"][place]["sparse"] = {
        "count": 3, "indices": {"bufferView": m.json["accessors"][m.accessor(changed, 5121)]["bufferView"], "componentType": 5121},
        "values": {"bufferView": m.json["accessors"][m.accessor(values, 5122)]["bufferView"]}}
    attributes = {"POSITION": place, "NORMAL": m.accessor([[round(127 * c) for c in n] for n in normals], 5120, normalized=True),
                  "TEXCOORD_0": m.accessor([[round(255 * c) for c in uv] for uv in uvs], 5121, normalized=True)}
    seen = [[255, 255, 255, 0 if i % 13 < 6 else 255] for i in range(len(points))]
    flat = {"POSITION": m.accessor([[10 * x, 10 * y, 2] for x, y, _ in points]), "COLOR_0": m.accessor(seen, 5121, normalized=True)}
    order = m.accessor(faces, 5121)
    m.add("meshes", {"primitives": [{"attributes": attributes, "indices": order, "material": 0}]})
    m.add("meshes", {"primitives": [{"attributes": flat, "indices": order, "material": 1}]})
    for i in range(80):
        m.add("nodes", {"children": [i + 1], "rotation": [0, 0, math.sin(0.004), math.cos(0.004)], "scale": [1.01, 0.995, 1]})
    m.add("nodes", {"mesh": 0, "scale": [0.0005, 0.0007, 0.0005]})
    m.add("nodes", {"mesh": 1, "scale": [0.05, 0.05, 0.3]})
    m.json["scenes"], m.json["scene"] = [{"nodes": [81]}, {"nodes": [0, 81]}], 1
    return m.write(path)


def write_bent(path):
    """A skin of three joints, one squeezed and one that moves, with targets for points and normals; a strip and a fan."""
    m = Maker()
    points, normals, _, faces = sheet()
    shares = []
    for x, y, _ in points:
        a, b = max(0, -x), max(0, x)
        shares.append([a, b, 1 - a - b, 0])
    target = {"POSITION": m.accessor([[0, 0.1 * x, 0.4 * math.cos(2 * x)] for x, _, _ in points]),
              "NORMAL": m.accessor([[0.8 * math.sin(2 * x), 0, 0] for x, _, _ in points])}
    m.add("materials", {"pbrMetallicRoughness": {"baseColorFactor": [0.2, 0.5, 0.9, 1]}, "doubleSided": True})
    m.add("meshes", {"weights": [0.3], "primitives": [{
        "attributes": {"POSITION": m.accessor(points), "NORMAL": m.accessor(normals),
                       "JOINTS_0": m.accessor([[0, 2, 1, 0]] * len(points), 5121), "WEIGHTS_0": m.accessor(shares)},
        "targets": [target], "indices": m.accessor(faces, 5123), "material": 0}]})
    turn, out = [math.cos(0.2), math.sin(0.2)], [0, 0, 0]
    inverse = [[1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 1], [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, *out, 1],
               [turn[0], -turn[1], 0, 0, turn[1], turn[0], 0, 0, 0, 0, 1, 0, -1, 0.1, 0, 1]]
    m.add("skins", {"joints": [2, 3, 4], "inverseBindMatrices": m.accessor(inverse, kind="MAT4")})
    zigzag = [[0.3 * i - 1.2, 1.3 + 0.4 * (i % 2), 0.05 * i * i - 1] for i in range(9)]
    around = [[0, -1.6, 0.3]] + [[math.cos(0.9 * i), -1.6 + 0.6 * math.sin(0.9 * i), 0.1 * i] for i in range(7)]
    m.add("meshes", {"primitives": [{"attributes": {"POSITION": m.accessor(zigzag)}, "mode": 5, "material": 0},
                                    {"attributes": {"POSITION": m.accessor(around)}, "mode": 6, "material": 0}]})
    m.json["scenes"] = [{"nodes": [0, 1, 5]}]
    m.add("nodes", {"mesh": 0, "skin": 0, "translation": [50, 0, 0]})  # which a skin does not heed
    m.add("nodes", {"children": [2, 3, 4], "scale": [1, 1.2, 1]})
    m.add("nodes", {"translation": [-1, 0, 0], "rotation": [0, math.sin(0.3), 0, math.cos(0.3)]})
    m.add("nodes", {"scale": [1, 0.6, 1.5]})
    m.add("nodes", {"translation": [1, 0.1, 0]})
    m.add("nodes", {"mesh": 1})
    m.json["animations"] = [{"samplers": [
        {"input": m.accessor([0.0, 1.0]), "output": m.accessor([[0, 0, 0, 1], [math.sin(0.5), 0, 0, math.cos(0.5)]])},
        {"input": m.accessor([0.2, 1.0]), "output": m.accessor([0.0, 1.0]), "interpolation": "STEP"},
        {"input": m.accessor([0.0, 1.0]), "interpolation": "CUBICSPLINE",
         "output": m.accessor([[0, 0, 0], [1, 0.1, 0], [0, 1, 0], [0, -2, 1], [1.2, 0.4, 0.3], [0, 0, 0]])}],
        "channels": [{"sampler": 0, "target": {"node": 4, "path": "rotation"}}, {"sampler": 1, "target": {"node": 0, "path": "weights"}},
                     {"sampler": 2, "target": {"node": 4, "path": "translation"}}]}]
    return m.write(path)
