"""The commands beside render: check and info."""
import os
import random
import re
import socket
import subprocess

import made_gltf
from rayfarm_job import ENVIRONMENT, JobTest, RAYFARM, SCENES, main

SCENE = SCENES / "primitives.yaml"


class Commands(JobTest):
    def test_check_lists_files(self):
        obj = self.write("tri.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        scene = self.write("s.yaml", "view: {location: [0, 0, 5], look_at: [0, 0, 0]}\nscene:\n  - mesh: {file: tri.obj}\n")
        result = self.run_alone("check", scene)
        self.assertEqual(result.code, 0, result.stderr)
        self.assertEqual(result.stdout.splitlines(), [str(scene), str(obj)])

    def test_check_lists_files_outside_of_the_scenes_folder(self):
        (self.folder / "scenes").mkdir()
        obj = self.write("tri.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        scene = self.write("scenes/s.yaml", "view: {location: [0, 0, 5], look_at: [0, 0, 0]}\nlights: [{position: [0, 0, 9]}]\nscene:\n  - mesh: {file: ../tri.obj}\n")
        result = self.run_alone("check", scene)
        self.assertEqual(result.code, 0, result.stderr)
        self.assertIn("outside of the scene's folder:\n", result.stderr)
        self.assertIn("tri.obj", result.stderr.split("folder:")[1])
        self.assertIn("no problems found", result.stderr)
        (self.folder / "scenes" / "tri.obj").write_text(obj.read_text())
        scene.write_text(scene.read_text().replace("../tri", "tri"))
        self.assertNotIn("outside", self.run_alone("check", scene).stderr)

    def test_only_regular_files_are_read(self):
        view = "view: {location: [0, 0, 5], look_at: [0, 0, 0]}\n"
        os.mkfifo(self.folder / "pipe.nff")
        (self.folder / "folder.nff").mkdir()
        (self.folder / "zero.nff").symlink_to("/dev/zero")
        with socket.socket(socket.AF_UNIX) as listening:
            listening.bind(str(self.folder / "socket.nff"))
            for name in ("pipe", "folder", "zero", "socket"):
                for extension in ("obj", "mtl", "ies", "png"):
                    (self.folder / f"{name}.{extension}").symlink_to(self.folder / f"{name}.nff")
                self.write("library.obj", f"mtllib {name}.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
                for text in (f"scene: [{{mesh: {{file: {name}.obj}}}}]", "scene: [{mesh: {file: library.obj}}]",
                             f"textures: {{a: {{kind: image, file: {name}.png}}}}\nscene: []",
                             f"lights: [{{position: [0, 0, 1], ies: {name}.ies}}]\nscene: []"):
                    result = self.run_alone("check", self.write("s.yaml", view + text + "\n"), limit=20)
                    # A mesh can do without its library, and says so.
                    self.assertEqual(result.code, 0 if "library" in text else 3, result.stderr)
                    self.assertRegex(result.stderr, r"(s\.yaml:2|library\.obj:1):\d+: .*(not a regular file|is a folder)")
                result = self.run_alone("check", self.folder / f"{name}.nff", limit=20)
                self.assertEqual(result.code, 3, result.stderr)
                self.assertRegex(result.stderr, "not a regular file|is a folder")

    def test_too_little_memory_is_said(self):
        self.write("mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n" + "f 1 2 3\n" * 2_000_000)
        scene = self.write("s.yaml", "view: {location: [0, 0, 5], look_at: [0, 0, 0]}\nscene: [{mesh: {file: mesh.obj}}]\n")
        for limit in (100_000, 200_000):  # to load it, and to build the hierarchy
            result = subprocess.run(["bash", "-c", f'ulimit -v {limit}; exec "$@"', "bash", RAYFARM, "check", str(scene)],
                                    capture_output=True, text=True, env=ENVIRONMENT, timeout=60)
            self.assertEqual(result.returncode, 3, result.stderr)
            self.assertIn("more memory than there is", result.stderr)

    def test_info(self):
        result = self.run_alone("info", SCENE)
        self.assertEqual(result.code, 0)
        for text in ("spheres 7", "bounds", "object tree", "memory"):
            self.assertIn(text, result.stdout)

    def test_info_lists_clips_and_cameras(self):
        model = made_gltf.Maker()
        points = model.accessor([[0, 0, 0], [1, 0, 0], [0, 1, 0]])
        clips = []
        for name, seconds in (("walk", 1), ("run", 3)):
            times, places = model.accessor([0, seconds]), model.accessor([[0, 0, 0], [1, 0, 0]])
            model.json["accessors"][times] |= {"min": [0], "max": [seconds]}
            clips.append({"name": name, "samplers": [{"input": times, "output": places}],
                          "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}]})
        lens = {"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}}
        model.json |= {"animations": clips, "cameras": [lens], "meshes": [{"primitives": [{"attributes": {"POSITION": points}}]}],
                       "nodes": [{"mesh": 0}, {"name": "Front", "camera": 0, "translation": [0, 0, 5]},
                                 {"name": "Back", "camera": 0, "translation": [0, 0, 9]}]}
        path = model.write(self.folder / "clips.gltf")
        text = self.run_alone("info", path, "--clip", "run", "--camera", "1").stdout
        self.assertIn("  0 'walk': 1 s, frames 0 to 24 at 24 a second\n  1 'run': 3 s, frames 0 to 72 at 24 a second, the one that plays\n", text)
        self.assertRegex(text, r"cameras .*\n  0 'Front'\n  1 'Back': the view\n")
        scene = self.write("scene.yaml", "view: {location: [0, 0, 5], look_at: [0, 0, 0]}\nscene: [{mesh: {file: clips.gltf}}]\n")
        text = self.run_alone("info", scene, "--fps", "10").stdout
        self.assertIn(f"  1 'run': 3 s, frames 0 to 30 at 10 a second, of {path}\n", text)
        self.assertIn(f"  0 'Front', of {path}\n", text)

        # Frames outside of the clip are said once.
        output = ("-o", self.folder / "a.####.png", "--size", "8x8")
        result = self.run_alone("render", path, *output, "--frames", "20,200-201")
        self.assertEqual(result.code, 0, result.stderr)
        self.assertEqual(result.stderr.count("2 of 3 frames lie outside of the scene's, 0 to 24 (the first such is 200)"), 1, result.stderr)
        self.assertNotIn("outside of", self.run_alone("render", path, *output, "--frames", "0,24").stderr)

    def test_info_counts_polygons(self):
        """As the thesis's Table 4.3 does: a vase of 16 x 5 polygons, triangles at its ends, and copies."""
        scene = self.write("s.yaml", """
view: {location: [0, 0, 9], look_at: [0, 0, 0]}
objects: {vase: {lathe: {profile: [%s, [0, 16]], sides: 5}}}
scene: [{use: vase}, {use: vase, transform: {translate: [3, 0, 0]}}, {sphere: {center: [0, 0, 0], radius: 1}}]
""" % ", ".join(f"[{0 if y == 0 else 1 + y % 2}, {y}]" for y in range(16)))
        result = self.run_alone("info", scene)
        self.assertEqual(result.code, 0, result.stderr)
        for text in ("polygons 80 (triangles 10, of more corners 70), spheres 1, quadrics 0, stored once",
                     "polygons 160, spheres 1, quadrics 0, each copy counted", "vase: 80 polygons"):
            self.assertIn(text, result.stdout)

    def test_info_counts_zones(self):
        """Of a square of 10 x 10, one whose node asks for 2 x 2, a mirror, and a medium; and says why there are none."""
        square = "polygon: {points: [[%d, 0, 0], [%d, 0, 0], [%d, 1, 0], [%d, 1, 0]]}"
        squares = [square % (x, x + 1, x + 1, x) for x in (0, 2, 4)]
        scene = self.write("s.yaml", f"""
view: {{location: [0, 0, 9], look_at: [0, 0, 0]}}
materials: {{m: {{lambertian: 0.5}}, mirror: {{conductor: {{metal: silver}}}}}}
media: [{{box: {{min: [0, 2, 0], max: [0.8, 2.4, 0.2]}}, scattering: 1}}]
scene: [{{material: m, {squares[0]}}}, {{material: m, zones: 0.5, {squares[1]}}}, {{material: mirror, {squares[2]}}}]
""")
        result = self.run_alone("info", scene, "--zone-size", "0.1")
        self.assertEqual(result.code, 0, result.stderr)
        for text in ("zones of surfaces 204 with two sides each, of media 8\n", "each copy counted, 3; zones of 1 keep nothing\n",
                     "sums of power 216; zones that keep light by direction 0\n"):
            self.assertIn(text, result.stdout)
        refused = self.run_alone("info", scene, "--zone-size", "1e-6")
        self.assertEqual(refused.code, 0, refused.stderr)
        self.assertIn("  none: zones of size 1e-06 would be more than ", refused.stdout)

    def test_info_tells_how_often_volumes_refer_to_primitives(self):
        """Whole, divided with a budget of 1.3 on average, or of 2 (README, --build)."""
        random.seed(1)
        def point(reach):
            return [round(random.uniform(-reach, reach), 4) for _ in range(3)]
        beams = []
        for _ in range(400):
            a, b = point(9), point(9)
            beams.append([a, b, [a[0], round(a[1] + 0.05, 4), a[2]]])
        points = [p for beam in beams for p in beam]
        scene = self.write("s.yaml", f"""
view: {{location: [0, 0, 30], look_at: [0, 0, 0]}}
scene: [{{triangles: {{points: {points}, triangles: {[[3 * i, 3 * i + 1, 3 * i + 2] for i in range(400)]}}}}}]
""")
        each = {}
        for build in ("fast", "balanced", "high"):
            result = self.run_alone("info", scene, "--build", build)
            self.assertEqual(result.code, 0, result.stderr)
            each[build] = float(re.search(r"references of volumes to primitives \d+, ([\d.]+) each", result.stdout)[1])
        self.assertEqual(each["fast"], 1)
        self.assertTrue(1 < each["balanced"] <= 1.3 and each["balanced"] < each["high"] <= 2, each)

    def test_gouraud_says_what_a_model_does_with_it(self):
        scene = self.write("s.yaml", """
view: {location: [0, 0, 5], look_at: [0, 0, 0]}
lights: [{position: [0, 0, 5]}]
scene: [{lathe: {profile: [[1, -1], [1, 1]], sides: 8, smooth: gouraud}}]
""")
        for lighting, is_noted in (("whitted", False), ("path", True)):
            result = self.run_alone("render", scene, "-o", self.folder / "x.png", "--size", "8x8", "--lighting", lighting)
            self.assertEqual(result.code, 0, result.stderr)
            self.assertEqual("`smooth: gouraud` belongs to the classical" in result.stderr, is_noted, result.stderr)


if __name__ == "__main__":
    main()
