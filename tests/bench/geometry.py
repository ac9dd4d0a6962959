"""Points and triangles of the benchmark scenes: a mesh is (points, triangles), a triangle three indices of points."""
import math


def bumpy_sphere(columns, rows, radius=1.0, center=(0, 0, 0), bumps=0.05):
    """2 columns (rows - 1) triangles."""
    points = []
    for j in range(1, rows):
        theta = math.pi * j / rows
        for i in range(columns):
            phi = 2 * math.pi * i / columns
            r = radius * (1 + bumps * math.sin(11 * phi) * math.sin(9 * theta) ** 2 * math.sin(theta)
                          + 0.4 * bumps * math.sin(31 * theta + 5 * phi) * math.sin(theta))
            points.append((center[0] + r * math.sin(theta) * math.cos(phi), center[1] + r * math.cos(theta),
                           center[2] + r * math.sin(theta) * math.sin(phi)))
    top, bottom = len(points), len(points) + 1
    points += [(center[0], center[1] + radius, center[2]), (center[0], center[1] - radius, center[2])]
    triangles = []
    for i in range(columns):
        k = (i + 1) % columns
        triangles.append((top, k, i))
        last = (rows - 2) * columns
        triangles.append((bottom, last + i, last + k))
        for j in range(rows - 2):
            a, b, c, d = j * columns + i, j * columns + k, (j + 1) * columns + i, (j + 1) * columns + k
            triangles += [(a, b, c), (b, d, c)]
    return points, triangles


def terrain(cells, extent=100.0):
    """2 cells² triangles."""
    points, triangles = [], []
    waves = [(0.11, 0.07, 0.3, 4.0), (-0.13, 0.19, 1.1, 2.5), (0.41, -0.33, 2.0, 1.0), (0.9, 0.7, 0.5, 0.45),
             (-1.9, 2.3, 0.2, 0.2), (4.7, 3.9, 1.7, 0.08), (-9.1, 8.3, 0.9, 0.03)]
    for j in range(cells + 1):
        z = extent * (j / cells - 0.5)
        for i in range(cells + 1):
            x = extent * (i / cells - 0.5)
            points.append((x, sum(h * math.sin(a * x + b * z + c) for a, b, c, h in waves), z))
    for j in range(cells):
        for i in range(cells):
            a = j * (cells + 1) + i
            triangles += [(a, a + cells + 1, a + 1), (a + 1, a + cells + 1, a + cells + 2)]
    return points, triangles


def box_polygons(lo, hi, turn=0.0, about=(0, 0, 0), inward=False):
    def corner(i):
        x, y, z = ((hi if i >> k & 1 else lo)[k] for k in range(3))
        c, s = math.cos(math.radians(turn)), math.sin(math.radians(turn))
        return about[0] + c * x + s * z, about[1] + y, about[2] - s * x + c * z
    faces = [(0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6)]
    return [[corner(i) for i in (reversed(f) if inward else f)] for f in faces]


def as_mesh(polygons):
    points, triangles = [], []
    for polygon in polygons:
        first = len(points)
        points += polygon
        triangles += [(first, first + k, first + k + 1) for k in range(1, len(polygon) - 1)]
    return points, triangles


def join(meshes):
    points, triangles = [], []
    for p, t in meshes:
        first = len(points)
        points += p
        triangles += [tuple(first + i for i in one) for one in t]
    return points, triangles


def cross(a, b):
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def unit(a):
    length = math.hypot(*a)
    return tuple(x / length for x in a)


def bar(a, b, radius, sides=8):
    """A prism about a line, however long: 4 sides - 4 triangles, its sides as long as the bar."""
    along = unit(tuple(q - p for p, q in zip(a, b)))
    u = unit(cross(along, (0, 1, 0) if abs(along[1]) < 0.9 else (1, 0, 0)))
    v = cross(along, u)
    turns = [2 * math.pi * (k + 0.5) / sides for k in range(sides)]
    ends = [[tuple(p[i] + radius * (math.cos(t) * u[i] + math.sin(t) * v[i]) for i in range(3)) for t in turns]
            for p in (a, b)]
    around = [[ends[0][k], ends[0][(k + 1) % sides], ends[1][(k + 1) % sides], ends[1][k]] for k in range(sides)]
    return as_mesh(around + [ends[0][::-1], ends[1]])


def turned(mesh, degrees):
    points, triangles = mesh
    return [place_point((degrees, (0, 0, 0)), p) for p in points], triangles


def strand(root, direction, length, width, segments, rng):
    """A ribbon of 2 segments triangles that bends, curls and twists from its root."""
    points, triangles = [], []
    p, step = root, length / segments
    bend = unit(tuple(rng.gauss(0, 1) for _ in range(3)))
    curl, twist, angle = rng.uniform(0.05, 0.3), rng.uniform(-0.5, 0.5), rng.uniform(0, math.pi)
    for k in range(segments + 1):
        u = unit(cross(direction, bend))
        v = cross(direction, u)
        half = 0.5 * width * (1 - 0.9 * k / segments)
        side = [half * (math.cos(angle) * u[i] + math.sin(angle) * v[i]) for i in range(3)]
        points += [tuple(p[i] - side[i] for i in range(3)), tuple(p[i] + side[i] for i in range(3))]
        p = tuple(p[i] + step * direction[i] for i in range(3))
        direction = unit((direction[0] + curl * u[0], direction[1] + curl * u[1] - 1.5 * step, direction[2] + curl * u[2]))
        angle += twist
    for k in range(0, 2 * segments, 2):
        triangles += [(k, k + 1, k + 2), (k + 1, k + 3, k + 2)]
    return points, triangles


def sphereflake(depth, center=(0, 0, 0), radius=0.5, axis=(0, 0, 1)):
    """A sphere with nine of a third of its radius on it, and so on (Haines 1987): (9^(depth+1) - 1) / 8 spheres."""
    spheres = [(center, radius)]
    if depth == 0:
        return spheres
    helper = (1, 0, 0) if abs(axis[0]) < 0.8 else (0, 1, 0)
    u = unit(cross(axis, helper))
    v = cross(axis, u)
    for ring, count, height in ((0, 6, 0.0), (1, 3, math.sqrt(2 / 3))):
        for k in range(count):
            angle = 2 * math.pi * (k + 0.5 * ring) / count
            across = math.sqrt(1 - height * height)
            d = tuple(across * (math.cos(angle) * u[i] + math.sin(angle) * v[i]) + height * axis[i] for i in range(3))
            place = tuple(center[i] + radius * 4 / 3 * d[i] for i in range(3))
            spheres += sphereflake(depth - 1, place, radius / 3, d)
    return spheres


def place_point(place, p):
    degrees, (tx, ty, tz) = place
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    return c * p[0] + s * p[2] + tx, p[1] + ty, -s * p[0] + c * p[2] + tz
