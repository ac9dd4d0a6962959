#!/usr/bin/env python3
"""What the farm itself costs: the host's share of a core, the wait between the last ray and the file, and small frames.

One host and N nodes under mpirun. Emulated processors (--processor-time) sleep while they "trace", so that more of them
than cores run at full speed and what is missing is the farm's; without them nodes trace as fast as they can. Best of
several runs each.

    tests/bench/farm.py [--nodes 1 2 4 8] [--runs 3] [--rayfarm BINARY] [--json F]
"""
import argparse
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

import write_scenes

SOURCE = pathlib.Path(__file__).resolve().parents[2]
PROCESSOR_TIME_S = 40e-6  # a ray
SIZE_PX = 512
SMALL_FRAMES = 100


def run(command, folder):
    """The statistics of a render, and its time of the clock."""
    begin = time.monotonic()
    done = subprocess.run([*command, "--stats", "stats.json", "-q"], cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    took = time.monotonic() - begin
    if done.returncode != 0:
        sys.exit(f"farm: {' '.join(map(str, command))} failed: {done.stderr.strip()}")
    return json.loads((folder / "stats.json").read_text()), took


def farm_run(rayfarm, nodes, is_emulated, folder):
    script = f". '{SOURCE}/deploy/mpi-env' && exec mpirun -n {nodes + 1} '{rayfarm}' render \"$@\""
    size = SIZE_PX // 2 if is_emulated else 2 * SIZE_PX
    command = ["bash", "-c", script, "bash", "room.yaml", "-o", "room.png", "--size", f"{size}x{size}"]
    if is_emulated:
        command += ["--processor-time", str(PROCESSOR_TIME_S)]
    stats, _ = run(command, folder)
    times = stats["time_s"]
    frame_s = times["trace"] + times["finish"]
    return {"nodes": nodes, "is_emulated": is_emulated, "frame_s": frame_s,
            "rays_s": sum(stats["rays"].values()) / times["trace"],
            "use": sum(n["busy_s"] for n in stats["nodes"]) / (nodes * times["trace"]),
            "host_share": times["host_cpu"] / frame_s, "finish_s": times["finish"]}


def small_frames(rayfarm, runs, folder):
    """What a picture of 64×64 pixels takes, alone and in a sequence, in one process."""
    command = [rayfarm, "render", SOURCE / "scenes/primitives.yaml", "--size", "64x64"]
    alone = [run([*command, "-o", "small.png"], folder) for _ in range(3 * runs)]
    sequence = [run([*command, "-o", "small.####.png", "--frames", f"0-{SMALL_FRAMES - 1}"], folder)[1] for _ in range(runs)]
    stats, took = min(alone, key=lambda each: each[1])
    times = stats["time_s"]
    return {"command_s": took, "load_s": times["load"] + times["build"], "trace_s": times["trace"], "finish_s": times["finish"],
            "frames": SMALL_FRAMES, "each_s": (min(sequence) - took) / (SMALL_FRAMES - 1)}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--nodes", type=int, nargs="+", default=[1, 2, 4, 8])
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--rayfarm", type=pathlib.Path, default=SOURCE / "build/rayfarm", help="the program to measure")
    parser.add_argument("--json", type=pathlib.Path, help="write the results here")
    options = parser.parse_args()
    rayfarm = options.rayfarm.resolve()
    if not shutil.which("mpirun"):
        parser.error("mpirun was not found; apt-get install openmpi-bin")
    if not os.access(rayfarm, os.X_OK):
        parser.error(f"{rayfarm} was not found; run deploy/setup first")
    if min(options.nodes + [options.runs]) < 1:
        parser.error("nodes and runs are at least 1")
    cores = len(os.sched_getaffinity(0))
    results = []
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        write_scenes.write_scene("room", folder, ["rayfarm"])
        for is_emulated in (False, True):
            for nodes in options.nodes:
                if not is_emulated and nodes > 2 * cores:
                    continue  # they would only wait for cores
                best = min((farm_run(rayfarm, nodes, is_emulated, folder) for _ in range(options.runs)), key=lambda r: r["frame_s"])
                results.append(best)
                print(f"{nodes} {'emulated ' if is_emulated else ''}nodes: {1e3 * best['frame_s']:.0f} ms a frame, nodes at work "
                      f"{100 * best['use']:.1f} %, host {100 * best['host_share']:.2f} % of a core, last ray to file "
                      f"{1e3 * best['finish_s']:.1f} ms", flush=True)
        small = small_frames(rayfarm, options.runs, folder)
        print(f"64×64 pixels: {1e3 * small['command_s']:.1f} ms from command to end, {1e3 * small['each_s']:.2f} ms each in a sequence")
    if options.json:
        options.json.write_text(json.dumps({"cores": cores, "size": f"{2 * SIZE_PX}×{2 * SIZE_PX} ({SIZE_PX // 2}×{SIZE_PX // 2} emulated)",
                                            "processor_time_s": PROCESSOR_TIME_S, "runs": results, "small": small}, indent=1) + "\n")


if __name__ == "__main__":
    main()
