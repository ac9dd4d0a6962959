"""Weghorst, Hooper and Greenberg's Pool Room (Figure 9, Table VIII). Lengths in metres; the table's play field is 2.24 x 1.12."""
from placing import move
from shapes import box, cluster, cylinder, item, lathe, of, polygon, prism, quad, sphere, view
from vectors import circle

CLOTH = 0.80  # height of the cloth
LONG, SHORT = 1.12, 0.56  # halves of the play field
BALL = 0.0286


def rails(inner, outer, low, high, gap):
    """Six prisms with mitred ends about the play field, between the pockets: 36 polygons."""
    pieces = []
    for side in (1, -1):
        for end in (1, -1):  # half of a long side
            pieces.append(prism([(end * gap, side * (SHORT + inner)), (end * (LONG - gap), side * (SHORT + inner)),
                                 (end * (LONG - gap + outer - inner), side * (SHORT + outer)),
                                 (end * gap * 0.9, side * (SHORT + outer))], low, high))
        pieces.append(prism([(side * (LONG + inner), -SHORT + gap), (side * (LONG + inner), SHORT - gap),
                             (side * (LONG + outer), SHORT - gap + outer - inner),
                             (side * (LONG + outer), -SHORT + gap - outer + inner)], low, high))
    return pieces


def pockets():
    """Six holes, black polygons of twelve corners."""
    centers = [(x, z) for x in (-LONG - 0.01, LONG + 0.01) for z in (-SHORT - 0.01, SHORT + 0.01)] + [(0, -SHORT - 0.035),
                                                                                                      (0, SHORT + 0.035)]
    return [of("black", polygon(*((cx + x, CLOTH + 0.001, cz - z) for x, z in circle(0.062, 12)))) for cx, cz in centers]


def room():
    """Floor, four walls and ceiling, 12 panels of 6 on the walls, and 2 pictures: 80 polygons."""
    x0, x1, z0, z1, h = -3.0, 3.0, -2.6, 3.4, 2.7
    shell = [of("boards", quad((x0, 0, z1), (x1 - x0, 0, 0), (0, 0, z0 - z1))),
             of("ceiling", quad((x0, h, z0), (x1 - x0, 0, 0), (0, 0, z1 - z0))),
             quad((x0, 0, z0), (x1 - x0, 0, 0), (0, h, 0)), quad((x0, 0, z1), (0, 0, z0 - z1), (0, h, 0)),
             quad((x1, 0, z0), (0, 0, z1 - z0), (0, h, 0)),
             quad((x1, 0, z1), (x0 - x1, 0, 0), (0, h, 0))]
    back = [of("panel", box((x0 + 0.08 + 0.985 * k, 0.08, z0), (x0 + 0.98 + 0.985 * k, 0.95, z0 + 0.03))) for k in range(6)]
    sides = [of("panel", box((x if x < 0 else x - 0.03, 0.08, z0 + 0.1 + 1.3 * k),
                             (x + 0.03 if x < 0 else x, 0.95, z0 + 1.3 + 1.3 * k)))
             for x in (x0, x1) for k in range(3)]
    pictures = [of("sea", quad((-0.2, 1.35, z0 + 0.01), (0.9, 0, 0), (0, 0.65, 0))),
                of("dusk", quad((0.95, 1.45, z0 + 0.01), (0.45, 0, 0), (0, 0.5, 0)))]
    return [*shell, *back, *sides, *pictures]


def shade():
    """A thin shell of 6 x 24 polygons about the rod."""
    return lathe(24, (0.05, 0.27), (0.09, 0.25), (0.28, 0.0), (0.27, 0.0), (0.085, 0.235), (0.045, 0.25), (0.05, 0.27))


def pool_room():
    places = [("cue ball", "ivory", (-0.52, 0.07)), ("ball 1", "yellow", (0.32, 0.03)), ("ball 2", "blue", (0.47, -0.16)),
              ("ball 3", "red", (0.55, 0.2)),
              ("ball 4", "violet", (0.7, 0.0)), ("ball 5", "orange", (0.62, -0.33)), ("ball 6", "green", (-0.1, 0.3)),
              ("ball 7", "maroon", (0.2, -0.3)),
              ("ball 8", "black ball", (0.05, -0.06)), ("ball 9", "yellow", (-0.75, -0.3)), ("ball 10", "blue", (0.85, 0.34)),
              ("ball 11", "red", (-0.33, -0.21)),
              ("ball 12", "violet", (-0.86, 0.33))]
    balls = cluster("balls", *(item(name, material, sphere((x, CLOTH + BALL, z), BALL)) for name, material, (x, z) in places))
    skirt = [box((-LONG - 0.12, 0.56, z - 0.02), (LONG + 0.12, 0.795, z + 0.02)) for z in (-SHORT - 0.1, SHORT + 0.1)] + \
            [box((x - 0.02, 0.56, -SHORT - 0.08), (x + 0.02, 0.795, SHORT + 0.08)) for x in (-LONG - 0.1, LONG + 0.1)]
    table = cluster(
        "table",
        item("bed", "cloth", quad((-LONG - 0.12, CLOTH, SHORT + 0.12), (2 * LONG + 0.24, 0, 0), (0, 0, -2 * SHORT - 0.24)), *pockets()),
        item("cushions", "cloth", *rails(0.0, 0.05, CLOTH + 0.002, CLOTH + 0.036, 0.065)),
        item("frame", "walnut", *rails(0.05, 0.17, CLOTH + 0.0, CLOTH + 0.042, 0.07), *skirt),
        cluster("legs", *(item(f"leg {k + 1}", "walnut", cylinder((x, 0, z), (x, 0.6, z), 0.075))
                          for k, (x, z) in enumerate((sx * 0.98, sz * 0.46) for sx in (-1, 1) for sz in (-1, 1)))),
        balls)
    lamps = []
    for k, x in enumerate((-0.75, 0.0, 0.75)):
        lamps.append(cluster(f"lamp {k + 1}", item(f"rod {k + 1}", "brass", cylinder((x, 1.92, 0), (x, 2.7, 0), 0.012)),
                             item(f"shade {k + 1}", "shade", shade(), at=move((x, 1.66, 0)))))
    lights = cluster("lamps", item("bar", "brass", cylinder((-1.0, 2.12, 0), (1.0, 2.12, 0), 0.016)), *lamps)
    board = [box((-0.5, 1.75, -2.58), (0.5, 1.85, -2.54)), box((-0.5, 0.98, -2.58), (0.5, 1.04, -2.48))]
    pegs = [box((-0.42 + 0.12 * k - 0.012, 1.76, -2.54), (-0.42 + 0.12 * k + 0.012, 1.79, -2.49)) for k in range(8)]
    cues = [item(f"cue {k + 1}", "ash", cylinder((x, 1.02, -2.51), (x, 2.4, -2.51), 0.014)) for k, x in enumerate((-1.5, -1.3, -1.1, -0.9))]
    rack = cluster("cue rack", item("rack", "walnut", *board, *pegs, at=move((-1.2, 0, 0))), *cues)
    seat = lathe(20, (0, 0.7), (0.19, 0.71), (0.2, 0.76), (0.15, 0.79), (0, 0.795))
    stools = [cluster(f"stool {k + 1}", item(f"seat {k + 1}", "leather", seat, at=move((x, 0, z))),
                      item(f"post {k + 1}", "brass", cylinder((x, 0, z), (x, 0.71, z), 0.035)))
              for k, (x, z) in enumerate([(1.75, -1.7), (2.35, -1.2)])]
    rest = item("cue 5", "ash", cylinder((-0.62, CLOTH + 0.05, 0.14), (-1.72, CLOTH + 0.16, 0.86), 0.013))
    shine = {"ambient": 0.2, "diffuse": 0.5, "specular": 0.45, "shininess": 90, "reflect": 0.15}
    gloss = {"ambient": 0.25, "diffuse": 0.55, "specular": 0.15, "shininess": 30, "reflect": 0.08}
    ball_colours = {"ivory": (0.93, 0.9, 0.8), "yellow": (0.9, 0.68, 0.05), "blue": (0.05, 0.12, 0.6), "red": (0.75, 0.05, 0.04),
                    "violet": (0.25, 0.06, 0.4),
                    "orange": (0.9, 0.32, 0.03), "green": (0.02, 0.32, 0.12), "maroon": (0.35, 0.03, 0.05),
                    "black ball": (0.02, 0.02, 0.02)}
    return {
        "comment": ["Pool Room of Weghorst, Hooper and Greenberg 1984 (Figure 9, Table VIII):",
                    "38 items of 835 polygons, 13 spheres and 15 cylinders, five lights."],
        "view": view((-1.75, 1.78, 2.9), (0.08, 0.98, -0.3), 53),
        "lights": [*({"position": (x, 1.72, 0), "color": (1, 0.9, 0.7), "intensity": 0.36} for x in (-0.75, 0.0, 0.75)),
                   {"position": (-2.6, 2.5, 3.0), "color": (0.8, 0.88, 1), "intensity": 0.3},
                   {"position": (2.6, 2.5, 2.4), "color": (1, 0.9, 0.8), "intensity": 0.25}],
        "textures": {"floor": {"kind": "boards", "first": (0.32, 0.18, 0.09), "second": (0.2, 0.1, 0.05), "scale": 0.12, "aspect": 9,
                               "gap": 0.02}},
        "materials": {
            "wall": {"color": (0.62, 0.55, 0.42), "ambient": 0.3, "diffuse": 0.6},
            "ceiling": {"color": (0.75, 0.72, 0.66), "ambient": 0.3, "diffuse": 0.5},
            "boards": {"color": 1.0, "texture": "floor", "ambient": 0.25, "diffuse": 0.65, "reflect": 0.07},
            "panel": {"color": (0.26, 0.13, 0.07), **gloss}, "sea": {"color": (0.15, 0.36, 0.5)}, "dusk": {"color": (0.6, 0.3, 0.2)},
            "cloth": {"color": (0.03, 0.34, 0.2), "ambient": 0.25, "diffuse": 0.7}, "black": {"color": 0.01},
            "walnut": {"color": (0.27, 0.12, 0.06), **gloss}, "ash": {"color": (0.75, 0.52, 0.28), **gloss},
            "brass": {"color": (0.85, 0.62, 0.25), "ambient": 0.2, "diffuse": 0.35, "specular": 0.5, "shininess": 60, "reflect": 0.35},
            "shade": {"color": (0.1, 0.4, 0.26), "ambient": 0.4, "diffuse": 0.45, "specular": 0.3, "shininess": 40, "reflect": 0.12},
            "leather": {"color": (0.42, 0.06, 0.05), **gloss},
            **{name: {"color": color, **shine} for name, color in ball_colours.items()},
        },
        "scene": [item("room", "wall", *room()), table, lights, rack, *stools, rest],
    }
