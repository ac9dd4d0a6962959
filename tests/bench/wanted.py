"""What the benchmarks are to reach, and the table of what they reach: one column for each machine.

A row is a title, its limits, whether more is better, and a function of one machine's results (see report.py) that gives
as many (value, note)s, or None for what was not measured there.
"""
import math

TINYBVH = "tinybvh's BVH8_CPU"
KINDS = ["primary", "diffuse", "shadow"]
SHORT = " ▼"


def geometric_mean(values):
    return math.exp(sum(map(math.log, values)) / len(values))


def rays_of(results, mode, kind):
    """{scene: ratio}"""
    return {scene: modes[mode]["ratio"] for scene, kinds in results.get("rays", {}).items()
            for modes in [kinds.get(kind, {})] if mode in modes}


def mean_ratio(mode):
    def values(results):
        found = [rays_of(results, mode, kind) for kind in KINDS]
        return [(geometric_mean(list(ratios.values())), "") if ratios else None for ratios in found]
    return values


def worst_ratio(mode):
    def values(results):
        found = [rays_of(results, mode, kind) for kind in KINDS]
        return [(ratios[worst], worst) if ratios else None
                for ratios in found for worst in [min(ratios, key=ratios.get, default=None)]]
    return values


def frame_ratio(peer, scenes):
    def values(results):
        best = results.get("frames", {}).get("best_s", {})
        return [(best[s][peer] / best[s]["rayfarm"], "") if peer in best.get(s, {}) else None for s in scenes]
    return values


def first_ray(*names):
    def values(results):
        found = results.get("first_ray", {})
        return [(found[name], "") if name in found else None for name in names]
    return values


def noise_ratios(results):
    return [(ratio, "") for ratio in results["noise"]["ratios"]] if "noise" in results else [None] * 3


TABLE = [
    ("single rays against Embree: primary, diffuse, shadow (geometric means)", (1.15,) * 3, True, mean_ratio("default")),
    ("– the worst scene", (1.0,) * 3, True, worst_ratio("default")),
    ("single rays against Embree ROBUST (watertight, as Rayfarm always is)", (1.4,) * 3, True, mean_ratio("robust")),
    ("packets of 8 against Embree's single rays", (2.2, 1.15, 1.8), True, mean_ratio("packets")),
    (f"single rays against {TINYBVH} by surface areas: the worst scene", (1.15,) * 3, True, worst_ratio("tinybvh")),
    ("– built with spatial splits: the worst scene", (1.15,) * 3, True, worst_ratio("tinybvh_splits")),
    ("whole frames against Tachyon: room, pot, mesh70k, balls, mesh1m", (2.5, 4, 5, 8, 8), True,
     frame_ratio("tachyon", ("room", "pot", "mesh70k", "balls", "mesh1m"))),
    ("whole frames against POV-Ray: room, balls, pot, mesh70k, mesh1m", (4, 5, 12, 12, 12), True,
     frame_ratio("povray", ("room", "balls", "pot", "mesh70k", "mesh1m"))),
    ("CPU time of paths to the noise of Cycles at 16, 64, 256 samples, over Cycles'", (0.6, 0.5, 0.4), False, noise_ratios),
    ("from OBJ to the first ray, a million triangles: reading, building (seconds of the clock)", (0.3, 0.4), False,
     first_ray("load_s", "build_s")),
    ("– CPU time of building, over Embree's", (1.2,), False, first_ray("build_over_embree")),
    ("– the most memory, bytes a triangle", (150,), False, first_ray("peak_bytes_each")),
]


def number(value):
    return f"{value:.0f}" if value >= 20 else f"{value:.2f}"


def is_short(value, limit, more_is_better):
    """As it is printed: what rounds to the limit reaches it."""
    value = float(number(value))
    return value < limit if more_is_better else value > limit


def cell(values, limits, more_is_better):
    """The text of a machine's cell, and how many of its values fall short."""
    texts, short = [], 0
    for value, limit in zip(values, limits):
        if value is None:
            texts.append("–")
            continue
        misses = is_short(value[0], limit, more_is_better)
        short += misses
        texts.append(number(value[0]) + (SHORT if misses else "") + (f" ({value[1]})" if value[1] else ""))
    return ", ".join(texts), short


def name_of_tinybvh(machines):
    """Honest about a header that is not the original: that one names its version."""
    rewritten = any(results.get("tinybvh", "").startswith("a reimplementation") for results in machines)
    return f"a reimplementation of {TINYBVH}" if rewritten else TINYBVH


def wanted_table(machines):
    """Lines of Markdown, and for each machine (values measured, values that fall short)."""
    lines = ["| | wanted |" + "".join(f" {results['letter']} |" for results in machines), "|---|---|" + "---|" * len(machines)]
    measured, short = [0] * len(machines), [0] * len(machines)
    for title, limits, more_is_better, values_of in TABLE:
        sign = "≥" if more_is_better else "≤"
        wanted = str(limits[0]) + (" each" if len(limits) > 1 else "") if len(set(limits)) == 1 else ", ".join(map(str, limits))
        cells = []
        for i, results in enumerate(machines):
            values = values_of(results)
            text, misses = cell(values, limits, more_is_better)
            measured[i] += sum(v is not None for v in values)
            short[i] += misses
            cells.append(text)
        title = title.replace(TINYBVH, name_of_tinybvh(machines))
        lines.append(f"| {title} | {sign} {wanted} | " + " | ".join(cells) + " |")
    return lines, list(zip(measured, short))
