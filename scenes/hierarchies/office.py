"""Weghorst, Hooper and Greenberg's Office (Figure 8, Table VII), a corner of a room. Lengths in metres."""
from placing import move, moved
from polyhedra import torus
from shapes import box, cluster, disc, frustum, item, lathe, mesh, of, polygon, prism, quad, sphere, view
from vectors import add, circle, rounded, times

X0, X1, Z0, Z1, H = -2.3, 2.3, -2.0, 3.0, 2.7
TOP = 0.75  # height of the desk


def bar(a, b, half):
    """A square prism between two points that share x, y or z with its axis in the plane of the others: six polygons."""
    along = add(b, times(-1, a))
    length = sum(c * c for c in along) ** 0.5
    u = times(half / length, (along[1], -along[0], 0.0)) if abs(along[2]) < 1e-9 else (half, 0.0, 0.0)
    v = (0.0, 0.0, half) if abs(along[2]) < 1e-9 else times(half / length, (0.0, along[2], -along[1]))
    corners = [add(p, add(times(s, u), times(t, v))) for p in (a, b) for s, t in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    return mesh(corners, [(3, 2, 1, 0), (4, 5, 6, 7), *((k, (k + 1) % 4, 4 + (k + 1) % 4, 4 + k) for k in range(4))])


def room():
    """Floor, ceiling, three walls and the left one about its window: 9 polygons."""
    z0, z1, low, high = -1.0, 1.0, 0.95, 2.15
    left = [quad((X0, 0, Z1), (0, 0, Z0 - Z1), (0, low, 0)), quad((X0, high, Z1), (0, 0, Z0 - Z1), (0, H - high, 0)),
            quad((X0, low, z0), (0, 0, Z0 - z0), (0, high - low, 0)), quad((X0, low, Z1), (0, 0, z1 - Z1), (0, high - low, 0))]
    shell = item("shell", "wall", of("floor", quad((X0, 0, Z1), (X1 - X0, 0, 0), (0, 0, Z0 - Z1))),
                 of("ceiling", quad((X0, H, Z0), (X1 - X0, 0, 0), (0, 0, Z1 - Z0))),
                 quad((X0, 0, Z0), (X1 - X0, 0, 0), (0, H, 0)), quad((X1, 0, Z0), (0, 0, Z1 - Z0), (0, H, 0)),
                 quad((X1, 0, Z1), (X0 - X1, 0, 0), (0, H, 0)), *left)
    frame = [box((X0 - 0.04, low, z), (X0 + 0.03, high, z + 0.06)) for z in (z0, -0.03, z1 - 0.06)] + \
            [box((X0 - 0.04, y, z0), (X0 + 0.03, y + 0.06, z1)) for y in (low, high - 0.06)] + \
            [box((X0 - 0.02, low - 0.04, z0 - 0.06), (X0 + 0.16, low, z1 + 0.06))]
    picture = [box((0.02, 1.45, Z0), (0.78, 1.49, Z0 + 0.03)), box((0.02, 1.99, Z0), (0.78, 2.03, Z0 + 0.03)),
               box((0.02, 1.45, Z0), (0.06, 2.03, Z0 + 0.03)), box((0.74, 1.45, Z0), (0.78, 2.03, Z0 + 0.03))]
    ridges = {"sky": [(0.74, 1.99), (0.06, 1.99)],
              "far hills": [(0.74, 1.7), (0.6, 1.78), (0.48, 1.7), (0.33, 1.84), (0.18, 1.72), (0.06, 1.76)],
              "hills": [(0.74, 1.58), (0.5, 1.64), (0.25, 1.56), (0.06, 1.66)]}
    hills = [of(name, polygon(*((x, y, Z0 + 0.01 + 0.002 * k) for x, y in [(0.06, 1.49), (0.74, 1.49), *ridge])))
             for k, (name, ridge) in enumerate(ridges.items())]
    lamps = [item(f"globe lamp {k + 1}", "lamp", sphere((x, 2.48, -0.2), 0.12)) for k, x in enumerate((-0.9, 0.9))]
    return cluster("room", shell, item("window", "white", *frame), item("landscape", "sky", quad((-9, -2, 9), (0, 0, -20), (0, 9, 0))),
                   item("rug", "rug", prism(rounded(2.7, 1.9, 0.3, 9), 0.0, 0.012), at=move((-0.15, 0, 0.15))),
                   item("frame", "dark wood", *picture),
                   item("picture", None, *hills), *lamps)


def desk():
    x0, x1, z0, z1 = -1.15, 0.75, -1.75, -0.9
    drawers = [cluster(f"drawer {k + 1}", item(f"front {k + 1}", "wood", box((x1 - 0.48, low, z1 - 0.03), (x1 - 0.06, low + 0.19, z1))),
                       item(f"knob {k + 1}", "brass", sphere((x1 - 0.27, low + 0.095, z1 + 0.02), 0.024)))
               for k, low in enumerate((0.08, 0.29, 0.5))]
    case = cluster("desk", item("desk top", "wood", prism(rounded(x1 - x0, z1 - z0, 0.06, 5), TOP - 0.035, TOP),
                                at=move(((x0 + x1) / 2, 0, (z0 + z1) / 2))),
                   item("pedestal", "wood", box((x1 - 0.5, 0.04, z0 + 0.05), (x1 - 0.04, TOP - 0.035, z1 - 0.03))), *drawers,
                   item("leg", "wood", box((x0 + 0.04, 0, z0 + 0.05), (x0 + 0.08, TOP - 0.035, z1 - 0.05))),
                   item("back panel", "wood", box((x0 + 0.08, 0.3, z0 + 0.08), (x1 - 0.5, TOP - 0.035, z0 + 0.1))))
    keys = [box((-0.225 + 0.036 * i + 0.005 * j, 0.028, -0.07 + 0.04 * j),
                (-0.196 + 0.036 * i + 0.005 * j, 0.042, -0.038 + 0.04 * j)) for j in range(4) for i in range(12)]
    computer = cluster(
        "computer", item("monitor", "putty", prism([(-0.2, 0.17), (0.2, 0.17), (0.2, 0.0), (0.13, -0.2), (-0.13, -0.2), (-0.2, 0.0)],
                                                   0.07, 0.42)),
        item("screen", "screen", prism([(-0.16, 0.171), (0.16, 0.171), (0.1, 0.185), (-0.1, 0.185)], 0.12, 0.37)),
        item("stand", "putty", disc(32, 0.13, 0.0, 0.07)),
        item("keyboard", "putty", box((-0.24, 0, -0.09), (0.24, 0.028, 0.1)), at=move((0, 0, 0.36))),
        item("keys", "keys", *keys, at=move((0, 0, 0.36))), at=move(("y", 12), (-0.4, TOP, -1.42)))
    lamp = cluster(
        "desk lamp", item("lamp foot", "red", lathe(36, (0, 0), (0.1, 0), (0.1, 0.018), (0.02, 0.035), (0, 0.036))),
        item("lower arm", "red", bar((0, 0.03, 0), (0.13, 0.32, 0), 0.009)),
        item("upper arm", "red", bar((0.13, 0.32, 0), (-0.13, 0.5, 0), 0.009)),
        item("joint", "brass", disc(12, 0.02, -0.02, 0.02), at=move(("x", 90), (0.13, 0.32, 0))),
        item("lamp shade", "red", lathe(36, (0.035, 0.1), (0.045, 0.1), (0.11, 0.0), (0.103, 0.0), (0.035, 0.1)),
             at=move(("z", -20), (-0.16, 0.42, 0))),
        item("bulb", "lamp", sphere((-0.145, 0.455, 0), 0.03)), at=move(("y", 30), (0.52, TOP, -1.5)))
    dial = lathe(28, (0, 0.0), (0.045, 0.0), (0.045, 0.012), (0, 0.016))
    phone = cluster("telephone", item("telephone case", "black", frustum((-0.1, 0.1, -0.09, 0.09), 0, (-0.06, 0.06, -0.06, 0.0), 0.08)),
                    item("dial", "white", dial, at=move(("x", 41.6), (0, 0.04, 0.05))),
                    item("handset", "black", box((-0.08, 0.09, -0.05), (0.08, 0.115, -0.015)),
                         *(prism(circle(0.034, 32, (x, -0.03)), 0.075, 0.12) for x in (-0.095, 0.095))),
                    at=move(("y", -25), (0.42, TOP, -1.12)))
    mug = lathe(28, (0, 0), (0.038, 0), (0.042, 0.01), (0.042, 0.1), (0.036, 0.1), (0.036, 0.015), (0, 0.015))
    stationery = cluster("stationery", item("mug", "blue", mug, at=move((0.05, TOP, -1.08))),
                         item("book", "green", box((-0.12, 0, -0.09), (0.12, 0.035, 0.09)), at=move(("y", 20), (-0.9, TOP, -1.15))),
                         item("cup", "brass", lathe(24, (0, 0), (0.035, 0), (0.042, 0.1), (0.036, 0.1), (0, 0.01)),
                              at=move((-0.95, TOP, -1.55))),
                         item("blotter", "dark green", box((-0.3, 0, -0.2), (0.3, 0.004, 0.2)),
                              at=move(("y", 4), (-0.38, TOP, -1.13))),
                         item("paperweight", "crystal", sphere((-0.9, TOP + 0.075, -1.13), 0.04)))
    return cluster("working place", case, computer, lamp, phone, stationery)


def chair():
    arm = prism([(0.03, -0.03), (0.3, -0.018), (0.3, 0.018), (0.03, 0.03)], 0.06, 0.09)
    arms = [moved(arm, move(("y", 72 * k))) for k in range(5)]
    casters = [item(f"caster {k + 1}", "black", disc(16, 0.03, -0.015, 0.015),
                    at=move(("x", 90), (0.28, 0.03, 0), ("y", 72 * k))) for k in range(5)]
    return cluster("chair", item("seat", "fabric", prism(rounded(0.5, 0.48, 0.12, 8), 0.43, 0.5)),
                   item("back", "fabric", prism(rounded(0.44, 0.4, 0.1, 8), -0.03, 0.03),
                        at=move(("x", 90), ("x", -8), (0, 0.84, 0.25))),
                   item("spine", "steel", bar((0, 0.42, 0.2), (0, 0.86, 0.3), 0.02)),
                   item("post", "steel", disc(20, 0.03, 0.08, 0.43)),
                   cluster("wheels", item("star", "steel", *arms), *casters), at=move(("y", -152), (-0.1, 0.012, -0.25)))


def shelves():
    x0, x1, z0, z1, top = 1.15, 2.15, Z0 + 0.02, Z0 + 0.34, 1.9
    boards = [box((x0, 0, z0), (x0 + 0.03, top, z1)), box((x1 - 0.03, 0, z0), (x1, top, z1))] + \
             [box((x0 + 0.03, y, z0), (x1 - 0.03, y + 0.025, z1)) for y in (0.06, 0.5, 0.95, 1.4, top - 0.025)]
    books, x = [], x0 + 0.06
    for k, (shelf, wide, high, colour) in enumerate([(0.975, 0.05, 0.3, "red"), (0.975, 0.07, 0.34, "green"),
                                                     (0.975, 0.045, 0.27, "ochre"), (0.975, 0.06, 0.32, "blue"),
                                                     (1.425, 0.08, 0.33, "ochre"), (1.425, 0.06, 0.28, "dark green"),
                                                     (1.425, 0.05, 0.35, "red"), (0.525, 0.34, 0.3, "putty")]):
        if k in (4, 7):
            x = x0 + (0.42 if k == 4 else 0.2)
        books.append(item(f"book {k + 1}", colour, box((x, shelf, z0 + 0.04), (x + wide, shelf + high, z1 - 0.04 - 0.01 * (k % 3)))))
        x += wide + 0.006
    return cluster("shelves", item("case", "dark wood", *boards), cluster("books", *books))


def cabinet():
    x0, x1, z0, z1 = X0 + 0.05, X0 + 0.6, Z0 + 0.05, Z0 + 0.55
    drawers = [item(f"file drawer {k + 1}", "steel", box((x0 + 0.03, 0.06 + 0.55 * k, z1), (x1 - 0.03, 0.58 + 0.55 * k, z1 + 0.015)),
                    box((x0 + 0.2, 0.42 + 0.55 * k, z1 + 0.015), (x1 - 0.2, 0.45 + 0.55 * k, z1 + 0.04))) for k in range(2)]
    globe = cluster("globe", item("globe foot", "dark wood",
                                  lathe(32, (0, 0), (0.1, 0), (0.1, 0.02), (0.03, 0.05), (0.015, 0.1), (0, 0.1))),
                    item("meridian", "brass", mesh(*torus(32, 5, 0.04)), at=move(0.2, ("x", 90), ("y", 20), (0, 0.29, 0))),
                    item("earth", "earth", sphere((0, 0.29, 0), 0.17)), at=move(((x0 + x1) / 2, 1.16, (z0 + z1) / 2)))
    return cluster("cabinet", item("cabinet case", "steel", box((x0, 0, z0), (x1, 1.16, z1))), *drawers, globe)


def office():
    basket = item("basket", "steel", lathe(36, (0, 0), (0.11, 0), (0.15, 0.32), (0.14, 0.32), (0.1, 0.01), (0, 0.01)),
                  at=move((1.0, 0, -1.2)))
    gloss = {"ambient": 0.28, "diffuse": 0.55, "specular": 0.2, "shininess": 40, "reflect": 0.06}
    colours = {"red": (0.65, 0.08, 0.06), "green": (0.12, 0.35, 0.15), "ochre": (0.75, 0.5, 0.12), "blue": (0.1, 0.2, 0.55),
               "dark green": (0.04, 0.18, 0.11), "putty": (0.72, 0.67, 0.56),
               "black": (0.04, 0.04, 0.045), "white": (0.88, 0.87, 0.84), "keys": (0.3, 0.28, 0.26)}
    matt = {"ambient": 0.3, "diffuse": 0.6}
    return {
        "comment": ["Office of Weghorst, Hooper and Greenberg 1984 (Figure 8, Table VII):",
                    "63 items of 2,101 polygons and 8 spheres, five lights."],
        "view": view((1.6, 1.7, 2.75), (-0.05, 1.08, -1.0), 55),
        "lights": [*({"position": (x, 2.3, -0.2), "color": (1, 0.93, 0.8), "intensity": 0.34} for x in (-0.9, 0.9)),
                   {"position": (0.4, 1.13, -1.42), "color": (1, 0.85, 0.6), "intensity": 0.3},
                   {"position": (-8.5, 5.5, 2.5), "color": (1, 0.97, 0.9), "intensity": 0.55},
                   {"position": (1.9, 2.2, 2.7), "color": (0.85, 0.92, 1), "intensity": 0.2}],
        "textures": {"boards": {"kind": "boards", "first": (0.5, 0.31, 0.16), "second": (0.38, 0.21, 0.1), "scale": 0.11, "aspect": 8,
                                "gap": 0.02},
                     "continents": {"kind": "noise", "seed": 5, "first": (0.06, 0.2, 0.5), "second": (0.75, 0.65, 0.35), "scale": 0.16,
                                    "octaves": 4, "strength": 1}},
        "materials": {
            "wall": {"color": (0.78, 0.74, 0.64), **matt}, "ceiling": {"color": (0.86, 0.85, 0.82), "ambient": 0.55, "diffuse": 0.4},
            "floor": {"color": 1, "texture": "boards", **matt, "reflect": 0.08},
            "sky": {"color": (0.55, 0.72, 0.95), "ambient": 0.98, "diffuse": 0.02}, "far hills": {"color": (0.3, 0.4, 0.5)},
            "hills": {"color": (0.25, 0.42, 0.15)},
            "rug": {"color": (0.45, 0.1, 0.09), **matt}, "dark wood": {"color": (0.26, 0.13, 0.07), **gloss},
            "wood": {"color": (0.56, 0.33, 0.16), **gloss},
            "brass": {"color": (0.85, 0.62, 0.25), "ambient": 0.2, "diffuse": 0.35, "specular": 0.5, "shininess": 60, "reflect": 0.35},
            "steel": {"color": (0.5, 0.54, 0.58), "ambient": 0.25, "diffuse": 0.5, "specular": 0.3, "shininess": 40, "reflect": 0.15},
            "screen": {"color": (0.05, 0.2, 0.12), "ambient": 0.5, "diffuse": 0.3, "specular": 0.5, "shininess": 100, "reflect": 0.2},
            "lamp": {"color": (1, 0.96, 0.85), "ambient": 0.98, "diffuse": 0.02}, "fabric": {"color": (0.1, 0.22, 0.42), **matt},
            "crystal": {"color": (0.92, 0.97, 1), "ambient": 0.02, "diffuse": 0.05, "specular": 0.5, "shininess": 120, "reflect": 0.1,
                        "transmit": 0.8, "index": 1.5},
            "earth": {"color": 1, "texture": "continents", "ambient": 0.25, "diffuse": 0.6, "specular": 0.2, "shininess": 40},
            **{name: {"color": colour, **gloss} for name, colour in colours.items()},
        },
        "scene": [room(), desk(), chair(), shelves(), cabinet(), basket],
    }
