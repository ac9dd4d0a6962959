"""The image is the same to the byte whoever renders it, however the work is cut and sent."""
import json
import subprocess

from rayfarm_job import ASSETS, JobTest, SCENES, main

SMALL = ["--size", "160x120"]


class Identity(JobTest):
    def hashes(self, scene, *arguments, name, ranks=(1, 2, 3, 4, 8), variants):
        found = {}
        for n in ranks:
            for variant in variants:
                stats = self.render(n, scene, *arguments, *variant, name=name)
                found[(n, *variant)] = stats["image"]["sha256_pixels"]
        self.assertEqual(len(set(found.values())), 1, found)

    def test_png_any_ranks_policy_and_wire(self):
        self.hashes(SCENES / "primitives.yaml", *SMALL, "--samples", "4", "--sampling", "jittered", name="out.png", variants=[
            ("--assign", policy, "--wire", wire) for policy in ("on-demand", "interleaved") for wire in ("block", "pixel")])

    def test_exr_any_ranks_and_policy(self):
        self.hashes(SCENES / "primitives.yaml", *SMALL, name="out.exr", variants=[
            ("--assign", policy) for policy in ("on-demand", "interleaved")])

    def test_every_scene_has_one_picture_in_every_hierarchy_on_every_number_of_ranks(self):
        # Each scene in three of the hierarchies, so that each has a dozen scenes; every_scene_test renders each in all, alone.
        hierarchies = [["thesis"], ["thesis", "--thesis-volumes", "spheres", "--thesis-clip", "always"], ["regular", "--mailbox"],
                       ["adaptive"], ["adaptive", "--octree-build", "tracing", "--octree-next", "dda"], ["brute"], ["object"],
                       ["object", "--clusters", "automatic", "--bounds", "slabs", "--last-hit"], ["sah", "--ray-coherence", "10"],
                       ["sah", "--item-buffer", "bound", "--light-buffer", "64"]]
        scenes = sorted(SCENES.rglob("*.yaml")) + sorted((ASSETS / "spd").glob("*.nff"))
        for i, scene in enumerate(scenes):
            if scene.stem == "rainbow":
                continue  # hundreds of thousands of copies take seconds to be placed
            tiny = ["--size", "12x9", "--max-depth", "3"]
            expected = self.render(1, scene, *tiny)["image"]["sha256_pixels"]
            for k in range(3):
                chosen = hierarchies[(3 * i + k) % len(hierarchies)]
                found = self.render(1 + 2 * ((i + k) % 2), scene, *tiny, "--hierarchy", *chosen)["image"]["sha256_pixels"]
                self.assertEqual(found, expected, f"{scene} {chosen}")

    def test_meshes_that_change_their_shape(self):
        # Skins, morph targets, textures; each node computes vertices and volumes by itself, and has seen other frames before.
        for name, frames in (("SimpleSkin.gltf", "0-60x20"), ("Fox.glb", "0-21x7"), ("AnimatedMorphCube/AnimatedMorphCube.gltf", "0-99x33")):
            model = self.asset(f"gltf/{name}")
            found = {}
            for ranks in (1, 3, 8):
                for assign in ("on-demand", "interleaved"):
                    folder = self.folder / f"{model.stem}-{ranks}-{assign}"
                    folder.mkdir()
                    result = self.run_farm(ranks, "render", model, "-o", folder / "####.png", "--frames", frames, "--size", "64x48", "--samples", "4",
                                           "--lighting", "path", "--assign", assign, "--shutter", "0.5", "-q")
                    self.assertEqual(result.code, 0, result.stderr)
                    found[(ranks, assign)] = [png.read_bytes() for png in sorted(folder.glob("*.png"))]
            pictures = list(found.values())
            self.assertTrue(all(p == pictures[0] for p in pictures), name)
            self.assertEqual(len(pictures[0]), 4)
            self.assertEqual(len(set(pictures[0])), 4, f"{name}: all frames differ")

    def test_corner_sampling_and_its_counts(self):
        # Thesis 3.4.1: corners are shared by neighbours, and so by subpolygons; each counts once.
        for primary, *arguments in ((161 * 121,), (161 * 121, "--subpixels", "1x1"), (321 * 361, "--subpixels", "2x3", "--lighting", "thesis")):
            counts = set()
            for ranks in (1, 2, 3, 4):
                stats = self.render(ranks, SCENES / "primitives.yaml", *SMALL, "--sampling", "corners", *arguments)
                self.assertEqual(stats["rays"]["primary"], primary)
                counts.add((json.dumps(stats["rays"]), stats["image"]["sha256_pixels"]))
            self.assertEqual(len(counts), 1)

    def test_compression_and_float_pixels(self):
        self.hashes(SCENES / "primitives.yaml", *SMALL, ranks=(1, 3), name="out.png",
                    variants=[("--compression", "lossless"), ("--compression", "none")])
        self.hashes(SCENES / "primitives.yaml", *SMALL, "--pixel-format", "float", ranks=(1, 3), name="out.exr", variants=[()])

    def test_a_crop_is_a_part_of_the_whole(self):
        whole, part = self.folder / "whole.exr", self.folder / "part.exr"
        for arguments in ([], ["--samples", "9", "--adaptive", "0.05"]):
            self.render(1, SCENES / "primitives.yaml", *SMALL, *arguments, name=whole.name)
            stats = self.render(3, SCENES / "primitives.yaml", *SMALL, *arguments, "--crop", "40,101,30,71", name=part.name)
            self.assertEqual((stats["image"]["width"], stats["image"]["height"]), (61, 41))
            self.assertEqual(self.run_alone("compare", whole, part).code, 1)  # sizes differ
            # An EXR's pixels keep their place in the picture.
            cut = subprocess.run(["oiiotool", whole, "--cut", "61x41+40+30", part, "--cut", "61x41+40+30", "--diff"],
                                 capture_output=True, text=True, timeout=60)
            self.assertIn("PASS", cut.stdout, cut.stdout + cut.stderr)

    def test_frames_of_what_comes_and_goes_are_those_of_single_runs(self):
        # Thesis 4.2.1.1: between frames links between objects are made and broken; a frame depends on its number alone.
        stage = SCENES.parent / "tests" / "golden" / "scenes" / "stage.yaml"
        small = ["--size", "32x24", "--samples", "2", "--lighting", "path"]
        together = self.render(3, stage, *small, "--assign", "interleaved", name="out.##.exr")["frames"]
        self.assertEqual(len(together), 6)
        for frame in together:
            alone = self.render(1, stage, *small, "--frames", str(frame["frame"]), name="alone.exr")
            self.assertEqual(alone["frames"][0]["sha256_pixels"], frame["sha256_pixels"])
        self.assertEqual(len({frame["sha256_pixels"] for frame in together}), 6)

    def test_every_lighting_model(self):
        policies = [("--assign", policy) for policy in ("on-demand", "interleaved")]
        for scene, *arguments in (("materials", "--lighting", "path"), ("diffuse_room", "--lighting", "thesis", "--diffuse-rays", "3"),
                                  ("prism", "--lighting", "path", "--colour", "meyer4"), ("textures", "--filter", "mitchell"),
                                  ("animation", "--shutter", "0.5", "--frames", "3"),
                                  ("sky", "--lighting", "path"), ("marina", "--adaptive", "0.05"), ("highlights", "--lighting", "torrance-sparrow")):
            self.hashes(SCENES / f"{scene}.yaml", "--size", "61x47", "--samples", "3", *arguments, ranks=(1, 3, 8), name="out.exr",
                        variants=policies)

    def test_more_ranks_than_cores(self):
        self.hashes(SCENES / "primitives.yaml", *SMALL, ranks=(1, 17), name="out.png", variants=[()])


class Animation(JobTest):
    def test_frames_together_are_frames_alone(self):
        scene = SCENES / "animation.yaml"
        alone = {}
        for frame in range(1, 25):
            stats = self.render(1, scene, "--frames", frame, "--size", "96x72", name="one.png")
            alone[frame] = stats["image"]["sha256_pixels"]
        self.assertGreater(len(set(alone.values())), 20, "the animation does not move")
        load_data = set()
        for policy in ("on-demand", "interleaved"):
            stats = self.render(4, scene, "--frames", "1-24", "--size", "96x72", "--assign", policy, name="all.####.png")
            self.assertEqual({f["frame"]: f["sha256_pixels"] for f in stats["frames"]}, alone)
            load_data.add(stats["traffic"]["load_data"]["bytes"])
            self.assertEqual(len(list(self.folder.glob("all.*.png"))), 24)
            if policy == "interleaved":
                self.assertEqual(stats["traffic"]["load_display_polygon"]["messages"], 0)
                sets = [f["traced_by"] for f in stats["frames"]]
                self.assertEqual([s[0] for s in sets], [sets[0][-i % len(sets[0])] for i in range(24)], "the sets do not rotate")
        single = self.render(4, scene, "--frames", "1", "--size", "96x72")
        load_data.add(single["traffic"]["load_data"]["bytes"])
        self.assertEqual(len(load_data), 1, "the scene was sent more than once")


class Wire(JobTest):
    def test_nine_bytes_per_pixel(self):
        stats = self.render(3, SCENES / "primitives.yaml", *SMALL, "--wire", "pixel")
        self.assertEqual(stats["traffic"]["bytes_per_pixel"], 9)
        self.assertEqual(stats["traffic"]["model_bytes_per_pixel"], 9)
        self.assertGreaterEqual(stats["traffic"]["return_result"]["messages"], 160 * 120)

    def test_ten_bytes_per_assignment(self):
        stats = self.render(3, SCENES / "primitives.yaml", *SMALL)
        polygons = stats["traffic"]["load_display_polygon"]
        self.assertEqual(polygons["bytes"], 10 * polygons["messages"])

    def test_compressed_block_under_one_byte(self):
        stats = self.render(3, self.asset("spd/balls.nff"), "--size", "1024x1024")
        self.assertLess(stats["traffic"]["bytes_per_pixel"], 1.0)


if __name__ == "__main__":
    main()
