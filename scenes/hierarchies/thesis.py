"""The thesis's three test images (section 4.3, Plates 4.1 and 4.2): objects, polygons and colours of Table 4.3."""
import math

from placing import move
from shapes import box, item, lathe, mesh, polygon, quad, sphere, view
from vectors import add, circle, times

# ---- Image 1 ----------------------------------------------------------------------------------------------------


def window(corner, across, width, height, bar=0.07):
    """A frame of ten polygons: a mitred ring, its inner sides, and a cross."""
    def at(a, b, inward=0.0):
        return add(add(corner, times(a, across)), add((0, b, 0), times(inward, (-across[2], 0, across[0]))))
    outer = [at(0, 0), at(width, 0), at(width, height), at(0, height)]
    inner = [at(bar, bar), at(width - bar, bar), at(width - bar, height - bar), at(bar, height - bar)]
    deep = [at(bar, bar, -bar), at(width - bar, bar, -bar), at(width - bar, height - bar, -bar), at(bar, height - bar, -bar)]
    ring = [polygon(outer[k], outer[(k + 1) % 4], inner[(k + 1) % 4], inner[k]) for k in range(4)]
    sides = [polygon(inner[k], inner[(k + 1) % 4], deep[(k + 1) % 4], deep[k]) for k in range(4)]
    half = bar / 3
    cross = [polygon(at(width / 2 - half, bar), at(width / 2 + half, bar), at(width / 2 + half, height - bar),
                     at(width / 2 - half, height - bar)),
             polygon(at(bar, 0.6 * height - half), at(width - bar, 0.6 * height - half), at(width - bar, 0.6 * height + half),
                     at(bar, 0.6 * height + half))]
    return ring + sides + cross


def strokes(points, pen=0.15):
    """A broad line through points of a plane, mitred: a quadrilateral for each part."""
    def normal(a, b):
        length = math.dist(a, b)
        return (a[1] - b[1]) / length, (b[0] - a[0]) / length
    closed = points[0] == points[-1]
    parts = [normal(a, b) for a, b in zip(points, points[1:])]
    sides = []
    for k, p in enumerate(points):
        before = parts[k - 1] if k > 0 or closed else parts[k]
        after = parts[k % len(parts)] if k < len(parts) or closed else parts[k - 1]
        middle = add(before, after)
        scale = pen / (1 + before[0] * after[0] + before[1] * after[1])
        sides.append((add(p, times(scale, middle)), add(p, times(-scale, middle))))
    return [(a[1], b[1], b[0], a[0]) for a, b in zip(sides, sides[1:])]


def title(corner, size):
    """BEACH HOUSE in 67 quadrilaterals."""
    bowl = [(0.12, 1.0), *circle(0.25, 4, (0.4, 0.75), 90, -90), (0.12, 0.5)]
    lower = [(0.12, 0.5), *circle(0.25, 4, (0.45, 0.25), 90, -90), (0.12, 0.0)]
    ring = [(0.4 + 0.35 * c, 0.5 + 0.5 * s) for c, s in circle(1, 12)]
    s_curve = [(0.4 + 0.3 * c, 0.75 + 0.25 * s) for c, s in circle(1, 6, first=30, last=255)] + \
              [(0.4 + 0.3 * c, 0.25 + 0.25 * s) for c, s in circle(1, 6, first=75, last=-150)]
    letters = {
        "A": [[(0.05, -0.03), (0.4, 1.03)], [(0.4, 1.03), (0.75, -0.03)], [(0.2, 0.35), (0.6, 0.35)]],  # 3
        "B": [[(0.12, -0.05), (0.12, 1.05)], bowl, lower],  # 11
        "C": [[(0.42 + 0.35 * c, 0.5 + 0.5 * s) for c, s in circle(1, 10, first=45, last=315)]],  # 9
        "E": [[(0.12, -0.05), (0.12, 1.05)], *([(0.12, y), (x, y)] for y, x in ((0, 0.68), (0.5, 0.6), (1, 0.68)))],  # 4
        "H": [[(0.12, -0.05), (0.12, 1.05)], [(0.68, -0.05), (0.68, 1.05)], [(0.12, 0.5), (0.68, 0.5)]],  # 3
        "O": [[*ring, ring[0]]],  # 12
        "S": [s_curve],  # 11
        "U": [[(0.1, 1.05), *circle(0.3, 6, (0.4, 0.3), 180, 360), (0.7, 1.05)]],  # 7
    }
    faces = []
    for k, letter in enumerate("BEACH HOUSE"):
        for line in letters.get(letter, []):
            faces += [polygon(*(add(corner, (size * (x + 0.95 * k), size * y, 0)) for x, y in face)) for face in strokes(line, 0.06)]
    return faces


def beach_house():
    x, h, near, far = 6.0, 4.0, 6.0, -6.0
    door = 3.6  # half of the opening to the sea, 2.9 high
    room = [quad((-x, 0, near), (2 * x, 0, 0), (0, 0, far - near)), quad((-x, h, far), (2 * x, 0, 0), (0, 0, near - far)),
            quad((x, 0, near), (-2 * x, 0, 0), (0, h, 0)),
            quad((-x, 0, far), (x - door, 0, 0), (0, h, 0)), quad((door, 0, far), (x - door, 0, 0), (0, h, 0)),
            quad((-door, 2.9, far), (2 * door, 0, 0), (0, h - 2.9, 0))]
    for side, step in ((-x, 1), (x, -1)):  # a wall about a window, from z = -4 to 0
        begin, end = (near, far) if step > 0 else (far, near)
        low, high = (0, -4) if step > 0 else (-4, 0)
        room += [quad((side, 0, begin), (0, 0, end - begin), (0, 1, 0)),
                 quad((side, 2.6, begin), (0, 0, end - begin), (0, h - 2.6, 0)),
                 quad((side, 1, begin), (0, 0, low - begin), (0, 1.6, 0)), quad((side, 1, high), (0, 0, end - high), (0, 1.6, 0))]
    frames = [p for k in range(4) for p in window((-door + 1.8 * k, 0.0, far), (1, 0, 0), 1.8, 2.9)]
    frames += [p for side, turn in ((-x, -1), (x, 1)) for k in range(2)
               for p in window((side, 1, (-2 * k if turn < 0 else -4 + 2 * k)), (0, 0, turn), 2.0, 1.6)]
    table = lathe(18, (0, 0), (0.34, 0), (0.38, 0.06), (0.12, 0.15), (0.08, 0.35), (0.17, 0.5), (0.08, 0.68), (0.12, 0.8),
                  (0.58, 0.84),
                  (0.58, 0.9), (0, 0.9))
    reach, back = 60.0, -110.0
    return {
        "comment": ["Image 1 of the thesis (section 4.3.2, Plate 4.1a, Table 4.3): a beach house, 14 objects of 1,658 polygons."],
        "view": view((0.7, 1.8, 3.9), (-0.05, 1.45, -3), 60, 256, 256),
        "background": (0.5, 0.68, 0.92),
        "lights": [{"position": (-1.6, 3.7, 2.6)}],
        "materials": {
            "white": {"color": (0.93, 0.92, 0.89), "ambient": 0.35, "diffuse": 0.62},
            "glazed": {"color": 0.94, "ambient": 0.3, "diffuse": 0.5, "specular": 0.2, "shininess": 60},
            "sky": {"color": (0.5, 0.68, 0.92), "ambient": 0.98, "diffuse": 0},
            "grass": {"color": (0.36, 0.6, 0.22), "ambient": 0.9, "diffuse": 0.1},
            "sand": {"color": (0.9, 0.8, 0.58), "ambient": 0.9, "diffuse": 0.1},
            "water": {"color": (0.16, 0.4, 0.68), "ambient": 0.9, "diffuse": 0.1},
            "brown": {"color": (0.5, 0.3, 0.16), "ambient": 0.3, "diffuse": 0.6, "specular": 0.2, "shininess": 40},
            "wood": {"color": (0.42, 0.26, 0.15), "ambient": 0.4, "diffuse": 0.55},
            "green": {"color": (0.2, 0.55, 0.25)},
            "red": {"color": (0.8, 0.13, 0.1), "ambient": 0.25, "diffuse": 0.6, "specular": 0.4, "shininess": 60},
            "gold": {"color": (0.95, 0.72, 0.25), "ambient": 0.2, "diffuse": 0.35, "specular": 0.5, "shininess": 70, "reflect": 0.4},
            "blue": {"color": (0.16, 0.3, 0.8), "ambient": 0.25, "diffuse": 0.6, "specular": 0.4, "shininess": 60},
        },
        "scene": [
            item("room", "white", *room),
            item("sky", "sky", quad((-reach, -2, back), (2 * reach, 0, 0), (0, 44, 50))),
            item("grass", "grass", quad((-reach, -0.1, 12), (2 * reach, 0, 0), (0, 0, -30))),
            item("sand", "sand", quad((-reach, -0.1, -18), (2 * reach, 0, 0), (0, -0.5, -6)),
                 quad((-reach, -0.6, -24), (2 * reach, 0, 0), (0, -0.5, -16))),
            item("water", "water", *(quad((-reach, -1, -34 - (back + 34) * -k / 3), (2 * reach, 0, 0),
                                          (0, 0, (back + 34) / 3)) for k in range(3))),
            item("centre table", "brown", lathe(14, (0, 0), (0.75, 0), (0.13, 0.16), (0.13, 0.86), (1.35, 0.93), (0, 0.96)),
                 at=move((0, 0, -1.2))),
            item("dish", "glazed", lathe(36, (0, 0), (0.15, 0), (0.17, 0.02), (0.3, 0.05), (0.42, 0.1), (0.44, 0.115), (0.4, 0.11),
                                         (0.3, 0.065),
                                         (0.2, 0.038), (0.1, 0.03), (0, 0.028)), at=move((0.45, 0.96, -0.9))),
            item("glass", "gold", lathe(36, (0, 0), (0.2, 0), (0.18, 0.03), (0.03, 0.07), (0.03, 0.32), (0.14, 0.4), (0.2, 0.55),
                                        (0.18, 0.78),
                                        (0.165, 0.78), (0.18, 0.55), (0, 0.4)), at=move((-0.5, 0.96, -0.75))),
            item("bowl", "blue", lathe(26, (0, 0), (0.18, 0), (0.2, 0.04), (0.34, 0.1), (0.45, 0.22), (0.5, 0.36), (0.47, 0.37),
                                       (0.42, 0.22),
                                       (0.3, 0.12), (0.15, 0.07), (0, 0.06)), at=move((-0.1, 0.96, -1.7))),
            item("left table", "white", table, at=move((-3.7, 0, -3.4))),
            item("right table", "white", table, at=move((3.4, 0, -3.4))),
            item("vase", "red", lathe(16, (0, 0), (0.14, 0), (0.27, 0.3), (0.08, 0.75), (0.17, 1.0), (0, 0.7)),
                 at=move((-3.7, 0.9, -3.4))),
            item("frames", "wood", *frames),
            item("title", "green", *title((-3.05, 3.2, -5.97), 0.6)),
        ],
    }


# ---- Image 2 ----------------------------------------------------------------------------------------------------


def primitives():
    balls = [("mirror", (0, 1.5, -0.6), 1.5), ("red", (-4.6, 0.9, 1.6), 0.9), ("glass", (1.9, 0.85, 3.9), 0.85),
             ("orange", (4.9, 0.75, 2.9), 0.75),
             ("teal", (-1.9, 0.6, 4.4), 0.6), ("violet", (-7.4, 1.1, -3.5), 1.1), ("mirror", (6.9, 1.2, -3.2), 1.2)]
    boxes = [("blue", (0.7, 1.4, 0.7), 0, (-3.2, 0, -1.6)), ("yellow", (0.7, 1.4, 0.7), 30, (3.4, 0, -0.4)),
             ("green", (0.8, 2.4, 0.8), -20, (-5.8, 0, -6)),
             ("orange", (1, 1.2, 0.6), 12, (0.6, 0, -6.2)), ("violet", (0.9, 1.8, 0.9), 48, (5.3, 0, -6.8)),
             ("green", (0.45, 0.7, 0.45), -35, (-0.3, 0, 6.1)),
             ("yellow", (0.4, 0.9, 0.6), 20, (-3.6, 0, 4.6))]
    pyramids = [(1, 25, (-2.5, 0, 1.6)), (1.5, -15, (-2.4, 0, -9)), (0.95, 50, (4.2, 0, 5.4))]
    pyramid = mesh([(-0.8, 0, -0.8), (0.8, 0, -0.8), (0.8, 0, 0.8), (-0.8, 0, 0.8), (0, 1.7, 0)],
                   [(0, 1, 2, 3), (3, 2, 4), (2, 1, 4), (1, 0, 4), (0, 3, 4)])
    shine = {"ambient": 0.2, "diffuse": 0.65, "specular": 0.3, "shininess": 30, "reflect": 0.12}
    return {
        "comment": ["Image 2 of the thesis (section 4.3.2, Plate 4.1b, Table 4.3): 19 objects of 58 polygons and 8 quadrics.",
                    "The places of ../primitives.yaml, each object under a name of its own, and one light."],
        "view": view((0, 5.4, 15.5), (0, 0.9, 0), 50, 256, 256),
        "lights": [{"position": (-14, 22, 18)}],
        "materials": {
            "floor": {"color": (0.9, 0.88, 0.84), "ambient": 0.3, "diffuse": 0.6},
            "sky": {"color": (0.42, 0.62, 0.9), "ambient": 0.95, "diffuse": 0.05},
            "mirror": {"color": (0.85, 0.87, 0.9), "ambient": 0.05, "diffuse": 0.15, "specular": 0.4, "shininess": 80,
                       "reflect": 0.75},
            "glass": {"color": (0.9, 1, 0.95), "ambient": 0.02, "diffuse": 0.05, "specular": 0.5, "shininess": 120, "reflect": 0.1,
                      "transmit": 0.85,
                      "index": 1.5},
            "red": {"color": (0.85, 0.2, 0.15), **shine}, "orange": {"color": (0.95, 0.55, 0.15), **shine},
            "yellow": {"color": (0.9, 0.8, 0.25), **shine},
            "green": {"color": (0.25, 0.65, 0.3), **shine}, "teal": {"color": (0.15, 0.6, 0.6), **shine},
            "blue": {"color": (0.2, 0.35, 0.8), **shine},
            "violet": {"color": (0.55, 0.3, 0.7), **shine},
        },
        "scene": [
            item("floor", "floor", polygon((-80, 0, 80), (80, 0, 80), (80, 0, -80), (-80, 0, -80))),
            # A half sphere of radius 80: x² + y² + z² = 6400, kept where -y <= 1.
            item("sky", "sky", {"quadric": {"coefficients": [1, 1, 1, 0, 0, 0, 0, 0, 0, -6400], "planes": [[0, -1, 0, 1]]}}),
            *(item(f"sphere {k}", m, sphere(c, r)) for k, (m, c, r) in enumerate(balls, 1)),
            *(item(f"box {k}", m, box((-sx, 0, -sz), (sx, sy, sz)), at=move(("y", turn), place))
              for k, (m, (sx, sy, sz), turn, place) in enumerate(boxes, 1)),
            *(item(f"pyramid {k}", "teal", pyramid, at=move(size, ("y", turn), place))
              for k, (size, turn, place) in enumerate(pyramids, 1)),
        ],
    }


# ---- Image 3 ----------------------------------------------------------------------------------------------------


def leaf(rise, reach, width):
    """A curved blade of 21 x 14 polygons along x: 20 rows of quadrilaterals and one of triangles at the tip.

    Rows are one curve, moved along the spine and scaled, so edges of a quadrilateral are parallel and it is planar.
    """
    section = [(abs(u) ** 1.6 * 0.45 - 0.25 * u * u, u) for u in (k / 7 - 1 for k in range(15))]  # up and aside
    points = []
    for along in range(21):
        t = along / 21
        spine = (0.1 + reach * t, rise * (1.9 * t - 1.35 * t * t), 0)
        half = width * (0.06 + math.sin(math.pi * t ** 0.8) ** 0.9 * (1 - 0.25 * t))
        points += [add(spine, (0, half * up, half * aside)) for up, aside in section]
    points.append((0.1 + reach, rise * 0.55, 0))
    faces = [(15 * a + c, 15 * a + c + 1, 15 * a + c + 16, 15 * a + c + 15) for a in range(20) for c in range(14)]
    return mesh(points, faces + [(300 + c, 301 + c, 315) for c in range(14)], "phong")


def plant():
    w, h = 2.16, 3.4  # the corner stands close about the leaves: Image 3 has little empty space
    leaves = [item(f"leaf {k + 1}", "green", leaf(rise, reach, 0.82),
                   at=move(("y", 20 + 45 * k + 13 * (k % 2)), (0, 1.5 + 0.16 * (k % 2), 0)))
              for k, (rise, reach) in enumerate([(1.1, 1.9), (2.3, 1.7), (1.3, 1.9), (2.1, 1.6), (1.0, 1.9), (2.4, 1.6), (1.4, 1.9),
                                                 (2.1, 1.7)])]
    return {
        "comment": ["Image 3 of the thesis (section 4.3.2, Plate 4.2, Table 4.3): a plant in a corner, 12 objects of 2,708 polygons."],
        "view": view((1.35, 4.4, 5.3), (-0.05, 1.4, 0), 43, 256, 256),
        "background": (0.75, 0.78, 0.82),
        "lights": [{"position": (1.6, 6.5, 4.5)}],
        "materials": {
            "green": {"color": (0.2, 0.56, 0.2), "ambient": 0.25, "diffuse": 0.6, "specular": 0.25, "shininess": 30, "reflect": 0.12},
            "brown": {"color": (0.62, 0.34, 0.19), "ambient": 0.25, "diffuse": 0.65, "specular": 0.15, "shininess": 20},
            "black": {"color": (0.06, 0.05, 0.04)},
            "white": {"color": (0.93, 0.92, 0.9), "ambient": 0.3, "diffuse": 0.65},
        },
        "scene": [
            *leaves,
            item("pot", "brown", lathe(28, (0, 0.02), (0.66, 0.02), (0.74, 0.3), (0.82, 0.6), (0.89, 0.85), (1.0, 0.85), (1.03, 1.12),
                                       (0.92, 1.12), (0.9, 0.98),
                                       (0.88, 0.92), (0, 0.92))),
            item("dirt", "black", mesh([(0, 1.03, 0), *((x, 0.99, -z) for x, z in circle(0.9, 36))],
                                       [(0, 1 + k, 1 + (k + 1) % 36) for k in range(36)])),
            item("stem", "green", lathe(12, (0, 0.95), (0.13, 0.98), (0.09, 1.7), (0, 1.85))),
            item("corner", "white", quad((-w, 0, w), (2 * w, 0, 0), (0, 0, -2 * w)), quad((-w, 0, -w), (2 * w, 0, 0), (0, h, 0)),
                 quad((-w, 0, w), (0, 0, -2 * w), (0, h, 0)), quad((w, 0, w), (0, 0, -2 * w), (0, h, 0))),
        ],
    }
