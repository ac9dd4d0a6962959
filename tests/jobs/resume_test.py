"""Jobs that end before their time, by kill -9, a signal or a limit, and go on with another number of nodes: the same bytes."""
import json
import os
import random
import re
import signal
import statistics
import subprocess
import time

from rayfarm_job import Job, JobTest, RAYFARM, SCENES, main

SCENE = SCENES / "primitives.yaml"
# Ten seconds of three processors, so that kills come in the middle; the picture is that of fast ones.
HEAVY = ["--size", "480x360", "--samples", "16"]
SLOW = ["--processor-time", "0.000002"]
# RAYFARM_ALL_KILLS=20 kills so often as a release has to stand (five minutes), and says what was lost.
KILLS = int(os.environ.get("RAYFARM_ALL_KILLS", "0"))


class Resume(JobTest):
    def kill_and_resume(self, rank, after, arguments, name, ranks):
        """Kills the host or mpirun (rank None) and resumes; returns the seconds since anything was last written."""
        job = Job(ranks[0], "render", SCENE, "-o", self.folder / name, "--progress", "none", "--journal", "0.5", "-v", *arguments, *SLOW)
        pid = job.pid_of_rank(0) if rank == 0 else job.process.pid
        job.wait_until_it_says("tracing begins")
        time.sleep(after)
        os.kill(pid, signal.SIGKILL)
        killed = time.time()
        begun = killed - after
        made = [path.stat().st_mtime for path in self.folder.iterdir() if path.name.startswith(name[:2])]
        self.assertNotEqual(job.wait(60).code, 0)
        result = self.run_farm(ranks[1], "render", SCENE, "-o", self.folder / name, "--progress", "none", "--resume", "--stats",
                               self.folder / "resumed.json", *arguments)
        self.assertEqual(result.code, 0, result.stderr)
        self.assertEqual([p.name for p in self.folder.glob("*.journal")], [])
        self.assertEqual(self.leftovers(), [])
        return killed - max([begun, *made])

    def check_kills(self, arguments, name, frames, times):
        shuffled = random.Random(1)
        whole = self.folder / ("whole.png" if frames == 1 else "whole.##.png")
        self.assertEqual(self.run_alone("render", SCENE, "-o", whole, "-q", *arguments).code, 0)
        longest = 2
        if KILLS:
            longest = 0.8 * self.run_farm(4, "render", SCENE, "-o", self.folder / "undisturbed.##.png", "-q", *arguments, *SLOW).seconds
        lost = []
        for turn in range(times):
            after = shuffled.uniform(0.2, longest)
            lost.append(self.kill_and_resume([0, None][turn % 2], after, arguments, name, [(4, 3), (3, 5), (2, 4)][turn % 3]))
            for frame in range(1, frames + 1):
                made, right = (path.parent / path.name.replace("##", f"{frame:02}") for path in (self.folder / name, whole))
                self.assertEqual(made.read_bytes(), right.read_bytes(), f"frame {frame} after kill {turn}")
                made.unlink()
        if KILLS:
            print(f"{name}: {times} kills; seconds since anything was written: median {statistics.median(lost):.2f}, "
                  f"largest {max(lost):.2f}", flush=True)

    def test_a_still_whose_host_is_killed(self):
        self.check_kills(HEAVY, "still.png", 1, KILLS or 2)

    def test_an_animation_whose_host_is_killed(self):
        self.check_kills(["--size", "160x120", "--samples", "8", "--frames", "1-20"], "a.##.png", 20, KILLS or 2)


class Stopped(JobTest):
    def stop(self, *arguments, name="a.png", after=None, number=signal.SIGUSR1, ranks=3):
        job = Job(ranks, "render", SCENE, "-o", self.folder / name, "--progress", "none", "-v", *HEAVY, *SLOW, *arguments)
        if after is not None:
            job.wait_until_it_says("tracing begins")
            time.sleep(after)
            job.process.send_signal(number)
        result = job.wait(60)
        self.assertNotEqual(result.code, 0, result.stderr)
        return result

    def resume(self, *arguments, name="a.png", ranks=4, code=0):
        result = self.run_farm(ranks, "render", SCENE, "-o", self.folder / name, "--progress", "none", "--resume", *HEAVY, *arguments)
        self.assertEqual(result.code, code, result.stderr)
        return result

    def whole(self, *arguments, name="a.png"):
        path = self.folder / ("whole-" + name)
        self.assertEqual(self.run_alone("render", SCENE, "-o", path, "-q", *HEAVY, *arguments).code, 0)
        return path.read_bytes()

    def test_a_warning_of_the_scheduler_keeps_the_journal_and_a_preview(self):
        # mpirun hands SIGUSR1 on to all; nodes leave it to their host.
        result = self.stop(after=1.5)
        self.assertIn("--resume goes on from there", result.stderr)
        share = float(re.search(r"frame 0: ([0-9.]+) % of its pixels are in .*a\.png\.journal\n",
                                result.stderr)[1])
        self.assertRegex(result.stderr, r"frame 0 can be looked at in .*a\.partial\.png")
        self.assertTrue(1 < share < 99, share)
        self.assertFalse((self.folder / "a.png").exists())
        told = subprocess.run(["oiiotool", "--info", self.folder / "a.partial.png"], capture_output=True, text=True).stdout
        self.assertRegex(told, "480 x +360")
        self.resume("--stats", self.folder / "s.json")
        self.assertEqual((self.folder / "a.png").read_bytes(), self.whole())
        told = json.loads((self.folder / "s.json").read_text())
        self.assertAlmostEqual(100 * told["resumed_pixels"] / (480 * 360), share, delta=0.1)
        self.assertEqual(sorted(p.name for p in self.folder.iterdir()), ["a.png", "s.json", "whole-a.png"])

    def test_two_jobs_do_not_share_a_journal(self):
        job = Job(3, "render", SCENE, "-o", self.folder / "a.png", "--progress", "none", "-v", "--journal", "0.2", *HEAVY, "--processor-time", "0.00001")
        while not (self.folder / "a.png.journal").exists() and job.process.poll() is None:
            time.sleep(0.05)
        for more in ([], ["--resume"]):
            other = self.run_alone("render", SCENE, "-o", self.folder / "a.png", *HEAVY, *more)
            self.assertEqual(other.code, 2, other.stderr)
            self.assertIn("is being written by another job", other.stderr)
        # One whose mpirun is gone is about to end: it is waited for. What it was writing goes, and so does what one of another machine left.
        (self.folder / ".a.png.some.where.77.0123456789abcdef0.part").write_bytes(b"")
        (self.folder / ".a.png.mine.part").write_bytes(b"")
        os.kill(job.process.pid, signal.SIGKILL)
        self.resume()
        job.wait()
        self.assertEqual((self.folder / "a.png").read_bytes(), self.whole())
        self.assertEqual(self.leftovers(), [".a.png.mine.part"])

    def test_max_time(self):
        result = self.run_alone("render", SCENE, "-o", self.folder / "a.png", "--progress", "none", "--max-time", "0:02", *HEAVY, *SLOW)
        self.assertEqual(result.code, 75, result.stderr)
        self.assertIn("stopped by --max-time", result.stderr)
        self.assertLess(result.seconds, 6)
        self.resume()
        self.assertEqual((self.folder / "a.png").read_bytes(), self.whole())

    def test_other_wires_formats_and_policies(self):
        for name, arguments in (("p.png", ["--wire", "pixel"]), ("h.exr", []), ("i.png", ["--assign", "interleaved"]),
                                ("n.png", ["--compression", "none"])):
            self.stop(*arguments, name=name, after=1.0)
            result = self.resume(*arguments, name=name, ranks=3)
            self.assertEqual((self.folder / name).read_bytes(), self.whole(*arguments, name=name), name)
            self.assertEqual("handed out on demand" in result.stderr, "interleaved" in arguments)

    def test_what_differs_is_named(self):
        self.stop(after=1.0)
        kept = (self.folder / "a.png.journal").read_bytes()
        for arguments, says in ((["--seed", "7"], "it is of another --seed;"), (["--filter", "tent"], "it is of another --filter;"),
                                (["--samples", "4"], "--samples")):
            heavy = [a for a in HEAVY if a not in ("--samples", "16")] if "--samples" in arguments else HEAVY
            result = self.run_alone("render", SCENE, "-o", self.folder / "a.png", "--resume", *heavy, *arguments)
            self.assertEqual(result.code, 2, result.stderr)
            self.assertIn(says, result.stderr)
        result = self.run_alone("render", SCENES / "blocks.yaml", "-o", self.folder / "a.png", "--resume", *HEAVY)
        self.assertEqual(result.code, 2, result.stderr)
        self.assertIn("another scene", result.stderr)
        self.assertEqual((self.folder / "a.png.journal").read_bytes(), kept)
        # Work of this very job is not thrown away without a word; that of others goes.
        result = self.run_alone("render", SCENE, "-o", self.folder / "a.png", "--progress", "none", *HEAVY)
        self.assertEqual(result.code, 2, result.stderr)
        self.assertIn("--resume goes on from there; remove it to begin anew", result.stderr)
        self.assertEqual((self.folder / "a.png.journal").read_bytes(), kept)
        result = self.run_alone("render", SCENE, "-o", self.folder / "a.png", "--progress", "none", "--size", "64x48")
        self.assertEqual(result.code, 0, result.stderr)
        self.assertEqual([p.name for p in self.folder.iterdir()], ["a.png"])

    def test_of_a_damaged_journal_the_good_part_is_used(self):
        self.stop(after=1.5)
        journal = self.folder / "a.png.journal"
        kept, whole = journal.read_bytes(), self.whole()
        begin = kept.index(b"\n\n") + 2
        middle = (begin + len(kept)) // 2
        flipped = kept[:middle] + bytes([kept[middle] ^ 1]) + kept[middle + 1:]
        for damaged, least, most in ((kept[:middle], 1, 99), (flipped, 1, 99), (kept + b"\xff" * 5000, 1, 99), (kept[:begin], 0, 0),
                                     (kept + kept[begin:], 1, 99)):
            journal.write_bytes(damaged)
            self.resume("--stats", self.folder / "s.json", ranks=3)
            share = json.loads((self.folder / "s.json").read_text())["resumed_pixels"] / (4.8 * 360)
            self.assertTrue(least <= share <= most, share)
            self.assertEqual((self.folder / "a.png").read_bytes(), whole)
            (self.folder / "a.png").unlink()
        for begun in (b"", b"rayfarm", kept[:100]):
            journal.write_bytes(begun)
            small = self.run_alone("render", SCENE, "-o", self.folder / "a.png", "-q", "--resume", "--size", "64x48")
            self.assertEqual(small.code, 0, small.stderr)
            (self.folder / "a.png").unlink()
        for damaged in (kept[100:], kept.replace(b"\ncolumns", b"\ncolumn"), kept.replace(b"\nrows ", b"\nrows -")):
            journal.write_bytes(damaged)
            result = self.run_alone("render", SCENE, "-o", self.folder / "a.png", "--resume", *HEAVY)
            self.assertEqual(result.code, 2, result.stderr)
            self.assertIn("a.png.journal", result.stderr)
            self.assertIn("remove it", result.stderr)

    def test_nothing_stays_of_a_short_job_and_nothing_is_kept_without_a_journal(self):
        self.assertEqual(self.run_alone("render", SCENE, "-o", self.folder / "a.png", "-q", "--size", "64x48").code, 0)
        self.assertEqual([p.name for p in self.folder.iterdir()], ["a.png"])
        result = self.stop("--journal", "0", name="b.png", after=1.0)
        self.assertNotIn(".journal", result.stderr)
        self.assertEqual(sorted(p.name for p in self.folder.iterdir()), ["a.png", "b.partial.png"])

    def test_a_journal_that_cannot_be_written_is_told_once(self):
        (self.folder / "a.png.journal").mkdir()
        result = self.run_alone("render", SCENE, "-o", self.folder / "a.png", "--progress", "none", "--journal", "0.1", *HEAVY)
        self.assertEqual(result.code, 0, result.stderr)
        self.assertEqual(result.stderr.count("a.png.journal: can't be written"), 1, result.stderr)

    def test_files_of_others_stay(self):
        (self.folder / "a.png.journal").write_text("mine")
        (self.folder / "a.partial.png").write_text("mine, too")
        self.stop("--journal", "0.2", after=1.0)
        self.assertEqual((self.folder / "a.png.journal").read_text(), "mine")
        self.assertEqual((self.folder / "a.partial.png").read_text(), "mine, too")
        for output in ("a.png.journal", "a.partial.png"):
            result = self.run_alone("render", SCENE, "-o", self.folder / "a.png", "--stats", self.folder / output)
            self.assertEqual(result.code, 2, result.stderr)
        name = "n" * 250 + ".png"
        self.assertEqual(self.run_alone("render", SCENE, "-o", self.folder / name, "-q", "--size", "64x48").code, 0)

    def test_ctrl_c_under_mpirun(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            # mpirun passes on nothing of what its processes say then: the files tell.
            self.stop("--stats", self.folder / "s.json", "--journal", "60", name=f"c{number}.png", after=1.2, number=number)
            for name in ("s.json", f"c{number}.partial.png", f"c{number}.png.journal"):
                self.assertTrue((self.folder / name).exists(), name)
                (self.folder / name).unlink()

    def test_one_wish_may_come_twice(self):
        process = subprocess.Popen([RAYFARM, "render", SCENE, "-o", self.folder / "a.png", "--progress", "none", *HEAVY, *SLOW],
                                   stderr=subprocess.PIPE, text=True)
        time.sleep(1)
        process.send_signal(signal.SIGTERM)
        time.sleep(0.01)
        process.send_signal(signal.SIGTERM)
        stderr = process.communicate(timeout=30)[1]
        self.assertEqual(process.returncode, 75, stderr)
        self.assertTrue((self.folder / "a.partial.png").exists())

    def test_what_was_resumed_has_no_costs(self):
        self.stop(after=1.5)
        result = self.resume("--cost-map", self.folder / "c.json")
        self.assertIn("--cost-map leaves out frames", result.stderr)
        self.assertEqual(json.loads((self.folder / "c.json").read_text())["frames"], [])

    def test_bad_options(self):
        for arguments, says in ((["--max-time", "soon"], "HH:MM:SS"), (["--max-time", "0"], "HH:MM:SS"), (["--max-time", "1:99"], "HH:MM:SS"),
                                (["--journal", "-1"], "--journal")):
            result = self.run_alone("render", SCENE, "-o", self.folder / "a.png", *arguments)
            self.assertEqual(result.code, 2)
            self.assertIn(says, result.stderr)


if __name__ == "__main__":
    main()
