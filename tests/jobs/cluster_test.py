"""Several machines, and who may reach them: deploy/cluster-check, a host that is killed, and the ports that a job opens."""
import importlib.machinery
import importlib.util
import ipaddress
import json
import os
import pathlib
import re
import shlex
import shutil
import signal
import socket
import subprocess
import threading
import time

from rayfarm_job import ENVIRONMENT, RAYFARM, SCENES, SOURCE, ClusterTestAlone, Job, JobTest, JobTestAlone, main

CLUSTER = SOURCE / "deploy/virtual-cluster"
CHECK = SOURCE / "deploy/cluster-check"
FAKE = pathlib.Path(RAYFARM).parent / "rayfarm_fake_zones"  # of another build
SCENE = SCENES / "primitives.yaml"
RAY_S = 2e-6


class ClusterCheck(ClusterTestAlone):
    def check(self, *arguments, nodes=2, flags=("--net", "switch")):
        command = [CLUSTER, "--nodes", nodes, *flags, "--on-host", "--", CHECK, *arguments]
        done = subprocess.run([str(c) for c in command], capture_output=True, text=True, timeout=100)
        self.assertEqual(self.spaces(), [])
        return done.returncode, done.stdout + done.stderr

    def test_machines_that_can_render_together(self):
        code, says = self.check("--net", "eth0", "--scene", SCENE, RAYFARM, flags=("--net", "switch", "--rate", "80mbit"))
        self.assertEqual(code, 0, says)
        self.assertIn("a small picture was rendered on all 3 machines together", says)
        self.assertIn("all is well: RAYFARM_NET=eth0", says)
        rows = re.findall(r"^node(\d) +([0-9a-f]{12}) +4\.\S+ +\d+ MiB +10\.77\.0\.(\d)/24 +(\S+)(?: s)? +(\S+)(?: MB/s)? +(\S+)(?: MB/s)?$", says, re.MULTILINE)
        self.assertEqual([(row[0], row[2]) for row in rows], [("0", "1"), ("1", "2"), ("2", "3")], says)
        self.assertEqual(len({row[1] for row in rows}), 1)
        for row in rows[1:]:
            self.assertLess(abs(float(row[3])), 0.5, "the machines have one clock")
            for rate in row[4:]:  # 10 MB/s, of which headers take a part
                self.assertGreater(float(rate), 4)  # what else the machine does can only take from it
                self.assertLess(float(rate), 10.5)

    def test_what_is_wrong_is_told_with_what_to_do(self):
        # Another build on node 2, and a scene that /dev/shm (2 GiB) can't hold.
        program = self.write("rayfarm", f'#!/bin/bash\n[ "$(hostname)" = node2 ] && exec {FAKE} "$@"\nexec {RAYFARM} "$@"\n')
        program.chmod(0o755)
        code, says = self.check("--scene-mib", "3000", program)
        self.assertEqual(code, 1, says)
        self.assertRegex(says, r"WRONG: node2: the build is 'rayfarm .*build \w+', on node0 it is 'rayfarm .*build \w+'\n  -> copy one executable")
        self.assertRegex(says, r"WRONG: node0, node1, node2: \d+ MiB are free in /dev/shm, and 3064 are needed.*\n  -> mount")
        # Nobody named a net: the one that all have is found.
        self.assertRegex(says, r"node1 .* 10\.77\.0\.2/24 ")

    def test_a_net_that_not_all_have(self):
        code, says = self.check("--net", "10.77.0.1/32", RAYFARM)
        self.assertEqual(code, 1, says)
        self.assertIn("WRONG: node1: has no address on '10.77.0.1/32' (it has: eth0 10.77.0.2/24)\n  -> name with --net", says)
        self.assertIn("no picture was tried", says)


class ClusterCheckParts(JobTest):
    """What no cluster of namespaces can be: clocks that differ, a bad cable, bridges of containers."""

    def setUp(self):
        super().setUp()
        loader = importlib.machinery.SourceFileLoader("cluster_check", str(CHECK))
        self.part = importlib.util.module_from_spec(importlib.util.spec_from_loader("cluster_check", loader))
        loader.exec_module(self.part)
        self.findings = self.part.Findings()

    def machine(self, rank, *addresses):
        pairs = [(name, ipaddress.ip_interface(address)) for name, address in addresses]
        return self.part.Machine(rank, f"node{rank}", "4.1.4", "build 0", 1 << 40, pairs, [])

    def test_a_clock_that_is_off(self):
        ours, theirs = socket.socketpair()

        def answer():
            while theirs.recv(100):
                theirs.sendall(f"{time.time() + 7.25:.6f}\n".encode())
        thread = threading.Thread(target=answer)
        thread.start()
        offset = self.part.measure_clock(ours)
        ours.close()
        thread.join()
        theirs.close()
        self.assertAlmostEqual(offset, 7.25, delta=0.2)
        self.part.check_links([self.machine(0), self.machine(1)], {1: self.part.Link(offset, 100, 100)}, self.findings)
        self.assertIn("its clock is +7.2 s off", str(dict(self.findings.notes)))

    def test_a_slow_link(self):
        rates = {rank: self.part.Link(0, 110, 10 if rank == 2 else 110) for rank in (1, 2, 3)}
        self.part.check_links([self.machine(rank) for rank in range(4)], rates, self.findings)
        (problem, _), names = next(iter(self.findings.notes.items()))
        self.assertEqual((names, len(self.findings.notes)), (["node2"], 1))
        self.assertIn("10.0 MB/s from it, where the median is 110.0", problem)

    def test_an_address_that_several_machines_have(self):
        machines = [self.machine(i, ("docker0", "172.17.0.1/16"), ("eth1", f"10.0.0.{i + 1}/24")) for i in range(3)]
        net, chosen = self.part.choose_net(machines, None, self.findings)
        self.assertEqual((net, str(chosen[2].ip)), ("10.0.0.0/24", "10.0.0.3"))
        (problem, advice), _ = next(iter(self.findings.wrong.items()))
        self.assertIn("docker0 172.17.0.1", problem)
        self.assertIn("RAYFARM_NET=10.0.0.0/24", advice)


class KilledHost(ClusterTestAlone):
    def test_another_number_of_nodes_goes_on(self):
        out, stats, still = self.folder / "still.exr", self.folder / "told.json", ["--size", "480x360", "--samples", "16"]

        def command(nodes, *arguments):
            """One node is on the host's machine: it sees that the host is gone, and tells mpirun. Others would wait 60 s."""
            hosts = ["10.77.0.1:2", *(f"10.77.0.{i}" for i in range(2, nodes + 1))]
            return [str(c) for c in (CLUSTER, "--nodes", nodes - 1, "--net", "switch", "--on-host", "--", "mpirun", "--host", ",".join(hosts),
                                     "-n", nodes + 1, RAYFARM, "render", SCENE, *still, "-o", out, "--processor-time", RAY_S,
                                     "--progress", "none", *arguments)]
        job = subprocess.Popen(command(3), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        journal = self.folder / "still.exr.journal"
        end = time.monotonic() + 40
        while not journal.exists() or journal.stat().st_size < 20000:
            self.assertLess(time.monotonic(), end, "nothing was kept")
            time.sleep(0.05)
        os.kill(self.host(out), signal.SIGKILL)
        _, says = job.communicate(timeout=30)
        self.assertEqual(job.returncode, 1, says)
        self.assertIn("its host", says)
        self.assertFalse(out.exists())
        self.assertEqual(self.spaces(), [])
        done = subprocess.run(command(2, "--resume", "--stats", stats), capture_output=True, text=True, timeout=90)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assert_resumed(json.loads(stats.read_text()))
        self.assertEqual(self.run_alone("render", SCENE, *still, "-o", self.folder / "alone.exr", "-q").code, 0)
        self.assertEqual(out.read_bytes(), (self.folder / "alone.exr").read_bytes())
        self.assertFalse(journal.exists())

    def host(self, out):
        """The process of rank 0 of the job that writes this file."""
        for entry in pathlib.Path("/proc").iterdir():
            try:
                if (str(out).encode() in (entry / "cmdline").read_bytes().split(b"\0") and (entry / "exe").resolve().name == "rayfarm"
                        and b"OMPI_COMM_WORLD_RANK=0" in (entry / "environ").read_bytes().split(b"\0")):
                    return int(entry.name)
            except (OSError, ValueError):
                continue
        raise AssertionError("there is no host")


class Ports(JobTestAlone):
    ARGUMENTS = ["render", SCENE, "--size", "480x360", "--samples", "16", "--processor-time", "0.000002", "--progress", "none", "-v"]

    def setUp(self):
        super().setUp()
        if not shutil.which("ss"):
            self.skip("ss is not installed (Debian: iproute2)")

    def listening(self, pids):
        """Pairs of a process and the address at which it listens, TCP and UDP."""
        listed = subprocess.run(["ss", "-H", "-tulnp"], capture_output=True, text=True, check=True).stdout
        found = [(int(pid), line.split()[4].rpartition(":")[0]) for line in listed.splitlines() for pid in re.findall(r"pid=(\d+)", line)]
        return [(pid, address) for pid, address in found if pid in pids]

    def test_on_one_machine_ranks_open_no_port(self):
        job = Job(3, *self.ARGUMENTS, "-o", self.folder / "a.png")
        job.wait_until_it_says("tracing begins")
        ranks = {job.pid_of_rank(rank) for rank in range(3)}
        found = self.listening({job.process.pid, *ranks})
        job.process.send_signal(signal.SIGTERM)
        job.wait()
        self.assertEqual([address for pid, address in found if pid in ranks], [])
        # mpirun serves its ranks on loopback. Its listener for other mpiruns has all addresses (once for IPv4, once for IPv6):
        # Open MPI 4.1 binds it to no interface. It asks for the job's key.
        self.assertEqual(sorted(address for pid, address in found if pid == job.process.pid), ["*", "0.0.0.0", "127.0.0.1"])

    def test_without_mpirun_nobody_listens(self):
        process = subprocess.Popen([RAYFARM, *map(str, self.ARGUMENTS), "-o", self.folder / "a.png", "--local-nodes", "2"],
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        time.sleep(0.6)
        self.assertIsNone(process.poll(), "it was over before anybody looked")
        found = self.listening({process.pid})
        process.terminate()
        process.wait(timeout=20)
        self.assertEqual(found, [])

    def test_with_a_net_of_its_own_there_is_only_loopback(self):
        """The command of deploy/README.md for who wants mpirun's listener out of reach, too."""
        shell = "ip link set lo up && ip -o link && " + shlex.join(["mpirun", "-n", "3", RAYFARM, *map(str, self.ARGUMENTS[:2]), "--size", "32x24",
                                                                    "-o", str(self.folder / "a.png")])
        done = subprocess.run(["unshare", "--map-root-user", "--net", "bash", "-c", shell], capture_output=True, text=True, timeout=60, env=ENVIRONMENT)
        if "Operation not permitted" in done.stderr:
            self.skip("this kernel gives no net of its own")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(re.findall(r"^\d+: (\w+)", done.stdout, re.MULTILINE), ["lo"])
        self.assertTrue((self.folder / "a.png").exists())


if __name__ == "__main__":
    main()
