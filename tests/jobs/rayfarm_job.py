"""Runs rayfarm as its users do, and finds the processes of a job so that tests can hurt them."""
import json
import os
import pathlib
import shutil
import signal
import subprocess
import tempfile
import threading
import time
import unittest

SOURCE = pathlib.Path(os.environ.get("RAYFARM_SOURCE", pathlib.Path(__file__).resolve().parents[2]))
RAYFARM = os.environ.get("RAYFARM", str(SOURCE / "build" / "rayfarm"))
ASSETS = SOURCE.parent / "shared" / "assets"
SCENES = SOURCE / "scenes"


def mpi_environment():
    """The environment that deploy/mpi-env sets, read by a shell."""
    text = subprocess.run(["bash", "-c", f". '{SOURCE}/deploy/mpi-env' && env -0"], capture_output=True, check=True).stdout
    return dict(entry.split("=", 1) for entry in text.decode().split("\0") if "=" in entry)


ENVIRONMENT = mpi_environment()


class Result:
    def __init__(self, code, stdout, stderr, seconds):
        self.code, self.stdout, self.stderr, self.seconds = code, stdout, stderr, seconds


class Job:
    """A running `mpirun -n RANKS rayfarm …`."""

    def __init__(self, ranks, *arguments, program=None, environment=None):
        self.begin = time.monotonic()
        command = ["mpirun", "-n", str(ranks), program or RAYFARM, *map(str, arguments)]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                        env=environment or ENVIRONMENT, start_new_session=True)
        self.lines = []
        self.reader = threading.Thread(target=lambda: self.lines.extend(self.process.stderr), daemon=True)
        self.reader.start()

    def wait_until_it_says(self, text, within=30):
        end = time.monotonic() + within
        while time.monotonic() < end:
            if any(text in line for line in list(self.lines)):
                return
            time.sleep(0.005)
        raise AssertionError(f"the job did not say '{text}': {''.join(self.lines)}")

    def pid_of_rank(self, rank, within=20):
        """The process of a rank, once it runs rayfarm."""
        wanted = f"OMPI_COMM_WORLD_RANK={rank}".encode()
        end = time.monotonic() + within
        while time.monotonic() < end:
            for entry in pathlib.Path("/proc").iterdir():
                if not entry.name.isdigit():
                    continue
                try:
                    if int((entry / "stat").read_text().rsplit(")", 1)[1].split()[1]) != self.process.pid:
                        continue
                    if wanted in (entry / "environ").read_bytes().split(b"\0") and (entry / "exe").resolve().name.startswith("rayfarm"):
                        return int(entry.name)
                except (OSError, ValueError):
                    continue
            time.sleep(0.005)
        raise AssertionError(f"rank {rank} did not start")

    def hurt(self, rank, number):
        os.kill(self.pid_of_rank(rank), number)

    def wait(self, limit=90):
        try:
            self.process.wait(timeout=limit)
        except subprocess.TimeoutExpired:
            os.killpg(self.process.pid, signal.SIGKILL)
            self.process.wait()
            raise AssertionError(f"the job did not end within {limit} s:\n{''.join(self.lines)}")
        seconds = time.monotonic() - self.begin
        stdout = self.process.stdout.read()
        self.reader.join()
        self.process.stdout.close()
        self.process.stderr.close()
        return Result(self.process.returncode, stdout, "".join(self.lines), seconds)


class JobTest(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="rayfarm-test-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def asset(self, name):
        path = ASSETS / name
        if not path.exists():
            self.skip(f"{path} is not there")
        return path

    def skip(self, why):
        """Ends the process as a skipped test: ctest reads the code, and unittest would take SystemExit for an error."""
        shutil.rmtree(self.folder, ignore_errors=True)
        print(f"skipped: {why}", flush=True)
        os._exit(77)

    def write(self, name, text):
        path = self.folder / name
        path.write_text(text)
        return path

    def run_alone(self, *arguments, environment=None, limit=90):
        """Without mpirun."""
        begin = time.monotonic()
        done = subprocess.run([RAYFARM, *map(str, arguments)], capture_output=True, text=True, timeout=limit,
                              env=environment or ENVIRONMENT)
        return Result(done.returncode, done.stdout, done.stderr, time.monotonic() - begin)

    def run_farm(self, ranks, *arguments, limit=90):
        return Job(ranks, *arguments).wait(limit)

    def render(self, ranks, scene, *arguments, name="out.png", expect=0):
        """Renders and returns the statistics."""
        stats = self.folder / "stats.json"
        stats.unlink(missing_ok=True)
        arguments = ["render", scene, "-o", self.folder / name, "--stats", stats, "-q", *arguments]
        result = self.run_alone(*arguments) if ranks == 1 else self.run_farm(ranks, *arguments)
        self.assertEqual(result.code, expect, result.stderr)
        return json.loads(stats.read_text())

    def assert_resumed(self, told):
        """An earlier run traced a part of the picture."""
        self.assertTrue(0 < told["resumed_pixels"] < told["image"]["width"] * told["image"]["height"], told["resumed_pixels"])

    def leftovers(self):
        return [p.name for p in self.folder.iterdir() if p.name.endswith(".part")]


class JobTestAlone(JobTest):
    """Measures time, or hurts a job at a moment that it may have passed on a busy machine: ctest runs nothing beside it."""


class ClusterTestAlone(JobTestAlone):
    """On a cluster of network namespaces on this machine (deploy/virtual-cluster)."""

    def setUp(self):
        super().setUp()
        if os.geteuid() != 0 or not shutil.which("ip") or not shutil.which("tc"):
            self.skip("network namespaces need root and iproute2")
        if subprocess.run(["unshare", "--net", "ip", "link", "add", "medium", "type", "ifb"], capture_output=True).returncode != 0:
            self.skip("this kernel gives no network namespaces, or no ifb device in them")
        self.others = set()
        self.others = set(self.spaces())

    def spaces(self):
        """The namespaces of clusters that were not there when the test began."""
        listed = subprocess.run(["ip", "netns", "list"], capture_output=True, text=True).stdout
        return [name for name in (line.split()[0] for line in listed.splitlines()) if name.startswith("rf") and name not in self.others]


def main():
    unittest.main(verbosity=2)
