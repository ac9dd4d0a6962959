#!/usr/bin/env python3
"""How fast files become scenes, and what memory that takes: the same mesh as OBJ, NFF and YAML.

    tests/bench/loading.py RAYFARM [RAYFARM ...] [--columns N]

Every program renders one small picture of each file, in turns, and the best of three counts. MB/s are of the file,
by all cores; bytes a triangle are the most that the process holds at once, less what it holds for a scene of two
triangles. Give two programs to compare them in one run.
"""
import argparse
import json
import os
import pathlib
import subprocess
import sys
import tempfile

HEAD = "view: {location: [0, 0, 4], look_at: [0, 0, 0]}\n"


def write_files(folder, columns, yaml_share):
    from write_scenes import bumpy_sphere
    points, triangles = bumpy_sphere(columns, columns // 2)
    number = "{:.6f}".format
    rows = [" ".join(map(number, p)) for p in points]
    with open(folder / "obj.obj", "w") as out:
        out.writelines(f"v {row}\n" for row in rows)
        out.writelines("f {} {} {}\n".format(*(i + 1 for i in t)) for t in triangles)
    (folder / "obj.yaml").write_text(HEAD + "scene: [{mesh: {file: obj.obj}}]\n")
    few = triangles[:int(len(triangles) * yaml_share)]
    with open(folder / "nff.nff", "w") as out:
        out.write("v\nfrom 0 0 4\nat 0 0 0\nup 0 1 0\nangle 45\nhither 1\nresolution 32 32\n")
        out.writelines("p 3\n" + "".join(rows[i] + "\n" for i in t) for t in triangles)
    with open(folder / "yaml.yaml", "w") as out:
        out.write(HEAD + "scene:\n- triangles:\n    points: [" +
                  ", ".join("[" + row.replace(" ", ", ") + "]" for row in rows[:max(map(max, few)) + 1]) + "]\n")
        out.write("    triangles: [" + ", ".join(f"[{a}, {b}, {c}]" for a, b, c in few) + "]\n")
    (folder / "none.yaml").write_text(HEAD + "scene: [{polygon: {points: [[0, 0, 0], [1, 0, 0], [0, 1, 0]]}}]\n")
    counts = {"obj": len(triangles), "nff": len(triangles), "yaml": len(few)}
    (folder / "counts.json").write_text(json.dumps(counts))


def run(program, folder, scene):
    stats = folder / "stats.json"
    process = subprocess.Popen([program, "render", folder / scene, "-o", folder / "out.png", "--size", "32x32", "-q",
                                "--stats", stats], stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    if status != 0:
        raise SystemExit(f"{program} failed on {scene}")
    return json.loads(stats.read_text())["time_s"], usage.ru_utime + usage.ru_stime, 1024 * usage.ru_maxrss


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs", nargs="+", metavar="RAYFARM")
    parser.add_argument("--columns", type=int, default=1000, help="of a mesh of about N² triangles (default: 1000)")
    parser.add_argument("--yaml-share", type=float, default=1, metavar="S",
                        help="of the triangles, in the YAML file: less for programs that need 12 kB for each (default: 1)")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        # By a process of its own: what this one holds would count as its children's.
        subprocess.run([sys.executable, "-c", "import pathlib, sys, loading; loading.write_files(pathlib.Path("
                        "sys.argv[1]), int(sys.argv[2]), float(sys.argv[3]))", name, str(options.columns),
                        str(options.yaml_share)],
                       check=True, cwd=pathlib.Path(__file__).parent)
        counts = json.loads((folder / "counts.json").read_text())
        files = {"obj": "obj.obj", "nff": "nff.nff", "yaml": "yaml.yaml"}
        print("| program | file | triangles | MB | load s | MB/s | build s | CPU s | bytes a triangle |")
        print("|---|---|---:|---:|---:|---:|---:|---:|---:|")
        for form, triangles in counts.items():
            scene = form + (".nff" if form == "nff" else ".yaml")
            size = (folder / files[form]).stat().st_size / 1e6
            best = {p: [] for p in options.programs}
            for _ in range(3):
                for program in options.programs:
                    best[program].append(run(program, folder, scene))
            for program in options.programs:
                least = run(program, folder, "none.yaml")[2]
                load = min(t["load"] for t, _, _ in best[program])
                build = min(t["build"] for t, _, _ in best[program])
                cpu = min(c for _, c, _ in best[program])
                peak = min(p for _, _, p in best[program]) - least
                print(f"| {program} | {form} | {triangles} | {size:.1f} | {load:.2f} | {size / load:.0f} | {build:.2f} "
                      f"| {cpu:.2f} | {peak / triangles:.0f} |", flush=True)


if __name__ == "__main__":
    main()
