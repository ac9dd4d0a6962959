"""What users get wrong: each ends in a clear message and its own exit code, and leaves nothing behind."""
import json
import os
import pathlib
import random
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
        self.expect(2, "rendr", SCENE, says=["did you mean 'render'?"])

    def test_unknown_option(self):
        self.expect(2, "render", SCENE, "-o", self.folder / "a.png", "--sample", "4", says=["did you mean '--samples'?"])
        self.expect(2, "render", SCENE, "-o", self.folder / "a.png", "--ligthing=path", says=["did you mean '--lighting'?"])

    def test_help_shows_nothing_of_the_parser(self):
        for command in ("render", "check", "info", "compare", "experiment", "model", "simulate"):
            text = self.run_alone(command, "--help").stdout
            self.assertNotRegex(text, r"[\x00-\x09\x0b-\x1f]|\{|->|UINT|FLOAT|:INT", command)
        text = self.run_alone("render", "--help").stdout
        for title in ("Picture:", "Sampling:", "Light:", "Nodes and net:", "Messages:"):
            self.assertIn(title, text)
        self.assertNotIn("\nOptions:\n  --", text)
        self.assertIn("bus|switch", self.run_alone("simulate", "--help").stdout)

    def test_outputs_need_names_of_their_own(self):
        same = self.folder / "same.png"
        self.expect(2, "render", SCENE, "-o", same, "--stats", same, says=["names the same file"])
        self.expect(2, "render", SCENE, "-o", same, "--stats", self.folder / "." / "s.json", "--cost-map", self.folder / "s.json",
                    says=["names the same file"])
        self.expect(2, "render", SCENE, "-o", self.folder / "f.##.png", "--frames", "1", "--stats", self.folder / "f.01.png", *SMALL,
                    says=["name of its own"])
        scene = self.write("scene.yaml", SCENE.read_text())
        self.expect(2, "render", scene, "-o", same, "--stats", scene, says=["the scene itself"])
        self.assertEqual(scene.read_text(), SCENE.read_text())
        self.assertFalse(same.exists())

    def test_adaptive_does_not_suit_paths(self):
        self.expect(2, "render", SCENE, "-o", self.folder / "a.png", "--adaptive", "0.1", "--samples", "4", "--lighting", "path",
                    says=["whitted and thesis"])

    def test_a_frame_larger_than_memory(self):
        result = self.expect(1, "render", SCENE, "-o", self.folder / "a.exr", "--size", "65536x65536", "--pixel-format", "float",
                             says=["48.00 GiB", "--crop"])
        self.assertLess(result.seconds, 20)

    def test_wrong_values(self):
        for option, value, says in (("--size", "64", "WIDTHxHEIGHT"), ("--size", "70000x10", "65536"), ("--size", "0x9", "65536"),
                                    ("--samples", "0", "samples"), ("--lighting", "fong", "torrance-sparrow|whitted"),
                                    ("--frames", "9-1", "before"), ("--frames", "x", "frame number"),
                                    ("--frames", "1-3", "####"), ("--crop", "1,2,3", "x0,x1,y0,y1"), ("--max-depth", "0", "max-depth"),
                                    ("--processor-time", "nan", "not a number"), ("--shutter", "nan", "--shutter"),
                                    ("--node-timeout", "nan", "not a number"), ("--seed", "-1", "whole number"), ("--seed", "18446744073709551616", "whole number"),
                                     ("--processor-times", "1,nan", "not a number")):
            self.expect(2, "render", SCENE, "-o", self.folder / "a.png", option, value, says=[says])

    def test_wavelengths_of_colour(self):
        for value, says in (("spectra", "did you mean 'spectral'?"), ("meyer4:3", "spectral:N"), ("spectral:", "after the colon"),
                            ("spectral:400,x", "after the colon"), ("spectral:3", "from 4 to 500"), ("spectral:501", "from 4 to 500"),
                            ("spectral:4.5", "from 4 to 500"), ("spectral:500,400,600", "must rise"),
                            ("spectral:400,410,420", "tell red, green and blue apart"), ("spectral:100,500,600", "from 380 to 730")):
            self.expect(2, "render", SCENE, "-o", self.folder / "a.png", "--colour", value, says=[says])

    def test_spectra_in_rgb_are_noted(self):
        chart = SCENES / "chart.yaml"
        note = "--colour rgb takes the red, green and blue"
        self.expect(0, "render", chart, "-o", self.folder / "a.png", "--size", "6x4", says=[note])
        result = self.expect(0, "render", chart, "-o", self.folder / "a.png", "--size", "6x4", "--colour", "meyer4")
        self.assertNotIn(note, result.stderr)

    def test_crop_outside(self):
        self.expect(2, "render", SCENE, "-o", self.folder / "a.png", "--size", "64x48", "--crop", "0,65,0,10", says=["64×48"])

    def test_output_names(self):
        self.expect(2, "render", SCENE, "-o", self.folder / "a.jpg", says=[".exr or .png"])
        self.expect(2, "render", SCENE, "-o", self.folder / "no" / "no" / "a.png", says=["there is no folder"])
        self.expect(2, "render", SCENE, "-o", self.folder / "a.png", "--stats", self.folder / "no" / "no" / "s.json", says=["there is no folder"])
        self.write("file", "")
        self.expect(2, "render", SCENE, "-o", self.folder / "file" / "a.png", says=["is not a folder"])
        self.expect(2, "render", SCENE, "-o", self.folder / "a.png", "--stats", self.folder, says=["is a folder"])
        self.expect(3, "render", self.folder / "no.yaml", "-o", self.folder / "new" / "a.png")
        self.assertFalse((self.folder / "new").exists(), "nothing is made for a job that can't begin")

    def test_an_output_folder_is_made_in_one_that_is_there(self):
        self.expect(0, "render", SCENE, "-o", self.folder / "new" / "a.png", "--stats", self.folder / "new" / "s.json", *SMALL)
        self.assertEqual(sorted(p.name for p in (self.folder / "new").iterdir()), ["a.png", "s.json"])

    def test_pixel_wire_needs_rgb8(self):
        self.expect(2, "render", SCENE, "-o", self.folder / "a.png", "--wire", "pixel", "--pixel-format", "half", says=["rgb8"])

    def test_corner_sampling_takes_one_ray(self):
        self.expect(2, "render", SCENE, "-o", self.folder / "a.png", "--sampling", "corners", "--samples", "4", says=["--subpixels"])

    def test_subpixels(self):
        corners = ["render", SCENE, "-o", self.folder / "a.png", *SMALL, "--sampling", "corners"]
        self.expect(2, "render", SCENE, "-o", self.folder / "a.png", "--subpixels", "2x2", says=["--sampling corners"])
        self.expect(2, "render", SCENE, "-o", self.folder / "a.png", "--subpixels", "1x1", "--samples", "4", says=["--sampling corners"])
        for wrong, says in (("2", "COLUMNSxROWS"), ("2x", "COLUMNSxROWS"), ("2x2x2", "COLUMNSxROWS"), ("0x2", "1 to 64"), ("2x65", "1 to 64")):
            self.expect(2, *corners, "--subpixels", wrong, says=[says])
        self.expect(2, *corners, "--lighting", "thesis", "--subpixels", "64x64", "--diffuse-rays", "1000", says=["--subpixels"])
        self.assertFalse((self.folder / "a.png").exists())
        self.expect(0, *corners, "--subpixels", "2x3")

    def test_patterns_that_do_not_fit(self):
        self.expect(2, "render", SCENE, "-o", self.folder / "a.png", "--sampling", "corners", "--filter", "tent", says=["corners"])
        self.expect(2, "render", SCENE, "-o", self.folder / "a.png", "--sampling", "poisson", "--samples", "2000", says=["1024"])

    def test_a_light_without_a_direction(self):
        scene = self.write("none.yaml", "view: {location: [0, 0, 5], look_at: [0, 0, 0]}\nlights: [{direction: [0, 0, 0]}]\nscene: []\n")
        self.expect(3, "check", scene, says=["none.yaml:2:", "must not be the zero vector"])

    def test_limits_of_the_lighting_tree(self):
        def limited(*arguments):
            return ("render", SCENE, "-o", self.folder / "a.png", *arguments)
        self.expect(2, *limited("--max-depth", "5", "--max-reflections", "5"), says=["can't be reached", "has 4 rays"])
        self.expect(2, *limited("--lighting", "path", "--max-transmissions", "100"), says=["a tree of depth 100"])
        self.expect(2, *limited("--max-reflections", "600", "--max-transmissions", "600"), says=["depth 1201, more than 1000"])
        self.expect(2, *limited("--max-reflections", "-1"), says=["max-reflections"])

        def rays(*arguments):
            stats = self.folder / "s.json"
            self.expect(0, *limited("--size", "32x24", "-q", "--stats", stats, *arguments))
            return json.loads(stats.read_text())["rays"]
        # Thesis 2.3.4: "after about four or five reflections or about seven transparent objects".
        usual = rays()
        self.assertEqual(usual, rays("--max-reflections", "4", "--max-transmissions", "7", "--max-depth", "12"))
        self.assertEqual(rays("--max-depth", "30"), rays("--max-reflections", "29", "--max-transmissions", "29", "--max-depth", "30"))
        self.assertEqual(rays("--max-reflections", "0", "--max-transmissions", "0"), rays("--max-depth", "1"))
        self.assertEqual(rays("--max-reflections", "0")["reflected"], 0)
        none = rays("--max-transmissions", "0")
        self.assertEqual(none["transmitted"], 0)
        self.assertGreater(none["reflected"], 0)
        self.assertGreater(usual["transmitted"], 0)

    def test_options_that_do_nothing_are_said(self):
        self.expect(0, "render", SCENE, "-o", self.folder / "a.png", "--lighting", "phong", "--max-reflections", "3", "--min-weight", "0.1",
                    "--size", "16x12", "--progress", "none", says=["beyond what the eye sees", "--min-weight belongs"])
        small = ["--size", "16x12", "--progress", "none"]
        result = self.expect(0, "render", SCENE, "-o", self.folder / "a.png", "--diffuse-jitter", "--no-rotation", *small,
                             says=["--lighting thesis, and do nothing", "--assign interleaved, and does nothing"])
        for option in (["--diffuse-bands", "cone"], ["--diffuse-set", "fixed"]):
            self.expect(0, "render", SCENE, "-o", self.folder / "a.png", *option, *small, says=["--lighting thesis, and do nothing"])
        result = self.expect(0, "render", SCENE, "-o", self.folder / "a.png", "--diffuse-rays", "3", "--lighting", "thesis", "--no-rotation",
                             "--assign", "interleaved", *small)
        self.assertNotIn("nothing", result.stderr)

    def test_options_of_light_that_do_nothing_are_said(self):
        picture = ["-o", self.folder / "a.png", "--size", "16x12", "--progress", "none"]
        many = ["--reflected-rays", "3", "--transmitted-rays", "2"]
        through = ["--glass-shadows", "transparent", "--ambient-colour", "light"]
        self.expect(0, "render", SCENE, *picture, "--lighting", "phong", *many, says=["--lighting whitted and thesis, and do nothing"])
        self.expect(0, "render", SCENE, *picture, "--lighting", "path", *through,
                    says=["--glass-shadows does nothing in --lighting path", "--ambient-colour belongs to --lighting phong"])
        plain = self.write("plain.yaml", "view: {location: [0, 0, 5], look_at: [0, 0, 0]}\nscene: [{sphere: {center: [0, 0, 0], radius: 1}}]\n")
        self.expect(0, "render", plain, *picture, *many, *through,
                    says=["no material that reflects has an `exponent`", "no material that transmits has an `exponent`",
                          "no material transmits light"])
        result = self.expect(0, "render", SCENES / "gloss.yaml", *picture, *many, *through)
        self.assertNotIn("nothing", result.stderr)
        self.expect(2, "render", SCENE, *picture, "--reflected-rays", "1001", says=["--reflected-rays", "1000"])
        self.expect(2, "render", SCENE, *picture, "--glass-shadows", "no", says=["blocked", "transparent"])

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
        self.assertEqual(len(rows), 16)
        cells = {row.split(",")[0]: dict(zip(rows[0].split(","), row.split(","))) for row in rows[1:]}
        ratio = {name: float(row["rays_ratio"]) for name, row in cells.items()}
        self.assertGreater(ratio["plate_3_1b"], 1.5)  # one diffuse ray and its shadow ray for each that meets a wall
        self.assertLess(ratio["plate_3_1b"], 2.1)
        # Thesis 3.5.1: 4, 9 and 25 directions a pixel by oversampling of 1, 4 and 16; (a w + 1)(b h + 1) rays through corners.
        self.assertEqual([cells[f"plate_3_{plate}"]["directions"] for plate in ("3b", "4a", "4b")], ["4", "9", "25"])
        self.assertEqual([int(cells[f"plate_3_{plate}"]["primary"]) for plate in ("3b", "4a", "4b")], [25 * 19, 49 * 37, 97 * 73])
        errors = [row.split(",") for row in (self.folder / "page" / "error.csv").read_text().splitlines()[1:]]
        for layout in ("thesis", "turned"):  # 3.5.1: errors fall with the rays
            rms = [float(row[5]) for row in errors if row[0] == layout]
            self.assertEqual(len(rms), 7)
            self.assertGreater(rms[0], 3 * rms[-1])
        page = (self.folder / "page" / "README.md").read_text()
        bands = re.search(r"sin² 45° = 0.5 \| ([0-9.]+) \| 1 - cos⁴ 45° = 0.75 \| ([0-9.]+)", page)  # 3.3
        self.assertAlmostEqual(float(bands[1]), 0.5, delta=0.01)
        self.assertAlmostEqual(float(bands[2]), 0.75, delta=0.01)
        for section in ("The time of Plate 3.1b", "Errors over rays", "Bands of light", "ball of light without"):
            self.assertIn(section, page)
        self.assertFalse((self.folder / "page" / "scratch").exists())
        for row in rows[1:]:
            self.assertIn(f"![{row.split(',')[0]}]", page)
            self.assertTrue((self.folder / "page" / f"{row.split(',')[0]}.png").exists())

    def test_depth_writes_its_page(self):
        # Thesis 2.3.4: what is missing behind four or five reflections and seven transparent objects.
        result = self.run_alone("experiment", "depth", "-o", self.folder / "page", "--scenes", SCENES, "--width", "20")
        self.assertEqual(result.code, 0, result.stderr)
        rows = [row.split(",") for row in (self.folder / "page" / "depth.csv").read_text().replace('"4 and 7, the default"', "default").splitlines()]
        self.assertEqual(len(rows), 2 + 3 * (3 * 14 + 7))
        rms = {tuple(row[:3]): float(row[6]) for row in rows[2:]}
        for scene, series in (("mirrors", "reflections"), ("glass", "transmissions"), ("both", "reflections"), ("both", "transmissions")):
            errors = [rms[series, str(n), scene] for n in (0, 4, 7, 14)]
            self.assertEqual(errors, sorted(errors, reverse=True))
            self.assertLess(errors[-1], 0.1 * errors[0])
        self.assertEqual(rms["transmissions", "0", "mirrors"], 0)
        self.assertLess(rms["together", "default", "both"], rms["together", "--max-depth 5", "both"])
        page = (self.folder / "page" / "README.md").read_text()
        self.assertRegex(page, r"\| 7 \| [0-9.e-]+ \| [0-9.]+ % \| [01]\.\d{3} \|")
        for scene in ("mirrors", "glass", "both"):
            self.assertIn(f"![{scene}]({scene}.png)", page)
            self.assertTrue((self.folder / "page" / f"{scene}.png").exists())

    def test_sampling_writes_its_page(self):
        # Shirley, Sung and Brown 1991, 2.2.1: errors by pattern and number of samples.
        result = self.run_alone("experiment", "sampling", "-o", self.folder / "page", "--scenes", SCENES, "--width", "12", "--samples", "8", "--seeds", "2")
        self.assertEqual(result.code, 0, result.stderr)
        rows = [row.split(",") for row in (self.folder / "page" / "sampling.csv").read_text().splitlines()]
        self.assertEqual(len(rows), 2 + 6 * 7 * 4)
        rms = {(row[0], row[1], int(row[2])): float(row[3]) for row in rows[2:]}
        self.assertTrue(all(0 < error < 2 for error in rms.values()))
        for scene in ("edges_upright", "soft_shadow", "gloss", "depth_of_field"):
            for pattern in ("n-rooks", "sobol"):
                self.assertLess(rms[scene, pattern, 8], 0.8 * rms[scene, pattern, 1], (scene, pattern))
        page = (self.folder / "page" / "README.md").read_text()
        self.assertIn("of 18 cases here", page)
        self.assertRegex(page, r"\| 8 \|( \d\.\d\de[+-]\d\d ± \d+ % \|){7}")
        self.assertEqual(self.run_alone("experiment", "depth", "--seeds", "3").code, 2)

    def test_colour_writes_its_page(self):
        result = self.run_alone("experiment", "colour", "-o", self.folder / "page", "--scenes", SCENES, "--width", "8")
        self.assertEqual(result.code, 0, result.stderr)
        header, *rows = (line.split(",") for line in (self.folder / "page" / "colour.csv").read_text().splitlines())
        self.assertEqual(len(rows), 15)
        of = {(row[0], row[1]): dict(zip(header[2:], map(float, row[2:]))) for row in rows}
        self.assertEqual([of["chart", model]["passes"] for model in ("rgb", "meyer4", "spectral20", "spectral:200")], [1, 2, 7, 67])
        self.assertEqual(of["prism", "spectral20"]["passes"], 20)
        for scene in ("chart", "glasses", "prism"):
            reference = of[scene, "spectral:200"]
            self.assertEqual((reference["mean_difference"], reference["largest_difference"]), (0, 0))
        # Lines of a lamp between the nodes: what has its nodes there is nearer than what has not.
        self.assertLess(of["chart", "spectral"]["mean_difference"], 0.5 * of["chart", "meyer4"]["mean_difference"])
        page = (self.folder / "page" / "README.md").read_text()
        for word in ("more than doubled", "no qualitative loss", "![glasses spectral:200](glasses_reference.png)"):
            self.assertIn(word, page)
        for name in ("colour.dat", "colour.gp", "chart_meyer4.png", "prism_reference.png"):
            self.assertTrue((self.folder / "page" / name).exists(), name)

    def test_missing_scenes_and_names(self):
        result = self.run_alone("experiment", "depth", "-o", self.folder / "page", "--scenes", self.folder / "none")
        self.assertEqual(result.code, 3, result.stderr)
        self.assertIn("mirrors.yaml", result.stderr)
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
                    self.assertEqual(result.code, 3, result.stderr)
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

    def test_smoothing_experiment(self):
        """The thesis's claims of 2.3.5 in numbers: only interpolation along a picture's lines depends on how a polygon is turned."""
        result = self.run_alone("experiment", "smoothing", "-o", self.folder / "page", "--width", "12")
        self.assertEqual(result.code, 0, result.stderr)
        lines = (self.folder / "page" / "smoothing.csv").read_text().splitlines()
        rows = [line.rsplit(",", 6) for line in lines if line and not line.startswith(("#", "method"))]
        rolls = {row[0].strip('"'): float(row[1]) for row in rows}
        self.assertEqual(list(rolls), ["flat", "gouraud", "phong", "center", "gouraud, by lines", "phong, by lines"])
        for name, change in rolls.items():
            if "by lines" in name:
                self.assertGreater(change, 0.0005, name)
            else:
                self.assertLess(change, 1e-6, name)
        page = (self.folder / "page" / "README.md").read_text()
        self.assertIn("| center |", page)
        for name in ("jumps.dat", "profile.dat", "smoothing.gp"):
            self.assertTrue((self.folder / "page" / name).exists(), name)


if __name__ == "__main__":
    main()
