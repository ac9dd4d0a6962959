"""What is seen first through the centre of each pixel, found with nothing of Rayfarm's: triangles one after another, a
list of all that lie behind each pixel, and materials as glTF 2.0 says."""
import math
import pathlib
import subprocess
import tempfile

from mesh_reader import linear


def minus(a, b):
    return [a[0] - b[0], a[1] - b[1], a[2] - b[2]]


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def normalized(a):
    length = math.sqrt(dot(a, a))
    return [x / length for x in a] if length > 0 else a


class View:
    """`half_width` is at distance one, or of an orthographic view in the world."""
    def __init__(self, location, forward, up, half_width, is_orthographic=False):
        self.location, self.forward = location, normalized(forward)
        self.right = normalized(cross(self.forward, up))
        self.up = cross(self.right, self.forward)
        self.half_width, self.is_orthographic = half_width, is_orthographic

    def of(self, p):
        """Along right and up, and the depth."""
        p = minus(p, self.location)
        return [dot(p, self.right), dot(p, self.up), dot(p, self.forward)]


def camera_view(camera, world):
    """A camera of glTF looks along the -z of its node; the picture is as wide as the camera sees."""
    column = lambda i: [world[r][i] for r in range(3)]
    lens = camera[camera["type"]]
    half = lens["aspectRatio"] * math.tan(lens["yfov"] / 2) if camera["type"] == "perspective" else lens["xmag"]
    return View(column(3), [-c for c in column(2)], column(1), half, camera["type"] == "orthographic")


class Image:
    """Eight bits a channel, as they stand in the file."""
    def __init__(self, data):
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            name = folder / ("in.png" if data[:4] == b"\x89PNG" else "in.jpg")
            name.write_bytes(data)
            info = subprocess.run(["oiiotool", "--info", name], capture_output=True, text=True, check=True, timeout=30).stdout
            channels = int(info.split(" channel")[0].split()[-1])
            color = "0,1,2" if channels > 2 else "0,0,0"
            alpha = {2: "1", 4: "3"}.get(channels, "0")
            subprocess.run(["oiiotool", "-iconfig", "oiio:UnassociatedAlpha", "1", name, "--dup", "--ch", color, "-d", "uint8", "-o",
                            folder / "color.ppm", "--pop", "--ch", alpha, "-d", "uint8", "-o", folder / "alpha.pgm"],
                           capture_output=True, check=True, timeout=30)
            self.size, self.color = self.read(folder / "color.ppm")
            self.alpha = self.read(folder / "alpha.pgm")[1] if channels in (2, 4) else None

    @staticmethod
    def read(path):
        data = path.read_bytes()
        kind, width, height, _ = data.split(None, 4)[:4]
        size = int(width), int(height)
        return size, data[len(data) - size[0] * size[1] * (3 if kind == b"P6" else 1):]


LINEAR = [linear(i / 255) for i in range(256)]
IMAGES = {}


def wrapped(i, n, wrap):
    if wrap == 33071:
        return min(max(i, 0), n - 1)
    if wrap == 33648:
        i %= 2 * n
        return i if i < n else 2 * n - 1 - i
    return i % n


def sampled(material, uv):
    """Linear light and alpha, between the four nearest texels."""
    image = IMAGES.get(material.image) or IMAGES.setdefault(material.image, Image(material.image))
    (w, h), row = image.size, [*uv, 1]
    x, y = dot(material.uv_rows[0], row) * w - 0.5, dot(material.uv_rows[1], row) * h - 0.5
    if material.is_nearest:
        x, y = math.floor(x + 0.5), math.floor(y + 0.5)
    left, top = math.floor(x), math.floor(y)
    sums = [0, 0, 0, 0]
    for i, k, weight in ((0, 0, (1 - x + left) * (1 - y + top)), (1, 0, (x - left) * (1 - y + top)),
                         (0, 1, (1 - x + left) * (y - top)), (1, 1, (x - left) * (y - top))):
        at = wrapped(top + k, h, material.wraps[1]) * w + wrapped(left + i, w, material.wraps[0])
        for c in range(3):
            sums[c] += weight * LINEAR[image.color[3 * at + c]]
        sums[3] += weight * (image.alpha[at] / 255 if image.alpha else 1)
    return sums


class Fragment:
    """A triangle where a pixel's ray meets it. `weights`: of its corners."""
    def __init__(self, view, mesh, face, depth, weights):
        self.depth = depth
        self.between = lambda of: [sum(w * of[i][c] for w, i in zip(weights, face)) for c in range(len(of[face[0]]))]
        a, b, c = (mesh.points[i] for i in face)
        normal = normalized(cross(minus(b, a), minus(c, a)))
        if mesh.is_mirrored:
            normal = [-x for x in normal]
        to_viewer = view.forward if view.is_orthographic else minus(self.between(mesh.points), view.location)
        self.is_front = dot(normal, to_viewer) < 0
        turned = (lambda n: n) if self.is_front else (lambda n: [-x for x in n])
        self.normal = turned(normal)
        self.shading_normal = turned(normalized(self.between(mesh.normals))) if mesh.normals else self.normal
        self.mesh, self.material = mesh, mesh.material

    def base(self):
        """Colour and alpha."""
        color = list(self.material.factor)
        if self.material.image is not None and len(self.mesh.uvs) > self.material.set:
            color = [x * y for x, y in zip(color, sampled(self.material, self.between(self.mesh.uvs[self.material.set])))]
        if self.mesh.colors:
            color = [x * y for x, y in zip(color, self.between(self.mesh.colors))]
        return color

    def opacity(self):
        if not self.is_front and not self.material.is_double_sided:
            return 0
        if self.material.mode == "OPAQUE":
            return 1
        alpha = self.base()[3]
        return alpha if self.material.mode == "BLEND" else int(alpha >= self.material.cutoff)


def all_hits(view, meshes, width, height):
    """For each pixel what its ray meets: (depth, mesh, face, weights)."""
    hits = [[] for _ in range(width * height)]
    half_w, half_h = view.half_width, view.half_width * height / width
    to_x, to_y = width / 2 / half_w, height / 2 / half_h
    for mesh in meshes:
        seen = [view.of(p) for p in mesh.points]
        if view.is_orthographic:
            raster = [(x * to_x, y * to_y) for x, y, _ in seen]
        else:
            raster = [(x / z * to_x, y / z * to_y) if z > 0 else None for x, y, z in seen]
        for face in mesh.faces:
            i, k, l = face
            corners = raster[i], raster[k], raster[l]
            if None in corners:
                if corners == (None, None, None):
                    continue
                columns, rows = range(width), range(height)
            else:
                (xa, ya), (xb, yb), (xc, yc) = corners
                columns = range(max(0, math.ceil(width / 2 + min(xa, xb, xc) - 0.500001)),
                                min(width - 1, math.floor(width / 2 + max(xa, xb, xc) - 0.499999)) + 1)
                rows = range(max(0, math.ceil(height / 2 - max(ya, yb, yc) - 0.500001)),
                             min(height - 1, math.floor(height / 2 - min(ya, yb, yc) - 0.499999)) + 1)
            if not columns or not rows:
                continue
            a, u, v = seen[i], minus(seen[k], seen[i]), minus(seen[l], seen[i])
            for y in rows:
                for x in columns:
                    at_x, at_y = (x + 0.5 - width / 2) / to_x, (height / 2 - y - 0.5) / to_y
                    origin, along = ([at_x, at_y, 0], [0, 0, 1]) if view.is_orthographic else ([0, 0, 0], [at_x, at_y, 1])
                    # Möller and Trumbore 1997.
                    p = cross(along, v)
                    d = dot(u, p)
                    if d == 0:
                        continue
                    from_a = minus(origin, a)
                    b = dot(from_a, p) / d
                    q = cross(from_a, u)
                    c, depth = dot(along, q) / d, dot(v, q) / d
                    if b >= 0 and c >= 0 and b + c <= 1 and depth > 0:
                        hits[y * width + x].append((depth, mesh, face, (1 - b - c, b, c)))
    return hits


def first_hits(view, meshes, width, height):
    """For each pixel what may be seen there, nearest first: nothing (None) at last, unless something is opaque. Several
    where a surface is there by chance, as alpha says."""
    result = []
    for hits in all_hits(view, meshes, width, height):
        seen = []
        for hit in sorted(hits, key=lambda hit: hit[0]):
            fragment = Fragment(view, hit[1], hit[2], hit[0], hit[3])
            opacity = fragment.opacity()
            if opacity > 0:
                seen.append(fragment)
            if opacity >= 1:
                break
        else:
            seen.append(None)
        result.append(seen)
    return result
