"""Readers of OBJ and PLY that share nothing with Rayfarm's: enough for the files that tests compare."""
import pathlib
import struct

from gltf_reader import Material, Mesh


def linear(c):
    """Of sRGB."""
    return c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055)**2.4


def materials_of(path):
    """Of an MTL file, what `Kd` and `map_Kd` say."""
    materials, last = {}, None
    for words in (line.split() for line in path.read_text(errors="replace").splitlines()):
        if not words:
            continue
        if words[0] == "newmtl":
            last = materials[" ".join(words[1:])] = Material()
            last.is_double_sided = last.is_named = True
        elif words[0] == "Kd":
            last.factor = [float(w) for w in words[1:4]] + [1]
        elif words[0] == "map_Kd":
            last.image = (path.parent / words[-1].replace("\\", "/")).read_bytes()
    return materials


def read_obj(path):
    """A mesh for each material. Normals stand there only if the file gives them."""
    points, uvs, normals, materials, meshes = [], [], [], {}, {}
    usual = Material()
    usual.is_double_sided = True
    now = usual
    for words in (line.split() for line in path.read_text(errors="replace").splitlines()):
        if not words:
            continue
        if words[0] == "v":
            points.append([float(w) for w in words[1:4]])
        elif words[0] == "vt":
            uvs.append([float(words[1]), 1 - float(words[2])])
        elif words[0] == "vn":
            normals.append([float(w) for w in words[1:4]])
        elif words[0] == "mtllib":
            materials.update(materials_of(path.parent / " ".join(words[1:])))
        elif words[0] == "usemtl":
            now = materials.get(" ".join(words[1:]), usual)
        elif words[0] == "f":
            mesh = meshes.setdefault(id(now), Mesh())
            mesh.material = now
            corners = []
            for word in words[1:]:
                at = [int(i) if i else 0 for i in word.split("/")] + [0, 0]
                place = lambda i, of: of[i - 1 if i > 0 else i]
                corners.append(len(mesh.points))
                mesh.points.append(place(at[0], points))
                if at[1]:
                    mesh.uvs = mesh.uvs or [[]]
                    mesh.uvs[0].append(place(at[1], uvs))
                if at[2]:
                    mesh.normals = mesh.normals or []
                    mesh.normals.append(place(at[2], normals))
            mesh.faces += [(corners[0], corners[i], corners[i + 1]) for i in range(1, len(corners) - 1)]
    return list(meshes.values())


SCALARS = {"char": "b", "int8": "b", "uchar": "B", "uint8": "B", "short": "h", "int16": "h", "ushort": "H", "uint16": "H",
           "int": "i", "int32": "i", "uint": "I", "uint32": "I", "float": "f", "float32": "f", "double": "d", "float64": "d"}


def read_ply(path):
    """One mesh; of text or bytes."""
    data = path.read_bytes()
    end = data.index(b"end_header")
    head, body = data[:end].decode().splitlines(), data[data.index(b"\n", end) + 1:]
    form, elements = "ascii", []
    for words in (line.split() for line in head):
        if words[:1] == ["format"]:
            form = words[1]
        elif words[:1] == ["element"]:
            elements.append((words[1], int(words[2]), []))
        elif words[:1] == ["property"]:
            elements[-1][2].append(words[1:])
    if form == "ascii":
        numbers = iter(body.split())
        next_number = lambda kind: (float if kind in "fd" else int)(next(numbers))
    else:
        order, at = "<" if "little" in form else ">", [0]

        def next_number(kind):
            value, = struct.unpack_from(order + kind, body, at[0])
            at[0] += struct.calcsize(kind)
            return value
    mesh = Mesh()
    mesh.material.is_double_sided = True
    for name, count, properties in elements:
        for _ in range(count):
            row = {}
            for p in properties:
                if p[0] == "list":
                    row[p[3]] = [next_number(SCALARS[p[2]]) for _ in range(next_number(SCALARS[p[1]]))]
                else:
                    row[p[1]] = next_number(SCALARS[p[0]])
            if name == "vertex":
                mesh.points.append([row[c] for c in "xyz"])
                if "nx" in row:
                    mesh.normals = (mesh.normals or []) + [[row["nx"], row["ny"], row["nz"]]]
                if "red" in row:
                    most = 1 if ["float", "red"] in properties else 255
                    mesh.colors = (mesh.colors or []) + [[linear(row[c] / most) for c in ("red", "green", "blue")] + [1]]
            elif name == "face":
                face = row.get("vertex_indices", row.get("vertex_index"))
                mesh.faces += [(face[0], face[i], face[i + 1]) for i in range(1, len(face) - 1)]
    return [mesh]


def read_meshes(path):
    path = pathlib.Path(path)
    return {".obj": read_obj, ".ply": read_ply}[path.suffix](path)
