"""What pictures of real files are made of, pixel by pixel, is what another renderer finds in them with readers of its
own: depth, normals and base colours."""
import math
import os
import pathlib
import shutil
import subprocess
import sys
import unittest

import first_hits
import gltf_reader
import mesh_reader
from rayfarm_job import ASSETS

FACTS = os.environ.get("MESH_FACTS", "build/mesh_facts")
WIDTH, HEIGHT = 96, 72
DEGREES = 40
# From what is looked at. Off the axes, so that no face is seen edge on, and off the lamp of models that have none.
FROM = {"front": (0.53, 0.41, 0.74), "behind": (-0.71, 0.33, -0.62)}
# Of the pixels where either sees something. Silhouettes, where a centre is on an edge to the last digits, are the rest.
SHARE = 0.995


def skip(why):
    print(f"skipped: {why}")
    raise SystemExit(77)


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
    """Shares of pixels that agree, of those where either sees something."""
    def __init__(self, ours, other, has_normals=True):
        self.pixels = self.depth = self.normal = self.shading = self.color = 0
        self.filtered, self.unfiltered = [0, 0, 0], [0, 0, 0]
        for mine, seen in zip(ours, other):
            if mine is None and seen[0] is None:
                continue
            self.pixels += 1
            if mine is None:
                if None in seen:
                    self.add(1, 1, 1, 1)
                continue
            depth, front, normal, shading, filtered, plain = mine[0], mine[1], mine[2:5], mine[5:8], mine[8:11], mine[11:14]
            there = [s for s in seen if s and abs(s.depth - depth) <= 1e-4 * s.depth]
            if not there:
                continue
            self.add(1, any(difference(s.normal, normal) < 1e-3 and s.is_front == bool(front) for s in there),
                     not has_normals or any(difference(s.shading_normal, shading) < 1e-3 for s in there),
                     any(difference(s.base()[:3], plain) < 0.01 for s in there))
            for c in range(3):
                self.filtered[c] += filtered[c]
                self.unfiltered[c] += there[0].base()[c]

    def add(self, depth, normal, shading, color):
        self.depth, self.normal, self.shading, self.color = (
            self.depth + depth, self.normal + normal, self.shading + shading, self.color + color)

    def shares(self):
        return {name: getattr(self, name) / max(self.pixels, 1) for name in ("depth", "normal", "shading", "color")}

    def mean_difference(self):
        """Of colours as pictures have them, filtered, and those of points."""
        return difference(self.filtered, self.unfiltered) / max(self.pixels, 1)


class FirstHits(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        if not ASSETS.exists():
            skip(f"{ASSETS} is not there")
        if not shutil.which("oiiotool"):
            skip("oiiotool (openimageio-tools) is not there")

    def compare(self, name, ours, other, has_normals=True):
        result = Comparison(ours, other, has_normals)
        print(f"{name}: {result.pixels} pixels, {result.shares()}, mean {result.mean_difference():.2g}", file=sys.stderr)
        with self.subTest(name):
            self.assertGreater(result.pixels, 200)
            for what, share in result.shares().items():
                self.assertGreaterEqual(share, SHARE, what)
            self.assertLess(result.mean_difference(), 0.01)

    def test_gltf_files(self):
        for path in sorted(p for p in (ASSETS / "gltf").rglob("*") if p.suffix in (".glb", ".gltf")):
            model = gltf_reader.Gltf(path)
            clips = len(model.json.get("animations", []))
            for side, part, clip in (("front", 0.37, 0), ("behind", 0.8, max(clips - 1, 0))):
                milliseconds = round(1000 * part * model.length(clip))
                meshes = list(model.meshes(milliseconds / 1000, clip))
                view, numbers = view_of(meshes, side)
                self.compare(f"{path.name}, {side} at {milliseconds} ms of clip {clip}",
                             rendered(path, milliseconds, "", clip if clips else "", numbers),
                             first_hits.first_hits(view, meshes, WIDTH, HEIGHT))
            for number, (camera, world) in enumerate(model.cameras(0)):
                self.compare(f"{path.name}, camera {number}", rendered(path, 0, number),
                             first_hits.first_hits(first_hits.camera_view(camera, world), list(model.meshes(0)), WIDTH, HEIGHT))

    def test_obj_and_ply_files(self):
        for name in ("meshes/stanford-bunny.obj", "meshes/teapot.obj", "spot/spot_triangulated.obj", "obj/spider.obj",
                     "obj/cube_usemtl.obj", "ply/cube.ply", "ply/cube_binary.ply", "ply/cube_uv.ply", "ply/float-color.ply"):
            path = ASSETS / name
            if not path.exists():
                skip(f"{path} is not there")
            meshes = mesh_reader.read_meshes(path)
            view, numbers = view_of(meshes, "front")
            # Without normals it is not said here what is smooth.
            has_normals = all(mesh.normals for mesh in meshes)
            self.compare(name, rendered(path, 0, view=numbers), first_hits.first_hits(view, meshes, WIDTH, HEIGHT), has_normals)


if __name__ == "__main__":
    unittest.main()
