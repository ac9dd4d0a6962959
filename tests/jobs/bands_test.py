"""Pictures larger than the memory that they may take: they leave for their files in bands, and are the same bytes."""
import hashlib
import json
import os
import re
import resource
import signal
import struct
import subprocess
import time

from rayfarm_job import Job, JobTest, JobTestAlone, RAYFARM, SCENES, main

SCENE = SCENES / "primitives.yaml"
SMALL = ["--size", "403x301", "--progress", "none"]
# A tenth of what such a picture takes.
LITTLE = ["--frame-memory", "0.0001"]
HEAVY = ["--size", "480x360", "--samples", "8", "--progress", "none"]
SLOW = ["--processor-time", "0.000004"]


class Bands(JobTest):
    def picture(self, ranks, name, *arguments, code=0):
        result = self.run_farm(ranks, "render", SCENE, "-o", self.folder / name, *arguments)
        self.assertEqual(result.code, code, result.stderr)
        self.assertEqual(self.leftovers(), [])
        return result.stderr

    def test_the_same_bytes(self):
        for name, more in (("a.png", []), ("a.exr", []), ("a.exr", ["--crop", "11,190,7,149"]), ("a.exr", ["--pixel-format", "float"]),
                           ("a.png", ["--wire", "pixel"]), ("a.exr", ["--subpolygons", "1"])):
            told = self.picture(3, name, *SMALL, *more)
            self.assertNotIn("--frame-memory", told)
            whole = (self.folder / name).read_bytes()
            for ranks in (1, 4):
                told = self.picture(ranks, name, *SMALL, *more, *LITTLE)
                self.assertIn("leave for their files row by row", told)
                self.assertEqual((self.folder / name).read_bytes(), whole, f"{name} {more} on {ranks} ranks")

    def test_frames_follow_each_other(self):
        self.picture(3, "a.##.png", *SMALL, "--frames", "1-4")
        whole = [(self.folder / f"a.{i:02}.png").read_bytes() for i in range(1, 5)]
        told = self.picture(3, "a.##.png", *SMALL, "--frames", "1-4", "--assign", "interleaved", *LITTLE)
        self.assertIn("--assign interleaved: subpolygons are handed out on demand", told)
        self.assertEqual([(self.folder / f"a.{i:02}.png").read_bytes() for i in range(1, 5)], whole)

    def test_a_node_is_killed(self):
        self.picture(3, "a.exr", *HEAVY)
        whole = (self.folder / "a.exr").read_bytes()
        job = Job(4, "render", SCENE, "-o", self.folder / "a.exr", "-v", *HEAVY, *SLOW, *LITTLE)
        job.wait_until_it_says("tracing begins")
        time.sleep(1)
        job.hurt(2, signal.SIGKILL)
        result = job.wait()
        self.assertEqual(result.code, 0, result.stderr)
        self.assertEqual((self.folder / "a.exr").read_bytes(), whole)

    def test_a_stopped_job_goes_on(self):
        self.picture(3, "a.png", *HEAVY)
        whole = (self.folder / "a.png").read_bytes()
        for before, after in ((LITTLE, LITTLE), (LITTLE, []), ([], LITTLE)):
            (self.folder / "a.png").unlink()
            job = Job(3, "render", SCENE, "-o", self.folder / "a.png", "-v", *HEAVY, *SLOW, *before)
            job.wait_until_it_says("tracing begins")
            time.sleep(1.5)
            job.process.send_signal(signal.SIGUSR1)
            stopped = job.wait()
            self.assertNotEqual(stopped.code, 0)
            self.assertEqual((self.folder / "a.partial.png").exists(), not before, stopped.stderr)
            share = float(re.search(r"frame 0: ([0-9.]+) % of its pixels", stopped.stderr)[1])
            self.assertGreater(share, 5)
            self.picture(4, "a.png", *HEAVY, *after, "--resume", "--stats", self.folder / "s.json")
            self.assertEqual((self.folder / "a.png").read_bytes(), whole)
            resumed = 100 * json.loads((self.folder / "s.json").read_text())["resumed_pixels"] / (480 * 360)
            if after:  # what came below the bands that there is memory for is traced again
                self.assertTrue(0.4 * share < resumed < share + 0.1, f"{resumed} of {share}")
            else:
                self.assertAlmostEqual(resumed, share, delta=0.1)
            self.assertFalse((self.folder / "a.png.journal").exists())

    def test_passes_need_the_whole_picture(self):
        self.picture(3, "a.exr", *SMALL, "--samples", "4")
        whole = (self.folder / "a.exr").read_bytes()
        told = self.picture(3, "a.exr", *SMALL, "--samples", "4", "--passes", "2", *LITTLE)
        self.assertIn("--frame-memory does nothing beside --passes", told)
        self.assertEqual((self.folder / "a.exr").read_bytes(), whole)

    def test_a_full_disk_ends_the_picture_at_once(self):
        def limit():
            resource.setrlimit(resource.RLIMIT_FSIZE, (40_000, 40_000))
        begin = time.monotonic()
        done = subprocess.run([RAYFARM, "render", SCENE, "-o", self.folder / "a.exr", *HEAVY, *LITTLE, "--journal", "0", "--processor-time", "0.00002"],
                              capture_output=True, text=True, timeout=90, preexec_fn=limit)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("frame 0 failed", done.stderr)
        self.assertIn("File too large", done.stderr)
        self.assertEqual(os.listdir(self.folder), [])
        traced = float(re.search(r"rays +([0-9.]+) M", done.stderr)[1])
        whole = self.run_alone("render", SCENE, "-o", self.folder / "b.exr", *HEAVY)
        self.assertLess(traced, 0.5 * float(re.search(r"rays +([0-9.]+) M", whole.stderr)[1]))
        self.assertLess(time.monotonic() - begin, 60)


class Memory(JobTestAlone):
    def test_a_large_picture_under_a_limit(self):
        # 288 MiB of pixels in a process that may take 244 MiB of addresses with all that it is made of. The camera looks away from all there is.
        scene = self.write("scene.yaml", "view: {location: [0, 0, 5], look_at: [0, 0, 9]}\nbackground: [0.25, 0.5, 0.75]\n"
                           "lights: [{position: [3, 4, 5], color: 0.7}]\nmaterials: {a: {lambertian: 0.5}}\nscene: [{material: a, sphere: {center: [0, 0, 0], radius: 1}}]\n")
        done = subprocess.run(["bash", "-c", 'ulimit -v 250000; exec "$@"', "bash", RAYFARM, "render", scene, "-o", self.folder / "a.exr",
                               "--size", "16384x1536", "--pixel-format", "float", "--frame-memory", "0.03", "--journal", "0", "--progress", "none",
                               "--local-nodes", "2", "--stats", self.folder / "s.json"], capture_output=True, text=True, timeout=120)
        self.assertEqual(done.returncode, 0, done.stderr)
        expected = hashlib.sha256()
        row = struct.pack("<3f", 0.25, 0.5, 0.75) * 16384
        for _ in range(1536):
            expected.update(row)
        self.assertEqual(json.loads((self.folder / "s.json").read_text())["image"]["sha256_pixels"], expected.hexdigest())
        corner = subprocess.run(["oiiotool", "--info", "-v", self.folder / "a.exr"], capture_output=True, text=True).stdout
        self.assertRegex(corner, "16384 x +1536")


if __name__ == "__main__":
    main()
