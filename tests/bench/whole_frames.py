#!/usr/bin/env python3
"""Trace time of whole frames against Tachyon and POV-Ray (Debian: tachyon-bin-nox, povray).

One tracing rank against one tracing thread, alternating, the best of several runs each: a machine is noisy, so only the
ratios mean something. Every program renders the same scene from its own format (write_scenes.py), one ray per pixel,
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


def measure(scene, size, runs, folder):
    """The best time of each program, in seconds."""
    write_scenes.write_scene(scene, folder)
    programs = {"rayfarm": rayfarm, "tachyon": tachyon, "povray": povray}
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
    for program in ("tachyon-nox", "povray", "mpirun"):
        if not shutil.which(program):
            parser.error(f"{program} was not found; apt-get install tachyon-bin-nox povray openmpi-bin")
    if not os.access(SOURCE / "build/rayfarm", os.X_OK):
        parser.error("build/rayfarm was not found; run deploy/setup first")
    results = {}
    print(f"{'scene':<10} {'rayfarm':>10} {'tachyon':>10} {'povray':>10}   tachyon/rayfarm  povray/rayfarm")
    for scene in options.scenes or SCENES:
        with tempfile.TemporaryDirectory() as folder:
            best = results[scene] = measure(scene, options.size, options.runs, pathlib.Path(folder))
        print(f"{scene:<10} {best['rayfarm']:>8.3f} s {best['tachyon']:>8.3f} s {best['povray']:>8.3f} s "
              f"{best['tachyon'] / best['rayfarm']:>14.2f} {best['povray'] / best['rayfarm']:>15.2f}", flush=True)
    if {"pot", "stadium"} <= results.keys():
        for name in ("rayfarm", "tachyon", "povray"):
            print(f"{name}: the mesh in the stadium takes {results['stadium'][name] / results['pot'][name]:.2f} times as "
                  "long as the mesh alone")
    if options.json:
        options.json.write_text(json.dumps({"size_px": options.size, "runs": options.runs, "best_s": results}, indent=1))


if __name__ == "__main__":
    main()
