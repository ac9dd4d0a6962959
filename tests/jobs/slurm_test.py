"""deploy/slurm/rayfarm.sbatch under a Slurm of one machine, whose daemons this test starts and ends: no systemd, no cgroups."""
import json
import os
import shutil
import socket
import subprocess
import time

from rayfarm_job import ENVIRONMENT, RAYFARM, SCENES, SOURCE, JobTestAlone, main

SBATCH = SOURCE / "deploy/slurm/rayfarm.sbatch"
SCENE = SCENES / "primitives.yaml"
# About ten seconds on three nodes, on any machine: processors as slow as that.
STILL = ["--size", "480x360", "--samples", "16"]
RAY_S = 2e-6
DAEMONS = ["munged", "slurmctld", "slurmd"]

CONFIGURATION = """\
ClusterName=test
SlurmctldHost={host}(127.0.0.1)
SlurmUser={user}
AuthType=auth/munge
# What is queued again waits until the old job's credential has expired: five seconds are Slurm's least.
AuthInfo=socket={folder}/munge.socket,cred_expire=5
CommunicationParameters=NoInAddrAny,NoCtldInAddrAny
SlurmctldPort={ports[0]}
SlurmdPort={ports[1]}
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
SlurmdParameters=config_overrides
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
MpiDefault=none
ReturnToService=2
KillWait=20
SchedulerParameters=sched_interval=1,sched_min_interval=0
NodeName={host} NodeAddr=127.0.0.1 CPUs=4 State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""


def free_ports(count):
    sockets = [socket.create_server(("127.0.0.1", 0)) for _ in range(count)]
    ports = [s.getsockname()[1] for s in sockets]
    for s in sockets:
        s.close()
    return ports


class Slurm(JobTestAlone):
    def setUp(self):
        super().setUp()
        missing = [name for name in (*DAEMONS, "sbatch") if not shutil.which(name)]
        if missing:
            self.skip(f"{', '.join(missing)} not installed (Debian: slurm-wlm, munge)")
        if os.geteuid() != 0:
            self.skip("slurmd needs root")
        self.slurm = self.folder / "slurm"
        for name in ("state", "spool"):
            (self.slurm / name).mkdir(parents=True)
        self.folder.chmod(0o755)  # munged wants its socket to be within reach of all
        configuration = self.slurm / "slurm.conf"
        configuration.write_text(CONFIGURATION.format(host=socket.gethostname().split(".")[0], user="root", folder=self.slurm,
                                                      ports=free_ports(2)))
        key = self.slurm / "munge.key"
        key.write_bytes(os.urandom(1024))
        key.chmod(0o600)
        self.environment = {name: value for name, value in ENVIRONMENT.items() if not name.startswith(("SLURM", "OMPI"))}
        self.environment.update(SLURM_CONF=str(configuration), RAYFARM=str(RAYFARM))
        self.daemons = []
        self.addCleanup(self.end_daemons)
        self.start("munged", "--foreground", f"--socket={self.slurm}/munge.socket", f"--key-file={key}", "--num-threads=1",
                   f"--pid-file={self.slurm}/munged.pid", f"--log-file={self.slurm}/munged.log", f"--seed-file={self.slurm}/seed")
        self.until(lambda: (self.slurm / "munge.socket").exists(), "munged did not start")
        self.start("slurmctld", "-D")
        self.start("slurmd", "-D")
        self.until(lambda: "idle" in self.ask("sinfo", "-h", check=False), "Slurm's machine did not become idle")

    def start(self, *command):
        with open(self.slurm / f"{command[0]}.out", "w") as out:
            self.daemons.append(subprocess.Popen(command, env=self.environment, stdout=out, stderr=out))

    def end_daemons(self):
        if len(self.daemons) == len(DAEMONS):
            self.ask("scancel", "--user=root", check=False)
            end = time.monotonic() + 25
            while self.ask("squeue", "-h", check=False) and time.monotonic() < end:
                time.sleep(0.2)
        for daemon in reversed(self.daemons):
            daemon.terminate()
            try:
                daemon.wait(timeout=10)
            except subprocess.TimeoutExpired:
                daemon.kill()
                daemon.wait()

    def ask(self, *command, check=True):
        return subprocess.run([str(word) for word in command], env=self.environment, cwd=self.folder, capture_output=True, text=True, timeout=30,
                              check=check).stdout.strip()

    def log(self):
        return "".join(path.read_text() for path in sorted(self.folder.glob("job*.log")))

    def until(self, is_so, otherwise, within=30):
        end = time.monotonic() + within
        while not is_so():
            if time.monotonic() > end:
                daemons = "".join(path.read_text()[-1500:] for path in [*self.slurm.glob("*.log"), *self.slurm.glob("*.out")])
                raise AssertionError(f"{otherwise} within {within} s\n{self.log()}\n{daemons}")
            time.sleep(0.05)

    def submit(self, *arguments, options=()):
        """Of three tasks, unless options say otherwise: a host and three nodes."""
        return self.ask("sbatch", "--parsable", "-n", 3, "-o", self.folder / "job-%j.log", *options, SBATCH, SCENE, *STILL,
                        "--processor-time", RAY_S, "--stats", "told.json", "--progress", "none", *arguments)

    def state(self, job):
        words = dict(word.split("=", 1) for word in self.ask("scontrol", "show", "job", job).split() if "=" in word)
        return words["JobState"], int(words["Restarts"])

    def stop_in_the_middle(self, job, *command):
        self.until(lambda: (self.folder / "still.exr.journal").exists(), "nothing was kept")
        time.sleep(1)
        self.ask(*command)

    def assert_undisturbed(self, nodes):
        self.assert_resumed(json.loads((self.folder / "told.json").read_text()))
        self.assertEqual(self.run_alone("render", SCENE, *STILL, "-o", self.folder / "alone.exr", "-q").code, 0)
        self.assertEqual((self.folder / "still.exr").read_bytes(), (self.folder / "alone.exr").read_bytes())
        self.assertEqual(sorted(path.name for path in self.folder.glob("still*")), ["still.exr"], "what was kept is gone then")

    def test_a_warning_queues_the_job_again_and_it_goes_on(self):
        job = self.submit("-o", "still.exr")
        self.stop_in_the_middle(job, "scancel", "--signal=USR1", "--batch", job)
        self.until(lambda: self.state(job) == ("PENDING", 1), "the job was not queued again")
        self.assertTrue((self.folder / "still.partial.png").exists())
        self.assertFalse((self.folder / "still.exr").exists())
        self.until(lambda: self.state(job) == ("COMPLETED", 1), "the job did not go on", 60)
        log = self.log()
        for text in ("first run: a host and 3 nodes", "stopped; frames that were finished are in place", "queues itself again",
                     "restart 1: a host and 3 nodes", "is complete"):
            self.assertIn(text, log)
        self.assert_undisturbed(3)

    def test_a_cancelled_job_keeps_what_it_has(self):
        job = self.submit("-o", "still.exr")
        self.stop_in_the_middle(job, "scancel", job)
        self.until(lambda: self.state(job) == ("CANCELLED", 0) and not self.ask("squeue", "-h"), "the job was not cancelled")
        # Only a host that stops by itself writes this.
        self.assertTrue((self.folder / "still.partial.png").exists(), self.log())
        self.assertIn("was cancelled; submit the same line again", self.log())
        again = self.submit("-o", "still.exr", options=["-n", "2"])
        self.until(lambda: self.state(again)[0] == "COMPLETED", "the second job did not go on", 60)
        self.assertIn("first run: a host and 2 nodes", self.log())
        self.assert_undisturbed(2)

    def test_what_fails_is_not_queued_again(self):
        job = self.submit("-o", "still.exr", "--size", "0x0")
        self.until(lambda: self.state(job)[0] == "FAILED", "the job did not fail")
        self.assertEqual(self.state(job)[1], 0)
        self.assertIn("rayfarm failed with code 1: the reason stands above", self.log())
        self.assertIn("--size", self.log())


if __name__ == "__main__":
    main()
