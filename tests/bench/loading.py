#!/usr/bin/env python3
"""How fast files become scenes, and what memory that takes: the same mesh as OBJ, as OBJ with normals and coordinates,
as NFF and as YAML.

    tests/bench/loading.py RAYFARM [RAYFARM ...] [--columns N]

Every program renders one small picture of each file, in turns, and the best of three counts. MB/s are of the file,
by all cores; bytes a triangle are the most that the process holds at once, less what it holds for a scene of two
triangles. Give two programs to compare them in one run: the last column is the time of load and build, against that of
the first. With --ranks N they run under mpirun, and bytes are those of the host, which reads.
"""
import argparse
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import threading
import time

HEAD = "view: {location: [0, 0, 4], look_at: [0, 0, 0]}\n"


def write_files(folder, columns, yaml_share):
    from write_scenes import bumpy_sphere
    points, triangles = bumpy_sphere(columns, columns // 2)
    number = "{:.6f}".format
    rows = [" ".join(map(number, p)) for p in points]
    with open(folder / "obj.obj", "w") as out:
        out.writelines(f"v {row}\n" for row in rows)
        out.writelines("f {} {} {}\n".format(*(i + 1 for i in t)) for t in triangles)
    with open(folder / "full.obj", "w") as out:
        out.writelines(f"v {row}\nvt {i % columns / columns:.6f} {i // columns / columns:.6f}\nvn {row}\n" for i, row in enumerate(rows))
        out.writelines("f {0}/{0}/{0} {1}/{1}/{1} {2}/{2}/{2}\n".format(*(i + 1 for i in t)) for t in triangles)
    (folder / "full.yaml").write_text(HEAD + "scene: [{mesh: {file: full.obj, smooth: phong}}]\n")
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
    counts = {"obj": len(triangles), "full": len(triangles), "nff": len(triangles), "yaml": len(few)}
    (folder / "counts.json").write_text(json.dumps(counts))


class Peak(threading.Thread):
    """Watches what the host holds: of mpirun's first child, or of the process itself."""

    def __init__(self, pid, is_farm):
        super().__init__()
        self.pid, self.is_farm, self.bytes = pid, is_farm, 0

    def host(self):
        if not self.is_farm:
            return self.pid
        children = pathlib.Path(f"/proc/{self.pid}/task/{self.pid}/children").read_text().split()
        return min(map(int, children), default=self.pid)

    def run(self):
        while True:
            try:
                status = pathlib.Path(f"/proc/{self.host()}/status").read_text()
                self.bytes = max(self.bytes, 1024 * int(status.split("VmHWM:")[1].split()[0]))
            except (OSError, IndexError):
                return
            time.sleep(0.005)


def run(program, folder, scene, ranks):
    stats = folder / "stats.json"
    launch = ["mpirun", "--oversubscribe", "--allow-run-as-root", "-n", str(ranks)] if ranks > 1 else []
    process = subprocess.Popen(launch + [program, "render", folder / scene, "-o", folder / "out.png", "--size", "32x32",
                                         "-q", "--stats", stats], stdout=subprocess.DEVNULL)
    peak = Peak(process.pid, ranks > 1)
    peak.start()
    _, status, usage = os.wait4(process.pid, 0)
    peak.join()
    if status != 0:
        raise SystemExit(f"{program} failed on {scene}")
    most = peak.bytes if ranks > 1 else 1024 * usage.ru_maxrss
    return json.loads(stats.read_text())["time_s"], usage.ru_utime + usage.ru_stime, most


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs", nargs="+", metavar="RAYFARM")
    parser.add_argument("--columns", type=int, default=1000, help="of a mesh of about N² triangles (default: 1000)")
    parser.add_argument("--ranks", type=int, default=1, help="processes of each render (default: 1)")
    parser.add_argument("--only", nargs="+", metavar="FORM", help="of obj, full, nff and yaml")
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
        files = {"obj": "obj.obj", "full": "full.obj", "nff": "nff.nff", "yaml": "yaml.yaml"}
        print("| program | file | triangles | MB | load s | MB/s | build s | CPU s | bytes a triangle | of the first's time |")
        print("|---|---|---:|---:|---:|---:|---:|---:|---:|---:|")
        for form, triangles in counts.items():
            if options.only and form not in options.only:
                continue
            first = None
            scene = form + (".nff" if form == "nff" else ".yaml")
            size = (folder / files[form]).stat().st_size / 1e6
            best = {p: [] for p in options.programs}
            for _ in range(3):
                for program in options.programs:
                    best[program].append(run(program, folder, scene, options.ranks))
            for program in options.programs:
                least = run(program, folder, "none.yaml", options.ranks)[2]
                load = min(t["load"] for t, _, _ in best[program])
                build = min(t["build"] for t, _, _ in best[program])
                cpu = min(c for _, c, _ in best[program])
                first = first or load + build
                peak = min(p for _, _, p in best[program]) - least
                print(f"| {program} | {form} | {triangles} | {size:.1f} | {load:.2f} | {size / load:.0f} | {build:.2f} "
                      f"| {cpu:.2f} | {peak / triangles:.0f} | {(load + build) / first:.2f} |", flush=True)


if __name__ == "__main__":
    main()
