"""What users get wrong: each ends in a clear message and its own exit code, and leaves nothing behind."""
import os
import pathlib
import re
import socket
import subprocess

from rayfarm_job import ENVIRONMENT, JobTest, RAYFARM, SCENES, main

SCENE = SCENES / "primitives.yaml"
SMALL = ["--size", "64x48", "-q"]


class Usage(JobTest):
    def expect(self, code, *arguments, says=(), environment=None):
        result = self.run_alone(*arguments, environment=environment)
        self.assertEqual(result.code, code, result.stderr)
        for text in says:
            self.assertIn(text, result.stderr)
        self.assertEqual(self.leftovers(), [])
        return result

    def test_help_and_version(self):
        self.assertIn("render", self.run_alone("--help").stdout)
        self.assertRegex(self.run_alone("--version").stdout, r"rayfarm \d")

    def test_no_command_and_unknown_command(self):
        self.expect(2)
        self.expect(2, "rendr", SCENE)

    def test_unknown_option(self):
        self.expect(2, "render", SCENE, "-o", self.folder / "a.png", "--sample", "4")

    def test_wrong_values(self):
        for option, value, says in (("--size", "64", "WIDTHxHEIGHT"), ("--size", "70000x10", "65536"), ("--size", "0x9", "65536"),
                                    ("--samples", "0", "samples"), ("--lighting", "fong", "torrance-sparrow|whitted"),
                                    ("--frames", "9-1", "before"), ("--frames", "x", "frame number"),
                                    ("--frames", "1-3", "####"), ("--crop", "1,2,3", "x0,x1,y0,y1"), ("--max-depth", "0", "max-depth")):
            self.expect(2, "render", SCENE, "-o", self.folder / "a.png", option, value, says=[says])

    def test_crop_outside(self):
        self.expect(2, "render", SCENE, "-o", self.folder / "a.png", "--size", "64x48", "--crop", "0,65,0,10", says=["64×48"])

    def test_output_names(self):
        self.expect(2, "render", SCENE, "-o", self.folder / "a.jpg", says=[".exr or .png"])
        self.expect(2, "render", SCENE, "-o", self.folder / "no" / "a.png", says=["there is no folder"])
        self.expect(2, "render", SCENE, "-o", self.folder / "a.png", "--stats", self.folder / "no" / "s.json", says=["there is no folder"])

    def test_pixel_wire_needs_rgb8(self):
        self.expect(2, "render", SCENE, "-o", self.folder / "a.png", "--wire", "pixel", "--pixel-format", "half", says=["rgb8"])

    def test_corner_sampling_takes_one_ray(self):
        self.expect(2, "render", SCENE, "-o", self.folder / "a.png", "--sampling", "corners", "--samples", "4")

    def test_patterns_that_do_not_fit(self):
        self.expect(2, "render", SCENE, "-o", self.folder / "a.png", "--sampling", "corners", "--filter", "tent", says=["corners"])
        self.expect(2, "render", SCENE, "-o", self.folder / "a.png", "--sampling", "poisson", "--samples", "2000", says=["1024"])

    def test_impossible_material(self):
        scene = self.write("impossible.yaml", "view: {location: [0, 0, 5], look_at: [0, 0, 0]}\nmaterials: {m: {lambertian: 1.5}}\nscene: []\n")
        self.expect(3, "render", scene, "-o", self.folder / "a.png", says=["impossible.yaml:2:", "1.5 times the light"])

    def test_missing_scene(self):
        self.expect(3, "render", self.folder / "no.yaml", "-o", self.folder / "a.png", says=["no such file"])
        self.expect(3, "check", self.folder, says=["unknown scene format"])

    def test_scene_error_has_a_place(self):
        scene = self.write("bad.yaml", "view: {location: [0, 0, 5], look_at: [0, 0, 0]}\nscene:\n  - spehre: {center: [0, 0, 0], radius: 1}\n")
        self.expect(3, "check", scene, says=[f"{scene}:3:5:", "did you mean 'sphere'?"])

    def test_scene_error_under_mpirun(self):
        scene = self.write("bad.yaml", "view: 1\nscene: []\n")
        result = self.run_farm(3, "render", scene, "-o", self.folder / "a.png")
        self.assertNotEqual(result.code, 0)
        self.assertIn("bad.yaml:1:7", result.stderr)
        self.assertLess(result.seconds, 20)

    def test_lone_slurm_task(self):
        self.expect(2, "render", SCENE, "-o", self.folder / "a.png", says=["srun --mpi=pmix"],
                    environment=ENVIRONMENT | {"SLURM_NTASKS": "4"})


class Output(JobTest):
    def test_exr_and_png_from_one_scene(self):
        for name in ("a.exr", "a.png"):
            self.assertEqual(self.run_alone("render", SCENE, "-o", self.folder / name, *SMALL).code, 0)
        self.assertEqual(self.run_alone("compare", self.folder / "a.exr", self.folder / "a.exr").code, 0)
        self.assertEqual(self.run_alone("compare", self.folder / "a.exr", self.folder / "a.png").code, 1)

    def test_full_disk(self):
        # /dev/full can't hold a rename; a tiny file-size limit fails the write in the same place as a full disk.
        result = subprocess.run(["bash", "-c", 'trap "" XFSZ; ulimit -f 1; exec "$@"', "bash", RAYFARM, "render", str(SCENE), "-o",
                                 str(self.folder / "a.png"), "--size", "256x256", "-q"], capture_output=True, text=True, env=ENVIRONMENT, timeout=60)
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertIn("can't be written", result.stderr)
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_skip_existing(self):
        arguments = ["render", SCENE, "-o", self.folder / "f.##.png", "--frames", "3-4", "--skip-existing", "--size", "32x24"]
        self.assertEqual(self.run_alone(*arguments).code, 0)
        second = self.folder / "f.04.png"
        second.unlink()
        first = (self.folder / "f.03.png").stat().st_mtime_ns
        self.assertEqual(self.run_alone(*arguments).code, 0)
        self.assertEqual((self.folder / "f.03.png").stat().st_mtime_ns, first)
        self.assertTrue(second.exists())

    def test_results_on_stdout(self):
        result = self.run_alone("render", SCENE, "-o", self.folder / "a.png", "--size", "32x24")
        self.assertEqual(result.stdout, f"{self.folder / 'a.png'}\n")
        self.assertIn("bytes per pixel", result.stderr)

    def test_statistics_keys(self):
        stats = self.render(3, SCENE, "--size", "64x48")
        self.assertLessEqual({"width", "height", "sha256_pixels"}, stats["image"].keys())
        self.assertEqual(stats["ranks"], 3)
        self.assertEqual(stats["nodes_lost"], [])
        self.assertEqual(set(stats["rays"]), {"primary", "shadow", "reflected", "transmitted", "diffuse"})
        for command in ("load_code", "load_data", "load_display_polygon", "return_result"):
            self.assertEqual(set(stats["traffic"][command]), {"messages", "bytes"})
            self.assertGreater(stats["traffic"][command]["bytes"], 0)
        self.assertEqual(set(stats["time_s"]), {"load", "build", "broadcast", "trace", "write", "total", "trace_began_unix", "host_cpu"})
        self.assertEqual([n["id"] for n in stats["nodes"]], [1, 2])
        self.assertEqual(sum(n["subpolygons"] for n in stats["nodes"]), stats["subpolygons"]["columns"] * stats["subpolygons"]["rows"])
        for key in ("subpolygons", "rays", "busy_s", "idle_s"):
            self.assertIn(key, stats["nodes"][0])


class Builds(JobTest):
    def test_a_node_of_another_build_is_refused(self):
        # The same program with another build id in its note, as another compilation would have.
        other = self.folder / "rayfarm-other"
        notes = subprocess.run(["readelf", "-n", RAYFARM], capture_output=True, text=True, check=True).stdout
        build = bytes.fromhex(re.search(r"Build ID: ([0-9a-f]+)", notes).group(1))
        other.write_bytes(pathlib.Path(RAYFARM).read_bytes().replace(build, bytes(255 - b for b in build)))
        other.chmod(0o755)
        arguments = ["render", str(SCENE), "-o", str(self.folder / "a.png"), *SMALL]
        result = subprocess.run(["mpirun", "-n", "2", RAYFARM, *arguments, ":", "-n", "1", str(other), *arguments],
                                capture_output=True, text=True, env=ENVIRONMENT, timeout=60)
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertIn("another build", result.stderr)
        self.assertFalse((self.folder / "a.png").exists())


class Experiments(JobTest):
    def test_lighting_writes_its_page(self):
        result = self.run_alone("experiment", "lighting", "-o", self.folder / "page", "--scenes", SCENES, "--width", "24")
        self.assertEqual(result.code, 0, result.stderr)
        rows = (self.folder / "page" / "lighting.csv").read_text().splitlines()
        self.assertEqual(len(rows), 14)
        ratio = {row.split(",")[0]: float(row.split(",")[10]) for row in rows[1:]}
        self.assertGreater(ratio["plate_3_1b"], 1.5)  # one diffuse ray and its shadow ray for each that meets a wall
        self.assertLess(ratio["plate_3_1b"], 2.1)
        page = (self.folder / "page" / "README.md").read_text()
        for row in rows[1:]:
            self.assertIn(f"![{row.split(',')[0]}]", page)
            self.assertTrue((self.folder / "page" / f"{row.split(',')[0]}.png").exists())

    def test_missing_scenes_and_names(self):
        result = self.run_alone("experiment", "lighting", "-o", self.folder / "page", "--scenes", self.folder / "none")
        self.assertEqual(result.code, 3, result.stderr)
        self.assertIn("goral_room.yaml", result.stderr)
        self.assertEqual(self.run_alone("experiment", "lightning").code, 2)


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
        scene = self.write("scenes/s.yaml", "view: {location: [0, 0, 5], look_at: [0, 0, 0]}\nscene:\n  - mesh: {file: ../tri.obj}\n")
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
                    self.assertEqual(result.code, 3, result.stderr)
                    self.assertRegex(result.stderr, r"(s\.yaml:2|library\.obj:1):\d+: .*(not a regular file|is a folder)")
                result = self.run_alone("check", self.folder / f"{name}.nff", limit=20)
                self.assertEqual(result.code, 3, result.stderr)
                self.assertRegex(result.stderr, "not a regular file|is a folder")

    def test_too_little_memory_is_said(self):
        self.write("mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n" + "f 1 2 3\n" * 2_000_000)
        scene = self.write("s.yaml", "view: {location: [0, 0, 5], look_at: [0, 0, 0]}\nscene: [{mesh: {file: mesh.obj}}]\n")
        result = subprocess.run(["bash", "-c", 'ulimit -v 150000; exec "$@"', "bash", RAYFARM, "check", str(scene)],
                                capture_output=True, text=True, env=ENVIRONMENT, timeout=60)
        self.assertEqual(result.returncode, 3, result.stderr)
        self.assertIn("more memory than there is", result.stderr)

    def test_info(self):
        result = self.run_alone("info", SCENE)
        self.assertEqual(result.code, 0)
        for text in ("spheres 7", "bounds", "object tree", "memory"):
            self.assertIn(text, result.stdout)


if __name__ == "__main__":
    main()
