"""A reader of glTF 2.0 that shares nothing with Rayfarm's: what triangles there are in the world at a time of a clip,
with all that says how they look."""
import base64
import json
import math
import pathlib
import struct
import urllib.parse

FORMATS = {5120: "b", 5121: "B", 5122: "h", 5123: "H", 5125: "I", 5126: "f"}
PARTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
LARGEST = {5120: 127, 5121: 255, 5122: 32767, 5123: 65535}


def product(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(4)) for j in range(4)] for i in range(4)]


def point(m, p):
    return [m[i][0] * p[0] + m[i][1] * p[1] + m[i][2] * p[2] + m[i][3] for i in range(3)]


def cofactors(m):
    """Of the linear part."""
    def cofactor(i, j):
        (a, b), (c, d) = [[m[r][c] for c in range(3) if c != j] for r in range(3) if r != i]
        return (a * d - b * c) * (-1)**(i + j)
    return [[cofactor(i, j) for j in range(3)] for i in range(3)]


def determinant(m):
    return sum(m[0][j] * c for j, c in enumerate(cofactors(m)[0]))


def normal_matrix(m):
    """The inverse transposed, to a positive factor."""
    sign = -1 if determinant(m) < 0 else 1
    return [[sign * c for c in row] for row in cofactors(m)]


def direction(m, n):
    return [m[i][0] * n[0] + m[i][1] * n[1] + m[i][2] * n[2] for i in range(3)]


def of_columns(values):
    return [[values[4 * j + i] for j in range(4)] for i in range(4)]


IDENTITY = of_columns([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1])


def of_parts(t, q, s):
    x, y, z, w = q
    rotation = [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]
    return [[rotation[i][j] * s[j] for j in range(3)] + [t[i]] for i in range(3)] + [[0, 0, 0, 1]]


def unit(q):
    length = math.sqrt(sum(c * c for c in q))
    return [c / length for c in q]


def slerp(a, b, t):
    a, b = unit(a), unit(b)
    cosine = sum(x * y for x, y in zip(a, b))
    if cosine < 0:
        b, cosine = [-c for c in b], -cosine
    if cosine > 0.9999999:
        return unit([x + t * (y - x) for x, y in zip(a, b)])
    angle = math.acos(cosine)
    return [(math.sin((1 - t) * angle) * x + math.sin(t * angle) * y) / math.sin(angle) for x, y in zip(a, b)]


class Gltf:
    def __init__(self, path):
        path = pathlib.Path(path)
        self.folder = path.parent
        data = path.read_bytes()
        chunk = b""
        if data[:4] == b"glTF":
            size = struct.unpack_from("<I", data, 12)[0]
            self.json = json.loads(data[20:20 + size])
            if len(data) > 28 + size:
                chunk = data[28 + size:]
        else:
            self.json = json.loads(data)
        self.buffers = []
        for buffer in self.json.get("buffers", []):
            uri = buffer.get("uri")
            if uri is None:
                self.buffers.append(chunk)
            elif uri.startswith("data:"):
                self.buffers.append(base64.b64decode(uri.split(",", 1)[1]))
            else:
                self.buffers.append((path.parent / urllib.parse.unquote(uri)).read_bytes())

    def strided(self, view, offset, count, code, parts):
        view = self.json["bufferViews"][view]
        size = struct.calcsize(FORMATS[code]) * parts
        begin = view.get("byteOffset", 0) + offset
        stride = view.get("byteStride", size)
        form = "<" + FORMATS[code] * parts
        return [list(struct.unpack_from(form, self.buffers[view["buffer"]], begin + i * stride)) for i in range(count)]

    def accessor(self, index):
        a = self.json["accessors"][index]
        parts, code = PARTS[a["type"]], a["componentType"]
        if "bufferView" in a:
            values = self.strided(a["bufferView"], a.get("byteOffset", 0), a["count"], code, parts)
        else:
            values = [[0] * parts for _ in range(a["count"])]
        if "sparse" in a:
            s = a["sparse"]
            at = self.strided(s["indices"]["bufferView"], s["indices"].get("byteOffset", 0), s["count"],
                              s["indices"]["componentType"], 1)
            new = self.strided(s["values"]["bufferView"], s["values"].get("byteOffset", 0), s["count"], code, parts)
            for (i,), value in zip(at, new):
                values[i] = value
        if a.get("normalized"):
            values = [[max(x / LARGEST[code], -1) for x in value] for value in values]
        return values

    def length(self, clip=0):
        """The time of the clip's last key; 0 if there is none."""
        clips = self.json.get("animations", [])[clip:clip + 1]
        return max((t[0] for c in clips for s in c["samplers"] for t in self.accessor(s["input"])), default=0)

    def animated(self, time, clip=0):
        """What a clip sets, by (node, path)."""
        result = {}
        for animation in self.json.get("animations", [])[clip:clip + 1]:
            for channel in animation["channels"]:
                sampler, target = animation["samplers"][channel["sampler"]], channel["target"]
                times = [t[0] for t in self.accessor(sampler["input"])]
                output = self.accessor(sampler["output"])
                way, path = sampler.get("interpolation", "LINEAR"), target["path"]
                per_time = len(output) // len(times)
                keys = [[x for value in output[i * per_time:(i + 1) * per_time] for x in value] for i in range(len(times))]
                last = max([i for i, t in enumerate(times) if t <= time], default=0)
                parts = len(keys[0]) // (3 if way == "CUBICSPLINE" else 1)
                value = lambda key: key[parts:2 * parts] if way == "CUBICSPLINE" else key
                if time <= times[0] or last == len(times) - 1 or way == "STEP":
                    now = value(keys[last])
                else:
                    length = times[last + 1] - times[last]
                    t = (time - times[last]) / length
                    a, b = value(keys[last]), value(keys[last + 1])
                    if way == "CUBICSPLINE":
                        out, into = keys[last][2 * parts:], keys[last + 1][:parts]
                        now = [(2 * t**3 - 3 * t**2 + 1) * a[i] + length * (t**3 - 2 * t**2 + t) * out[i] +
                               (-2 * t**3 + 3 * t**2) * b[i] + length * (t**3 - t**2) * into[i] for i in range(parts)]
                    elif path == "rotation":
                        now = slerp(a, b, t)
                    else:
                        now = [x + t * (y - x) for x, y in zip(a, b)]
                result[target.get("node"), path] = unit(now) if path == "rotation" else now
        return result

    def placed(self, moved):
        """By node of the scene: the matrix that leads from it to the world."""
        nodes, worlds = self.json.get("nodes", []), {}

        def place(index, above):
            node = nodes[index]
            get = lambda path, usual: moved.get((index, path), node.get(path, usual))
            own = of_columns(node["matrix"]) if "matrix" in node else of_parts(
                get("translation", [0, 0, 0]), unit(get("rotation", [0, 0, 0, 1])), get("scale", [1, 1, 1]))
            worlds[index] = product(above, own)
            for child in node.get("children", []):
                place(child, worlds[index])

        children = {c for n in nodes for c in n.get("children", [])}
        scenes = self.json.get("scenes")
        roots = scenes[self.json.get("scene", 0)].get("nodes", []) if scenes else [
            i for i in range(len(nodes)) if i not in children]
        for root in roots:
            place(root, IDENTITY)
        return worlds

    def cameras(self, time, clip=0):
        """Each as what the file says of it and the matrix of its node."""
        nodes = self.json.get("nodes", [])
        return [(self.json["cameras"][nodes[i]["camera"]], world)
                for i, world in self.placed(self.animated(time, clip)).items() if "camera" in nodes[i]]

    def meshes(self, time, clip=0):
        """All primitives with triangles, in the world."""
        nodes, moved = self.json.get("nodes", []), self.animated(time, clip)
        worlds = self.placed(moved)
        for index, world in worlds.items():
            node = nodes[index]
            if "mesh" not in node:
                continue
            mesh = self.json["meshes"][node["mesh"]]
            weights = moved.get((index, "weights"), node.get("weights", mesh.get("weights")))
            matrices = [world]
            if "skin" in node:
                skin = self.json["skins"][node["skin"]]
                inverse = self.accessor(skin["inverseBindMatrices"]) if "inverseBindMatrices" in skin else None
                matrices = [product(worlds[joint], of_columns(inverse[j]) if inverse else IDENTITY)
                            for j, joint in enumerate(skin["joints"])]
            for primitive in mesh["primitives"]:
                if primitive.get("mode", 4) >= 4:
                    yield self.mesh(primitive, matrices, weights, "skin" in node)

    def triangles(self, time):
        """Each as three points of the world."""
        for mesh in self.meshes(time):
            for face in mesh.faces:
                yield [mesh.points[i] for i in face]

    def mesh(self, primitive, matrices, weights, has_skin):
        mode, attributes = primitive.get("mode", 4), primitive["attributes"]
        morphed = {}
        for name in ("POSITION", "NORMAL"):
            if name not in attributes:
                continue
            values = self.accessor(attributes[name])
            for weight, target in zip(weights or [], primitive.get("targets", [])):
                if name in target and weight != 0:
                    values = [[x + weight * d for x, d in zip(p, by)] for p, by in zip(values, self.accessor(target[name]))]
            morphed[name] = values
        points, normals = morphed["POSITION"], morphed.get("NORMAL")
        if has_skin:
            influences = [[] for _ in points]
            for i in range(8):
                if f"JOINTS_{i}" in attributes:
                    for row, joints, shares in zip(influences, self.accessor(attributes[f"JOINTS_{i}"]),
                                                   self.accessor(attributes[f"WEIGHTS_{i}"])):
                        row.extend((j, w) for j, w in zip(joints, shares) if w > 0)
            own = []
            for row in influences:
                total = sum(w for _, w in row)
                own.append([[sum(w / total * matrices[j][i][k] for j, w in row) for k in range(4)] for i in range(3)])
        else:
            own = [matrices[0]] * len(points)
        mesh = Mesh()
        mesh.points = [point(m, p) for m, p in zip(own, points)]
        if normals:
            by = [normal_matrix(m) for m in own] if has_skin else [normal_matrix(matrices[0])] * len(own)
            mesh.normals = [direction(m, n) for m, n in zip(by, normals)]
            if has_skin or weights:  # what has been bent has unit normals again before it is interpolated
                mesh.normals = [unit(n) for n in mesh.normals]
        # A mirrored mesh has its front where it would be without the mirror.
        mesh.is_mirrored = not has_skin and determinant(matrices[0]) < 0
        mesh.uvs = [self.accessor(attributes[f"TEXCOORD_{i}"]) for i in range(2) if f"TEXCOORD_{i}" in attributes]
        if "COLOR_0" in attributes:
            mesh.colors = [c + [1] * (4 - len(c)) for c in self.accessor(attributes["COLOR_0"])]
        if "material" in primitive:
            mesh.material = self.material(self.json["materials"][primitive["material"]])
        order = [i[0] for i in self.accessor(primitive["indices"])] if "indices" in primitive else list(range(len(points)))
        if mode == 4:
            corners = [order[i:i + 3] for i in range(0, len(order) - 2, 3)]
        elif mode == 5:
            corners = [(order[i], order[i + 1 + i % 2], order[i + 2 - i % 2]) for i in range(len(order) - 2)]
        else:
            corners = [(order[i + 1], order[i + 2], order[0]) for i in range(len(order) - 2)]
        mesh.faces = [face for face in corners if mode == 4 or len(set(face)) == 3]
        return mesh

    def material(self, m):
        pbr, result = m.get("pbrMetallicRoughness", {}), Material()
        result.factor = pbr.get("baseColorFactor", [1, 1, 1, 1])
        result.is_double_sided = m.get("doubleSided", False)
        result.mode, result.cutoff = m.get("alphaMode", "OPAQUE"), m.get("alphaCutoff", 0.5)
        info = pbr.get("baseColorTexture")
        if info is None:
            return result
        moved = info.get("extensions", {}).get("KHR_texture_transform", {})
        result.set = moved.get("texCoord", info.get("texCoord", 0))
        (u, v), (a, b), turn = moved.get("offset", [0, 0]), moved.get("scale", [1, 1]), moved.get("rotation", 0)
        # Translation * rotation * scale, as the extension writes them down.
        result.uv_rows = [[math.cos(turn) * a, math.sin(turn) * b, u], [-math.sin(turn) * a, math.cos(turn) * b, v]]
        texture = self.json["textures"][info["index"]]
        sampler = self.json["samplers"][texture["sampler"]] if "sampler" in texture else {}
        result.wraps = [sampler.get("wrapS", 10497), sampler.get("wrapT", 10497)]
        result.is_nearest = sampler.get("magFilter") == 9728
        image = self.json["images"][texture["source"]]
        if "bufferView" in image:
            view = self.json["bufferViews"][image["bufferView"]]
            begin = view.get("byteOffset", 0)
            result.image = self.buffers[view["buffer"]][begin:begin + view["byteLength"]]
        elif image["uri"].startswith("data:"):
            result.image = base64.b64decode(image["uri"].split(",", 1)[1])
        else:
            result.image = (self.folder / urllib.parse.unquote(image["uri"])).read_bytes()
        return result


class Material:
    """Of a base colour alone. Without an image it is the factor; the usual one is glTF's own, and not named."""
    def __init__(self):
        self.is_named = False
        self.factor, self.is_double_sided, self.mode, self.cutoff = [1, 1, 1, 1], False, "OPAQUE", 0.5
        self.image, self.set, self.uv_rows, self.wraps, self.is_nearest = None, 0, [[1, 0, 0], [0, 1, 0]], [10497] * 2, False


class Mesh:
    """Points and normals of the world, and what else stands at them; v of coordinates runs down."""
    def __init__(self):
        self.points, self.normals, self.uvs, self.colors, self.faces = [], None, [], None, []
        self.material, self.is_mirrored = Material(), False


def facts(path, time):
    low, high, area, count = [math.inf] * 3, [-math.inf] * 3, 0, 0
    for a, b, c in Gltf(path).triangles(time):
        u, v = [y - x for x, y in zip(a, b)], [y - x for x, y in zip(a, c)]
        area += math.sqrt((u[1] * v[2] - u[2] * v[1])**2 + (u[2] * v[0] - u[0] * v[2])**2 + (u[0] * v[1] - u[1] * v[0])**2) / 2
        count += 1
        for p in (a, b, c):
            low, high = [min(x, y) for x, y in zip(low, p)], [max(x, y) for x, y in zip(high, p)]
    return {"triangles": count, "low": low, "high": high, "area": area}
