#!/usr/bin/env python3
"""What --noise does, on path-traced scenes: the error that comes of a target, and what the same rays give when they are shared out evenly.

Errors are differences from a picture of many samples of another seed, as displays show both (sRGB, 8 bits a channel, from 0 to 1): their root
mean square, and the share of pixels that are off by more than twice the target in a channel, which are those that one sees. A target E
bounds each pixel's standard error as if its samples were independent; Sobol's are better spread, so that the error is to come out below
E, but for pixels that need more than --samples, and those whose first samples miss what is rare.

    tests/bench/noise_target.py [--rayfarm build/rayfarm] [--size 96x72] [--converged 4096] [--samples 1024] [SCENE …]
"""
import argparse
import json
import math
import pathlib
import re
import subprocess
import tempfile

SOURCE = pathlib.Path(__file__).resolve().parents[2]
TARGETS = (0.04, 0.02, 0.01)
UNIFORM = (16, 32, 64, 128, 256, 512, 1024)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--rayfarm", default=SOURCE / "build" / "rayfarm")
    parser.add_argument("--size", default="96x72")
    parser.add_argument("--converged", type=int, default=4096)
    parser.add_argument("--samples", type=int, default=1024)
    parser.add_argument("scenes", nargs="*", default=[SOURCE / "scenes" / f"{name}.yaml" for name in ("materials", "diffuse_room")])
    options = parser.parse_args()
    for scene in options.scenes:
        with tempfile.TemporaryDirectory(prefix="rayfarm-noise-") as folder:
            measure(options, pathlib.Path(scene), pathlib.Path(folder))


def measure(options, scene, folder):
    def render(name, *arguments):
        """(file, rays, seconds, samples per pixel)"""
        stats = folder / "stats.json"
        subprocess.run([options.rayfarm, "render", scene, "-o", folder / name, "--size", options.size, "--lighting", "path", "--stats",
                        stats, "-q", "--local-nodes", "1", *map(str, arguments)], check=True, stdout=subprocess.DEVNULL)
        found = json.loads(stats.read_text())
        pixels = found["image"]["width"] * found["image"]["height"]
        return folder / name, sum(found["rays"].values()), found["time_s"]["trace"], found["rays"]["primary"] / pixels

    def errors(picture, target=0.0):
        """(root mean square, percentage of pixels off by more than twice the target)"""
        text = subprocess.run([options.rayfarm, "compare", picture, reference, "--tolerance", str(2 * target)], capture_output=True,
                              text=True).stdout
        return float(re.search(r"RMSE ([-+.e0-9]+)", text)[1]), float(re.search(r"\(([-+.e0-9]+) %\)", text)[1])

    reference = render("reference.png", "--samples", options.converged, "--seed", 1)[0]
    print(f"{scene.stem}, {options.size}, reference of {options.converged} samples")
    print("                 samples    RMSE        rays  seconds")
    even = []
    for samples in (n for n in UNIFORM if n <= options.samples):
        picture, rays, seconds, _ = render(f"even-{samples}.png", "--samples", samples)
        even.append((rays, picture))
        print(f"  evenly       {samples:9.1f}  {errors(picture)[0]:.4f}  {rays:10}  {seconds:7.2f}", flush=True)
    for target in TARGETS:
        picture, rays, seconds, samples = render(f"noise-{target}.png", "--samples", options.samples, "--noise", target)
        rmse, off = errors(picture, target)
        same_rmse, same_off = at_equal_rays([(r, *errors(p, target)) for r, p in even], rays)
        print(f"  --noise {target:<5g}{samples:9.1f}  {rmse:.4f}  {rays:10}  {seconds:7.2f}   off by more than {2 * target:g}: {off:.2f} % of pixels; "
              f"the same rays evenly: RMSE {same_rmse:.4f}, {same_off:.2f} %", flush=True)


def at_equal_rays(curve, rays):
    """The other two numbers of a curve of (rays, RMSE, percentage), between its points in the logarithm of rays."""
    for (r0, *before), (r1, *after) in zip(curve, curve[1:]):
        if r0 <= rays <= r1:
            t = math.log(rays / r0) / math.log(r1 / r0)
            return [a + (b - a) * t for a, b in zip(before, after)]
    return math.nan, math.nan


if __name__ == "__main__":
    main()
