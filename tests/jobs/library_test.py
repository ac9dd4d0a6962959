"""Objects compiled into files, through the command line."""
from rayfarm_job import JobTest, main


class CompiledObjects(JobTest):
    """Thesis 4.2.2: objects are built into volumes once, and scenes take them from a library."""

    def test_a_scene_renders_with_a_file_as_with_its_nodes(self):
        nodes = ("materials: {red: {color: [0.8, 0.2, 0.1], reflect: 0.2}}\n", "- {material: red, sphere: {center: [0, 0, 0], radius: 0.8}}",
                 "- {light: {position: [1, 2, 2], falloff: true, color: 9}, visible: {1: true, 3: false}}",
                 "- {box: {min: [-0.2, 0.6, -0.2], max: [0.2, 1.4, 0.2]}, transform: {rotate: {axis: [0, 0, 1], degrees: {1: 0, 3: 60}}}}")
        view = "view: {location: [0, 1, 5], look_at: [0, 0, 0]}\nframes: [1, 3]\nlights: [{direction: [-1, -1, -1], color: 0.3}]\n"
        self.write("part.yaml", nodes[0] + "scene:\n" + "".join(f"  {n}\n" for n in nodes[1:]))
        inline = self.write("inline.yaml", view + nodes[0] + "objects:\n  part:\n" + "".join(f"    {n}\n" for n in nodes[1:]) +
                            "scene: [{use: part, transform: {translate: [0.3, 0, 0]}}]\n")
        used = self.write("used.yaml", view + "scene: [{use: {file: part.rfp}, transform: {translate: [0.3, 0, 0]}}]\n")
        made = self.run_alone("compile", self.folder / "part.yaml", "-o", self.folder / "part.rfp")
        self.assertEqual((made.code, made.stdout.strip()), (0, str(self.folder / "part.rfp")), made.stderr)
        for arguments in ([], ["--lighting", "path", "--samples", "3"]):
            hashes = [[f["sha256_pixels"] for f in self.render(ranks, scene, "--size", "40x30", *arguments, name="out.#.exr")["frames"]]
                      for scene, ranks in ((inline, 1), (used, 1), (used, 3))]
            self.assertEqual(hashes[0], hashes[1])
            self.assertEqual(hashes[0], hashes[2])
        listed = self.run_alone("check", used)
        self.assertEqual(listed.code, 0, listed.stderr)
        self.assertIn("part.rfp", listed.stdout)
        told = self.run_alone("info", self.folder / "part.rfp")
        self.assertEqual(told.code, 0, told.stderr)
        self.assertIn("objects move, objects come and go", told.stdout)

    def test_what_cannot_be_compiled_leaves_the_file_as_it_was(self):
        good = self.write("good.yaml", "scene: [{sphere: {center: [0, 0, 0], radius: 1}}]\n")
        bad = self.write("bad.yaml", "scene: [{sphere: {center: [0, 0, 0], radius: -1}}]\n")
        empty = self.write("empty.yaml", "scene: []\n")
        file = self.folder / "part.rfp"
        self.assertEqual(self.run_alone("compile", good, "-o", file).code, 0)
        before = file.read_bytes()
        for scene, code, words in ((bad, 3, "radius"), (empty, 3, "no object"), (self.folder / "none.yaml", 3, "no such file")):
            result = self.run_alone("compile", scene, "-o", file)
            self.assertEqual(result.code, code, result.stderr)
            self.assertIn(words, result.stderr)
        self.assertEqual(file.read_bytes(), before)
        self.assertEqual(sorted(p.name for p in self.folder.iterdir()), ["bad.yaml", "empty.yaml", "good.yaml", "part.rfp"])
        for arguments, words in (((good, "-o", self.folder / "part.bin"), "must end in .rfp"), ((good,), "output"),
                                 ((file, "-o", self.folder / "again.rfp"), "compiled already")):
            result = self.run_alone("compile", *arguments)
            self.assertEqual(result.code, 2, result.stderr)
            self.assertIn(words, result.stderr)


if __name__ == "__main__":
    main()
