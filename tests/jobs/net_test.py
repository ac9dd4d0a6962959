"""The net: virtual clusters, emulated processors, the model and the simulator from the command line."""
import csv
import json
import os
import signal
import subprocess
import time

from rayfarm_job import RAYFARM, SCENES, SOURCE, ClusterTestAlone, JobTest, JobTestAlone, main

CLUSTER = SOURCE / "deploy/virtual-cluster"
SCENE = SCENES / "primitives.yaml"


def run(*command, timeout=120, **keywords):
    return subprocess.run([str(c) for c in command], capture_output=True, text=True, timeout=timeout, **keywords)


class Emulated(JobTestAlone):
    def local(self, nodes, *arguments):
        stats = self.folder / "emulated.json"
        result = run(RAYFARM, "render", SCENE, "-o", self.folder / "emulated.png", "--size", "96x72", "--local-nodes", nodes,
                     "--processor-time", "0.0002", "--stats", stats, "-q", *arguments)
        self.assertEqual(result.returncode, 0, result.stderr)
        told = json.loads(stats.read_text())
        return told, sum(told["rays"].values()) * 0.0002

    def test_processors_take_their_time_without_the_cores(self):
        before = os.times()
        told, work = self.local(8, "--least-side", "4")  # small enough that the last ones of a frame are short
        after = os.times()
        self.assertGreater(told["time_s"]["trace"], work / 8)
        self.assertLess(told["time_s"]["trace"], 1.15 * work / 8)
        used = after.children_user + after.children_system - before.children_user - before.children_system
        self.assertLess(used, work / 4)

    def test_a_slow_processor_gets_less_on_demand(self):
        told, work = self.local(4, "--processor-times", "1,1,1,2")
        self.assertGreater(work / 3.5 / told["time_s"]["trace"], 0.9)
        rays = [node["rays"] for node in told["nodes"]]
        self.assertLess(rays[3], 0.7 * sum(rays[:3]) / 3)

    def test_simulation_of_a_measured_frame(self):
        cost_map = self.folder / "map.json"
        told, _ = self.local(4, "--assign", "interleaved", "--cost-map", cost_map)
        result = run(RAYFARM, "simulate", "--cost-map", cost_map, "--processors", "4", "--wire", "compressed", "--rate", "10gbit",
                     "--held", "0", "--least-side", "8", "--format", "json")
        self.assertEqual(result.returncode, 0, result.stderr)
        simulated = json.loads(result.stdout)["simulation"][0]["total_s"]
        self.assertAlmostEqual(simulated / told["time_s"]["trace"], 1, delta=0.05)

    def test_rotation_can_be_left_out(self):
        for flags, moves in (([], True), (["--no-rotation"], False)):
            stats = self.folder / "rotation.json"
            result = run(RAYFARM, "render", SCENES / "animation.yaml", "-o", self.folder / "r.##.png", "--frames", "1-3", "--size",
                         "64x48", "--local-nodes", "3", "--assign", "interleaved", "--stats", stats, "-q", *flags)
            self.assertEqual(result.returncode, 0, result.stderr)
            sets = [frame["traced_by"] for frame in json.loads(stats.read_text())["frames"]]
            self.assertEqual(sets[0] != sets[1], moves)

    def test_sets_move_to_the_right(self):
        """Thesis 4.4.4.2: in the next frame a processor does what is directly to the right, from the last to the first."""
        for sets in ("lattice", "rows"):
            stats = self.folder / "sets.json"
            result = run(RAYFARM, "render", SCENES / "animation.yaml", "-o", self.folder / "s.##.png", "--frames", "1-3", "--size",
                         "64x48", "--local-nodes", "3", "--assign", "interleaved", "--sets", sets, "--stats", stats)
            self.assertEqual(result.returncode, 0, result.stderr)
            told = json.loads(stats.read_text())
            self.assertEqual(told["sets"], sets)
            first, second, third = [frame["traced_by"] for frame in told["frames"]]
            self.assertEqual(second, first[-1:] + first[:-1])
            self.assertEqual(third, first[-2:] + first[:-2])
            if sets == "rows":
                self.assertEqual(first, [1 + i % 3 for i in range(len(first))])

    def test_subpolygons_down_to_a_pixel(self):
        """Thesis 4.4.4.1: "as few as one ray could be assigned to each processor". The picture is the same."""
        hashes, grids = set(), []
        for flags in (["--wire", "pixel"], ["--wire", "pixel", "--least-side", "8"], ["--wire", "block"],
                      ["--wire", "block", "--least-side", "1", "--assign", "interleaved", "--sets", "rows"]):
            stats = self.folder / "small.json"
            result = run(RAYFARM, "render", SCENE, "-o", self.folder / "small.png", "--size", "32x24", "--local-nodes", "12",
                         "--subpolygons", "100", "--stats", stats, *flags)
            self.assertEqual(result.returncode, 0, result.stderr)
            told = json.loads(stats.read_text())
            hashes.add(told["image"]["sha256_pixels"])
            grids.append(told["subpolygons"])
            # What the picture has no room for is said once.
            self.assertEqual(result.stderr.count("100 subpolygons for each of 12 processors are 1200"), 1)
            self.assertIn("are only 768", result.stderr)
        self.assertEqual(len(hashes), 1)
        self.assertEqual(grids, [{"columns": 32, "rows": 24}, {"columns": 4, "rows": 3}, {"columns": 4, "rows": 3}, {"columns": 32, "rows": 24}])

    def test_a_simulation_says_what_the_picture_has_no_room_for(self):
        few = run(RAYFARM, "simulate", "--processors", "2,300,600", "--wire", "block")
        self.assertEqual(few.returncode, 0, few.stderr)
        self.assertEqual(few.stderr.count("have room for only 16384 of at least 8 × 8 (--least-side)"), 1)
        self.assertEqual(run(RAYFARM, "simulate", "--processors", "2,300,600", "--wire", "block", "--least-side", "4").stderr, "")
        self.assertEqual(run(RAYFARM, "simulate", "--processors", "2,300,600").stderr, "")

    def test_sets_belong_to_interleaved_work(self):
        out = self.folder / "idle.png"
        for command in (["render", SCENE, "-o", out, "--size", "16x12"], ["simulate", "--assign", "on-demand", "--processors", "2"]):
            result = run(RAYFARM, *command, "--sets", "rows")
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertEqual(result.stderr.count("--sets belongs to --assign interleaved"), 1)
            result = run(RAYFARM, *command, "--sets", "columns")
            self.assertEqual(result.returncode, 2)
            self.assertIn("choose lattice|rows", result.stderr)


class CommandLine(JobTest):
    def test_model_prints_the_thesiss_figures(self):
        result = run(RAYFARM, "model", "--preset", "thesis", "--processors", "4444")
        self.assertEqual(result.returncode, 0, result.stderr)
        for figure in ("4444", "0.1944", "0.247", "9.92", "9.438", "4228"):
            self.assertIn(figure, result.stdout)
        row = list(csv.DictReader(run(RAYFARM, "model", "--preset", "thesis", "--processors", "4444", "--format", "csv")
                                  .stdout.split("# wire: pixel\n")[1].splitlines()))[0]
        self.assertEqual(f"{float(row['first_frame_s']):.2f}", "9.92")

    def test_model_of_a_real_run(self):
        stats = self.folder / "real.json"
        run(RAYFARM, "render", SCENE, "-o", self.folder / "real.png", "--size", "96x72", "--stats", stats, "-q")
        result = run(RAYFARM, "model", "--stats", stats, "--rate", "100mbit", "--format", "json")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("measured", [row["wire"] for row in json.loads(result.stdout)["limits"]])

    def test_working_sets(self):
        """Table 4.12: total and active size of the thesis's three images, traced in columns from the lower left."""
        result = run(RAYFARM, "experiment", "working-sets", "--scenes", SCENES, "--width", "64", "-o", self.folder / "sets")
        self.assertEqual(result.returncode, 0, result.stderr)
        with open(self.folder / "sets/working_sets.csv") as file:
            rows = list(csv.DictReader(file.read().splitlines()[1:]))
        self.assertEqual([row["scene"] for row in rows[::4]],
                         ["Image 1", "Image 2", "Image 3", f"{2 * (708 * 64 // 256) ** 2} triangles", "rainbow.yaml"])
        self.assertEqual(len(rows), 20)
        for row in rows:
            self.assertLessEqual(float(row["active_bytes"]), float(row["block_bytes"]))
            self.assertGreater(float(row["active_bytes"]), 0)
            if row["code_bytes"] != "-":  # of a kernel that tells
                parts = ("block_bytes", "code_bytes"), ("active_bytes", "active_code_bytes", "active_raster_bytes")
                self.assertAlmostEqual(float(row["total_bytes"]), sum(float(row[p]) for p in parts[0]) + 3 * 64 * 64, delta=1)
                self.assertAlmostEqual(float(row["active_total_bytes"]), sum(float(row[p]) for p in parts[1]), delta=1)
                self.assertLess(float(row["active_code_bytes"]), float(row["code_bytes"]))
        # Of a large scene neighbouring rays touch little, and shuffled ones more.
        large = [float(row["active_share"]) for row in rows if row["scene"] == "rainbow.yaml"]
        self.assertLess(large[0], 0.05)
        self.assertGreater(large[3], 1.2 * large[0])
        self.assertIn("columns from the lower left", (self.folder / "sets/README.md").read_text())

    def test_bad_input(self):
        bad = self.folder / "bad.json"
        bad.write_text("{}")
        for command, says in ((["model", "--rate", "8 megabit"], "not a rate"), (["model", "--stats", "none.json"], "none.json"),
                              (["model", "--stats", bad], "not the statistics"), (["simulate", "--cost-map", bad], "not a cost map"),
                              (["simulate", "--processors", "20000"], "20000"), (["simulate", "--least-side", "0"], "--least-side"),
                              (["render", SCENE, "-o", "a.png", "--least-side", "0"], "--least-side"), (["model", "--preset", "1986"], "1986"),
                              (["render", SCENE, "-o", "a.png", "--processor-times", "1,2"], "--processor-time")):
            result = run(RAYFARM, *command)
            self.assertNotEqual(result.returncode, 0, command)
            self.assertIn(says, result.stderr)


class VirtualCluster(ClusterTestAlone):
    def on_cluster(self, *arguments, nodes=2, flags=(), told=("-q",), timeout=90):
        stats, links = self.folder / "cluster.json", self.folder / "links.json"
        result = run(CLUSTER, "--nodes", nodes, "--counters", links, *flags, "--", RAYFARM, "render", *arguments, "-o",
                     self.folder / "cluster.png", "--stats", stats, *told, "--node-timeout", "60", timeout=timeout)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(self.spaces(), [])
        self.stderr = result.stderr
        return json.loads(stats.read_text()), json.loads(links.read_text())

    def assert_takes(self, measure, least, most, tries=4):
        """What else the machine does can only add to a time: one try must be below most, and none below least."""
        for _ in range(tries):
            took = measure()
            self.assertGreater(took, least)
            if took < most:
                return
        self.assertLess(took, most)

    def test_a_cluster_renders_the_same_picture(self):
        reference = self.render(1, SCENE, "--size", "96x72", "--pixel-format", "rgb8")["image"]["sha256_pixels"]
        told, links = self.on_cluster(SCENE, "--size", "96x72", nodes=3)
        self.assertEqual(told["image"]["sha256_pixels"], reference)
        self.assertEqual({node["machine"] for node in told["nodes"]}, {"node1", "node2", "node3"})
        self.assertEqual(len(links["members"]), 4)
        self.assertGreater(links["bytes"], told["traffic"]["return_result"]["bytes"])

    def test_a_full_bus_takes_the_time_of_its_bytes(self):
        # 9 bytes a pixel, all on one medium of 2 Mbit/s; frames and acknowledgements add up to a quarter.
        alone = 160 * 120 * 9 * 8 / 2e6

        def trace():
            told, _ = self.on_cluster(SCENE, "--size", "160x120", "--wire", "pixel", "--assign", "interleaved", nodes=4,
                                      flags=["--rate", "2mbit"])
            return told["time_s"]["trace"] / alone
        self.assert_takes(trace, 0.95, 1.3)

    def test_every_copy_of_the_scene_takes_its_time(self):
        scene = self.folder / "load.nff"
        spheres = "".join(f"s {i % 50 * 0.05 - 1} {i // 50 * 0.01 - 1} 0 0.01\n" for i in range(7500))
        scene.write_text("v\nfrom 0 0 9\nat 0 0 0\nup 0 1 0\nangle 40\nhither 1\nresolution 16 16\nb 0 0 0\nl 5 5 5\n"
                         "f 0.5 0.5 0.5 1 0 0 0 1\n" + spheres)
        for nodes in (1, 2):
            def broadcast():
                told, _ = self.on_cluster(scene, nodes=nodes, flags=["--rate", "8mbit"], told=["--progress", "tty"])
                if nodes == 2:  # it takes more than a second: it is shown
                    self.assertRegex(self.stderr, r" sending 0\.[0-9] of 0\.[0-9] MB")
                return told["time_s"]["broadcast"] / (nodes * told["traffic"]["load_data"]["bytes"] * 8 / 8e6)
            self.assert_takes(broadcast, 0.85, 1.15)

    def test_nothing_stays_behind(self):
        process = subprocess.Popen([CLUSTER, "--nodes", "2", "--", RAYFARM, "render", SCENE, "-o", self.folder / "a.####.png",
                                    "--frames", "1-500", "-q"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        end = time.time() + 20
        while not self.spaces() and time.time() < end:
            time.sleep(0.1)
        time.sleep(1)
        process.send_signal(signal.SIGTERM)
        self.assertEqual(process.wait(timeout=30), 143)
        self.assertEqual(self.spaces(), [])

    def test_bad_flags(self):
        for flags, says in ((["--nodes", "0", "--", "true"], "--nodes"), (["--rate", "fast", "--", "true"], "--rate"),
                            (["--net", "ring", "--", "true"], "bus or switch"), (["--nodes", "2"], "no command"),
                            (["--colour"], "unknown option")):
            result = run(CLUSTER, *flags)
            self.assertEqual(result.returncode, 2)
            self.assertIn(says, result.stderr)
        self.assertEqual(self.spaces(), [])


if __name__ == "__main__":
    main()
