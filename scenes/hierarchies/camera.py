"""Weghorst, Hooper and Greenberg's Camera (Figure 7, Table VI). Lengths in centimetres; the lens looks along z."""
import math

from placing import move
from polyhedra import torus
from shapes import box, cluster, disc, frustum, item, lathe, mesh, prism, quad, sphere, view
from vectors import on_circle, rounded

AXIS = 4.3  # height of the lens's axis


def on_axis(z):
    """Of what is turned about y: on the lens's axis, its y = 0 at z."""
    return move(("x", 90), (0, AXIS, z))


def tube(sides, inner, outer, low, high):
    """A ring of 4 x sides polygons."""
    return lathe(sides, (outer, low), (outer, high), (inner, high), (inner, low), (outer, low))


def strap(quads):
    """A leather band that stands on its edge in a loop: planar, as its rulings are upright."""
    def at(t):
        a = math.radians(150 + 330 * t)
        r = 3.6 + 1.6 * math.cos(2 * a + 0.6) + 0.4 * math.sin(5 * a)
        return -9.6 + 1.25 * r * math.cos(a), 4.6 + 0.8 * r * math.sin(a)
    path = [at(k / quads) for k in range(quads + 1)]
    points = [(x, y, z) for y in (0.02, 1.1) for x, z in path]
    return mesh(points, [(k, k + 1, quads + k + 2, quads + k + 1) for k in range(quads)], "phong")


def leader(quads):
    """The film that comes out of its canister: it lies down in a curve."""
    points = []
    for k in range(quads + 1):
        t = k / quads
        points += [(1.15 + 4.6 * t, 3.3 - 0.5 * t * t + y, 0.9 + 0.75 * math.sin(3.0 * t)) for y in (-2.6, 0.0)]
    return mesh(points, [(2 * k, 2 * k + 2, 2 * k + 3, 2 * k + 1) for k in range(quads)], "phong")


def camera():
    knurled = [on_circle(3.2 if k % 2 else 3.05, 5 * k) for k in range(72)]
    body = cluster(
        "body",
        item("case", "leather", prism(rounded(14, 3.6, 1.5, 5), 1.0, 6.2)),
        item("bottom plate", "chrome", prism(rounded(14.2, 3.8, 1.6, 5), 0.05, 1.0)),
        item("top plate", "chrome", prism(rounded(14.2, 3.8, 1.6, 5), 6.2, 7.5)),
        item("strap ring left", "chrome", mesh(*torus(12, 6, 0.2)), at=move(0.55, ("z", 90), ("y", 90), (-7.4, 6.5, 0))),
        item("strap ring right", "chrome", mesh(*torus(12, 6, 0.2)), at=move(0.55, ("z", 90), ("y", 90), (7.4, 6.5, 0))),
        item("self-timer axle", "chrome", disc(16, 0.55, 0, 0.4), at=move(("x", 90), (-5.0, 4.6, 1.8))),
        item("self-timer lever", "black", prism([(-0.3, -0.3), (0.3, -0.3), (0.22, 2.0), (0.12, 2.2), (-0.12, 2.2), (-0.22, 2.0)], 0.4,
                                                0.6),
             at=move(("x", 90), (-5.0, 4.6, 1.8))),
        item("flash socket", "chrome", disc(12, 0.32, 0, 0.3), at=move(("x", 90), (5.4, 5.3, 1.8))),
        item("lens release", "chrome", disc(12, 0.35, 0, 0.5), at=move(("x", 90), (3.6, 3.0, 1.8))))
    finder = cluster(
        "finder",
        item("prism housing", "chrome", frustum((-2.5, 2.5, -1.9, 1.9), 7.5, (-1.3, 1.3, -1.9, 1.2), 9.1)),
        item("nameplate", "black", box((-1.5, 7.62, 1.75), (1.5, 8.1, 1.95))),
        item("shoe", "black", box((-0.8, 9.1, -1.5), (0.8, 9.3, 0.3))),
        item("eyepiece", "black", box((-1, 7.6, -2.3), (1, 8.8, -1.85))))
    controls = cluster(
        "controls",
        item("rewind knob", "chrome", lathe(24, (0, 0.95), (0.8, 0.95), (0.95, 0.8), (0.95, 0.1), (0.5, 0)), at=move((-5.2, 7.5, 0))),
        item("rewind crank", "black", box((-5.3, 8.45, -0.7), (-5.1, 8.6, 0.7))),
        item("speed dial", "chrome", prism([on_circle(1.0 if k % 2 else 0.94, 9 * k) for k in range(40)], 0, 0.6),
             at=move((3.5, 7.5, 0.1))),
        item("shutter release", "chrome", disc(16, 0.3, 0, 0.45), at=move((5.1, 7.5, 1.0))),
        item("advance axle", "chrome", disc(20, 0.75, 0, 0.35), at=move((5.6, 7.5, -0.5))),
        item("advance lever", "black", prism([(4.9, -0.6), (5.3, -1.1), (7.0, -1.0), (7.9, -0.2), (7.9, 0.15), (7.5, 0.2), (6.8, -0.3),
                                              (5.6, 0.1)], 7.85, 8.05)),
        item("counter", "black", disc(16, 0.35, 0, 0.05), at=move((6.35, 7.5, 0.8))))
    lens = cluster(
        "lens",
        item("mount", "chrome", tube(24, 2.0, 3.3, 0, 0.5), at=on_axis(1.8)),
        item("aperture ring", "black", tube(24, 2.0, 3.0, 0, 0.8), at=on_axis(2.3)),
        item("scale ring", "chrome", tube(24, 2.0, 3.1, 0, 0.35), at=on_axis(3.1)),
        item("focus ring", "rubber", prism(knurled, 0, 1.5), at=on_axis(3.45)),
        item("barrel", "black", tube(28, 2.45, 3.0, 0, 1.1), at=on_axis(4.95)),
        item("bezel", "chrome", tube(28, 2.3, 2.75, 0, 0.2), at=on_axis(5.95)),
        item("glass", "coated", sphere((0, AXIS, 3.35), 2.55)))
    film = cluster(
        "film",
        item("canister", "yellow", disc(24, 1.25, 0.35, 3.75), at=move((0, 0, 0))),
        item("canister foot", "black", disc(24, 1.32, 0.0, 0.4)),
        item("canister cap", "black", disc(24, 1.32, 3.7, 4.05)), item("spool", "black", disc(12, 0.45, 4.05, 4.7)),
        item("lip", "yellow", box((0.6, 0.5, 0.7), (1.6, 3.6, 0.95))), item("leader", "celluloid", leader(8)),
        item("box", "yellow", box((-1.6, 0, -5.6), (1.6, 5.2, -2.4))), at=move(("y", -28), (9.3, 0, 4.6)))
    cap = cluster(
        "cap",
        item("lens cap", "black", lathe(28, (0, 0.55), (2.3, 0.55), (2.5, 0.75), (2.9, 0.75), (3.0, 0.6), (3.0, 0.0))),
        item("cap clip left", "chrome", box((-2.2, 0.56, -0.6), (-1.6, 0.8, 0.6))),
        item("cap clip right", "chrome", box((1.6, 0.56, -0.6), (2.2, 0.8, 0.6))),
        at=move(("y", 35), (1.2, 0, 10.2)))
    leather = {"color": (0.05, 0.045, 0.045), "ambient": 0.3, "diffuse": 0.6, "specular": 0.12, "shininess": 12}
    black = {"color": (0.05, 0.05, 0.055), "ambient": 0.3, "diffuse": 0.55, "specular": 0.35, "shininess": 40, "reflect": 0.1}
    return {
        "comment": ["Camera of Weghorst, Hooper and Greenberg 1984 (Figure 7, Table VI):",
                    "39 items of 1,392 polygons and a sphere, one light."],
        "view": view((-9.0, 13.5, 28), (0.9, 3.4, 2.2), 43),
        "background": (0.62, 0.66, 0.72),
        "lights": [{"position": (-16, 34, 26)}],
        "materials": {
            "table": {"color": (0.62, 0.2, 0.13), "ambient": 0.28, "diffuse": 0.55, "specular": 0.1, "shininess": 30, "reflect": 0.12},
            "leather": leather, "black": black, "rubber": {**leather, "specular": 0.2},
            "chrome": {"color": (0.86, 0.87, 0.9), "ambient": 0.15, "diffuse": 0.4, "specular": 0.45, "shininess": 60,
                       "reflect": 0.42},
            "coated": {"color": (0.1, 0.08, 0.28), "ambient": 0.1, "diffuse": 0.3, "specular": 0.7, "shininess": 150, "reflect": 0.3},
            "yellow": {"color": (0.92, 0.66, 0.08), "ambient": 0.25, "diffuse": 0.6, "specular": 0.3, "shininess": 40,
                       "reflect": 0.05},
            "celluloid": {"color": (0.25, 0.2, 0.22), "ambient": 0.3, "diffuse": 0.5, "specular": 0.4, "shininess": 50,
                          "reflect": 0.15},
            "strap": {"color": (0.4, 0.2, 0.1), "ambient": 0.3, "diffuse": 0.6, "specular": 0.1, "shininess": 15},
        },
        "scene": [item("table", "table", quad((-150, 0, 60), (300, 0, 0), (0, 0, -210))),
                  cluster("camera", body, finder, controls, lens), film, cap,
                  item("strap", "strap", strap(39))],
    }
