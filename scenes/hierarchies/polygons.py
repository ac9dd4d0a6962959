"""Weghorst, Hooper and Greenberg's Polygons (Figure 6, Table V): polyhedra about three balls."""
import polyhedra as p
from placing import move
from shapes import cluster, hue, item, lathe, mesh, sphere, view
from vectors import on_circle


def polygons():
    ico, octa = p.icosahedron(), p.octahedron()
    dodeca = p.dual(ico)
    thirty_two, sixty_two = p.ambo(dodeca), p.ambo(p.ambo(dodeca))
    top = [(0.03 + 0.42 * f, y) for f, y in ((0.1, -0.75), (1, -0.1), (0.9, 0.1), (0.55, 0.18), (0.3, 0.3), (0.3, 0.5),
                                             (0.12, 0.56), (0.12, 0.75), (0.2, 0.8), (0.1, 0.86))]
    solids = [
        ("star of eight", p.kis(octa, 2.0)), ("star of twelve", p.kis(dodeca, 1.95)), ("football", p.truncate(ico)),
        ("thirty rhombs", p.dual(thirty_two)), ("hundred and twenty", p.kis(p.dual(thirty_two), 1.12)),
        ("ring", p.torus(24, 10, 0.26)), ("sixty-two", sixty_two), ("sixty kites", p.dual(sixty_two)), ("geodesic", p.geodesic(ico)),
        ("knot", p.trefoil(40, 6, 0.15)), ("six squares", p.ambo(octa)), ("six octagons", p.truncate(octa, 0.3)),
        ("burr", p.kis(sixty_two, 1.5)), ("thirty-two", thirty_two), ("spiked ball", p.kis(thirty_two, 1.45)),
        ("star of twenty", p.kis(ico, 1.9)),
        ("stud", p.kis(p.truncate(ico), 1.3)), ("top", None)]
    tints = [hue(k / 18, 0.65, 0.95) for k in range(18)]
    gloss = {"ambient": 0.2, "diffuse": 0.5, "specular": 0.3, "shininess": 40, "reflect": 0.2}
    materials = {"mirror": {"color": 0.95, "ambient": 0.1, "diffuse": 0.22, "specular": 0.4, "shininess": 90, "reflect": 0.6}}
    rings = []
    for ring, (center, tilt, turn) in enumerate([((-3.1, 0.2, 0.6), 62, 15), ((0.1, 1.0, -2.6), 78, -8), ((3.1, -0.3, 0.7), 58, -25)]):
        elements = [item(f"ball {ring + 1}", "mirror", sphere((0, 0, 0), 1.0))]
        for k in range(6):
            number = 6 * ring + k
            name, solid = solids[(number * 7) % 18]
            materials[name] = {"color": tints[number], **gloss}
            place = (*on_circle(2.1, 60 * k + 20 * ring), 0)
            shape = lathe(12, (0, -0.78), *top, (0, 0.88)) if solid is None else mesh(*p.scaled(solid, 0.72))
            elements.append(item(name, name, shape, at=move(("x", 31 * number + 10), ("y", 47 * number), place)))
        rings.append(cluster(f"ring {ring + 1}", *elements, at=move(("x", tilt - 90), ("y", turn), center)))
    return {
        "comment": ["Polygons of Weghorst, Hooper and Greenberg 1984 (Figure 6, Table V):",
                    "21 items of 1,980 polygons and 3 spheres, three lights.",
                    "Views A, B, C and D are frames 1, 2, 3 and 4. The background is not modelled: rays that leave get its colour."],
        "view": view({1: (0, 1.6, 12.5), 2: (-1.0, 1.7, 6.6), 3: (22, 18, 44), 4: (4, 15.5, 5)},
                     {1: (0, 0.1, 0), 2: (-0.9, 0.2, 0), 3: (-8, 5, 0), 4: (0, 0, -0.5)}, {1: 53, 2: 50, 3: 50, 4: 55}),
        "background": (0.035, 0.05, 0.11),
        "lights": [{"position": (-12, 14, 14), "intensity": 0.7},
                   {"position": (16, 6, 10), "color": (1, 0.85, 0.7), "intensity": 0.45},
                   {"position": (2, 10, -16), "color": (0.65, 0.8, 1), "intensity": 0.5}],
        "materials": materials,
        "frames": [1, 4],
        "scene": rings,
    }
