"""What a render leaves behind: pictures, statistics and reports, and what it says of them where they can not be written."""
import json
import pathlib
import re
import subprocess

from rayfarm_job import ENVIRONMENT, JobTest, RAYFARM, SCENES, main

SCENE = SCENES / "primitives.yaml"
SMALL = ["--size", "64x48", "-q"]


class Output(JobTest):
    def test_exr_and_png_from_one_scene(self):
        for name in ("a.exr", "a.png"):
            self.assertEqual(self.run_alone("render", SCENE, "-o", self.folder / name, *SMALL).code, 0)
        self.assertEqual(self.run_alone("compare", self.folder / "a.exr", self.folder / "a.exr").code, 0)
        mixed = self.run_alone("compare", self.folder / "a.exr", self.folder / "a.png")
        self.assertEqual(mixed.code, 1)
        self.assertIn("linear light", mixed.stderr)

    def test_full_disk(self):
        # /dev/full can't hold a rename; a tiny file-size limit fails the write in the same place as a full disk.
        result = subprocess.run(["bash", "-c", 'trap "" XFSZ; ulimit -f 1; exec "$@"', "bash", RAYFARM, "render", str(SCENE), "-o",
                                 str(self.folder / "a.png"), "--size", "256x256", "-q"], capture_output=True, text=True, env=ENVIRONMENT, timeout=60)
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertIn("can't be written: File too large", result.stderr)
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

    def skip_existing(self, *arguments, scene=SCENE):
        result = self.run_alone("render", scene, "-o", self.folder / "f.##.png", "--frames", "3-4", "--skip-existing", "--size", "32x24",
                                *arguments)
        self.assertEqual(result.code, 0, result.stderr)
        return result

    def test_skip_existing_knows_what_is_not_the_picture(self):
        scene = self.write("s.yaml", SCENE.read_text())
        self.skip_existing(scene=scene)
        first, second = self.folder / "f.03.png", self.folder / "f.04.png"
        good = first.read_bytes()
        self.assertEqual(self.skip_existing(scene=scene).stdout, "")
        other_size = self.folder / "small.png"
        self.assertEqual(self.run_alone("render", scene, "-o", other_size, "--size", "16x12", "-q").code, 0)
        damaged = bytearray(good)
        damaged[len(good) * 3 // 4] ^= 255
        foreign = subprocess.run(["oiiotool", "--create", "32x24", "3", "-o", str(self.folder / "foreign.png")], capture_output=True, timeout=30)
        self.assertEqual(foreign.returncode, 0, foreign.stderr)
        for content, says in ((good[:len(good) // 2], "not a whole picture"), (b"", "not a whole picture"), (bytes(damaged), "not a whole picture"),
                              (other_size.read_bytes(), "16×12"), (second.read_bytes(), "another frame"),
                              ((self.folder / "foreign.png").read_bytes(), "does not say")):
            first.write_bytes(content)
            result = self.skip_existing(scene=scene)
            self.assertIn(says, result.stderr)
            self.assertEqual(result.stdout, f"{first}\n")
            self.assertEqual(first.read_bytes(), good)
        result = self.skip_existing("--samples", "2", scene=scene)
        self.assertIn("other settings", result.stderr)
        self.assertEqual(len(result.stdout.splitlines()), 2)
        scene.write_text(scene.read_text().replace("background: [0, 0, 0]", "background: [0.1, 0, 0]"))
        self.assertIn("another scene", self.skip_existing("--samples", "2", scene=scene).stderr)

    def test_skip_existing_reads_exr(self):
        arguments = ["render", SCENE, "-o", self.folder / "a.exr", "--skip-existing", *SMALL]
        self.assertNotEqual(self.run_alone(*arguments).stdout, "")
        self.assertEqual(self.run_alone(*arguments).stdout, "")
        whole = (self.folder / "a.exr").read_bytes()
        (self.folder / "a.exr").write_bytes(whole[:-100])
        self.assertNotEqual(self.run_alone(*arguments).stdout, "")

    def with_shell(self, redirection, *arguments):
        return subprocess.run(["bash", "-c", f'exec "$@" {redirection}', "bash", RAYFARM, "render", str(SCENE), "-o", str(self.folder / "a.png"),
                               "--size", "64x48", *map(str, arguments)], capture_output=True, text=True, env=ENVIRONMENT, timeout=60)

    def test_text_that_can_not_be_told_costs_no_picture(self):
        for redirection in ("2>&-", "2>/dev/full", "2> >(head -c 1 >/dev/null)"):
            (self.folder / "a.png").unlink(missing_ok=True)
            done = self.with_shell(redirection)
            self.assertEqual(done.returncode, 0, redirection)
            self.assertEqual(done.stdout, f"{self.folder / 'a.png'}\n")
            self.assertTrue((self.folder / "a.png").exists())

    def test_texts_are_never_written_into_a_picture(self):
        # With stderr closed the next file that is opened would take its place.
        self.assertEqual(self.with_shell("").returncode, 0)
        expected = (self.folder / "a.png").read_bytes()
        for redirection in ("2>&-", "0<&- 2>&-", "0<&- 1>&- 2>&-"):
            (self.folder / "a.png").unlink()
            done = self.with_shell(redirection, "-v", "--progress", "tty")
            self.assertEqual(done.returncode, 1 if "1>" in redirection else 0, redirection)
            self.assertEqual((self.folder / "a.png").read_bytes(), expected, redirection)

    def test_tables_that_can_not_be_told_are_an_error(self):
        for arguments in (["check", str(SCENE)], ["info", str(SCENE)], ["model", "--preset", "thesis"]):
            done = subprocess.run(["bash", "-c", 'exec "$@" >/dev/full', "bash", RAYFARM, *arguments], capture_output=True, text=True, timeout=60)
            self.assertEqual(done.returncode, 1, arguments)
            self.assertIn("can't be printed on stdout", done.stderr)

    def test_names_that_can_not_be_told_are_an_error(self):
        done = self.with_shell(">/dev/full")
        self.assertEqual(done.returncode, 1)
        self.assertIn("can't be printed on stdout", done.stderr)
        self.assertTrue((self.folder / "a.png").exists())

    def test_statistics_that_fail_hide_no_frame(self):
        stats = self.folder / "stats"
        stats.mkdir()
        process = subprocess.Popen([RAYFARM, "render", str(SCENE), "-o", str(self.folder / "a.png"), "--size", "320x240", "--samples", "64",
                                    "--stats", str(stats / "s.json"), "-v"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        while "tracing begins" not in process.stderr.readline():
            self.assertIsNone(process.poll())
        stats.rmdir()
        stats.write_text("")  # no folder any more: nothing can be written in it
        out, err = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 1, err)
        self.assertEqual(out, f"{self.folder / 'a.png'}\n")
        self.assertIn("s.json", err)

    def test_threads_that_are_refused(self):
        # Stacks so large that the limit on address space holds a few of them.
        reference = self.render(1, SCENE, "--size", "64x48")["image"]["sha256_pixels"]
        stats = self.folder / "few.json"
        done = subprocess.run(["bash", "-c", 'ulimit -s 1000000; ulimit -v 5000000; exec "$@"', "bash", RAYFARM, "render", str(SCENE), "-o",
                               str(self.folder / "few.png"), "--size", "64x48", "--local-nodes", "8", "--stats", str(stats)],
                              capture_output=True, text=True, env=ENVIRONMENT, timeout=60)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("refuses 8 threads", done.stderr)
        self.assertEqual(json.loads(stats.read_text())["image"]["sha256_pixels"], reference)

    def test_the_report_is_short_unless_asked_for(self):
        short = self.run_alone("render", SCENE, "-o", self.folder / "a.png", "--size", "32x24", "--progress", "none").stderr
        self.assertLessEqual(len(short.splitlines()), 10)
        for word in ("picture", "time", "rays", "speed"):
            self.assertIn(word, short)
        full = self.run_alone("render", SCENE, "-o", self.folder / "a.png", "--size", "32x24", "--progress", "none", "--report", "full").stderr
        for word in ("load_display_polygon", "subpolygons", "busy"):
            self.assertIn(word, full)

    def test_the_model_knows_the_scene_of_a_render_without_mpirun(self):
        tables = []
        for ranks in (1, 3):
            stats = self.folder / f"{ranks}.json"
            self.render(ranks, SCENE, "--size", "64x48").keys()
            (self.folder / "stats.json").rename(stats)
            model = json.loads(self.run_alone("model", "--stats", stats, "--processors", "8", "--format", "json").stdout)
            tables.append(json.dumps(model))
            self.assertGreater(json.loads(stats.read_text())["scene"]["bytes"], 10000)
        data = [re.search(r'"data_s": ([0-9.e-]+)', table).group(1) for table in tables]
        self.assertAlmostEqual(float(data[0]) / float(data[1]), 1, delta=0.01)
        self.assertGreater(float(data[0]), 0)

    def test_black_pictures_say_why(self):
        result = self.run_alone("render", SCENE, "-o", self.folder / "a.png", "--size", "32x24", "--lighting", "whitted", "-q")
        self.assertNotIn("black", result.stderr)
        away = self.write("away.yaml", "view: {location: [0, 0, 5], direction: [0, 0, 1]}\nlights: [{position: [0, 9, 9], color: 1}]\n"
                                       "scene: [{sphere: {center: [0, 0, 0], radius: 1}}]\n")
        result = self.run_alone("render", away, "-o", self.folder / "a.png", "--size", "32x24", "--progress", "none")
        self.assertEqual(result.code, 0, result.stderr)
        self.assertIn("the camera sees nothing", result.stderr)
        dark = self.write("dark.yaml", "view: {location: [0, 0, 5], look_at: [0, 0, 0]}\nambient: 0\nlights: []\n"
                                       "scene: [{sphere: {center: [0, 0, 0], radius: 1}}]\n")
        result = self.run_alone("render", dark, "-o", self.folder / "a.png", "--size", "32x24", "--progress", "none")
        self.assertIn("every pixel is black", result.stderr)

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
        self.assertEqual(set(stats["time_s"]), {"load", "build", "broadcast", "trace", "write", "finish", "total", "trace_began_unix", "host_cpu"})
        self.assertEqual([n["id"] for n in stats["nodes"]], [1, 2])
        self.assertEqual(stats["subpolygons"], {"columns": 8, "rows": 6})
        self.assertEqual(sum(n["subpolygons"] for n in stats["nodes"]), 8 * 6)
        # Where subpolygons are small, those that are handed out first are larger.
        stats = self.render(3, SCENE, "--size", "160x120")
        cut = stats["subpolygons"]
        self.assertEqual(sum(n["subpolygons"] for n in stats["nodes"]), cut["columns"] * cut["rows"] + cut["small_columns"] * cut["small_rows"])
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


if __name__ == "__main__":
    main()
