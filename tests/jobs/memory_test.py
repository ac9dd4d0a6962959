"""What the processes of a job hold in memory."""
import pathlib

from rayfarm_job import Job, JobTestAlone, SCENES, main

MOST_PRIVATE_KB = 20 * 1024  # beside the scene block, of which a machine holds one


def private_kb(pid):
    """Memory that a process shares with no other."""
    lines = pathlib.Path(f"/proc/{pid}/smaps_rollup").read_text().splitlines()
    return sum(int(line.split()[1]) for line in lines if line.startswith("Private_"))


class Node(JobTestAlone):
    def test_holds_little_of_its_own(self):
        job = Job(4, "render", SCENES / "primitives.yaml", "-o", self.folder / "m.png", "--progress", "none", "-v",
                  "--size", "640x480", "--samples", "16")
        job.wait_until_it_says("tracing begins")
        held = [private_kb(job.pid_of_rank(rank)) for rank in (1, 2, 3)]
        self.assertEqual(job.wait().code, 0)
        self.assertGreater(min(held), 0)
        self.assertLess(max(held), MOST_PRIVATE_KB)

    def test_holds_little_of_what_changes_its_shape(self):
        model = self.asset("gltf/Fox.glb")
        job = Job(4, "render", model, "-o", self.folder / "m.####.png", "--frames", "0-3", "--progress", "none", "-v",
                  "--size", "640x480", "--samples", "16", "--shutter", "0.5")
        job.wait_until_it_says("tracing begins")
        held = [private_kb(job.pid_of_rank(rank)) for rank in (1, 2, 3)]
        self.assertEqual(job.wait().code, 0)
        self.assertLess(max(held), MOST_PRIVATE_KB)


if __name__ == "__main__":
    main()
