#!/usr/bin/env python3
"""Trace time of whole frames against Tachyon and POV-Ray (Debian: tachyon-bin-nox, povray).

One tracing rank against one tracing thread, alternating, the best of several runs each: a machine is noisy, so only the
ratios mean something. A program that is not installed is left out. Every program renders the same scene from its own format (write_scenes.py), one ray per pixel,
with shadows and reflections; loading and building are not counted.

    tests/bench/whole_frames.py [SCENE ...] [--size 1024] [--runs 5] [--json F]
"""
import argparse
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import write_scenes

SOURCE = pathlib.Path(__file__).resolve().parents[2]
SCENES = ["balls", "mesh70k", "mesh1m", "room", "pot", "stadium"]


def rayfarm(scene, size, folder):
    stats = folder / "stats.json"
    script = f". '{SOURCE}/deploy/mpi-env' && exec mpirun -n 2 '{SOURCE}/build/rayfarm' render \"$@\""
    subprocess.run(["bash", "-c", script, "bash", f"{scene}.yaml", "-o", folder / "rayfarm.png", "--size",
                    f"{size}x{size}", "--max-depth", "5", "-q", "--stats", stats], check=True, stdout=subprocess.DEVNULL, cwd=folder)
    return json.loads(stats.read_text())["time_s"]["trace"]


def tachyon(scene, size, folder):
    text = subprocess.run(["tachyon-nox", f"{scene}.dat", "-res", str(size), str(size), "-numthreads", "1", "-nosave"],
                          capture_output=True, text=True, check=True, cwd=folder).stdout
    return float(re.search(r"Ray Tracing Time:\s*([0-9.]+)", text).group(1))


def povray(scene, size, folder):
    text = subprocess.run(["povray", f"+I{scene}.pov", f"+W{size}", f"+H{size}", "-D", "+WT1", "-A", "-F"],
                          capture_output=True, text=True, check=True, cwd=folder).stderr
    return float(re.search(r"Trace Time:.*\(([0-9.]+) seconds\)", text).group(1))


PROGRAMS = {"rayfarm": rayfarm, "tachyon": tachyon, "povray": povray}
COMMANDS = {"tachyon": "tachyon-nox", "povray": "povray"}
PACKAGES = {"tachyon": "tachyon-bin-nox", "povray": "povray"}


def measure(scene, size, runs, programs, folder):
    """The best time of each program, in seconds."""
    write_scenes.write_scene(scene, folder, list(programs))
    times = {name: [] for name in programs}
    for _ in range(runs):
        for name, run in programs.items():
            times[name].append(run(scene, size, folder))
    return {name: min(values) for name, values in times.items()}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help=f"default: {' '.join(SCENES)}")
    parser.add_argument("--size", type=int, default=1024, help="width and height in pixels")
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--json", type=pathlib.Path, help="write the times here")
    options = parser.parse_args()
    for name in options.scenes:
        if name not in write_scenes.SCENES:
            parser.error(f"no scene is called '{name}'; there are {', '.join(write_scenes.SCENES)}")
    if not shutil.which("mpirun"):
        parser.error("mpirun was not found; apt-get install openmpi-bin")
    if not os.access(SOURCE / "build/rayfarm", os.X_OK):
        parser.error("build/rayfarm was not found; run deploy/setup first")
    programs = {name: run for name, run in PROGRAMS.items() if name == "rayfarm" or shutil.which(COMMANDS[name])}
    left_out = [name for name in PROGRAMS if name not in programs]
    for name in left_out:
        print(f"whole_frames: {COMMANDS[name]} was not found and is left out; apt-get install {PACKAGES[name]}", file=sys.stderr)
    results = {}
    print(f"{'scene':<10}" + "".join(f" {name:>10}" for name in programs) + "".join(f"  {name}/rayfarm" for name in programs if name != "rayfarm"))
    for scene in options.scenes or SCENES:
        with tempfile.TemporaryDirectory() as folder:
            best = results[scene] = measure(scene, options.size, options.runs, programs, pathlib.Path(folder))
        print(f"{scene:<10}" + "".join(f" {best[name]:>8.3f} s" for name in programs)
              + "".join(f"{best[name] / best['rayfarm']:>{len(name) + 10}.2f}" for name in programs if name != "rayfarm"), flush=True)
    if {"pot", "stadium"} <= results.keys():
        for name in programs:
            print(f"{name}: the mesh in the stadium takes {results['stadium'][name] / results['pot'][name]:.2f} times as "
                  "long as the mesh alone")
    if options.json:
        options.json.write_text(json.dumps({"size_px": options.size, "runs": options.runs, "left_out": left_out, "best_s": results}, indent=1))


if __name__ == "__main__":
    main()
