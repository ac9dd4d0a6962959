"""Writes glTF files of what is made of numbers: accessors, pictures, and grids of vertices."""
import base64
import json
import math
import pathlib
import struct
import zlib

FORMATS = {5121: "B", 5123: "H", 5126: "f"}
PARTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}


def picture(width, height, pixel):
    """A PNG of red, green, blue and alpha."""
    rows = b"".join(b"\0" + bytes(c for x in range(width) for c in pixel(x, y)) for y in range(height))
    chunk = lambda kind, data: struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 6, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b""))


def grid(columns, rows, point):
    """Vertices of columns + 1 by rows + 1 points, and the triangles between them."""
    vertices = [point(x / columns, y / rows) for y in range(rows + 1) for x in range(columns + 1)]
    at = lambda x, y: y * (columns + 1) + x
    triangles = [i for y in range(rows) for x in range(columns)
                 for i in (at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y), at(x + 1, y + 1), at(x, y + 1))]
    return vertices, triangles


def turn(axis, degrees):
    """A quaternion; the axis has the length 1."""
    return [math.sin(math.radians(degrees) / 2) * a for a in axis] + [math.cos(math.radians(degrees) / 2)]


def moved(x, y, z):
    """A matrix by columns."""
    return [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, x, y, z, 1]


class Writer:
    def __init__(self):
        self.buffer, self.views, self.accessors = bytearray(), [], []

    def view(self, data):
        self.buffer.extend(b"\0" * (-len(self.buffer) % 4))
        self.views.append({"buffer": 0, "byteOffset": len(self.buffer), "byteLength": len(data)})
        self.buffer.extend(data)
        return len(self.views) - 1

    def accessor(self, values, shape, code=5126, normalized=False):
        flat = [x for value in values for x in (value if isinstance(value, (list, tuple)) else [value])]
        a = {"bufferView": self.view(struct.pack(f"<{len(flat)}{FORMATS[code]}", *flat)), "componentType": code,
             "type": shape, "count": len(flat) // PARTS[shape]}
        if normalized:
            a["normalized"] = True
        self.accessors.append(a)
        return len(self.accessors) - 1

    def write(self, path, model):
        """As text with all data in it (.gltf), or as .glb. `model` has all but buffers, their views and accessors."""
        path = pathlib.Path(path)
        model = {"asset": {"version": "2.0"}, **model, "bufferViews": self.views, "accessors": self.accessors,
                 "buffers": [{"byteLength": len(self.buffer)}]}
        if path.suffix == ".gltf":
            model["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64.b64encode(self.buffer).decode()
            path.write_text(json.dumps(model, separators=(",", ":")).replace('},{', '},\n{') + "\n")
            return
        text = json.dumps(model, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        data = bytes(self.buffer) + b"\0" * (-len(self.buffer) % 4)
        path.write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + 8 + len(text) + 8 + len(data)) +
                         struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(data), b"BIN\0") + data)
