"""Pictures that do not change: renders every line of renders.txt and compares the SHA-256 of its float pixels.

golden.py check [NAME …]    on every SIMD target of the machine, and on three ranks; exit code 1 if a picture changed
golden.py record [NAME …]   writes the hashes anew, and says which changed; a commit that changes one says why

RAYFARM_ON_TARGET is the executable (default: build/rayfarm_on_target); RAYFARM_RUN a program to run it under.
"""
import concurrent.futures
import json
import os
import pathlib
import shlex
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
SOURCE = HERE.parents[1]
TABLE = HERE / "renders.txt"
PROGRAM = [*shlex.split(os.environ.get("RAYFARM_RUN", "")),
           os.environ.get("RAYFARM_ON_TARGET", str(SOURCE / "build" / "rayfarm_on_target"))]
RANKS = 3
sys.path.insert(0, str(HERE.parent / "jobs"))
from rayfarm_job import ENVIRONMENT  # noqa: E402


def read_table():
    """Lines of the table: text as it is, or (name, arguments, hash)."""
    lines = []
    for number, line in enumerate(TABLE.read_text().splitlines(), 1):
        if not line or line.startswith("#"):
            lines.append(line)
            continue
        fields = [field.strip() for field in line.split("|")]
        if len(fields) != 3:
            sys.exit(f"{TABLE}:{number}: not of the form NAME | ARGUMENTS | SHA-256")
        lines.append(tuple(fields))
    names = [line[0] for line in lines if isinstance(line, tuple)]
    if len(set(names)) != len(names):
        sys.exit(f"{TABLE}: a name stands twice")
    return lines


def run(command, target=None):
    environment = dict(ENVIRONMENT, **({"RAYFARM_SIMD": target} if target else {}))
    return subprocess.run(command, capture_output=True, text=True, timeout=120, env=environment, cwd=SOURCE)


def pixels_hash(arguments, target=None, ranks=1):
    """Of all frames' pixels, or a text that says what went wrong."""
    with tempfile.TemporaryDirectory(prefix="rayfarm-golden-") as folder:
        stats = f"{folder}/stats.json"
        launcher = ["mpirun", "-n", str(ranks)] if ranks > 1 else []
        command = [*launcher, *PROGRAM, "render", *shlex.split(arguments), "-o", f"{folder}/out.exr", "--pixel-format", "float",
                   "--stats", stats, "-q", *([] if launcher else ["--local-nodes", "1"])]
        result = run(command, target)
        if result.returncode != 0:
            return f"failed ({result.returncode}): {result.stderr.strip()}"
        return json.loads(pathlib.Path(stats).read_text())["image"]["sha256_pixels"]


def chosen(lines, names):
    renders = {line[0]: line[1:] for line in lines if isinstance(line, tuple)}
    for name in names:
        if name not in renders:
            sys.exit(f"{TABLE} has no '{name}'")
    return {name: renders[name] for name in names or renders}


def all_at_once(tasks):
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        return list(pool.map(lambda task: pixels_hash(*task), tasks))


def check(names):
    renders = chosen(read_table(), names)
    targets = run(PROGRAM, "list").stdout.split()
    if not targets:
        sys.exit(f"{PROGRAM[-1]} can't be run")
    where = [(target, 1) for target in targets]
    if not os.environ.get("RAYFARM_RUN"):
        where.append((targets[0], RANKS))
    tasks = [(name, expected, arguments, *place) for name, (arguments, expected) in renders.items() for place in where]
    found = all_at_once([(arguments, target, ranks) for _, _, arguments, target, ranks in tasks])
    changed = 0
    for (name, expected, _, target, ranks), result in zip(tasks, found):
        if result != expected:
            changed += 1
            print(f"{name} on {target}, {ranks} rank{'s' if ranks > 1 else ''}: {result}\n  expected {expected}")
    also = f" and on {RANKS} ranks" if (targets[0], RANKS) in where else ""
    print(f"{len(renders)} renders on {', '.join(targets)}{also}: "
          f"{f'{changed} of {len(tasks)} pictures changed' if changed else f'all {len(tasks)} pictures are the same'}")
    return 1 if changed else 0


def record(names):
    lines = read_table()
    renders = chosen(lines, names)
    found = dict(zip(renders, all_at_once([(arguments,) for arguments, _ in renders.values()])))
    failed = {name: result for name, result in found.items() if len(result) != 64}
    for name, result in failed.items():
        print(f"{name}: {result}")
    if failed:
        return 1
    for name, (_, before) in renders.items():
        if found[name] != before:
            print(f"{name}: {'changed' if before else 'new'}")
    text = [line if isinstance(line, str) else " | ".join((line[0], line[1], found.get(line[0], line[2]))) for line in lines]
    TABLE.write_text("\n".join(text) + "\n")
    print(f"{sum(found[name] != renders[name][1] for name in renders)} of {len(renders)} hashes written anew")
    return 0


if __name__ == "__main__":
    verbs = {"check": check, "record": record}
    if len(sys.argv) < 2 or sys.argv[1] not in verbs:
        sys.exit(__doc__)
    sys.exit(verbs[sys.argv[1]](sys.argv[2:]))
