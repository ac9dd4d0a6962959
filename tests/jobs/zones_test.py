"""Stages of zones on whole farms, with zones that hold no light (fake_zones.cpp): who did what must not show, and what goes wrong is told."""
import json
import re
import os
import pathlib
import signal
import subprocess
import time

from rayfarm_job import ENVIRONMENT, Job, JobTest, JobTestAlone, RAYFARM, SCENES, main

FAKE = str(pathlib.Path(RAYFARM).parent / "rayfarm_fake_zones")
SCENE = SCENES / "primitives.yaml"
SMALL = ["--size", "48x32", "--lighting", "phong", "--progress", "none"]


class ZonesTest(JobTest):
    def start(self, ranks, *arguments, scene=SCENE, name="z.png", **fake):
        environment = ENVIRONMENT | {f"FAKE_{k.upper()}": str(v) for k, v in fake.items()}
        stats = self.folder / "stats.json"
        stats.unlink(missing_ok=True)
        small = [word for option, value in zip(SMALL[::2], SMALL[1::2]) if option not in arguments for word in (option, value)]
        arguments = ["render", scene, "-o", self.folder / name, "--stats", stats, *small, *arguments]
        if ranks > 1:
            return Job(ranks, *arguments, program=FAKE, environment=environment)
        return subprocess.Popen([FAKE, *map(str, arguments)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment)

    def run_fake(self, ranks, *arguments, **more):
        job = self.start(ranks, *arguments, **more)
        if ranks > 1:
            result = job.wait()
            return result.code, result.stderr
        _, stderr = job.communicate(timeout=60)
        return job.returncode, stderr

    def solve(self, ranks, *arguments, **more):
        """A render that keeps its zones: their file's bytes, and the statistics."""
        file = self.folder / "a.zones"
        file.unlink(missing_ok=True)
        code, stderr = self.run_fake(ranks, "--zones", file, *arguments, **more)
        self.assertEqual(code, 0, stderr)
        return file.read_bytes(), json.loads((self.folder / "stats.json").read_text())


class AnyFarm(ZonesTest):
    # zonal.md 4: "the order, ranks, cut and retries can't show".
    def test_sums_are_the_same_to_the_byte(self):
        alone, told = self.solve(1, "--local-nodes", "1")
        picture = told["image"]["sha256_pixels"]
        for ranks, batch, policy in ((1, 1000, "on-demand"), (2, 7, "interleaved"), (3, 1000, "on-demand"), (9, 7, "on-demand")):
            with self.subTest(ranks=ranks, batch=batch, policy=policy):
                sums, told = self.solve(ranks, "--assign", policy, batch=batch)
                self.assertEqual(sums, alone)
                self.assertEqual(told["image"]["sha256_pixels"], picture, "all nodes must be given the same light")
                zones = told["zones"]
                self.assertEqual((zones["stages"], zones["rounds"], zones["retried_items"]), (4, 4, 0))
                self.assertEqual(zones["data_bytes"], 5 * 800)
                self.assertEqual(sum(node["zone_items"] for node in told["nodes"]), zones["results"])

    def test_bytes_of_pixels_are_not_those_of_zones(self):
        _, told = self.solve(3, slots=20000)
        without = self.render(3, SCENE, *SMALL)["traffic"]
        traffic, zones = told["traffic"], told["zones"]
        # Pixels differ, as they show what came of zones, but not by much in their size.
        self.assertLess(traffic["bytes_per_pixel"], 3.2)
        self.assertGreater(zones["result_bytes"], 100_000)
        self.assertGreater(traffic["return_result"]["bytes"], zones["result_bytes"])
        self.assertEqual(traffic["load_display_polygon"]["bytes"] - zones["assignment_bytes"],
                         without["load_display_polygon"]["bytes"])
        (self.folder / "told.json").write_text(json.dumps(told))
        model = self.run_alone("model", "--stats", self.folder / "told.json", "--processors", "4", "--rate", "8mbit")
        self.assertEqual(model.code, 0, model.stderr)
        # Four stages of a fifth of the data: 24 bytes a zone on a megabyte a second.
        found = model.stdout.split("\nzones\n")[1].splitlines()[1].split()
        self.assertAlmostEqual(float(found[1]), zones["data_bytes"] / 1e6, delta=1e-3)
        self.assertAlmostEqual(float(found[3]), zones["result_bytes"] / 1e6, delta=1e-3 * zones["result_bytes"] / 1e6 + 1e-4)

    def test_killed_in_a_stage(self):
        alone, _ = self.solve(1)
        file = self.folder / "k.zones"
        job = self.start(4, "--zones", file, "-v", unit_us=1500, slots=100)
        job.wait_until_it_says("tracing begins")
        time.sleep(0.4)
        job.hurt(2, signal.SIGKILL)
        result = job.wait()
        self.assertEqual(result.code, 0, result.stderr)
        self.assertEqual(file.read_bytes(), alone)
        told = json.loads((self.folder / "stats.json").read_text())
        self.assertEqual(told["nodes_lost"], [2])
        self.assertGreater(told["nodes"][1]["zone_items"], 0, "it was lost before it did anything: the test shows nothing")

    def test_stopped_in_a_stage_and_back_in_a_later_one(self):
        # Data so large that what a stopped node is not sent is told from what it is.
        alone, _ = self.solve(1, slots=100_000)
        file = self.folder / "k.zones"
        job = self.start(3, "--zones", file, "-v", "--node-timeout", "2", unit_us=3500, slots=100_000, batch=20)
        job.wait_until_it_says("tracing begins")
        time.sleep(0.3)
        pid = job.pid_of_rank(1)
        os.kill(pid, signal.SIGSTOP)
        time.sleep(3.2)
        os.kill(pid, signal.SIGCONT)
        result = job.wait()
        self.assertEqual(result.code, 0, result.stderr)
        self.assertIn("node 1 is back", result.stderr)
        self.assertEqual(file.read_bytes(), alone)


class RealZones(JobTest):
    """The program's own: zones of surfaces, directions and media."""

    def test_ranks_policies_batches_and_losses_do_not_show(self):
        scene = SCENES / "materials.yaml"
        usual = ["--lighting", "zonal", "--size", "40x30", "--zone-size", "1", "--zone-samples", "4", "--zone-view", "gather"]
        few = ["--zone-rays", "30000"]
        expected = self.render(1, scene, *usual, *few)["image"]["sha256_pixels"]
        for ranks, batch, policy in ((2, 1000, "interleaved"), (3, 7, "on-demand"), (9, 1000, "on-demand")):
            with self.subTest(ranks=ranks, batch=batch, policy=policy):
                told = self.render(ranks, scene, *usual, *few, "--zone-batch", str(batch), "--assign", policy)
                self.assertEqual(told["image"]["sha256_pixels"], expected)
        stats = self.folder / "killed.json"
        job = Job(4, "render", scene, "-o", self.folder / "k.png", "--stats", stats, "-v", *usual, "--zone-rays", "400000", "--zone-batch", "100")
        job.wait_until_it_says("tracing begins")
        time.sleep(0.3)
        job.hurt(2, signal.SIGKILL)
        result = job.wait()
        self.assertEqual(result.code, 0, result.stderr)
        told = json.loads(stats.read_text())
        whole = self.render(1, scene, *usual, "--zone-rays", "400000")
        self.assertEqual(told["image"]["sha256_pixels"], whole["image"]["sha256_pixels"])
        self.assertEqual(told["nodes_lost"], [2])

    def test_a_walk_shares_its_zones_and_a_file_keeps_them(self):
        walk = ["--lighting", "zonal", "--size", "24x24", "--zone-size", "0.5", "--zone-rays", "5000"]
        file = self.folder / "room.zones"
        first = self.render(1, SCENES / "goral_room.yaml", *walk, "--zones", file)
        again = self.render(1, SCENES / "goral_room.yaml", *walk, "--zones", file)
        self.assertGreater(first["zones"]["rounds"], 1)
        self.assertEqual(again["zones"]["rounds"], 0)
        self.assertEqual(again["image"]["sha256_pixels"], first["image"]["sha256_pixels"])
        other = self.run_alone("render", SCENES / "goral_room.yaml", "-o", self.folder / "o.png", *walk, "--zone-view", "flat", "--zones", file)
        self.assertEqual(other.code, 0, other.stderr)  # the view is the picture's alone

    def test_odd_scenes(self):
        view = "view: {location: [0,0,5], look_at: [0,0,0], field_of_view: 40, aspect: 1}\n"
        sphere = "materials: {m: {lambertian: 0.5}}\nscene: [{material: m, sphere: {center: [0,0,0], radius: 1}}]\n"
        medium = "lights: [{position: [0,3,0], color: 1}]\nmedia: [{box: {min: [-1,-1,-1], max: [1,1,1]}, absorption: 0.1, scattering: 0.5}]\nscene: []\n"
        for name, text in (("nothing", "scene: []\n"), ("dark", sphere), ("sky", "background: 0.5\n" + sphere), ("fog", medium)):
            with self.subTest(name):
                scene = self.folder / f"{name}.yaml"
                scene.write_text(view + text)
                for model in ("zonal", "radiosity"):
                    self.render(1, scene, "--lighting", model, "--size", "8x8", "--zone-rays", "500", "--zone-samples", "2")
        moving = self.run_alone("render", SCENES / "animation.yaml", "-o", self.folder / "m.png", "--lighting", "zonal", "--frames", "1",
                                "--size", "16x12", "--shutter", "0.5", "--zone-size", "2", "--zone-rays", "500", "--zone-samples", "1")
        self.assertEqual(moving.code, 0, moving.stderr)
        self.assertIn("zones keep the light of the moment when it opens", moving.stderr)

    def test_too_many_zones_are_refused(self):
        for option in (["--zone-size", "1e-6"], ["--zone-memory", "0.001"]):
            result = self.run_alone("render", SCENES / "goral_room.yaml", "-o", self.folder / "o.png", "--lighting", "zonal", *option)
            self.assertEqual(result.code, 1, result.stderr)
            self.assertIn("--zone-size", result.stderr)
        for option in (["--zone-size", "0"], ["--zone-size", "1e-30"], ["--zone-tolerance", "2"]):
            result = self.run_alone("render", SCENES / "goral_room.yaml", "-o", self.folder / "o.png", "--lighting", "zonal", *option)
            self.assertEqual(result.code, 2, result.stderr)
            self.assertIn(option[0], result.stderr)


class WhatGoesWrong(ZonesTest):
    def test_a_part_that_fails_three_times(self):
        file = self.folder / "a.zones"
        code, stderr = self.run_fake(1, "--zones", file, fails=1)
        self.assertEqual(code, 1, stderr)
        self.assertIn("zones of frame 0, round 1: a part failed three times: the tracer's own error", stderr)
        self.assertEqual([p.name for p in self.folder.iterdir()], ["stats.json"])

    def test_interrupted(self):
        file = self.folder / "a.zones"
        process = self.start(1, "--zones", file, "--progress", "plain", unit_us=20_000)
        time.sleep(0.6)
        process.send_signal(signal.SIGINT)
        _, stderr = process.communicate(timeout=20)
        self.assertEqual(process.returncode, 75, stderr)
        self.assertEqual([p.name for p in self.folder.iterdir()], ["stats.json"])

    def test_progress(self):
        code, stderr = self.run_fake(1, "--progress", "tty", "--local-nodes", "1", unit_us=500)
        self.assertEqual(code, 0, stderr)
        self.assertRegex(stderr, r"zones: round \d, [0-9.]+ % unsent, [0-9.]+ k?rays  0:0\d  1 node")
        self.assertRegex(stderr, r"zones    4 stages, 4 rounds, [0-9.]+ k?rays in ")


class Files(ZonesTest):
    def test_what_is_there_is_not_computed_again(self):
        file = self.folder / "a.zones"
        before, told = self.solve(1)
        code, stderr = self.run_fake(1, "--zones", file, "--size", "30x20", "--samples", "4")
        self.assertEqual(code, 0, stderr)
        self.assertIn("it is not computed again", stderr)
        again = json.loads((self.folder / "stats.json").read_text())["zones"]
        self.assertEqual((again["stages"], again["read_from_files"]), (0, 1))
        self.assertEqual(file.read_bytes(), before)
        code, _ = self.run_fake(2, "--zones", file)
        self.assertEqual(code, 0)
        again = json.loads((self.folder / "stats.json").read_text())
        self.assertEqual(again["image"]["sha256_pixels"], told["image"]["sha256_pixels"])

    def test_another_camera_and_options_that_do_nothing_need_no_new_zones(self):
        """A walk through a scene costs its light once, also where each picture has a scene of its own."""
        self.solve(1)
        room = (SCENES / "goral_room.yaml").read_text()
        moved = re.sub(r"location: \[[^\]]*\]", "location: [0.1, 0.2, 0.9]", room)
        self.assertNotEqual(moved, room)
        light = self.folder / "light.zones"
        for text, option in ((room, []), (moved, ["--min-weight", "0.1", "--hemicube", "9"])):
            (self.folder / "room.yaml").write_text(text)
            code, stderr = self.run_fake(1, "--zones", light, *option, scene=self.folder / "room.yaml")
            self.assertEqual(code, 0, stderr)
            self.assertEqual("it is not computed again" in stderr, bool(option), stderr)

    def refused(self, code, message, *arguments, file="a.zones", **more):
        found, stderr = self.run_fake(1, "--zones", self.folder / file, *arguments, **more)
        self.assertEqual(found, code, stderr)
        self.assertIn(message, stderr)
        self.assertFalse((self.folder / "z.png").exists())

    def test_of_others_or_damaged(self):
        file = self.folder / "a.zones"
        whole, _ = self.solve(1)
        (self.folder / "z.png").unlink()
        self.refused(2, "it is of another --seed; remove it, or name another file", "--seed", "7")
        self.refused(2, "it is of another --max-depth, another --max-reflections", "--max-depth", "3")
        self.refused(2, "it is of another --zone-rays", "--zone-rays", "77777")
        self.refused(2, "it is of another scene", scene=SCENES / "blocks.yaml")
        for damaged, message in ((whole[:-1], "it is cut off: "), (whole[:40], "it is cut off, or damaged"), (b"", "this is no file of zones"),
                                 (b"my diary\n\n", "this is no file of zones"), (whole + b"x", "its bytes are not those"),
                                 (whole[:-1] + bytes([whole[-1] ^ 1]), "its bytes are not those"),
                                 (whole.replace(b"length ", b"length -"), "its header can't be read"),
                                 (whole.replace(b"\nscene", b"\nscone"), "has no 'scene'"), (whole.replace(b"zones 2", b"zones 3"), "another version")):
            file.write_bytes(damaged)
            code, stderr = self.run_fake(1, "--zones", file)
            self.assertIn(code, (2, 3), stderr)
            self.assertIn(message, stderr)
            self.assertEqual(file.read_bytes(), damaged)
        self.assertFalse((self.folder / "z.png").exists())

    def test_frames_in_which_things_move_have_a_file_each(self):
        scene = SCENES / "animation.yaml"
        code, stderr = self.run_fake(1, "--zones", self.folder / "a.zones", "--frames", "1-2", scene=scene, name="z.##.png")
        self.assertEqual(code, 2, stderr)
        self.assertIn("put #### into the name", stderr)
        code, stderr = self.run_fake(2, "--zones", self.folder / "a.##.zones", "--frames", "1-2", scene=scene, name="z.##.png")
        self.assertEqual(code, 0, stderr)
        files = [self.folder / f"a.0{i}.zones" for i in (1, 2)]
        self.assertNotEqual(files[0].read_bytes(), files[1].read_bytes())
        files[1].replace(files[0])
        code, stderr = self.run_fake(1, "--zones", self.folder / "a.##.zones", "--frames", "1", scene=scene, name="z.##.png")
        self.assertEqual(code, 2, stderr)
        self.assertIn("another frame, and things move in this scene", stderr)

    def test_a_place_that_can_not_be_written_to(self):
        self.refused(2, "there is no folder", file="no/where/a.zones")
        self.refused(2, "names the same file", file="z.png")

    def test_models_without_zones_say_that_the_option_does_nothing(self):
        code, stderr = self.run_fake(1, "--zones", self.folder / "a.zones", "--lighting", "whitted")
        self.assertEqual(code, 0, stderr)
        self.assertIn("--zones belongs to lighting models with zones, and does nothing here", stderr)
        self.assertFalse((self.folder / "a.zones").exists())


if __name__ == "__main__":
    main()
