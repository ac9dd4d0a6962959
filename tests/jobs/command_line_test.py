"""What users get wrong: each ends in a clear message and its own exit code, and leaves nothing behind."""
import json

from rayfarm_job import ENVIRONMENT, JobTest, SCENES, main

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
        self.assertRegex(self.run_alone("--version").stdout, r"^rayfarm \d[\d.]*, build [0-9a-f]{16,}$")
        self.assertEqual(self.run_alone("help").stdout, self.run_alone("--help").stdout)
        self.assertEqual(self.run_alone("help", "render").stdout, self.run_alone("render", "--help").stdout)
        self.assertEqual(self.run_alone("--help", "render").stdout, self.run_alone("render", "--help").stdout)
        for words in (["help", "rendr"], ["rendr", "--help"]):
            self.expect(2, *words, says=["unknown command 'rendr'", "did you mean 'render'?"])

    def test_no_command_and_unknown_command(self):
        self.expect(2, says=["a command is missing", "--help"])
        self.expect(2, "rendr", SCENE, says=["did you mean 'render'?"])

    def test_unknown_option(self):
        self.expect(2, "render", SCENE, "-o", self.folder / "a.png", "--sample", "4", says=["did you mean '--samples'?"])
        self.expect(2, "render", SCENE, "-o", self.folder / "a.png", "--ligthing=path", says=["did you mean '--lighting'?"])

    def test_words_of_another_form(self):
        output = ["-o", self.folder / "a.png"]
        self.expect(2, "render", SCENE, *output, "--size", "320", says=["--size 320: not of the form WIDTHxHEIGHT"])
        self.expect(2, "render", SCENE, *output, "--crop", "0,10,0", says=["--crop 0,10,0: not of the form x0,x1,y0,y1"])
        self.expect(2, "render", SCENE, *output, "--subpixels", "2", says=["--subpixels 2: not of the form COLUMNSxROWS"])
        self.expect(2, "render", SCENE, "a.png", says=["--output is required (-o a.png?)"])
        self.assertNotIn("(-o", self.expect(2, "render", SCENE, says=["--output is required"]).stderr)

    def test_help_shows_nothing_of_the_parser(self):
        for command in ("render", "bake", "check", "info", "compile", "convert", "compare", "experiment", "model", "simulate"):
            text = self.run_alone(command, "--help").stdout
            self.assertNotRegex(text.replace("`use: {file: ", ""), r"[\x00-\x09\x0b-\x1f]|\{|->|UINT|FLOAT|INT|TEXT|Positionals", command)
            usage, _, examples = text.partition("\nExamples:\n")
            self.assertEqual([line for line in usage.splitlines() if len(line) > 100], [], command)
            self.assertRegex(examples, rf"  (mpirun .*)?rayfarm {command} ")
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

    def test_passes_of_a_frame_larger_than_memory(self):
        result = self.expect(1, "render", SCENE, "-o", self.folder / "a.exr", "--size", "65536x65536", "--pixel-format", "float",
                             "--samples", "2", "--passes", "2", says=["192.00 GiB", "--crop", "leave out --passes"])
        self.assertLess(result.seconds, 20)

    def test_wrong_values(self):
        for option, value, says in (("--size", "64", "WIDTHxHEIGHT"), ("--size", "70000x10", "65536"), ("--size", "0x9", "65536"),
                                    ("--samples", "0", "--samples: '0' is not a whole number from 1 to 1048576"), ("--samples", "many", "'many' is not a whole number"), ("--lighting", "fong", "torrance-sparrow|whitted"),
                                    ("--frames", "9-1", "before"), ("--frames", "x", "frame number"),
                                    ("--frames", "1-3", "####"), ("--crop", "1,2,3", "x0,x1,y0,y1"), ("--max-depth", "0", "max-depth"),
                                    ("--processor-time", "nan", "not a number"), ("--shutter", "nan", "--shutter"),
                                    ("--node-timeout", "nan", "not a number"), ("--seed", "-1", "whole number"), ("--seed", "18446744073709551616", "whole number"),
                                     ("--processor-times", "1,nan", "not a number")):
            self.expect(2, "render", SCENE, "-o", self.folder / "a.png", option, value, says=[says])
        self.expect(2, "render", SCENE, "-o", self.folder / "a.png", "--spp", "4", "--samples", "16", says=["--samples, or --spp is given 2 times; give it once"])
        self.expect(2, "render", SCENE, "-o", self.folder / "a.png", "--skip-existing=perhaps", says=["--skip-existing = perhaps: this value can't be read"])

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

    def test_item_buffers_say_where_they_do_nothing(self):
        small = ("--size", "16x12", "--progress", "none")
        out = self.folder / "a.png"
        self.expect(2, "render", SCENE, "-o", out, "--item-buffer", "yes", says=["--item-buffer"])
        self.expect(2, "render", SCENE, "-o", out, "--item-radius", "0.5", says=["--item-radius"])
        self.expect(2, "render", SCENE, "-o", out, "--light-buffer", "1", says=["2 to 3344 points"])
        self.expect(2, "render", SCENE, "-o", out, "--item-buffer", "bound", "--size", "65536x65536", says=["12 bytes for each corner", "--crop"])
        self.expect(0, "render", SCENE, "-o", out, "--item-radius", "2", *small, says=["--item-radius belongs to --item-buffer"])
        self.expect(0, "render", SCENE, "-o", out, "--item-buffer", "trusted", *small, says=["may differ", "--item-buffer checked"])
        self.expect(0, "render", SCENE, "-o", out, "--light-buffer", "8", "--lighting", "path", *small, says=["--light-buffer does nothing in --lighting path"])
        lamp = self.write("lamp.yaml", "view: {location: {0: [0, 0, 5], 1: [1, 0, 5]}, look_at: [0, 0, 0]}\nlights: [{position: [1, 2, 9]}]\n"
                        "materials: {lamp: {luminaire: {emission: 5}}}\nscene: [{material: lamp, sphere: {center: [0, 0, 0], radius: 1}}]\n")
        self.expect(0, "render", lamp, "-o", out, "--light-buffer", "8", *small, says=["1 of 2 lights have no one point", "its shadow rays"])
        self.expect(0, "render", lamp, "-o", out, "--light-buffer", "8", "--item-buffer", "bound", "--shutter", "0.5", *small,
                    says=["--item-buffer does nothing here", "--light-buffer does nothing here"])

    def test_rays_that_know_their_medium_ask_for_closed_bodies(self):
        """Shirley, Sung and Brown 1991, 3.1: "we need to maintain an outward facing normal"."""
        small = ("--size", "16x12", "--progress", "none", "-o", self.folder / "a.png")
        self.expect(2, "render", SCENE, *small, "--self-hit", "epsilon", says=["--self-hit", "bound", "medium"])
        open_scene = self.write("open.yaml", "view: {location: [0, 0, 5], look_at: [0, 0, 0]}\nlights: [{position: [1, 2, 9]}]\n"
                                "materials: {wall: {color: 0.5}, paper: {translucent: {front: 0.5, through: 0.4}}}\nobjects:\n"
                                "  ball: [{material: wall, sphere: {center: [0, 0, 0], radius: 1}}]\n"
                                "  sheet: [{material: paper, polygon: {points: [[0, 0, 2], [1, 0, 2], [0, 1, 2]]}}]\n"
                                "  floor: [{material: wall, polygon: {points: [[0, 0, 0], [1, 0, 0], [0, 1, 0]]}}]\n"
                                "scene: [{use: ball}, {use: sheet}, {use: floor}]\n")
        self.expect(0, "render", open_scene, *small, "--self-hit", "medium", "--light-buffer", "8",
                    says=["('floor')", "front alone", "by a bound on rounding", "'paper'", "--light-buffer does nothing with --self-hit medium"])
        self.assertNotIn("self-hit", self.expect(0, "render", open_scene, *small).stderr)

    def test_radiosity_names_what_it_leaves_out(self):
        """The thesis's 2.2.5: "The model cannot account for reflective, transparent, or specular lighting effects"."""
        small = ("--size", "16x12", "--progress", "none", "-o", self.folder / "a.png")
        matrix = ("--lighting", "radiosity", "--zone-size", "1", "--zone-rays", "100")
        room = self.write("room.yaml", "view: {location: [0, 0, 5], look_at: [0, 0, 0]}\nlights: [{position: [1, 2, 9]}]\n"
                          "materials: {wall: {lambertian: 0.5}, pane: {dielectric: {index: 1.5}}}\n"
                          "scene: [{material: wall, box: {min: [-1, -1, -1], max: [1, 1, 0]}}, {material: pane, sphere: {center: [0, 0, 2], radius: 0.5}}]\n")
        result = self.expect(0, "render", room, *small, *matrix, "--shoot", "one", "--hemicube", "8",
                             says=["'pane'; --lighting zonal", "--shoot and --zone-tolerance belong", "--hemicube belongs"])
        self.assertNotIn("'wall'", result.stderr)
        self.expect(0, "render", room, *small, "--lighting", "zonal", "--form-factors", "hemicube", says=["belong to --lighting radiosity"])
        self.expect(0, "render", room, *small, "--zone-size", "1", says=["options of zones"])
        self.expect(0, "render", room, *small, "--lighting", "zonal", "--gather-rays", "4", says=["--gather-rays belongs to --zone-view gather"])
        self.expect(2, "render", room, *small, "--lighting", "zonal", "--gather-rays", "0", says=["--gather-rays"])
        self.expect(1, "render", room, *small, *matrix[:2], "--zone-size", "0.02", "--form-factors", "hemicube", "--zone-memory", "0.1",
                    says=["sides of zones", "a larger --zone-size, a smaller --hemicube"])

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



VIEW = "view: {location: [0, 0, 5], look_at: [0, 0, 0]}\n"
BALL = "lights: [{position: [3, 3, 5]}]\nscene: [{sphere: {center: [0, 0, 0], radius: 1}}]\n"


class SceneChoices(JobTest):
    """`render` in a scene: options of the command line that count where that does not have them."""

    def bytes_of(self, scene, *arguments):
        picture = self.folder / "picture.png"
        picture.unlink(missing_ok=True)
        result = self.run_alone("render", scene, "-o", picture, "-q", *arguments)
        self.assertEqual(result.code, 0, result.stderr)
        return picture.read_bytes()

    def test_a_scene_looks_as_it_asks_and_the_command_line_has_the_last_word(self):
        plain = self.write("plain.yaml", VIEW + BALL)
        scene = self.write("scene.yaml", VIEW + BALL + "render: {lighting: path, samples: 4, size: [40, 30], max_depth: 3, filter: tent, exposure: 1.5}\n")
        asked = ["--lighting", "path", "--samples", "4", "--size", "40x30", "--max-depth", "3", "--filter", "tent", "--exposure", "1.5"]
        self.assertEqual(self.bytes_of(scene), self.bytes_of(plain, *asked))
        self.assertEqual(self.bytes_of(scene, "--spp", "9", "--lighting=phong", "--max-depth", "5"),
                         self.bytes_of(plain, *asked[4:6], *asked[8:], "--samples", "9", "--lighting", "phong", "--max-depth", "5"))
        self.assertNotEqual(self.bytes_of(scene), self.bytes_of(scene, "--seed", "1"))
        picture = self.folder / "farm.png"
        self.assertEqual(self.run_farm(3, "render", scene, "-o", picture, "-q").code, 0)
        self.assertEqual(picture.read_bytes(), self.bytes_of(scene))
        self.assertRegex(self.run_alone("info", scene).stdout, r"render, where the command line says nothing else\n  lighting path\n  samples 4\n  size 40x30\n")

    def test_what_is_given_may_need_what_the_scene_asks_for(self):
        scene = self.write("scene.yaml", VIEW + BALL + "render: {samples: 4, size: 40x30}\n")
        plain = self.write("plain.yaml", VIEW + BALL)
        self.assertEqual(self.bytes_of(scene, "--adaptive", "0.1"),
                         self.bytes_of(plain, "--samples", "4", "--size", "40x30", "--adaptive", "0.1"))
        result = self.run_alone("render", scene, "-o", self.folder / "a.png", "--frames", "1,2")
        self.assertEqual(result.code, 2, result.stderr)
        self.assertIn("rayfarm: -o", result.stderr)
        self.assertIn("several frames need ####", result.stderr)
        result = self.run_alone("render", scene, "-o", self.folder / "a.png", "--subpixels", "2x2")
        self.assertEqual(result.code, 2, result.stderr)
        self.assertIn("rayfarm: --subpixels", result.stderr)
        for needy in (plain, self.write("none.yaml", "# render nothing\n" + VIEW + BALL)):
            result = self.run_alone("render", needy, "-o", self.folder / "a.png", "--adaptive", "0.1")
            self.assertEqual(result.code, 2, result.stderr)
            self.assertIn("--adaptive chooses where more than one sample", result.stderr)

    def test_wrong_choices_have_their_place(self):
        for render, place, problem in (("{sampels: 4}", ":4:18", "did you mean 'samples'"), ("{samples: 0}", ":4:18", "--samples"),
                                       ("{frames: 1}", ":4:17", "on the command line"), ("{lighting: paths}", ":4:19", "choose path|"),
                                       ("{lighting: path, adaptive: 1, samples: 4}", ":4:19", "--adaptive compares"),
                                       ("{size: 9x9, crop: [0, 10, 0, 5]}", ":4:26", "crop 0,10,0,5: must lie inside"), ("{spp: 4, samples: 16}", ":4:15", "is given 2 times"),
                                       ("{samples: {a: 1}}", ":4:19", "a value was expected"), ("{samples: [1]}", ":4:19", "takes one value"), ("[1]", ":4:9", "must be a map")):
            scene = self.write("scene.yaml", VIEW + BALL + f"render: {render}\n")
            for command in (["check", scene], ["render", scene, "-o", self.folder / "a.png"]):
                result = self.run_alone(*command)
                self.assertEqual(result.code, 3, result.stderr)
                self.assertRegex(result.stderr, r"scene\.yaml:\d+:\d+: ")
                self.assertIn(problem, result.stderr)
        self.assertEqual(self.leftovers(), [])

    def test_a_picture_takes_the_place_of_no_file_of_the_scene(self):
        texture = self.folder / "texture.png"
        plain = self.write("plain.yaml", VIEW + BALL)
        self.assertEqual(self.run_alone("render", plain, "-o", texture, "--size", "8x8", "-q").code, 0)
        before = texture.read_bytes()
        scene = self.write("scene.yaml", VIEW + "scene: [{material: {texture: {kind: image, file: texture.png}}, sphere: {center: [0, 0, 0], radius: 1}}]\n")
        result = self.run_alone("render", scene, "-o", texture, "--size", "8x8", "-q")
        self.assertEqual(result.code, 2, result.stderr)
        self.assertIn("the scene is made of this file", result.stderr)
        self.assertEqual(texture.read_bytes(), before)

    def test_exposure_scales_what_pictures_hold(self):
        for name, background, stops in (("dim", 0.25, 1), ("bright", 0.5, 0)):
            scene = self.write(f"{name}.yaml", VIEW + f"background: {background}\nscene: []\n")
            self.assertEqual(self.run_alone("render", scene, "-o", self.folder / f"{name}.exr", "--size", "8x8", "-q", "--exposure", stops).code, 0)
        result = self.run_alone("compare", self.folder / "dim.exr", self.folder / "bright.exr")
        self.assertEqual(result.code, 0, result.stdout + result.stderr)

    def test_what_does_not_take_them_says_so(self):
        scene = self.write("scene.yaml", VIEW + BALL + "render: {samples: 4}\n")
        result = self.run_alone("bake", scene, "-o", self.folder / "a.glb", "--zone-rays", "100", "--zone-size", "1")
        self.assertIn("scene.yaml:4:19: `render` is for `rayfarm render`, and does nothing here", result.stderr)


if __name__ == "__main__":
    main()
