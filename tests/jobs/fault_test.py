"""Faults injected for real: processes of a running job are killed, stopped or starved."""
import json
import os
import pathlib
import signal
import subprocess
import time

from rayfarm_job import ENVIRONMENT, Job, JobTest, JobTestAlone, RAYFARM, SCENES, main

SCENE = SCENES / "primitives.yaml"
# Work for three nodes, and processors so slow that it takes two seconds and more on any machine: enough to be hurt in
# the middle of it.
HEAVY = ["--size", "480x360", "--samples", "16"]
SLOW = ["--processor-time", "0.0000007"]
# So slow that a silence of three seconds is noticed before the others have done the silent node's work, too.
SLOWER = ["--processor-time", "0.000003"]


class LostNode(JobTest):
    def expect_whole_frame(self, number, *arguments, rank=2, delay=0.7, slow=SLOW):
        reference = self.render(1, SCENE, *HEAVY, *arguments)["image"]["sha256_pixels"]
        stats = self.folder / "hurt.json"
        job = Job(4, "render", SCENE, "-o", self.folder / "hurt.png", "--stats", stats, "--progress", "none",
                  "--node-timeout", "3", "-v", *HEAVY, *slow, *arguments)
        job.wait_until_it_says("tracing begins")
        time.sleep(delay)
        job.hurt(rank, number)
        result = job.wait()
        self.assertEqual(result.code, 0, result.stderr)
        told = json.loads(stats.read_text())
        self.assertEqual(told["image"]["sha256_pixels"], reference)
        self.assertEqual(self.leftovers(), [])
        self.assertEqual(told["nodes_lost"], [rank])
        self.assertTrue(told["nodes"][rank - 1]["had_work"], "the node was lost with nothing in hand: the test shows nothing")
        self.assertIn("others do its work", result.stderr)
        return told, result

    def test_killed_on_demand(self):
        self.expect_whole_frame(signal.SIGKILL)

    def test_killed_interleaved(self):
        _, result = self.expect_whole_frame(signal.SIGKILL, "--assign", "interleaved")
        self.assertIn("node 2", result.stderr)
        self.assertIn("its process is gone", result.stderr)

    def test_killed_while_paths_are_traced(self):
        self.expect_whole_frame(signal.SIGKILL, "--lighting", "path")

    def test_killed_on_the_pixel_wire(self):
        self.expect_whole_frame(signal.SIGKILL, "--wire", "pixel", rank=1)

    def test_segmentation_fault(self):
        self.expect_whole_frame(signal.SIGSEGV, rank=3)

    def test_hung_on_demand(self):
        self.expect_whole_frame(signal.SIGSTOP, slow=SLOWER)

    def test_hung_interleaved(self):
        _, result = self.expect_whole_frame(signal.SIGSTOP, "--assign", "interleaved", slow=SLOWER)
        self.assertIn("is lost: silent for 3 s", result.stderr)

    def test_killed_while_returning_large_blocks(self):
        # Long messages are handed over in the middle of a kill at many moments.
        for delay in (0.2, 0.5, 0.9):
            self.expect_whole_frame(signal.SIGKILL, "--pixel-format", "float", delay=delay)

    def test_all_nodes_killed(self):
        job = Job(3, "render", SCENE, "-o", self.folder / "none.png", "--progress", "none", "--node-timeout", "3",
                  "--size", "1600x1200", "--samples", "64", "-v")
        job.wait_until_it_says("tracing begins")
        pids = [job.pid_of_rank(1), job.pid_of_rank(2)]
        for pid in pids:
            os.kill(pid, signal.SIGKILL)
        result = job.wait(40)
        self.assertEqual(result.code, 1)
        self.assertIn("every node is lost (node 1: its process is gone)", result.stderr)
        self.assertEqual(list(self.folder.glob("*.png")), [])


class LostLate(JobTestAlone):
    def late_loss(self, number):
        # So late that the picture is whole long before the silence would be noticed.
        job = Job(4, "render", SCENE, "-o", self.folder / "late.png", "--stats", self.folder / "late.json", "--progress", "none",
                  "-v", "--size", "320x240", "--samples", "9")
        job.wait_until_it_says("tracing begins")
        job.hurt(3, number)
        result = job.wait(40)
        self.assertEqual(result.code, 0, result.stderr)
        self.assertEqual(json.loads((self.folder / "late.json").read_text())["nodes_lost"], [3], result.stderr)

    def test_killed_late(self):
        self.late_loss(signal.SIGKILL)

    def test_hung_late(self):
        self.late_loss(signal.SIGSTOP)


def write_big_scene(test, rows=420):
    with open(test.folder / "big.obj", "w") as out:
        for i in range(rows):
            for j in range(rows):
                out.write(f"v {i} {(i * 7 + j * 3) % 5} {j}\n")
        for i in range(rows - 1):
            for j in range(rows - 1):
                a = i * rows + j + 1
                out.write(f"f {a} {a + 1} {a + rows}\nf {a + 1} {a + rows + 1} {a + rows}\n")
    return test.write("big.yaml", "view: {location: [0, 50, 0], look_at: [99, 0, 99]}\nscene: [{mesh: {file: big.obj}}]\n")


class LostWhileLoading(JobTestAlone):
    def test_killed_while_loading(self):
        scene = write_big_scene(self, 1300)  # whose loading takes longer than the longest delay
        for delay in (0.0, 0.5):
            for _ in range(3):
                job = Job(4, "render", scene, "-o", self.folder / "big.png", "--progress", "none", "--size", "64x64")
                pid = job.pid_of_rank(2)
                time.sleep(delay)
                os.kill(pid, signal.SIGKILL)
                result = job.wait(40)
                self.assertLess(result.seconds, 32)
                # A rank that dies while mpirun starts can spoil mpirun's own messages (PMIx: BAD-PARAM in event notification):
                # then it passes on nothing of what the host says, and another run must tell.
                if "PMIX ERROR" not in result.stderr or "rayfarm:" in result.stderr:
                    break
            if "trace" in result.stderr:  # it was late: loading was over, and the frame must be whole
                self.assertEqual(result.code, 0, result.stderr)
            else:
                self.assertEqual(result.code, 1, result.stderr)
                self.assertRegex(result.stderr, "rayfarm: .*(lost|did not start)")
                self.assertNotIn("its host", result.stderr, "the host was not lost")

    def test_the_lost_node_is_named(self):
        scene = write_big_scene(self, 1300)
        job = Job(4, "render", scene, "-o", self.folder / "big.png", "--progress", "none", "--size", "64x64")
        pid = job.pid_of_rank(3)
        time.sleep(0.8)  # MPI has started: the host builds, the nodes wait
        os.kill(pid, signal.SIGKILL)
        result = job.wait(40)
        self.assertEqual(result.code, 1, result.stderr)
        self.assertRegex(result.stderr, f"node 3 .*process {pid}.* lost while loading")
        self.assertLess(result.seconds, 8)


    def test_killed_when_load_code_has_been_sent(self):
        # It hears nothing of the code, which others may have to get from it; then it is gone.
        scene = write_big_scene(self, 1300)
        job = Job(5, "render", scene, "-o", self.folder / "big.png", "--progress", "none", "--size", "64x64")
        pid = job.pid_of_rank(2)
        time.sleep(0.8)  # MPI has started: the host builds, the nodes wait
        os.kill(pid, signal.SIGSTOP)
        time.sleep(6)  # the host has built
        os.kill(pid, signal.SIGKILL)
        result = job.wait(40)
        self.assertEqual(result.code, 1, result.stderr)
        self.assertRegex(result.stderr, f"node 2 .*process {pid}.* lost while loading")
        self.assertLess(result.seconds, 14)


class SmallSharedMemory(JobTest):
    def test_every_process_holds_a_copy(self):
        # A mount of its own, 24 MB: MPI's buffers fit, the scene's block does not. Needs root.
        scene = write_big_scene(self)
        command = [RAYFARM, "render", str(scene), "-o", str(self.folder / "small.png"), "--size", "64x48", "--stats",
                   str(self.folder / "small.json"), "--progress", "none"]
        done = subprocess.run(["unshare", "--mount", "sh", "-c", 'mount -t tmpfs -o size=24m tmpfs /dev/shm || exit 77; exec "$@"', "sh",
                               "mpirun", "-n", "3", *command], capture_output=True, text=True, env=ENVIRONMENT, timeout=90)
        if done.returncode in (1, 77) and "rayfarm" not in done.stderr:
            self.skip("no right to mount: " + done.stderr)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("/dev/shm has no room", done.stderr)
        reference = self.render(1, scene, "--size", "64x48")["image"]["sha256_pixels"]
        self.assertEqual(json.loads((self.folder / "small.json").read_text())["image"]["sha256_pixels"], reference)


class LostHost(JobTest):
    def test_killed_host_ends_its_nodes(self):
        job = Job(4, "render", SCENE, "-o", self.folder / "host.png", "--progress", "none", "--size", "1600x1200",
                  "--samples", "64", "-v")
        job.wait_until_it_says("tracing begins")
        pids = [job.pid_of_rank(rank) for rank in (1, 2, 3)]
        job.hurt(0, signal.SIGKILL)
        begin = time.monotonic()
        while time.monotonic() < begin + 10 and any(pathlib.Path(f"/proc/{pid}").exists() for pid in pids):
            time.sleep(0.05)
        self.assertFalse(any(pathlib.Path(f"/proc/{pid}").exists() for pid in pids), "a node outlived its host by 10 s")
        result = job.wait(20)
        self.assertNotEqual(result.code, 0)
        self.assertRegex(result.stderr, r"node \d on .* ends: its host \(process \d+ on .*\) is gone")


class Stall(JobTest):
    """Processes that are stopped for a while and go on: exit code 0 and the same bytes, whoever it is, whenever. Some of all by default;
    RAYFARM_ALL_STALLS=1 tries every length from 1 to 20 s in every phase (half an hour)."""

    # What a process does when it is stopped: (how long it has run, scene). Big scenes take seconds to build.
    SECONDS = range(1, 21) if os.environ.get("RAYFARM_ALL_STALLS") else None

    def stall(self, rank, seconds, *arguments, scene=SCENE, delay=None):
        size = ["--size", "64x48"] if scene != SCENE else HEAVY
        job = Job(4, "render", scene, "-o", self.folder / "s.png", "--stats", self.folder / "s.json", "--progress", "none", "-v", *size,
                  *(SLOW if scene == SCENE else []), *arguments)
        pid = job.pid_of_rank(rank)
        if delay is None:
            job.wait_until_it_says("tracing begins")
            time.sleep(0.3)
        else:
            time.sleep(delay)
        os.kill(pid, signal.SIGSTOP)
        time.sleep(seconds)
        try:
            os.kill(pid, signal.SIGCONT)
        except ProcessLookupError:
            pass  # the pictures were whole, and it was not waited for
        result = job.wait(120)
        self.assertEqual(result.code, 0, f"rank {rank} stopped for {seconds} s at {delay}:\n{result.stderr}")
        if scene not in self.references:
            self.references[scene] = self.render(1, scene, *size)["image"]["sha256_pixels"]
        self.assertEqual(json.loads((self.folder / "s.json").read_text())["image"]["sha256_pixels"], self.references[scene])
        return result

    def setUp(self):
        super().setUp()
        self.references = {}

    def test_node_while_tracing(self):
        for seconds in self.SECONDS or [7]:
            self.stall(2, seconds)

    def test_node_while_tracing_beyond_its_time(self):
        for seconds in self.SECONDS or [9]:
            self.stall(1, seconds, "--node-timeout", "2")

    def test_host_while_tracing(self):
        for seconds in self.SECONDS or [9]:
            self.stall(0, seconds, *(["--node-timeout", "2"] if seconds % 2 else []))

    def test_host_and_node_while_loading(self):
        scene = write_big_scene(self, 1300)
        for rank in (0, 2):
            for seconds in self.SECONDS or [9]:
                self.stall(rank, seconds, scene=scene, delay=0.9)

    def test_anyone_while_mpi_starts(self):
        for rank in (0, 3):
            for seconds in self.SECONDS or [7]:
                self.stall(rank, seconds, delay=0.05 * rank)

    def test_the_only_node_beyond_its_time(self):
        # No other can do its work: the host waits for it.
        job = Job(2, "render", SCENE, "-o", self.folder / "s.png", "--progress", "none", "--node-timeout", "2", "-v", *HEAVY, *SLOW)
        job.wait_until_it_says("tracing begins")
        pid = job.pid_of_rank(1)
        os.kill(pid, signal.SIGSTOP)
        job.wait_until_it_says("no node can be heard")
        time.sleep(2)
        os.kill(pid, signal.SIGCONT)
        result = job.wait(60)
        self.assertEqual(result.code, 0, result.stderr)
        self.assertIn("node 1 is back", result.stderr)

    def test_a_render_without_mpirun(self):
        process = subprocess.Popen([RAYFARM, "render", str(SCENE), "-o", str(self.folder / "s.png"), "--progress", "none", "--node-timeout", "2",
                                    *HEAVY, *SLOW], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        time.sleep(0.5)
        process.send_signal(signal.SIGSTOP)
        time.sleep(10)
        self.assertIsNone(process.poll(), "it was over before it was stopped")
        process.send_signal(signal.SIGCONT)
        stderr = process.communicate(timeout=60)[1]
        self.assertEqual(process.returncode, 0, stderr)
        self.assertNotIn("lost", stderr)

    def test_long_computations_between_two_polls(self):
        # A hundred thousand moving objects: each node's frame takes seconds to set up, in which it polls nothing.
        scene = self.write("many.yaml", "view: {location: [0, 0, 40], look_at: [0, 0, 0]}\nlights: [{position: [9, 9, 40], color: 1}]\n"
                           "objects:\n  ball: [{sphere: {center: [0, 0, 0], radius: 0.1}}]\n"
                           + "".join(f"  n{i}: [" + ", ".join(f"{{use: {'n%d' % (i - 1) if i else 'ball'}, transform: {{translate: [{x * 0.3 * 1.9 ** i}, {i}, 0]}}}}"
                                                              for x in range(10)) + "]\n" for i in range(5))
                           + "scene: [{use: n4, transform: {rotate: {axis: [0, 1, 0], degrees: {0: 0, 9: 90}}}}]\n")
        result = self.run_farm(3, "render", scene, "-o", self.folder / "many.png", "--size", "64x48", "--shutter", "0.5", "--node-timeout", "2",
                               "--progress", "none", "-v", limit=200)
        self.assertEqual(result.code, 0, result.stderr)
        self.assertNotIn("lost", result.stderr)


class Interrupted(JobTestAlone):
    def interrupt(self, number, *command):
        process = subprocess.Popen([*command, RAYFARM, "render", str(SCENE), "-o", str(self.folder / "f.####.png"), "--frames",
                                    "1-50", "--size", "320x240", "--samples", "16", "--progress", "none"],
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=ENVIRONMENT)
        end = time.monotonic() + 30
        while time.monotonic() < end and not list(self.folder.glob("f.*.png")):
            time.sleep(0.02)
        process.send_signal(number)
        stderr = process.communicate(timeout=30)[1]
        if command:  # mpirun kills the host 20 ms after it told it to end: what it was writing stays until it is written again
            for part in self.leftovers():
                frame = part.split(".")[2]
                self.assertNotIn(f"f.{frame}.png", os.listdir(self.folder))
                again = self.run_alone("render", SCENE, "-o", self.folder / "f.####.png", "--frames", frame, "--size", "320x240", "-q")
                self.assertEqual(again.code, 0, again.stderr)
        self.assertEqual([p.name for p in self.folder.iterdir() if not p.name.endswith((".png", ".png.journal")) or p.name.startswith(".")], [])
        frames = [p for p in self.folder.glob("f.*.png") if "partial" not in p.name]
        self.assertTrue(0 < len(frames) < 50)
        for frame in frames:
            self.assertEqual(self.run_alone("compare", frame, frame).code, 0)
        return process.returncode, stderr

    def test_interrupt_alone(self):
        code, stderr = self.interrupt(signal.SIGINT)
        self.assertEqual(code, 75)
        self.assertIn("--resume", stderr)

    def test_terminate_alone(self):
        self.assertEqual(self.interrupt(signal.SIGTERM)[0], 75)

    def test_interrupt_while_objects_are_compiled(self):
        scene = write_big_scene(self, 1300)
        for number in (signal.SIGINT, signal.SIGTERM):
            process = subprocess.Popen([RAYFARM, "compile", str(scene), "-o", str(self.folder / "big.rfp")], stdout=subprocess.PIPE,
                                       stderr=subprocess.PIPE, text=True, env=ENVIRONMENT)
            time.sleep(0.3)
            process.send_signal(number)
            stderr = process.communicate(timeout=30)[1]
            self.assertEqual(process.returncode, 75, stderr)
            self.assertIn("stopped before", stderr)
            self.assertEqual(sorted(os.listdir(self.folder)), ["big.obj", "big.yaml"])

    def test_interrupt_while_loading(self):
        scene = write_big_scene(self, 1300)
        for delay in (0.1, 0.3, 0.7):  # it reads, and builds
            process = subprocess.Popen([RAYFARM, "render", str(scene), "-o", str(self.folder / "f.png"), "--progress", "none"],
                                       stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            time.sleep(delay)
            process.send_signal(signal.SIGINT)
            begin = time.monotonic()
            stderr = process.communicate(timeout=30)[1]
            self.assertEqual(process.returncode, 75, stderr)
            self.assertIn("before the scene was loaded", stderr)
            self.assertLess(time.monotonic() - begin, 2)  # 1 s on a machine that does nothing else

    def test_interrupt_under_mpirun(self):
        self.assertNotEqual(self.interrupt(signal.SIGINT, "mpirun", "-n", "3")[0], 0)


class Waiting(JobTestAlone):
    def cpu_seconds(self, pid):
        fields = pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def test_host_and_idle_nodes_use_no_processor(self):
        # Node 1 holds the only subpolygon of a tiny, heavy image; the host and the other nodes wait.
        job = Job(4, "render", SCENE, "-o", self.folder / "wait.png", "--progress", "none", "--size", "8x8", "--samples",
                  "1000000", "--node-timeout", "60", "-v")
        job.wait_until_it_says("tracing begins")
        pids = {rank: job.pid_of_rank(rank) for rank in range(4)}
        time.sleep(1)
        before = {rank: self.cpu_seconds(pid) for rank, pid in pids.items()}
        time.sleep(5)
        used = {rank: (self.cpu_seconds(pid) - before[rank]) / 5 for rank, pid in pids.items()}
        for pid in pids.values():
            os.kill(pid, signal.SIGKILL)
        job.wait(30)
        self.assertLess(used[0], 0.02, used)
        self.assertLess(sorted(used[rank] for rank in (1, 2, 3))[0], 0.02, used)


if __name__ == "__main__":
    main()
