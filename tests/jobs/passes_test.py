"""Pictures whose samples come in passes, or end when a pixel has little noise: the same bytes on any net, and after any accident."""
import json
import signal
import time

from rayfarm_job import Job, JobTest, SCENES, main

SMALL = ["--size", "61x47"]
MODELS = (("materials", "--lighting", "path"), ("diffuse_room", "--lighting", "thesis", "--diffuse-rays", "2"),
          ("diffuse_room", "--lighting", "zonal", "--zone-size", "4", "--zone-rays", "16"), ("animation", "--shutter", "0.5", "--frames", "3"),
          ("textures", "--filter", "mitchell", "--colour", "meyer4"))
# Three seconds of three processors.
HEAVY = ["--size", "240x180", "--samples", "48"]
SLOW = ["--processor-time", "0.0000015"]
SCENE = SCENES / "primitives.yaml"


def pass_of(path):
    """What a picture says: "2 of 4"; "" if it is of all passes."""
    data = path.read_bytes()
    at = data.find(b"rayfarm/pass\0string\0")
    if at < 0:
        return ""
    begin = at + len(b"rayfarm/pass\0string\0")
    size = int.from_bytes(data[begin:begin + 4], "little")
    return data[begin + 4:begin + 4 + size].decode()


class Noise(JobTest):
    def test_the_same_bytes_on_any_net(self):
        for scene, *arguments in MODELS:
            found = set()
            most = self.render(1, SCENES / f"{scene}.yaml", *SMALL, "--samples", "48", *arguments)["rays"]["primary"]
            for ranks, *more in ((1,), (3,), (5, "--subpolygons", "7"), (3, "--assign", "interleaved", "--subpolygons", "200", "--least-side", "1"),
                                 (3, "--passes", "3")):
                stats = self.render(ranks, SCENES / f"{scene}.yaml", *SMALL, "--samples", "48", "--noise", "0.02", *arguments, *more, name="a.exr")
                found.add((stats["image"]["sha256_pixels"], json.dumps(stats["rays"])))
                self.assertLess(stats["rays"]["primary"], most)
                self.assertGreaterEqual(stats["rays"]["primary"], 16 * 61 * 47)
            self.assertEqual(len(found), 1, f"{scene} {arguments}")

    def test_a_scene_asks_for_it(self):
        scene = self.write("noisy.yaml", SCENE.read_text() + "render: {lighting: path, samples: 40, noise: 0.05}\n")
        asked = self.render(1, scene, *SMALL)["image"]["sha256_pixels"]
        given = self.render(1, SCENE, *SMALL, "--lighting", "path", "--samples", "40", "--noise", "0.05")["image"]["sha256_pixels"]
        self.assertEqual(asked, given)

    def expect(self, says, *arguments):
        result = self.run_alone("render", SCENE, "-o", self.folder / "a.png", *SMALL, *arguments)
        self.assertEqual(result.code, 2, result.stderr)
        self.assertIn(says, result.stderr)
        self.assertFalse((self.folder / "a.png").exists())

    def test_what_does_not_go_together(self):
        noise = ["--noise", "0.01", "--samples", "64"]
        self.expect("--sampling sobol", *noise, "--sampling", "jittered")
        self.expect("at least 16 samples", "--noise", "0.01", "--samples", "16")
        self.expect("--adaptive suits phong", *noise, "--adaptive", "0.1")
        self.expect("--diffuse-set fixed", *noise, "--lighting", "thesis", "--diffuse-set", "fixed")
        self.expect("--noise", "--noise", "1.5", "--samples", "64")
        self.expect("set --samples to 4", "--passes", "4", "--samples", "3")
        self.expect("--passes takes some", "--passes", "2", "--sampling", "corners")
        self.expect("--passes takes some", "--passes", "2", "--samples", "4", "--adaptive", "0.1")
        self.expect("on-demand", "--passes", "2", "--samples", "4", "--assign", "interleaved")
        self.expect("--wire block", "--passes", "2", "--samples", "4", "--wire", "pixel")

    def test_what_it_does_not_suit_is_told(self):
        for lighting, is_told in (("whitted", True), ("path", False)):
            result = self.run_alone("render", SCENE, "-o", self.folder / "a.png", *SMALL, "--noise", "0.1", "--samples", "20", "--lighting", lighting)
            self.assertEqual(result.code, 0, result.stderr)
            self.assertEqual("for edges alone --adaptive" in result.stderr, is_told, result.stderr)
        result = self.run_alone("render", SCENE, "-o", self.folder / "a.png", *SMALL, "--passes", "2", "--samples", "4", "--sampling", "n-rooks")
        self.assertIn("off by less than a pixel", result.stderr)


class Passes(JobTest):
    def test_the_last_is_what_one_gives(self):
        for scene, *arguments in MODELS:
            for name in ("a.exr", "a.png"):
                self.render(1, SCENES / f"{scene}.yaml", *SMALL, "--samples", "7", *arguments, name=f"one-{name}")
                for ranks, passes, *more in ((1, 7), (3, 3), (5, 2, "--subpolygons", "5")):
                    self.render(ranks, SCENES / f"{scene}.yaml", *SMALL, "--samples", "7", "--passes", passes, *arguments, *more, name=name)
                    self.assertEqual((self.folder / name).read_bytes(), (self.folder / f"one-{name}").read_bytes(), f"{scene} {ranks} {passes}")

    def test_frames_of_an_animation(self):
        stats = {passes: self.render(3, SCENES / "animation.yaml", "--size", "48x36", "--samples", "4", "--frames", "1-4", "--passes", passes,
                                     name="a.##.png")["frames"] for passes in (1, 3)}
        self.assertEqual([f["sha256_pixels"] for f in stats[1]], [f["sha256_pixels"] for f in stats[3]])

    def begin(self, *arguments, name="a.exr", ranks=4):
        job = Job(ranks, "render", SCENE, "-o", self.folder / name, "--progress", "none", "-v", *HEAVY, *SLOW, "--passes", "4", *arguments)
        job.wait_until_it_says("tracing begins")
        return job

    def wait_for_pass(self, number, name="a.exr", within=60):
        """Returns what is there of this or a later pass."""
        end = time.monotonic() + within
        path = self.folder / name
        while time.monotonic() < end:
            if path.exists() and (found := pass_of(path)) >= f"{number} of 4":
                return found
            time.sleep(0.01)
        raise AssertionError(f"no picture of pass {number} came")

    def whole(self, *arguments):
        self.assertEqual(self.run_alone("render", SCENE, "-o", self.folder / "whole.exr", "-q", *HEAVY, *arguments).code, 0)
        return (self.folder / "whole.exr").read_bytes()

    def test_each_is_a_whole_picture_with_its_samples(self):
        job = self.begin()
        found = self.wait_for_pass(2)
        early = (self.folder / "a.exr").read_bytes()
        self.assertEqual(job.wait().code, 0)
        self.assertEqual(pass_of(self.folder / "a.exr"), "")
        self.assertEqual((self.folder / "a.exr").read_bytes(), self.whole())
        (self.folder / "early.exr").write_bytes(early)
        self.assertIn(found, ("2 of 4", "3 of 4"))
        samples = 12 * int(pass_of(self.folder / "early.exr")[0])
        self.assertEqual(self.run_alone("render", SCENE, "-o", self.folder / "less.exr", "-q", *HEAVY[:2], "--samples", str(samples)).code, 0)
        same = self.run_alone("compare", self.folder / "early.exr", self.folder / "less.exr")
        self.assertEqual(same.code, 0, same.stdout)

    def test_a_journal_with_a_gap(self):
        """A disk that was too slow for a result of the first pass may have kept that of the next, which goes on from it."""
        picture = self.folder / "a.exr"
        job = Job(3, "render", SCENE, "-o", picture, "--progress", "none", "--passes", "3", "--journal", "0.2", *HEAVY, *SLOW)
        while not (picture.exists() and pass_of(picture) == "2 of 3") and job.process.poll() is None:
            time.sleep(0.02)
        time.sleep(0.3)
        job.process.send_signal(signal.SIGUSR1)
        self.assertNotEqual(job.wait().code, 0)
        journal = self.folder / "a.exr.journal"
        data = journal.read_bytes()
        begin = data.index(b"\n\n") + 2
        size = int.from_bytes(data[begin:begin + 4], "little")
        journal.write_bytes(data[:begin] + data[begin + 8 + size:])
        result = self.run_farm(4, "render", SCENE, "-o", picture, "--progress", "none", "--passes", "3", "--resume", *HEAVY)
        self.assertEqual(result.code, 0, result.stderr)
        self.assertEqual(picture.read_bytes(), self.whole())

    def test_a_node_is_killed(self):
        for after in (1, 2):
            job = self.begin()
            self.wait_for_pass(after)
            job.hurt(2, signal.SIGKILL)
            result = job.wait()
            self.assertEqual(result.code, 0, result.stderr)
            self.assertIn("others do its work", result.stderr)
            self.assertEqual((self.folder / "a.exr").read_bytes(), self.whole())
            (self.folder / "a.exr").unlink()

    def test_a_stopped_job_goes_on(self):
        for noise in ([], ["--lighting", "path", "--noise", "0.005"]):
            job = self.begin("--journal", "0.3", *noise)
            self.wait_for_pass(2)
            time.sleep(0.2)
            job.process.send_signal(signal.SIGUSR1)
            result = job.wait()
            self.assertNotEqual(result.code, 0, "it was over before it was stopped")
            picture = (self.folder / "a.exr").read_bytes()
            self.assertIn("of 4", pass_of(self.folder / "a.exr"))
            other = self.run_alone("render", SCENE, "-o", self.folder / "a.exr", "--resume", "--passes", "2", *HEAVY, *noise)
            self.assertEqual(other.code, 2, other.stderr)
            self.assertIn("another --passes", other.stderr)
            self.assertEqual((self.folder / "a.exr").read_bytes(), picture)
            stats = self.folder / "s.json"
            resumed = self.run_farm(3, "render", SCENE, "-o", self.folder / "a.exr", "--resume", "--passes", "4", "--stats", stats, *HEAVY, *noise)
            self.assertEqual(resumed.code, 0, resumed.stderr)
            self.assertGreaterEqual(json.loads(stats.read_text())["resumed_pixels"], 2 * 240 * 180)
            self.assertEqual((self.folder / "a.exr").read_bytes(), self.whole(*noise))
            self.assertEqual(self.leftovers(), [])
            self.assertEqual(list(self.folder.glob("*.journal")), [])

    def test_a_picture_of_some_passes_is_not_finished(self):
        job = self.begin("--journal", "0")
        self.wait_for_pass(1)
        job.process.send_signal(signal.SIGTERM)
        job.wait()
        self.assertIn("of 4", pass_of(self.folder / "a.exr"))
        result = self.run_alone("render", SCENE, "-o", self.folder / "a.exr", "--skip-existing", *HEAVY)
        self.assertEqual(result.code, 0, result.stderr)
        self.assertRegex(result.stderr, "a.exr is of pass [123] of 4, and not finished; frame 0 is rendered again")
        self.assertEqual((self.folder / "a.exr").read_bytes(), self.whole())
        result = self.run_alone("render", SCENE, "-o", self.folder / "a.exr", "--skip-existing", *HEAVY)
        self.assertIn("is there; frame 0 is skipped", result.stderr)


if __name__ == "__main__":
    main()
