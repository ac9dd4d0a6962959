#!/usr/bin/env python3
"""Makes results.json, a page with tables and a plot from what the benchmarks measured, and prints what is wanted and reached.

    tests/bench/report.py FOLDER [--with OTHER ...]

FOLDER holds what was measured: embree-SCENE.json (of against_embree), first_ray.jsonl (a line for each run), frames.json,
farm.json, refit.json, library.json, noise.json (of equal_noise.py) and machine.txt; what is missing is said and left out. README.md, results.json and the plots are written
there. OTHER is another machine's results.json, or its folder; its figures stand beside this one's.
"""
import argparse
import datetime
import json
import pathlib
import platform
import re
import subprocess
import sys

from wanted import KINDS, SHORT, TINYBVH, geometric_mean, name_of_tinybvh, rays_of, wanted_table

MODES = {"default": "one ray at a time", "robust": "one ray at a time, Embree ROBUST",
         "packets": "Rayfarm in packets of 8, Embree one ray at a time",
         "tinybvh": f"one ray at a time, against {TINYBVH}", "tinybvh_splits": "the same, built with spatial splits"}
MOST_HITS_DIFFER = 1e-4


# ---- collecting --------------------------------------------------------------------------------------------------

def machine(folder):
    named = folder / "machine.txt"
    text = named.read_text() if named.exists() else pathlib.Path("/proc/cpuinfo").read_text()
    model = re.search(r"model name\s*:\s*(.*)", text)
    return model.group(1).strip() if model else platform.machine()


def read_json(text, path):
    try:
        return json.loads(text)
    except json.JSONDecodeError as e:
        sys.exit(f"report: {path} is damaged ({e}); measure again")


def collect_embree(path, results):
    content = read_json(path.read_text(), path)
    if "tinybvh" in content["context"]:
        results["tinybvh"] = content["context"]["tinybvh"]
    for run in content["benchmarks"]:
        if run.get("error_occurred"):
            results["left_out"].append(f"{run['name']} failed: {run['error_message']}")
            continue
        scene, kind, *mode = re.sub(r"/(min_time:[^/]*|manual_time)", "", run["name"]).split("/")
        counters = {name: value for name, value in run.items() if name.startswith(("rayfarm_", "other_", "embree_"))
                    or name in ("ratio", "time_ratio", "hits_differ")}
        if kind == "build":
            results["builds"][scene] = counters
        else:
            results["rays"].setdefault(scene, {}).setdefault(kind, {})[mode[0]] = counters


def collect_first_ray(path):
    """The best of the runs, each figure for itself."""
    runs = [read_json(line, path) for line in path.read_text().splitlines()]
    best = {name: min(run[name] for run in runs) for name in runs[0]}
    return best | {"build_over_embree": best["build_cpu_s"] / best["embree_build_cpu_s"]}


def collect(folder):
    """One machine's results, from what lies in the folder."""
    results = {"machine": machine(folder), "date": datetime.date.today().isoformat(), "rays": {}, "builds": {}, "left_out": []}
    for path in sorted(folder.glob("embree-*.json")):
        if path.stat().st_size > 0:
            collect_embree(path, results)
        else:
            results["left_out"].append(f"{path.stem}: it ended early")
    if not results["rays"]:
        results["left_out"].append("rays against Embree")
    elif not any("tinybvh" in modes for kinds in results["rays"].values() for modes in kinds.values()):
        results["left_out"].append("tinybvh (RAYFARM_TINYBVH=FOLDER deploy/bench, where tiny_bvh.h lies)")
    if (first := folder / "first_ray.jsonl").exists() and first.stat().st_size > 0:
        results["first_ray"] = collect_first_ray(first)
    else:
        results["left_out"].append("the way to the first ray")
    for name, what in (("frames", "whole frames"), ("farm", "the farm"), ("refit", "updates between frames"), ("library", "compiled objects"),
                       ("noise", "noise against Cycles (tests/bench/equal_noise.py --json FOLDER/noise.json)")):
        path = folder / f"{name}.json"
        if not path.exists() or path.stat().st_size == 0:
            results["left_out"].append(what)
            continue
        content = read_json(path.read_text(), path)
        results[name] = content.get("benchmarks", content)
    results["left_out"] += [f"whole frames of {peer}" for peer in results.get("frames", {}).get("left_out", [])]
    return results


def read_other(path):
    if path.is_dir():
        return read_json(kept.read_text(), kept) if (kept := path / "results.json").exists() else collect(path)
    return read_json(path.read_text(), path)


# ---- tables ------------------------------------------------------------------------------------------------------

def having(machines, key):
    return [results for results in machines if results.get(key)]


def caption(results, machines):
    return f"\nMachine {results['letter']}:" if len(machines) > 1 else ""


def ray_tables(machines, out):
    scenes = list(dict.fromkeys(scene for results in machines for scene in results["rays"]))
    for mode, title in MODES.items():
        those = [results for results in machines if any(rays_of(results, mode, kind) for kind in KINDS)]
        if not those:
            continue
        columns = [(results, kind) for results in those for kind in KINDS]
        names = [kind + (f" ({results['letter']})" if len(machines) > 1 else "") for results, kind in columns]
        title = title.replace(TINYBVH, name_of_tinybvh(those))
        out.append(f"\n### {title}\n\n| scene | " + " | ".join(names) + " |\n|---|" + "---:|" * len(columns))
        for scene in scenes:
            found = [results["rays"].get(scene, {}).get(kind, {}).get(mode) for results, kind in columns]
            if any(found):
                out.append(f"| {scene} | " + " | ".join(
                    f"{f['ratio']:.2f} ({f['rayfarm_Mray/s']:.1f} M/s)" if f else "–" for f in found) + " |")
        means = [list(rays_of(results, mode, kind).values()) for results, kind in columns]
        out.append("| **geometric mean** | " + " | ".join(f"**{geometric_mean(m):.2f}**" if m else "–" for m in means) + " |")
        differ = [f"{scene}, {kind}: {100 * found['hits_differ']:.2f} %" for results in those for scene, kinds in results["rays"].items()
                  for kind, modes in kinds.items() for found in [modes.get(mode)] if found and found["hits_differ"] > MOST_HITS_DIFFER]
        if differ:
            out.append("\nOf so many rays more the two programs disagree whether they hit (the others' hits are in float): " + "; ".join(differ) + ".")


def build_tables(machines, out):
    if having(machines, "builds"):
        out.append("\n### Builds\n\nCPU time of all threads: Rayfarm's whole compilation of a loaded scene, Embree's commit at medium quality. Bytes "
                   "a primitive: nodes, leaves\nand vertices.")
    for results in having(machines, "builds"):
        out.append(caption(results, machines) + "\n| scene | Rayfarm | Embree | ratio | Rayfarm bytes | Embree bytes |\n|---|" + "---:|" * 5)
        for scene, b in results["builds"].items():
            out.append(f"| {scene} | {b['rayfarm_s']:.3f} s | {b['embree_s']:.3f} s | {b['time_ratio']:.2f} | {b['rayfarm_bytes']:.0f} | "
                       f"{b['embree_bytes']:.0f} |")


def first_ray_table(machines, out):
    those = having(machines, "first_ray")
    if not those:
        return
    out.append("\n### From OBJ to the first ray\n\n`mesh1m` in a process that does nothing else, best of several; the most memory less what the program "
               "takes to start.\n\n| machine | reading | building | CPU of building | Embree's | ratio | bytes a triangle |\n|---|" + "---:|" * 6)
    for results in those:
        f = results["first_ray"]
        out.append(f"| {results['letter']} | {f['load_s']:.2f} s | {f['build_s']:.2f} s | {f['build_cpu_s']:.2f} s | "
                   f"{f['embree_build_cpu_s']:.2f} s | {f['build_over_embree']:.2f} | {f['peak_bytes_each']:.0f} |")


def frame_tables(machines, out):
    for results in having(machines, "frames"):
        frames = results["frames"]
        out.append(f"\n## Whole frames\n{caption(results, machines)}\nTrace time of {frames['size_px']}×{frames['size_px']} pixels, one core, best of "
                   f"{frames['runs']}.\n\n| scene | Rayfarm | Tachyon | POV-Ray | Tachyon / Rayfarm | POV-Ray / Rayfarm |\n|---|" + "---:|" * 5)
        best = frames["best_s"]
        for scene, t in best.items():
            times = [f"{t[peer]:.3f} s" if peer in t else "–" for peer in ("rayfarm", "tachyon", "povray")]
            ratios = [f"{t[peer] / t['rayfarm']:.2f}" if peer in t else "–" for peer in ("tachyon", "povray")]
            out.append(f"| {scene} | " + " | ".join(times + ratios) + " |")
        if {"pot", "stadium"} <= best.keys():
            more = ", ".join(f"{label} {best['stadium'][key] / best['pot'][key]:.2f}" for label, key in
                             (("Rayfarm", "rayfarm"), ("Tachyon", "tachyon"), ("POV-Ray", "povray")) if key in best["pot"])
            out.append(f"\nThe mesh over two huge polygons (`stadium`) against the mesh alone (`pot`), the same eye rays: {more} times the time.")


def farm_tables(machines, out):
    for results in having(machines, "farm"):
        farm = results["farm"]
        out.append(f"\n## The farm\n{caption(results, machines)}\nOne host and so many nodes on {farm['cores']} cores, `room` at {farm['size']}. The host's "
                   "share is its CPU time, writing the file included, over the time of the frame; its wait, the time from the last ray to the\nlast file. Emulated processors take "
                   f"{1e6 * farm['processor_time_s']:.0f} µs a ray and use no CPU time while they do, so that the host's work shows alone. Use: the "
                   "nodes' time at work over\nall their time.\n\n| nodes | processors | frame | rays/s | use of the nodes | host's share | last ray to file |\n"
                   "|---:|---|" + "---:|" * 5)
        for r in farm["runs"]:
            out.append(f"| {r['nodes']} | {'emulated' if r['is_emulated'] else 'as they are'} | {1e3 * r['frame_s']:.0f} ms | {1e-6 * r['rays_s']:.2f} M | "
                       f"{100 * r['use']:.1f} % | {100 * r['host_share']:.2f} % | {1e3 * r['finish_s']:.1f} ms |")
        small = farm["small"]
        out.append(f"\nSmall frames, 64×64 pixels of `primitives`: a command alone {1e3 * small['command_s']:.0f} ms from start to end (loading and building "
                   f"{1e3 * small['load_s']:.1f} ms, tracing {1e3 * small['trace_s']:.1f} ms,\nlast ray to file {1e3 * small['finish_s']:.1f} ms); "
                   f"in a sequence of {small['frames']} frames {1e3 * small['each_s']:.2f} ms each.")


def update_tables(machines, out):
    for results in having(machines, "refit"):
        times = {tuple(r["name"].split("/")): r["cpu_time"] for r in results["refit"]}
        out.append(f"\n## Updates between frames\n{caption(results, machines)}\nCPU time before a frame's first ray, for so many objects that all move (poses "
                   "and refit) or of which half come and go (links, refit,\ntable of lights). The thesis's Table 4.6 has 2.1 to 3.2 ms for its three images, "
                   "at 157 µs for each object node.\n\n| objects | all move | half come and go |\n|---:|---:|---:|")
        for count in sorted({int(name[1]) for name in times}):
            out.append(f"| {count:,} | {times['refit_frame', str(count)]:,.1f} µs | {times['links_frame', str(count)]:,.1f} µs |")


def library_tables(machines, out):
    for results in having(machines, "library"):
        out.append(f"\n## Compiled objects\n{caption(results, machines)}\nWall time from the scene's name to the compiled block: a mesh read from OBJ and "
                   "built, and the same from a file of `rayfarm compile`, in turn.\n\n| triangles | read OBJ | build | from the file | ratio to both | to "
                   "the build alone |\n|---:|" + "---:|" * 5)
        for r in results["library"]:
            out.append(f"| {int(r['name'].split('/')[1]):,} | {r['read_s']:.3f} s | {r['build_s']:.3f} s | {r['library_s']:.3f} s | {r['ratio']:.2f} | "
                       f"{r['build_ratio']:.2f} |")


def plot(results, folder):
    """Bars of one machine's ratios to Embree; False if there is nothing to draw, or nothing to draw it with."""
    rays = results["rays"]
    bars = [(mode, kind) for mode in ("default", "packets") for kind in KINDS if (mode, kind) != ("packets", "diffuse")]
    scenes = [scene for scene in rays if all(scene in rays_of(results, mode, kind) for mode, kind in bars)]
    if not scenes:
        return False
    lines = ["kind " + " ".join(scenes)]
    for mode, kind in bars:
        label = kind + ("" if mode == "default" else r"\nin\ packets")
        lines.append(f'"{label}" ' + " ".join(f"{rays[s][kind][mode]['ratio']:.3f}" for s in scenes))
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
    try:
        subprocess.run(["gnuplot", "ratios.gnuplot"], cwd=folder, check=True)
    except (OSError, subprocess.CalledProcessError) as e:
        print(f"report: no plot: {e}", file=sys.stderr)
        return False
    return True


def write_page(machines, folder):
    table, counts = wanted_table(machines)
    names = [f"{results['letter']}: {results['machine']}, {results['date']}" for results in machines]
    tells = [f"{results['letter']}: {short} of {measured} fall short{SHORT}" for results, (measured, short) in zip(machines, counts)]
    out = ["# Benchmarks", "\n" + "; ".join(names) + ". Again with `deploy/bench`. A ratio above 1 means that Rayfarm is faster.",
           "\n## Wanted and reached\n", *table, "\n" + "; ".join(tells) + ". Limits and means are of all scenes that were measured; "
           "– stands for what was not."]
    left_out = [f"{results['letter']}: {what}" for results in machines for what in results["left_out"]]
    if left_out:
        out.append("\nNot measured: " + "; ".join(left_out) + ".")
    if having(machines, "rays"):
        out.append("\n## The hierarchy against Embree 3.13.5\n\nThe same rays in one thread, alternating in chunks of 2,048; thread CPU time.")
        if plot(machines[0], folder):
            out.append("\n![rays per second against Embree](ratios.svg)")
        ray_tables(machines, out)
    for tables in (build_tables, first_ray_table, frame_tables, farm_tables, update_tables, library_tables):
        tables(machines, out)
    (folder / "README.md").write_text("\n".join(out) + "\n")
    print("\n".join([*names, "", *table, "", *tells, *(f"not measured: {what}" for what in left_out), f"{folder}/README.md"]))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--with", dest="others", type=pathlib.Path, nargs="+", default=[], metavar="OTHER")
    options = parser.parse_args()
    for path in (options.folder, *options.others):
        if not path.exists():
            parser.error(f"there is no {path}")
    others = [read_other(path) for path in options.others]
    results = collect(options.folder)
    (options.folder / "results.json").write_text(json.dumps(results, indent=1) + "\n")
    machines = [results, *others]
    for i, each in enumerate(machines):
        each["letter"] = chr(ord("A") + i)
    write_page(machines, options.folder)


if __name__ == "__main__":
    main()
