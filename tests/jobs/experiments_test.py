"""Experiments, as small as they get: each writes its page, tables and pictures."""
import csv
import json
import re
import shutil

from rayfarm_job import JobTest, SCENES, main


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

    def test_hierarchies_writes_its_page(self):
        # Chapter 4 of the thesis and what it says in numbers, on its three images.
        page = self.folder / "page"
        page.mkdir()
        (page / "embree.csv").write_text("scene,rays,rayfarm_ns,embree_ns\nImage 1,578,80,70\n")
        (page / "scenes").mkdir()
        shutil.copy(SCENES / "blocks.yaml", page / "scenes" / "instances.yaml")
        result = self.run_alone("experiment", "hierarchies", "-o", page, "--scenes", SCENES, "--width", "16")
        self.assertEqual(result.code, 0, result.stderr)
        self.assertIn("mesh1m.yaml, so the page is without it", result.stderr)
        lines = (page / "hierarchies.csv").read_text().splitlines()
        rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
        images = [row for row in rows if row["scene"].startswith("Image")]
        self.assertEqual(len(images), 3 * 22)
        self.assertEqual({int(row["primitives"]) for row in images}, {1658, 66, 2708})  # Table 4.3
        for row in rows:
            self.assertGreater(float(row["primitives_per_ray"]), 0)
            self.assertGreater(float(row["ns_per_ray"]), 0)
        for row in images:
            self.assertEqual(int(row["eye_rays"]), 17 * 17)
            types = [int(row[f"type_{k}_rays"]) for k in (1, 2, 3)]  # Figure 4.6
            self.assertEqual(sum(types), sum(int(row[f"{kind}_rays"]) for kind in ("eye", "secondary", "shadow")))
            if row["hierarchy"] == "object":
                self.assertIn(int(row["objects"]), (15, 20, 13))  # Table 4.5
                self.assertIn(float(row["thesis_bytes"]), (1376, 1836, 1192))
        tests = {(row["scene"], row["hierarchy"], row["setting"]): float(row["primitives_per_ray"]) for row in images}
        for image in ("Image 1", "Image 2", "Image 3"):
            for hierarchy, setting in (("sah", "8"), ("thesis", "25"), ("thesis, spheres", "15"), ("object/volume", "15"), ("object", "a sphere each")):
                self.assertLess(tests[image, hierarchy, setting], tests[image, "brute", ""])
        self.assertEqual({row["hierarchy"] for row in rows if row["scene"] == "instances"},
                         {"brute", "object", "regular", "adaptive", "thesis", "sah"})
        for image in ("Image 1", "Image 2", "Image 3"):  # every structure finds the same
            self.assertEqual(len({(row["hits"], row["answers"]) for row in images if row["scene"] == image}), 1)
        text = (page / "README.md").read_text()
        for exact in ("27 of 27 to the byte | 27 |", "| 3 of 3 | 3 |", "| 2.75, 3.06, 2.59 | 2.75, 3.06, 2.59 |", "| 289 | 289 |", "66 runs, one answer"):
            self.assertIn(f"{exact} holds |" if exact.endswith("|") else exact, text)
        self.assertIn("| Image 1: empty cells of regular at 25 |", text)
        self.assertRegex(text, r"\| `regular` \| 9 \| [0-9.]+ ns")  # Equation 4.5
        self.assertRegex(text, r"\| 2 \| 20 \| 19 \| [0-9.]+ µs \| [0-9.]+ µs \|")  # Equation 4.2
        self.assertRegex(text, r"\| \*wpixel\* \| pixels \| 256 \| 256 \| 256 \|")  # Table 4.8
        self.assertRegex(text, r"\| 1 \| 5\d % \| 0 % \| 0 % \| \d+ % \| `thesis` \|( \d+ % \|){3}")  # Figure 4.6
        self.assertRegex(text, r"\| Image 1 \| `\w+` [^|]*\| [0-9.]+ times as fast \| [0-9.e+]+ times as slow \| 1.14 \|")
        self.assertIn("There was no", text)
        for relation in ("bytes of object/volume over adaptive at 15", "pointers per primitive, regular at 25", "children per interior volume at 10",
                         "N_P at 25: object/volume never more than others", "VAX ms a ray at 25", "best cut of regular by VAX ms",
                         "rebuilding object/volume over updating it", "(Table 4.10)"):
            self.assertIn(relation, text)
        failing = [line for line in text.splitlines() if line.endswith("| **does not hold** |")]
        for line in failing:  # each with what was measured about it
            self.assertIn(f"- {line.split(' | ')[0].removeprefix('| ')}: ", text)
        for name in ("hierarchies.json", "cuts.dat", "growth.dat", "hierarchies.gp", "tests_beach_house.png", "tests_primitives.png", "tests_plant.png"):
            self.assertTrue((page / name).exists(), name)
        self.assertEqual(len((page / "cuts.dat").read_text().splitlines()), 1 + 3 * 3 * 7)
        self.assertEqual(len((page / "growth.dat").read_text().splitlines()), 1 + 7)

    def test_hierarchies_draws_tests_of_any_scene(self):
        folder = self.folder / "pictures"
        result = self.run_alone("experiment", "hierarchies", "--picture", "tests", "--scene", SCENES / "primitives.yaml", "--width", "24", "-o", folder)
        self.assertEqual(result.code, 0, result.stderr)
        self.assertEqual([path.name for path in folder.iterdir()], ["tests_primitives.png"])
        self.assertEqual(self.run_alone("experiment", "hierarchies", "--scene", SCENES / "primitives.yaml").code, 2)
        self.assertEqual(self.run_alone("experiment", "depth", "--picture", "tests").code, 2)
        self.assertEqual(self.run_alone("experiment", "hierarchies", "--picture", "rays").code, 2)
        result = self.run_alone("experiment", "hierarchies", "--picture", "tests", "--scene", folder / "none.yaml", "-o", folder)
        self.assertEqual(result.code, 3, result.stderr)
        self.assertIn("none.yaml", result.stderr)

    def test_bounding_volumes_writes_its_page(self):
        # Weghorst, Hooper and Greenberg 1984, section 5: eight combinations on each environment.
        result = self.run_alone("experiment", "bounding-volumes", "-o", self.folder / "page", "--scenes", SCENES, "--width", "12")
        self.assertEqual(result.code, 0, result.stderr)
        lines = (self.folder / "page" / "bounding_volumes.csv").read_text().splitlines()
        rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
        self.assertEqual(len(rows), 10 * 8)
        for row in rows:
            self.assertEqual(int(row["eye_rays"]), 13 * 12)
            has_buffer = row["combination"].endswith("Z")
            self.assertEqual(float(row["buffer_s"]) > 0, has_buffer)
            self.assertEqual(float(row["eye_volumes"]) == 0, has_buffer)  # "the ray-tracing process may then substitute a simple indexing operation"
            if has_buffer:
                self.assertLessEqual(float(row["eye_items"]), 1)
            self.assertGreater(float(row["search_cost_ns"]), 0)
        cost = {(row["environment"], row["frame"], row["combination"]): float(row["search_cost_ns"]) for row in rows}
        for environment in ("pencils_1", "pencils_2", "pencils_3", "camera", "office"):  # T = b·B + i·I
            self.assertLess(cost[environment, "0", "SH"], cost[environment, "0", "C"])
            self.assertLess(cost[environment, "0", "SHZ"], cost[environment, "0", "SH"])
        depths = {row["environment"]: float(row["average_depth"]) for row in rows}
        self.assertEqual((depths["pencils_1"], depths["pencils_3"]), (1, 1))
        self.assertGreater(depths["pencils_2"], 1)
        page = (self.folder / "page" / "README.md").read_text()
        self.assertRegex(page, r"\| Pencils I: total of CH \| 0.86 ± 0.15 \| [0-9.]+ \| (holds|\*\*does not hold\*\*) \|")
        self.assertIn("| tree, 1984, % | 48.4 | 14.3 |", page)
        for name in ("bounding_volumes.json", "bounding_volumes.gp", "totals.dat", "phases.dat", "wheel.yaml"):
            self.assertTrue((self.folder / "page" / name).exists(), name)
        self.assertFalse((self.folder / "page" / "scratch.png").exists())

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

    def test_smoothing_writes_its_page(self):
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

    def test_zones_writes_its_page(self):
        """zonal.md 5: its rows with the numbers reached. So small, that only what does not depend on rays is right."""
        page = self.folder / "page"
        result = self.run_alone("experiment", "zones", "-o", page, "--scenes", SCENES, "--width", "16")
        self.assertEqual(result.code, 0, result.stderr)
        told = json.loads((page / "zones.json").read_text())
        held = {check["what"]: check["holds"] for check in told["checks"]}
        for what in ("solution and picture on 1, 2, 3, 9 nodes, batches of 4096 and 1000 rays, both policies", "balance of the same, in integers",
                     "the same by hemicubes at 7 × 7 middles", "slab, absorbing, τ = 0.5: diffuse light through"):
            self.assertEqual(held[what], 1, what)
        self.assertEqual(len({row["zones_sha256"] for row in told["ranks"]}), 1)
        self.assertEqual([row["nodes"] for row in told["ranks"]], [1, 2, 3, 9])
        for row in told["ranks"]:
            self.assertGreater(row["result_bytes"], 0)
            self.assertGreater(row["rays"], 10_000)
        for row in told["rounds"]:
            self.assertLess(row["unsent"], 0.001)
        for room in ("Goral's room", "Goral's room, closed by a luminaire"):
            errors = told[f"{room}, error over rays"]
            self.assertGreater(errors[0]["flat_pixels"], errors[-1]["flat_pixels"])
        text = (page / "README.md").read_text()
        for section in ("What is asked, and what was reached", "Errors against paths", "equal noise", "Unsent power", "Ranks", "full matrix", "a medium"):
            self.assertIn(section, text)
        for name in ("error_size.dat", "rounds.dat", "ranks.dat", "costs.dat", "zones.gp"):
            self.assertTrue((page / name).exists(), name)
        self.assertFalse((page / "scratch").exists())


if __name__ == "__main__":
    main()
