"""The scenes of scenes/hierarchies against what their sources state: counts of items, primitives, lights and clusters. Those of
scenes/zones: what a script writes, and the commands in their first lines."""
import re
import shlex
import subprocess
import sys
import zlib

from rayfarm_job import SCENES, JobTest, main

FOLDER = SCENES / "hierarchies"
sys.path.insert(0, str(FOLDER))
sys.dont_write_bytecode = True
import placing  # noqa: E402
import shapes  # noqa: E402
import vectors  # noqa: E402
import write_scenes  # noqa: E402
ZONES = SCENES / "zones"
sys.path.insert(0, str(ZONES))
import write_gallery  # noqa: E402

# Items (objects in the thesis), polygons, spheres, other quadrics, lights, --max-depth.
STATED = {
    # The thesis, Tables 4.3 and 4.4: 66 primitives in Image 2, 8 of them quadrics. One light is ours.
    "beach_house": (14, 1658, 0, 0, 1, None),
    "primitives": (19, 58, 7, 1, 1, None),
    "plant": (12, 2708, 0, 0, 1, None),
    # Weghorst, Hooper and Greenberg 1984, specifications below Tables II to VIII.
    "pencils_1": (38, 1806, 0, 0, 1, 1),
    "pencils_2": (38, 1806, 0, 0, 1, 3),
    "pencils_3": (38, 1806, 0, 0, 3, 1),
    "polygons": (21, 1980, 3, 0, 3, None),
    "camera": (39, 1392, 1, 0, 1, None),
    "office": (63, 2101, 8, 0, 5, None),
    "pool_room": (38, 835, 13, 15, 5, None),
}
TABLE_4_3 = {
    "beach_house": {"room": 14, "sky": 1, "grass": 1, "centre table": 70, "dish": 360, "sand": 2, "water": 3, "left table": 180,
                    "right table": 180, "vase": 80, "glass": 360, "bowl": 260, "frames": 80, "title": 67},
    "primitives": {"floor": 1, "sky": 1, **{f"sphere {k}": 1 for k in range(1, 8)}, **{f"box {k}": 6 for k in range(1, 8)},
                   **{f"pyramid {k}": 5 for k in range(1, 4)}},
    "plant": {**{f"leaf {k}": 294 for k in range(1, 9)}, "pot": 280, "dirt": 36, "stem": 36, "corner": 4},
}


class HierarchyScenes(JobTest):
    def info(self, name):
        told = self.run_alone("info", FOLDER / f"{name}.yaml")
        self.assertEqual(told.code, 0, told.stderr)
        return re.sub(r"; x .* to .*, y .* to .*, z .*$", "", told.stdout, flags=re.M)  # no bounds of objects

    def test_generator_writes_the_files_that_are_kept(self):
        written = self.folder / "new" / "scenes"
        subprocess.run([sys.executable, FOLDER / "write_scenes.py", written], check=True)
        self.assertEqual(sorted(p.name for p in written.iterdir()), sorted(p.name for p in FOLDER.glob("*.yaml")))
        for path in written.iterdir():
            self.assertEqual(path.read_bytes(), (FOLDER / path.name).read_bytes(), path.name)
        in_the_way = self.write("file", "")
        result = subprocess.run([sys.executable, FOLDER / "write_scenes.py", in_the_way], capture_output=True, text=True)
        self.assertEqual((result.returncode, result.stderr), (1, f"can't write {in_the_way}: File exists\n"))

    def test_counts_are_those_that_the_sources_state(self):
        self.assertEqual(set(STATED), set(write_scenes.SCENES))
        for name, (items, polygons, spheres, quadrics, lights, _) in STATED.items():
            told = self.info(name)
            self.assertIn(f"\n  polygons {polygons}, spheres {spheres}, quadrics {quadrics}, each copy counted\n", told, name)
            self.assertRegex(told, rf"object nodes \d+, lights {lights}, ", name)
            listed = [one for node in write_scenes.SCENES[name]()["scene"] for one in shapes.items(node)]
            self.assertEqual((len(listed), len(set(listed))), (items, items), name)
            leaves = re.findall(r"^    *(.+): \d+ \w+$", told.split("object tree\n")[1].split("memory")[0], re.M)
            if "  …\n" in told:
                listed = listed[:len(leaves)]
            self.assertEqual(leaves, listed, name)

    def test_all_shapes_stand_in_one_space(self):
        # The thesis, section 4.3.2: "The initial volume of the regular volume hierarchy must enclose the entire scene". What
        # has a transform or is used would be a part with a hierarchy of its own.
        for name in STATED:
            self.assertNotRegex((FOLDER / f"{name}.yaml").read_text(), r"\b(transform|use|objects):", name)
            self.assertIn("\n  parts 1, instances 1, ", self.info(name), name)

    def test_what_the_generator_moves_looks_as_what_a_transform_moves(self):
        ring = vectors.circle(0.2, 14, (1.5, -0.5))
        shapes_of_all_kinds = [
            shapes.lathe(12, (0.5, -2), (0.9, -1.6), (0.9, -1.2)),  # lids, an edge and a crease
            shapes.lathe(10, (0, -0.1), (0.5, -0.05), (0.9, 0.2), (0.85, 0.2), (0.45, 0.08), (0, 0.05)),  # smooth tips, a rim
            shapes.lathe(5, (0, 2.2), (0.8, 1.3), (0, 0.6)),  # sharp tips, downward
            shapes.lathe(7, *ring, ring[0]),
            shapes.box((-2.4, -2, -0.4), (-1.6, -1, 0.3)), shapes.sphere((1.6, 1.5, 0), 0.5),
            shapes.cylinder((-2, 0.6, 0), (-1.4, 1.9, 0.4), 0.3), shapes.quad((1.2, -2, 0), (1, 0.2, 0), (0, 1, -0.4)),
            shapes.frustum((1, 2, -1.6, -0.6), -1, (1.2, 1.8, -1.4, -0.8), 0)]
        for motion, steps in ((placing.move(0.8, ("x", 40), ("z", -25), (0.3, -0.2, 0.5), ("y", 70)),
                               [{"scale": 0.8}, {"rotate": {"axis": [1, 0, 0], "degrees": 40}}, {"rotate": {"axis": [0, 0, 1], "degrees": -25}},
                                {"translate": [0.3, -0.2, 0.5]}, {"rotate": {"axis": [0, 1, 0], "degrees": 70}}]),
                              (placing.move((0.4, 0.1, -0.3), 1.2), [{"translate": [0.4, 0.1, -0.3]}, {"scale": 1.2}])):
            node = shapes.cluster("all", *shapes_of_all_kinds)
            for name, nodes in (("moved", [placing.moved(node, motion)]),
                                ("transformed", [{"name": "all", "transform": steps, "group": shapes_of_all_kinds}])):
                scene = {"comment": [], "view": shapes.view((1, 3, 9), (0, 0, 0), 34, 120, 120), "background": (0.2, 0.3, 0.5),
                         "lights": [{"position": (5, 9, 6)}], "materials": {"shiny": {"diffuse": 0.5, "specular": 0.5, "reflect": 0.3}},
                         "scene": [{"name": "root", "material": "shiny", "group": nodes}]}
                told = self.run_alone("render", self.write(f"{name}.yaml", shapes.text_of(scene)), "-o", self.folder / f"{name}.png")
                self.assertEqual((told.code, "rayfarm:" in told.stderr), (0, False), told.stderr)
            self.assertNotIn("transform", (self.folder / "moved.yaml").read_text())
            compared = self.run_alone("compare", self.folder / "moved.png", self.folder / "transformed.png", "--tolerance", "0.01",
                                      "--share", "0.0005")
            self.assertEqual(compared.code, 0, compared.stdout + compared.stderr)

    def test_objects_of_the_thesis_are_those_of_table_4_3(self):
        # Table 4.5: the object hierarchies have 15, 20 and 13 nodes, a root and the objects.
        for name, objects in TABLE_4_3.items():
            told = self.info(name)
            self.assertEqual({m[1]: int(m[2]) for m in re.finditer(r"^    (.+): (\d+) (?:polygon|sphere|quadric)s?$", told, re.M)}, objects)
            self.assertIn(f"object nodes {len(objects) + 1},", told)

    def test_volumes_of_the_plant_are_about_those_of_table_4_5(self):
        # Object/volume, 3/25: 188 interior volumes and 1,110 leaves, 6.9 octants each; 8,994 pointers. The scene is rebuilt: within a factor of 1.5.
        told = self.run_alone("info", FOLDER / "plant.yaml", "--hierarchy", "thesis", "--thesis-volumes", "spheres", "--thesis-clip", "always",
                              "--thesis-center", "volume", "--max-primitives", "25")
        counts = re.search(r"spheres of `thesis` (\d+) about interior volumes, (\d+) about leaves, pointers (\d+), .*: (\d+) bytes", told.stdout)
        interior, leaves, pointers, size = (int(n) for n in counts.groups())
        for ours, stated in ((interior, 188), (leaves, 1110), (pointers, 8994)):
            self.assertTrue(1 / 1.5 < ours / stated < 1.5, (ours, stated))
        self.assertAlmostEqual((interior + leaves - 1) / interior, 6.9, delta=1)
        self.assertEqual(size, 24 * interior + 20 * leaves + 4 * pointers)

    def test_pencils_are_nine_clusters_of_four(self):
        # Table II, note 2: "Each pencil is grouped with its three closest neighbors, creating nine clusters."
        for name in ("pencils_1", "pencils_2", "pencils_3"):
            self.assertEqual(len(re.findall(r"    bundle \d \(4 children\)\n(?:      pencil \d+: 50 polygons\n){4}", self.info(name))), 9)

    def test_loader_and_renderer_have_nothing_to_note(self):
        for name, (*_, depth) in STATED.items():
            checked = self.run_alone("check", FOLDER / f"{name}.yaml")
            self.assertEqual((checked.code, checked.stderr.count("\n")), (0, 1), checked.stderr)
            self.assertIn("no problems found", checked.stderr)
            told = self.run_alone("render", FOLDER / f"{name}.yaml", "-o", self.folder / "a.png", "--size", "32x30", "--fit", "width",
                                  *(["--max-depth", depth] if depth else []))
            self.assertEqual(told.code, 0, told.stderr)
            self.assertNotIn("rayfarm:", told.stderr)  # so begins all that is noted


class ZoneScenes(JobTest):
    """After Figures 4, 6, 7 and 8 of Shirley, Sung and Brown 1991, and the room of the thesis's 2.2.5."""

    def test_mist_is_in_the_gallery_that_is_kept(self):
        self.assertEqual((ZONES / "gallery_mist.yaml").read_text(), write_gallery.mist())

    def test_paintings_are_those_that_are_kept(self):
        # Their first rows; how a PNG is packed is zlib's.
        for k, (paint, width, height) in enumerate(write_gallery.PAINTINGS):
            data = (ZONES / f"painting_{k + 1}.png").read_bytes()
            self.assertEqual((int.from_bytes(data[16:20], "big"), int.from_bytes(data[20:24], "big")), (width, height))
            length = int.from_bytes(data[33:37], "big")
            self.assertEqual(data[37:41], b"IDAT")
            rows = zlib.decompress(data[41:41 + length])
            self.assertEqual(rows[1:3 * width + 1], next(write_gallery.painted(paint, width, height)), k)

    def test_commands_in_the_scenes_render_without_notes(self):
        commands = [line.split("rayfarm render ")[1] for path in sorted(ZONES.glob("*.yaml"))
                    for line in path.read_text().splitlines() if line.startswith("#") and "rayfarm render " in line]
        self.assertEqual(len(commands), 6)
        for command in commands:
            scene, _, picture, *options = shlex.split(command)
            self.assertTrue((SCENES.parent / picture).is_file(), picture)
            for option, few in (("--zone-rays", "1000"), ("--zone-samples", "1"), ("--samples", "1"), ("--zone-size", "0.5")):
                if option in options:
                    options[options.index(option) + 1] = few
            told = self.run_alone("render", SCENES.parent / scene, "-o", self.folder / "a.png", *options, "--size", "12x9", "--fit", "width")
            self.assertEqual(told.code, 0, told.stderr)
            self.assertNotIn("rayfarm:", told.stderr)  # so begins all that is noted


if __name__ == "__main__":
    main()
