"""What pictures of real files are made of, pixel by pixel, is what another renderer finds in them with readers of its
own: depth, normals and base colours."""
import math
import os
import shutil
import subprocess

import first_hits
import gltf_reader
import made_gltf
import mesh_reader
from rayfarm_job import JobTest, main

FACTS = os.environ.get("MESH_FACTS", "build/mesh_facts")
WIDTH, HEIGHT = 96, 72
DEGREES = 40
# From what is looked at. Off the axes, so that no face is seen edge on, and off the lamp of models that have none.
FROM = {"front": (0.53, 0.41, 0.74), "behind": (-0.71, 0.33, -0.62)}
# Of the pixels where either sees something. Silhouettes, where a centre is on an edge to the last digits, are the rest.
SHARE = 0.995
# Of colours' means over a picture. Textures are filtered by squares of what a pixel sees, ours, or by points in it.
MEAN = 0.004


def view_of(meshes, side):
    """The view of a sphere about the meshes, and how mesh_facts is told of it."""
    points = [p for mesh in meshes for p in mesh.points]
    low, high = [min(c) for c in zip(*points)], [max(c) for c in zip(*points)]
    middle, radius = [(a + b) / 2 for a, b in zip(low, high)], math.dist(low, high) / 2
    half = math.tan(math.radians(DEGREES / 2))
    distance = 1.02 * radius / math.sin(math.atan(half * HEIGHT / WIDTH))
    direction = first_hits.normalized(list(FROM[side]))
    location = [m + distance * d for m, d in zip(middle, direction)]
    return first_hits.View(location, first_hits.minus(middle, location), [0, 1, 0], half), [*location, *middle, DEGREES]


def rendered(path, milliseconds, camera="", clip="", view=()):
    """Of each pixel the numbers of first_hits.h, or None."""
    run = subprocess.run([FACTS, path, *map(str, (milliseconds, WIDTH, HEIGHT, camera, clip)), *map(repr, view)],
                         capture_output=True, text=True, timeout=60)
    if run.returncode != 0:
        raise AssertionError(f"{path}: {run.stderr}")
    return [None if line == "-" else [float(x) for x in line.split()] for line in run.stdout.splitlines()]


def difference(a, b):
    return max(abs(x - y) for x, y in zip(a, b))


class Comparison:
    """How many pixels agree, of those where either sees something."""
    def __init__(self, ours, other, has_normals=True, has_color=True):
        self.pixels, self.agree = 0, dict.fromkeys(("depth", "normal", "shading normal", "colour"), 0)
        self.filtered, self.mean = [0, 0, 0], [0, 0, 0]
        for mine, seen in zip(ours, other):
            if mine is None and seen[0] is None:
                continue
            self.pixels += 1
            if mine is None:
                self.add([None in seen] * 4)
                continue
            depth, front, normal, shading, filtered, plain = mine[0], mine[1], mine[2:5], mine[5:8], mine[8:11], mine[11:14]
            there = [s for s in seen if s and abs(s.depth - depth) <= 1e-4 * s.depth]
            self.add([bool(there), any(difference(s.normal, normal) < 1e-3 and s.is_front == bool(front) for s in there),
                      any(not has_normals or difference(s.shading_normal, shading) < 1e-3 for s in there),
                      any(not has_color or difference(s.base()[:3], plain) < 0.01 for s in there)])
            if there and has_color:
                mean = there[0].mean_base()
                for c in range(3):
                    self.filtered[c] += filtered[c]
                    self.mean[c] += mean[c]

    def add(self, agree):
        for what, is_equal in zip(self.agree, agree):
            self.agree[what] += is_equal

    def disagreements(self, most=MEAN):
        """Shares of pixels that differ, where they are too many, and of colours as pictures have them, filtered, the
        difference of the means if it is more than `most`."""
        found = {what: 1 - count / self.pixels for what, count in self.agree.items() if count < SHARE * self.pixels}
        filtered = difference(self.filtered, self.mean) / max(self.pixels, 1)
        return found if filtered < most else found | {"mean colour": filtered}


def of_meshes(meshes, view):
    """What the other renderer finds."""
    return first_hits.first_hits(view, meshes, WIDTH, HEIGHT)


class FirstHits(JobTest):
    def setUp(self):
        super().setUp()
        if not shutil.which("oiiotool"):
            self.skip("oiiotool (openimageio-tools) is not there")

    def compare(self, name, ours, other, may_be_empty=False, mean=MEAN, **what):
        result = Comparison(ours, other, **what)
        with self.subTest(name):
            self.assertTrue(may_be_empty or result.pixels > 200, f"{result.pixels} pixels")
            self.assertEqual(result.disagreements(mean), {})

    def test_gltf_files(self):
        self.compare_files(sorted(p for p in self.asset("gltf").rglob("*") if p.suffix in (".glb", ".gltf")))

    def test_gltf_files_that_have_it_all(self):
        self.compare_files([made_gltf.write_textured(self.folder / "textured.gltf"), made_gltf.write_bent(self.folder / "bent.gltf"),
                            made_gltf.write_packed(self.folder / "packed.gltf")],
                           mean=0.01)  # texels without likeness to their neighbours

    def compare_files(self, paths, **how):
        for path in paths:
            model = gltf_reader.Gltf(path)
            clips = len(model.json.get("animations", []))
            for side, part, clip in (("front", 0.37, 0), ("behind", 0.8, max(clips - 1, 0))):
                milliseconds = round(1000 * part * model.length(clip))
                meshes = list(model.meshes(milliseconds / 1000, clip))
                view, numbers = view_of(meshes, side)
                # A sheet of one side is nothing from behind.
                self.compare(f"{path.name}, {side}, at {milliseconds} ms of clip {clip}",
                             rendered(path, milliseconds, "", clip if clips else "", numbers), of_meshes(meshes, view),
                             may_be_empty=side == "behind", **how)
            for number, (camera, world) in enumerate(model.cameras(0)):
                self.compare(f"{path.name}, camera {number}", rendered(path, 0, number),
                             of_meshes(list(model.meshes(0)), first_hits.camera_view(camera, world)))

    def test_obj_and_ply_files(self):
        for name in ("meshes/stanford-bunny.obj", "meshes/teapot.obj", "obj/spider.obj", "obj/cube_usemtl.obj", "ply/cube.ply",
                     "ply/cube_binary.ply", "ply/cube_uv.ply", "ply/float-color.ply"):
            path = self.asset(name)
            meshes = mesh_reader.read_meshes(path)
            view, numbers = view_of(meshes, "front")
            # Where the file says nothing of normals or colours nothing is equal but what it does say.
            self.compare(name, rendered(path, 0, view=numbers), of_meshes(meshes, view),
                         has_normals=all(mesh.normals for mesh in meshes),
                         has_color=any(mesh.colors or mesh.material.is_named for mesh in meshes))

    def test_a_texture_on_the_coordinates_of_an_obj_file(self):
        mesh, image = self.asset("spot/spot_triangulated.obj"), self.asset("spot/spot_texture.png")
        scene = self.write("scene.yaml", "view: {location: [0, 0, 9], look_at: [0, 0, 0]}\nlights: [{direction: [0, -1, -1]}]\n"
                           f"scene:\n  - {{material: {{lambertian: 1, texture: {{kind: image, file: '{image}'}}}}, mesh: {{file: '{mesh}'}}}}\n")
        meshes = mesh_reader.read_meshes(mesh)
        for part in meshes:
            part.material.image = image.read_bytes()
        view, numbers = view_of(meshes, "front")
        self.compare(mesh.name, rendered(scene, 0, view=numbers), of_meshes(meshes, view), has_normals=False)

    def test_what_is_read_wrongly_is_noticed(self):
        """The comparison fails where a reader makes one of the usual mistakes; only the named things differ."""
        box, fox, coat, morph = (self.asset(f"gltf/{name}") for name in (
            "BoxTextured.glb", "Fox.glb", "ClearCoat/ClearCoatTest.gltf", "AnimatedMorphCube/AnimatedMorphCube.gltf"))

        def found(path, milliseconds, spoil):
            meshes = list(gltf_reader.Gltf(path).meshes(milliseconds / 1000))
            view, numbers = view_of(meshes, "front")
            ours = rendered(path, milliseconds, "", "", numbers)
            self.assertEqual(Comparison(ours, of_meshes(meshes, view)).disagreements(), {})
            return set(Comparison(ours, of_meshes(spoil(meshes) or meshes, view)).disagreements())

        def upside_down(meshes):
            for mesh in meshes:
                mesh.uvs = [[[u, 1 - v] for u, v in uvs] for uvs in mesh.uvs]

        def moved(meshes):
            for mesh in meshes:
                mesh.points = [[x, y + 1e-3 * abs(x + y + z), z] for x, y, z in mesh.points]

        def turned_inside_out(meshes):
            for mesh in meshes:
                mesh.faces = [face[::-1] for face in mesh.faces]

        def flat(meshes):
            for mesh in meshes:
                mesh.normals = None

        def darker(meshes):
            for mesh in meshes:
                mesh.material.factor = [0.97 * c for c in mesh.material.factor[:3]] + [1]

        self.assertEqual(found(box, 0, upside_down) - {"mean colour"}, {"colour"})
        self.assertLessEqual({"depth"}, found(box, 0, moved))
        self.assertLessEqual({"depth", "normal"}, found(box, 0, turned_inside_out))
        self.assertEqual(found(coat, 0, flat), {"shading normal"})
        self.assertEqual(found(morph, 700, darker), {"colour", "mean colour"})
        self.assertLessEqual({"depth", "normal"}, found(fox, 700, lambda _: list(gltf_reader.Gltf(fox).meshes(0.72))))


if __name__ == "__main__":
    main()
