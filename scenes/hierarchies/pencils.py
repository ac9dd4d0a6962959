"""Weghorst, Hooper and Greenberg's Pencils (Figure 5, Tables II to IV)."""
from placing import move
from shapes import cluster, hue, item, mesh, of, polygon, view
from vectors import circle


def pencil():
    """50 polygons along x, from the eraser at 0 to the lead at 7: four bands of twelve and both ends."""
    def ring(x, radius):
        return [(x, y, -z) for z, y in circle(radius, 12, first=15, last=375)]

    def band(x0, r0, x1, r1):
        return mesh(ring(x0, r0) + ring(x1, r1), [(k, 12 + k, 12 + (k + 1) % 12, (k + 1) % 12) for k in range(12)], "phong")
    return [of("eraser", polygon(*ring(0, 0.16))), of("eraser", band(0, 0.16, 0.35, 0.16)),
            of("ferrule", band(0.35, 0.17, 0.75, 0.17)),
            band(0.75, 0.18, 6.2, 0.18), of("wood", band(6.2, 0.18, 6.9, 0.045)), of("lead", polygon(*ring(6.9, 0.045)[::-1]))]


def pencils(number):
    reflective = number == 2
    shapes, bundles, materials = pencil(), [], {}
    coat = {"ambient": 0.2, "diffuse": 0.55, "specular": 0.35, "shininess": 50, **({"reflect": 0.25} if reflective else {})}
    for b in range(9):
        group = []
        for k in range(4):
            name = f"paint {4 * b + k + 1}"
            materials[name] = {"color": hue((b + 0.22 * k) / 9, 0.85 - 0.1 * (k == 3), 0.95 - 0.12 * (k % 2)), **coat}
            # Three side by side, the fourth in the groove upon them, a little askew.
            aside, up, turn = [(-0.37, 0.176, 1.2), (0, 0.176, -0.8), (0.37, 0.176, 0.5), (0.17, 0.49, 0)][k]
            group.append(item(f"pencil {4 * b + k + 1}", name, *shapes,
                              at=move(("y", turn), (-9.3 + 0.25 * (k % 3), up, aside), ("y", 40 * b + 10))))
        bundles.append(cluster(f"bundle {b + 1}", *group))
    lights = [{"position": (-9, 16, 9), "intensity": 1.05}]
    if number == 3:
        lights = [{"position": (-9, 16, 9), "intensity": 0.55}, {"position": (12, 14, 5), "color": (1, 0.86, 0.7), "intensity": 0.4},
                  {"position": (1, 15, -14), "color": (0.7, 0.85, 1), "intensity": 0.35}]
    mirror = {"color": 0.95, "ambient": 0.05, "diffuse": 0.1, "specular": 0.3, "shininess": 100, "reflect": 0.7}
    paper = {"color": (0.93, 0.91, 0.86)}
    return {
        "comment": [f"Pencils {'I' * number} of Weghorst, Hooper and Greenberg 1984 (Figure 5, Table {['II', 'III', 'IV'][number - 1]}):",
                    "38 items of 1,806 polygons; each pencil with its three neighbours is one of nine clusters.",
                    ["One light, depth 1 (--max-depth 1).", "Reflective, one light, depth 3 (--max-depth 3).",
                     "Three lights, depth 1 (--max-depth 1)."][number - 1]],
        "view": view((0, 13.5, 14.5), (0, -0.3, 0.75), 53),
        "background": (0.26, 0.29, 0.34),
        "lights": lights,
        "textures": {"grain": {"kind": "wood", "first": (0.36, 0.2, 0.1), "second": (0.2, 0.1, 0.05), "scale": (2.5, 2.5, 16),
                               "strength": 1.2}},  # rings that are drawn out along z are a board's grain
        "materials": {
            "table": {"color": 1.0, "texture": "grain", "ambient": 0.25, "diffuse": 0.6, "specular": 0.1, "shininess": 20,
                      **({"reflect": 0.2} if reflective else {})},
            "facet": mirror if reflective else paper,
            "eraser": {"color": (0.85, 0.42, 0.4)},
            "ferrule": {"color": (0.75, 0.62, 0.3), "ambient": 0.2, "diffuse": 0.4, "specular": 0.5, "shininess": 40,
                        **({"reflect": 0.4} if reflective else {})},
            "wood": {"color": (0.85, 0.66, 0.42)},
            "lead": {"color": 0.05},
            **materials,
        },
        "scene": [
            item("table", "table", polygon((-31, 0, 16), (49, 0, 16), (49, 0, -60), (-31, 0, -60))),
            *bundles,
            item("pyramid", "facet", mesh([(-1, 0, 1), (1, 0, 1), (1, 0, -1), (-1, 0, -1), (0, 1.9, 0)],
                                          [(3, 2, 1, 0), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)]),
                 at=move((0, 0.005, 0), ("y", 25))),
        ],
    }
