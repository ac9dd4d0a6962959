#!/usr/bin/env python3
"""Writes the benchmark scenes, each in the formats of Rayfarm (.yaml, .obj), Tachyon (.dat) and POV-Ray (.pov).

    tests/bench/write_scenes.py FOLDER [NAME ...] [--formats rayfarm tachyon povray]

One generator makes all three, so that every program renders the same geometry, camera, lights and materials (Tachyon's
space is left-handed, so its pictures are mirrored).
"""
import argparse
import math
import pathlib
import random
from dataclasses import dataclass, field

from geometry import as_mesh, bar, box_polygons, bumpy_sphere, join, place_point, sphereflake, strand, terrain, turned, unit


@dataclass
class Material:
    name: str
    color: tuple
    diffuse: float = 0.8
    ambient: float = 0.15
    reflect: float = 0.0


@dataclass
class Mesh:
    material: Material
    points: list
    triangles: list  # of point indices
    places: list = field(default_factory=lambda: [(0.0, (0, 0, 0))])  # degrees about y, then translation


@dataclass
class Scene:
    name: str
    eye: tuple
    at: tuple
    angle: float = 45.0  # degrees, across the width of a square image
    up: tuple = (0, 1, 0)
    lights: list = field(default_factory=list)  # (position, grey level)
    spheres: list = field(default_factory=list)  # (material, centre, radius)
    polygons: list = field(default_factory=list)  # (material, points)
    meshes: list = field(default_factory=list)

    def materials(self):
        used = [m for m, *_ in self.spheres] + [m for m, _ in self.polygons] + [m.material for m in self.meshes]
        return list({m.name: m for m in used}.values())


# ---- materials --------------------------------------------------------------------------------------------------

CLAY = Material("clay", (0.9, 0.6, 0.4))
STONE = Material("stone", (0.7, 0.7, 0.65))
GRASS = Material("grass", (0.45, 0.65, 0.3))
PEARL = Material("pearl", (0.9, 0.8, 0.6), diffuse=0.5, reflect=0.45)
FLOOR = Material("floor", (0.8, 0.75, 0.7), diffuse=0.85)
STEEL = Material("steel", (0.6, 0.62, 0.7))
FUR = Material("fur", (0.55, 0.35, 0.2))


# ---- scenes ------------------------------------------------------------------------------------------------------

def make_balls():
    spheres = [(PEARL, c, r) for c, r in sphereflake(4)]
    floor = (FLOOR, [(12, 12, -0.5), (-12, 12, -0.5), (-12, -12, -0.5), (12, -12, -0.5)])
    return Scene("balls", (2.1, 1.3, 1.7), (0, 0, 0), up=(0, 0, 1), spheres=spheres, polygons=[floor],
                 lights=[((4, 3, 2), 0.55), ((1, -4, 4), 0.4), ((-3, 1, 5), 0.4)])


def make_mesh70k():
    return Scene("mesh70k", (1.2, 1.4, 2.6), (0, 0, 0), lights=[((4, 5, 3), 0.7), ((-4, 3, 5), 0.4)],
                 meshes=[Mesh(CLAY, *bumpy_sphere(264, 133))])


def make_mesh1m():
    return Scene("mesh1m", (-38, 16, 42), (6, -4, -6), angle=60, lights=[((-60, 70, 20), 0.9), ((40, 60, 50), 0.3)],
                 meshes=[Mesh(GRASS, *terrain(708))])


def make_architecture():
    """A hall of huge walls, askew to the axes, with columns and 60 dense ornaments."""
    turn = 23.0
    walls = box_polygons((-30, 0, -20), (30, 12, 20), turn, inward=True)
    parts = [as_mesh(walls)]
    for k in range(8):
        x = -24.5 + 7 * k
        for z in (-13, 13):
            parts.append(as_mesh(box_polygons((x - 0.5, 0, z - 0.5), (x + 0.5, 12, z + 0.5), turn)))
        parts.append(as_mesh(box_polygons((x - 0.3, 10.5, -20), (x + 0.3, 11.2, 20), turn)))
    c, s = math.cos(math.radians(turn)), math.sin(math.radians(turn))
    for k in range(60):
        x, z = -26 + 5.7 * (k % 10), -15 + 6 * (k // 10)
        place = (c * x + s * z, 0.9 + 0.35 * (k % 3), -s * x + c * z)
        parts.append(bumpy_sphere(60, 28, 0.8, place, 0.12))
    return Scene("architecture", (-22, 4.5, 2.5), (10, 2, -1), angle=70,
                 lights=[((-8, 9, 2), 0.5), ((12, 9, -6), 0.5)], meshes=[Mesh(STONE, *join(parts))])


def roof_frame(parts):
    """A space frame of 16 by 11 pyramids under the roof: chords as long as the hall, and diagonals."""
    def low(i, j):
        return -28 + 3.5 * i, 11.0, -18 + 3.27 * j

    def high(i, j):
        return -26.25 + 3.5 * i, 13.2, -16.365 + 3.27 * j
    for i in range(17):
        parts.append(bar(low(i, 0), low(i, 11), 0.07))
    for j in range(12):
        parts.append(bar(low(0, j), low(16, j), 0.07))
    for i in range(16):
        parts.append(bar(high(i, 0), high(i, 10), 0.06))
        for j in range(11):
            parts += [bar(low(i + di, j + dj), high(i, j), 0.04, 6) for di in (0, 1) for dj in (0, 1)]


def glazing(parts):
    """Walls of crossing diagonal mullions, each from floor to roof, and thin transoms."""
    for side in (-1, 1):
        for k in range(-7, 61):
            for lean in (-1, 1):
                x = -30 + k
                a, b = (x, 0, 19.6 * side), (x + 7 * lean, 14, 19.6 * side)
                if -30 <= b[0] <= 30 and -30 <= x <= 30:
                    parts.append(bar(a, b, 0.05, 4))
        for k in range(1, 28):
            parts.append(bar((-30, 0.5 * k, 19.55 * side), (30, 0.5 * k, 19.55 * side), 0.015, 4))


def stairs(parts, foot, run, rise, width, steps):
    """A flight along x with stringers, handrails and a net of leaning rods on both sides."""
    x, y, z = foot
    for k in range(steps):
        lo = (x + run * k / steps, y + rise * (k + 1) / steps - 0.05, z - width / 2)
        parts.append(as_mesh(box_polygons(lo, (lo[0] + 1.15 * abs(run) / steps, lo[1] + 0.05, z + width / 2))))
    for side in (-1, 1):
        w = z + side * width / 2
        for height, radius in ((0, 0.09), (0.35, 0.012), (0.7, 0.012), (1.05, 0.04)):
            parts.append(bar((x, y + height, w), (x + run, y + rise + height, w), radius, 12))
        for k in range(3 * steps):
            across, up = x + run * k / (3 * steps), y + rise * k / (3 * steps)
            for lean in (-0.3, 0.3):
                parts.append(bar((across, up, w), (across + lean, up + 1.05, w), 0.008, 6))


def make_trusses():
    """A hall of huge walls, askew to the axes, full of thin things at angles: a space frame, wind braces from corner to
    corner, glazing of diagonal mullions, stairs with railings; and a few dense statues."""
    parts = [as_mesh(box_polygons((-30, 0, -20), (30, 14, 20), inward=True))]
    roof_frame(parts)
    glazing(parts)
    for k in range(12):
        for row_of, x in enumerate((-27 + 4.5 * k, -22.5 + 4.5 * k)):
            parts.append(bar((x, 0, -17 + 34 * row_of), (x + 3, 11, 17 - 34 * row_of), 0.02, 6))
    for k in range(6):
        for lane in (-9, -3, 3, 9):
            stairs(parts, (-26 + 9 * k, 0 if k % 2 == 0 else 6, lane), 8, 6 if k % 2 == 0 else -6, 2.4, 30)
    for k in range(20):
        parts.append(bumpy_sphere(40, 20, 0.7, (-25 + 5.5 * (k % 10), 0.7, -15 + 30 * (k // 10)), 0.12))
    return Scene("trusses", (-24, 5.5, 9), (12, 5, -7), angle=70,
                 lights=[((-8, 9, 2), 0.5), ((12, 9.5, -6), 0.5)], meshes=[Mesh(STEEL, *turned(join(parts), 23))])


def make_hair():
    """Strands from all over a ball, each a ribbon that curls its own way: 320,000 triangles much longer than wide."""
    rng = random.Random(1)
    strands = []
    for k in range(8000):
        height = 1 - (2 * k + 1) / 8000  # a spiral of equal areas
        across, phi = math.sqrt(1 - height * height), 2.399963229728653 * k
        root = (across * math.cos(phi), height, across * math.sin(phi))
        direction = unit(tuple(x + rng.gauss(0, 0.5) for x in root))
        strands.append(strand(root, direction, rng.uniform(0.7, 1.6), rng.uniform(0.004, 0.01), 20, rng))
    return Scene("hair", (2.2, 1.4, 3.4), (0, -0.1, 0), angle=40, lights=[((4, 5, 3), 0.7), ((-4, 3, 5), 0.4)],
                 meshes=[Mesh(FUR, *join(strands)), Mesh(CLAY, *bumpy_sphere(132, 66, 1.0, bumps=0.01))])


def make_instances():
    places = [(37.0 * k, (2.6 * (k % 10) - 11.7, 0.4 * math.sin(k), 2.6 * (k // 10) - 11.7)) for k in range(100)]
    points, triangles = bumpy_sphere(264, 133)
    return Scene("instances", (-14, 10, 18), (0, 0, 0), lights=[((20, 30, 10), 0.7), ((-20, 25, 10), 0.4)],
                 meshes=[Mesh(CLAY, points, triangles, places)])


def make_room():
    """28 polygons: a closed room, three boxes, and four panels on its walls."""
    polygons = [(STONE, p) for p in box_polygons((-3, 0, -4), (3, 3, 4), inward=True)]
    for lo, hi, turn, about in (((-0.8, 0, -0.5), (0.8, 0.8, 0.5), 20, (-0.8, 0, -1.5)),
                                ((-0.4, 0, -0.4), (0.4, 1.7, 0.4), -30, (1.4, 0, -2.2)),
                                ((-0.3, 0, -0.3), (0.3, 0.6, 0.3), 50, (0.9, 0, 0.2))):
        polygons += [(CLAY, p) for p in box_polygons(lo, hi, turn, about)]
    for x in (-2.2, -0.7, 0.8):
        polygons.append((PEARL, [(x, 1.2, -3.98), (x + 1.2, 1.2, -3.98), (x + 1.2, 2.4, -3.98), (x, 2.4, -3.98)]))
    polygons.append((FLOOR, [(-1.5, 0.01, 2), (1.5, 0.01, 2), (1.5, 0.01, -1), (-1.5, 0.01, -1)]))
    return Scene("room", (0, 1.6, 3.6), (0, 1.1, -2), angle=65, polygons=polygons,
                 lights=[((1.5, 2.7, 1), 0.6), ((-1.8, 2.6, -1), 0.5)])


def make_pot():
    """The mesh of the stadium without the stadium; in both it fills the picture, so that the same rays are traced."""
    return Scene("pot", (1.2, 1, 2.2), (0, 0, 0), angle=24, lights=[((400, 500, 300), 0.7), ((-400, 300, 500), 0.4)],
                 meshes=[Mesh(CLAY, *bumpy_sphere(264, 133))])


def make_stadium():
    """A small dense mesh over two huge polygons, the "teapot in a stadium"."""
    scene = make_pot()
    scene.name = "stadium"
    far = 10000
    scene.polygons = [(FLOOR, [(-far, -2, far), (far, -2, far), (far, -2, -far), (-far, -2, -far)]),
                      (STONE, [(-far, -2, -far), (far, -2, -far), (far, far, -far), (-far, far, -far)])]
    return scene


SCENES = {f.__name__[5:]: f for f in (make_balls, make_mesh70k, make_mesh1m, make_architecture, make_trusses, make_hair,
                                       make_instances, make_room, make_pot, make_stadium)}


# ---- formats -----------------------------------------------------------------------------------------------------

def row(values, separator=", "):
    return separator.join(f"{v:.9g}" for v in values)


def write_rayfarm(scene, folder):
    with open(folder / f"{scene.name}.yaml", "w") as out:
        out.write(f"view:\n  location: [{row(scene.eye)}]\n  look_at: [{row(scene.at)}]\n  up: [{row(scene.up)}]\n"
                  f"  field_of_view: {scene.angle}\n  aspect: 1\n  resolution: [512, 512]\nlights:\n")
        for position, level in scene.lights:
            out.write(f"  - {{position: [{row(position)}], color: [{level}, {level}, {level}]}}\n")
        out.write("materials:\n")
        for m in scene.materials():
            out.write(f"  {m.name}: {{color: [{row(m.color)}], ambient: {m.ambient}, diffuse: {m.diffuse}, "
                      f"reflect: {m.reflect}}}\n")
        if scene.meshes:
            out.write("objects:\n")
        for k, mesh in enumerate(scene.meshes):
            file = f"{scene.name}.{k}.obj"
            out.write(f"  mesh{k}: {{material: {mesh.material.name}, mesh: {{file: {file}, smooth: flat}}}}\n")
            with open(folder / file, "w") as obj:
                obj.writelines(f"v {row(p, ' ')}\n" for p in mesh.points)
                obj.writelines(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in mesh.triangles)
        out.write("scene:\n")
        for material, points in scene.polygons:
            corners = ", ".join(f"[{row(p)}]" for p in points)
            out.write(f"  - {{material: {material.name}, polygon: {{points: [{corners}]}}}}\n")
        for material, center, radius in scene.spheres:
            out.write(f"  - {{material: {material.name}, sphere: {{center: [{row(center)}], radius: {radius:.9g}}}}}\n")
        for k, mesh in enumerate(scene.meshes):
            for degrees, offset in mesh.places:
                if degrees == 0 and not any(offset):
                    out.write(f"  - {{use: mesh{k}}}\n")
                else:
                    out.write(f"  - {{use: mesh{k}, transform: [{{rotate: {{axis: [0, 1, 0], degrees: {degrees}}}}}, "
                              f"{{translate: [{row(offset)}]}}]}}\n")


def write_tachyon(scene, folder):
    direction = [a - e for a, e in zip(scene.at, scene.eye)]
    with open(folder / f"{scene.name}.dat", "w") as out:
        out.write("Begin_Scene\nResolution 512 512\nCamera\n"
                  f"  Zoom {0.5 / math.tan(math.radians(scene.angle) / 2):.9g}\n  Aspectratio 1\n  Antialiasing 0\n"
                  f"  Raydepth 6\n  Center {row(scene.eye, ' ')}\n  Viewdir {row(direction, ' ')}\n"
                  f"  Updir {row(scene.up, ' ')}\nEnd_Camera\nBackground 0 0 0\n")
        for position, level in scene.lights:
            out.write(f"Light Center {row(position, ' ')} Rad 0.001 Color {level} {level} {level}\n")
        for m in scene.materials():
            out.write(f"TexDef {m.name} Ambient {m.ambient} Diffuse {m.diffuse} Specular {m.reflect} Opacity 1 "
                      f"Color {row(m.color, ' ')} TexFunc 0\n")
        for material, points in scene.polygons:
            for k in range(1, len(points) - 1):
                a, b, c = points[0], points[k], points[k + 1]
                out.write(f"TRI V0 {row(a, ' ')} V1 {row(b, ' ')} V2 {row(c, ' ')} {material.name}\n")
        for material, center, radius in scene.spheres:
            out.write(f"Sphere Center {row(center, ' ')} Rad {radius:.9g} {material.name}\n")
        for mesh in scene.meshes:
            for place in mesh.places:
                points = [row(place_point(place, p), " ") for p in mesh.points]
                out.writelines(f"TRI V0 {points[a]} V1 {points[b]} V2 {points[c]} {mesh.material.name}\n"
                               for a, b, c in mesh.triangles)
        out.write("End_Scene\n")


def write_povray(scene, folder):
    with open(folder / f"{scene.name}.pov", "w") as out:
        out.write("#version 3.7;\nglobal_settings { assumed_gamma 1 max_trace_level 6 }\nbackground { rgb 0 }\n"
                  f"camera {{ perspective location <{row(scene.eye)}> right -x up y angle {scene.angle} "
                  f"sky <{row(scene.up)}> look_at <{row(scene.at)}> }}\n")
        for position, level in scene.lights:
            out.write(f"light_source {{ <{row(position)}>, rgb {level} }}\n")
        for m in scene.materials():
            out.write(f"#declare T_{m.name} = texture {{ pigment {{ rgb <{row(m.color)}> }} finish {{ ambient "
                      f"{m.ambient} diffuse {m.diffuse} reflection {m.reflect} }} }}\n")
        for material, points in scene.polygons:
            corners = ", ".join(f"<{row(p)}>" for p in points + points[:1])
            out.write(f"polygon {{ {len(points) + 1}, {corners} texture {{ T_{material.name} }} }}\n")
        for material, center, radius in scene.spheres:
            out.write(f"sphere {{ <{row(center)}>, {radius:.9g} texture {{ T_{material.name} }} }}\n")
        for k, mesh in enumerate(scene.meshes):
            out.write(f"#declare Mesh{k} = mesh2 {{ vertex_vectors {{ {len(mesh.points)}")
            out.writelines(f",\n<{row(p)}>" for p in mesh.points)
            out.write(f" }} face_indices {{ {len(mesh.triangles)}")
            out.writelines(f",\n<{a},{b},{c}>" for a, b, c in mesh.triangles)
            out.write(f" }} texture {{ T_{mesh.material.name} }} }}\n")
            for degrees, offset in mesh.places:
                out.write(f"object {{ Mesh{k} rotate <0, {-degrees}, 0> translate <{row(offset)}> }}\n")


FORMATS = {"rayfarm": write_rayfarm, "tachyon": write_tachyon, "povray": write_povray}


def write_scene(name, folder, formats=FORMATS):
    folder.mkdir(parents=True, exist_ok=True)
    scene = SCENES[name]()
    for name in formats:
        FORMATS[name](scene, folder)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("names", nargs="*", metavar="NAME", help=", ".join(SCENES))
    parser.add_argument("--formats", nargs="+", choices=FORMATS, default=list(FORMATS))
    options = parser.parse_args()
    for name in options.names or SCENES:
        if name not in SCENES:
            parser.error(f"no scene is called '{name}'; there are {', '.join(SCENES)}")
        write_scene(name, options.folder, options.formats)


if __name__ == "__main__":
    main()
