#!/usr/bin/env python3
"""Trace time of whole frames against Tachyon (Debian: tachyon-bin-nox) on NFF scenes that both read.

One tracing rank against one tracing thread, alternating, the best of several runs each: the machine is noisy, so only
the ratio means something. Both render one ray per pixel with shadows and reflections; Tachyon's own limits apply
(its depth, its shading), so the number of rays is near but not the same, and is printed for Rayfarm.

    tests/bench/against_tachyon.py ../shared/assets/spd/balls.nff [--size 1024] [--runs 5]
"""
import argparse
import json
import os
import pathlib
import re
import subprocess
import tempfile

SOURCE = pathlib.Path(__file__).resolve().parents[2]


def rayfarm(scene, size, folder):
    stats = pathlib.Path(folder) / "stats.json"
    script = f". '{SOURCE}/deploy/mpi-env' && exec mpirun -n 2 '{SOURCE}/build/rayfarm' render \"$@\""
    subprocess.run(["bash", "-c", script, "bash", scene, "-o", f"{folder}/out.png", "--size", f"{size}x{size}", "-q",
                    "--stats", str(stats)], check=True, stdout=subprocess.DEVNULL)
    told = json.loads(stats.read_text())
    return told["time_s"]["trace"], sum(told["rays"].values())


def tachyon(scene, size):
    text = subprocess.run(["tachyon-nox", scene, "-res", str(size), str(size), "-numthreads", "1", "-nosave"],
                          capture_output=True, text=True, check=True).stdout
    return float(re.search(r"Ray Tracing Time:\s*([0-9.]+)", text).group(1))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="+")
    parser.add_argument("--size", type=int, default=1024)
    parser.add_argument("--runs", type=int, default=5)
    options = parser.parse_args()
    print(f"{'scene':<12} {'rayfarm':>9} {'tachyon':>9}   tachyon/rayfarm")
    for scene in options.scenes:
        ours, theirs, rays = [], [], 0
        with tempfile.TemporaryDirectory() as folder:
            for _ in range(options.runs):
                seconds, rays = rayfarm(scene, options.size, folder)
                ours.append(seconds)
                theirs.append(tachyon(scene, options.size))
        print(f"{os.path.basename(scene):<12} {min(ours):>7.3f} s {min(theirs):>7.3f} s   {min(theirs) / min(ours):.2f}"
              f"   ({rays / 1e6:.2f} M rays, best of {options.runs})", flush=True)


if __name__ == "__main__":
    main()
