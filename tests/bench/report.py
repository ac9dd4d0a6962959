#!/usr/bin/env python3
"""Makes a page with tables and a plot from what the benchmarks measured.

    tests/bench/report.py FOLDER    (with embree.json, refit.json, library.json and frames.json; writes README.md, ratios.svg and .png)
"""
import datetime
import json
import math
import pathlib
import platform
import re
import subprocess
import sys

KINDS = ["primary", "diffuse", "shadow"]
MODES = {"default": "one ray at a time", "robust": "one ray at a time, Embree ROBUST",
         "packets": "Rayfarm in packets of 8, Embree one ray at a time"}


def geometric_mean(values):
    return math.exp(sum(map(math.log, values)) / len(values))


def machine():
    text = pathlib.Path("/proc/cpuinfo").read_text()
    model = re.search(r"model name\s*:\s*(.*)", text)
    return model.group(1).strip() if model else platform.machine()


def read_embree(path):
    """{mode: {kind: {scene: counters}}} and {scene: build counters}."""
    rays, builds = {mode: {kind: {} for kind in KINDS} for mode in MODES}, {}
    for run in json.loads(path.read_text())["benchmarks"]:
        if run.get("error_occurred"):
            sys.exit(f"report: {run['name']} failed: {run['error_message']}")
        parts = run["name"].removesuffix("/manual_time").split("/")
        if parts[1] == "build":
            builds[parts[0]] = run
        else:
            rays[parts[2]][parts[1]][parts[0]] = run
    return rays, builds


def ray_tables(rays, out):
    scenes = list(rays["default"]["primary"])
    for mode, title in MODES.items():
        out.append(f"\n### {title}\n\n| scene | " + " | ".join(KINDS) + " |\n|---|" + "---:|" * len(KINDS))
        for scene in scenes:
            cells = [f"{rays[mode][k][scene]['ratio']:.2f} ({rays[mode][k][scene]['rayfarm_Mray/s']:.1f} M/s)" for k in KINDS]
            out.append(f"| {scene} | " + " | ".join(cells) + " |")
        means = [geometric_mean([rays[mode][k][s]["ratio"] for s in scenes]) for k in KINDS]
        out.append("| **geometric mean** | " + " | ".join(f"**{m:.2f}**" for m in means) + " |")


def build_table(builds, out):
    out.append("\n### Builds\n\nCPU time of all threads: Rayfarm's whole compilation of a loaded scene, Embree's commit at medium quality. Bytes a "
               "primitive: nodes, leaves\nand vertices.\n\n| scene | Rayfarm | Embree | ratio | Rayfarm bytes | Embree bytes |\n|---|" + "---:|" * 5)
    for scene, b in builds.items():
        out.append(f"| {scene} | {b['rayfarm_s']:.3f} s | {b['embree_s']:.3f} s | {b['time_ratio']:.2f} | {b['rayfarm_bytes']:.0f} | "
                   f"{b['embree_bytes']:.0f} |")


def frame_table(frames, out):
    out.append(f"\n## Whole frames\n\nTrace time of {frames['size_px']}×{frames['size_px']} pixels, one core, best of {frames['runs']}.\n\n"
               "| scene | Rayfarm | Tachyon | POV-Ray | Tachyon / Rayfarm | POV-Ray / Rayfarm |\n|---|" + "---:|" * 5)
    best = frames["best_s"]
    for scene, t in best.items():
        out.append(f"| {scene} | {t['rayfarm']:.3f} s | {t['tachyon']:.3f} s | {t['povray']:.3f} s | {t['tachyon'] / t['rayfarm']:.2f} | "
                   f"{t['povray'] / t['rayfarm']:.2f} |")
    if {"pot", "stadium"} <= best.keys():
        more = ", ".join(f"{label} {best['stadium'][key] / best['pot'][key]:.2f}" for label, key in
                         (("Rayfarm", "rayfarm"), ("Tachyon", "tachyon"), ("POV-Ray", "povray")))
        out.append(f"\nThe mesh over two huge polygons (`stadium`) against the mesh alone (`pot`), the same eye rays: {more} times the time.")


def update_table(runs, out):
    times = {tuple(r["name"].split("/")): r["cpu_time"] for r in runs}
    out.append("\n## Updates between frames\n\nCPU time before a frame's first ray, for so many objects that all move (poses and refit) or of which half "
               "come and go (links, refit,\ntable of lights). The thesis's Table 4.6 has 2.1 to 3.2 ms for its three images, "
               "at 157 µs for each object node.\n\n| objects | all move | half come and go |\n|---:|---:|---:|")
    for count in sorted({int(name[1]) for name in times}):
        out.append(f"| {count:,} | {times['refit_frame', str(count)]:,.1f} µs | {times['links_frame', str(count)]:,.1f} µs |")


def library_table(runs, out):
    out.append("\n## Compiled objects\n\nWall time from the scene's name to the compiled block: a mesh read from OBJ and built, and the same from a file of "
               "`rayfarm compile`, in turn.\n\n| triangles | read OBJ | build | from the file | ratio to both | to the build alone |\n|---:|" + "---:|" * 5)
    for r in runs:
        out.append(f"| {int(r['name'].split('/')[1]):,} | {r['read_s']:.3f} s | {r['build_s']:.3f} s | {r['library_s']:.3f} s | {r['ratio']:.2f} | "
                   f"{r['build_ratio']:.2f} |")


def plot(rays, folder):
    scenes = list(rays["default"]["primary"])
    lines = ["kind " + " ".join(scenes)]
    for mode in ("default", "packets"):
        for kind in KINDS:
            if mode == "packets" and kind == "diffuse":
                continue
            label = kind + ("" if mode == "default" else r"\nin\ packets")
            lines.append(f'"{label}" ' + " ".join(f"{rays[mode][kind][s]['ratio']:.3f}" for s in scenes))
    (folder / "ratios.dat").write_text("\n".join(lines) + "\n")
    script = f"""set style data histograms
set style histogram clustered gap 1
set style fill solid 0.8 noborder
set boxwidth 0.9
set grid ytics
set yrange [0:*]
set ylabel "rays per second, Embree = 1"
set key top left horizontal
set bmargin 4
set arrow from graph 0, first 1 to graph 1, first 1 nohead lw 2 front
set terminal svg size 900,420 font "sans,12"
set output "ratios.svg"
plot for [i=2:{len(scenes) + 1}] "ratios.dat" using i:xtic(1) title columnheader(i)
set terminal png size 900,420 font "sans,11"
set output "ratios.png"
replot
"""
    (folder / "ratios.gnuplot").write_text(script)
    subprocess.run(["gnuplot", "ratios.gnuplot"], cwd=folder, check=True)


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    folder = pathlib.Path(sys.argv[1])
    rays, builds = read_embree(folder / "embree.json")
    out = ["# Benchmarks", f"\n{machine()}, {datetime.date.today().isoformat()}; again with `deploy/bench`. A ratio above 1 means that Rayfarm is "
           "faster.\n\n![rays per second against Embree](ratios.svg)",
           "\n## The hierarchy against Embree 3.13.5\n\nThe same rays in one thread, alternating in chunks of 2,048; thread CPU time."]
    ray_tables(rays, out)
    build_table(builds, out)
    frame_table(json.loads((folder / "frames.json").read_text()), out)
    update_table(json.loads((folder / "refit.json").read_text())["benchmarks"], out)
    library_table(json.loads((folder / "library.json").read_text())["benchmarks"], out)
    plot(rays, folder)
    (folder / "README.md").write_text("\n".join(out) + "\n")
    print(f"{folder}/README.md")


if __name__ == "__main__":
    main()
