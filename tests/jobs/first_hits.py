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
    """A triangle where a pixel's ray meets its plane. `meet(dx, dy)`: the depth, and the weights of its corners, that far
    from the pixel's centre."""
    def __init__(self, view, mesh, face, meet):
        self.mesh, self.face, self.material, self.meet = mesh, face, mesh.material, meet
        self.depth, self.weights = meet(0, 0)
        a, b, c = (mesh.points[i] for i in face)
        normal = normalized(cross(minus(b, a), minus(c, a)))
        if mesh.is_mirrored:
            normal = [-x for x in normal]
        to_point = view.forward if view.is_orthographic else minus(self.between(mesh.points), view.location)
        self.is_front = dot(normal, to_point) < 0
        turned = (lambda n: n) if self.is_front else (lambda n: [-x for x in n])
        self.normal = turned(normal)
        self.shading_normal = turned(normalized(self.between(mesh.normals))) if mesh.normals else self.normal

    def between(self, of, weights=None):
        return [sum(w * of[i][c] for w, i in zip(weights or self.weights, self.face)) for c in range(len(of[self.face[0]]))]

    def has_texture(self):
        return self.material.image is not None and len(self.mesh.uvs) > self.material.set

    def base(self, weights=None):
        """Colour and alpha, in the pixel's centre if not elsewhere."""
        color = self.material.factor
        if self.has_texture():
            uv = self.between(self.mesh.uvs[self.material.set], weights)
            color = [x * y for x, y in zip(color, sampled(self.material, uv))]
        if self.mesh.colors:
            color = [x * y for x, y in zip(color, self.between(self.mesh.colors, weights))]
        return color

    def mean_base(self):
        """Over what of the triangle's plane is seen in the pixel."""
        if not self.has_texture():
            return self.base()
        places = [(i + 0.5) / POINTS - 0.5 for i in range(POINTS)]
        colors = [self.base(self.meet(x, y)[1]) for y in places for x in places]
        return [sum(c) / len(colors) for c in zip(*colors)]

    def opacity(self):
        """0: it is not there; 1: it is; between: by chance."""
        if not self.is_front and not self.material.is_double_sided:
            return 0
        if self.material.mode == "OPAQUE":
            return 1
        alpha = self.mean_base()[3]
        return alpha if self.material.mode == "BLEND" else int(alpha >= self.material.cutoff)


POINTS = 4  # a side, for means over a pixel


def meeting(corners, origin, along):
    """Depth and weights where a ray meets a triangle's plane; None if it is parallel to it. As Möller and Trumbore 1997."""
    a, u, v = corners[0], minus(corners[1], corners[0]), minus(corners[2], corners[0])
    p = cross(along, v)
    d = dot(u, p)
    if d == 0:
        return None
    from_a = minus(origin, a)
    q = cross(from_a, u)
    b, c = dot(from_a, p) / d, dot(along, q) / d
    return dot(v, q) / d, (1 - b - c, b, c)


class Raster:
    def __init__(self, view, width, height):
        self.view, self.width, self.height = view, width, height
        self.per_length = width / 2 / view.half_width  # at depth one

    def ray(self, x, y):
        """Through a place in pixels, along right, up and depth."""
        x, y = (x - self.width / 2) / self.per_length, (self.height / 2 - y) / self.per_length
        return ([x, y, 0], [0, 0, 1]) if self.view.is_orthographic else ([0, 0, 0], [x, y, 1])

    def pixels(self, corners):
        """Those whose centres may be in a triangle."""
        if all(z <= 0 for _, _, z in corners):
            return range(0), range(0)
        if any(z <= 0 for _, _, z in corners):
            return range(self.width), range(self.height)
        places = [(x / (1 if self.view.is_orthographic else z), y / (1 if self.view.is_orthographic else z)) for x, y, z in corners]
        xs = [self.width / 2 + x * self.per_length for x, _ in places]
        ys = [self.height / 2 - y * self.per_length for _, y in places]
        slack = 1e-6
        span = lambda at, size: range(max(0, math.ceil(min(at) - 0.5 - slack)), min(size - 1, math.floor(max(at) - 0.5 + slack)) + 1)
        return span(xs, self.width), span(ys, self.height)


def all_fragments(view, meshes, width, height):
    """Of each pixel, in no order."""
    raster, found = Raster(view, width, height), [[] for _ in range(width * height)]
    for mesh in meshes:
        seen = [view.of(p) for p in mesh.points]
        for face in mesh.faces:
            corners = [seen[i] for i in face]
            columns, rows = raster.pixels(corners)
            for y in rows:
                for x in columns:
                    meet = lambda dx, dy, x=x, y=y, corners=corners: meeting(corners, *raster.ray(x + 0.5 + dx, y + 0.5 + dy))
                    met = meet(0, 0)
                    if met and met[0] > 0 and min(met[1]) >= 0:
                        found[y * width + x].append(Fragment(view, mesh, face, meet))
    return found


def first_hits(view, meshes, width, height):
    """For each pixel what may be seen there, nearest first, and at last None, for nothing, unless something is opaque.
    Several where a surface is there by chance, as alpha says."""
    result = []
    for fragments in all_fragments(view, meshes, width, height):
        seen = []
        for fragment in sorted(fragments, key=lambda f: f.depth):
            opacity = fragment.opacity()
            if opacity > 0:
                seen.append(fragment)
            if opacity >= 1:
                break
        else:
            seen.append(None)
        result.append(seen)
    return result
