#!/usr/bin/env python3
"""Writes ggx_albedo.inc: the light that white microfacets send on at its first bounce.

Row i is of the roughness i / 31 (alpha is its square; of the first row very small), column k of the viewer's cosine c with
c (1 + alpha) / (c + alpha) = k / 31: so what happens where the cosine is about alpha, which the eye sees at the rims of
things, has its columns at any roughness. Each number is the mean of the weight G1(L) over visible normals (Heitz 2018,
"Sampling the GGX Distribution of Visible Normals"), at the middles of POINTS x POINTS cells of the unit square. The last
32 numbers are the rows' means over the hemisphere, weighed by the cosine. ggx.cpp reads them."""
import math
import os

STEPS, POINTS, MEAN_POINTS = 32, 128, 2000


def shadowing(cosine, alpha):
    """Smith's G1 of GGX."""
    return 2 * cosine / (cosine + math.sqrt(alpha * alpha + (1 - alpha * alpha) * cosine * cosine))


def sent_on(cosine, alpha):
    sine = math.sqrt(max(0.0, 1 - cosine * cosine))
    x, z = alpha * sine, cosine
    length = math.hypot(x, z)
    x, z = x / length, z / length  # the viewer, where facets are a hemisphere; in the plane y = 0
    lean = 0.5 * (1 + z)
    total = 0.0
    for j in range(POINTS):
        turn = 2 * math.pi * (j + 0.5) / POINTS
        c, s = math.cos(turn), math.sin(turn)
        for i in range(POINTS):
            r = math.sqrt((i + 0.5) / POINTS)
            p, q = r * c, r * s
            q = (1 - lean) * math.sqrt(1 - p * p) + lean * q
            up = math.sqrt(max(0.0, 1 - p * p - q * q))
            # Axes across the viewer: (0, 1, 0) and (-z, 0, x).
            nx, ny, nz = alpha * (-q * z + up * x), alpha * p, max(0.0, q * x + up * z)
            scale = 1 / math.sqrt(nx * nx + ny * ny + nz * nz)
            half = (nx * sine + nz * cosine) * scale
            light = 2 * half * nz * scale - cosine
            if light > 0:
                total += shadowing(light, alpha)
    return total / POINTS**2


def alpha_of(row):
    return max(1e-5, (row / (STEPS - 1)) ** 2)


def mean(values, alpha):
    total = 0.0
    for k in range(MEAN_POINTS):
        cosine = (k + 0.5) / MEAN_POINTS
        place = (STEPS - 1) * cosine * (1 + alpha) / (cosine + alpha)
        below = min(int(place), STEPS - 2)
        value = values[below] + (place - below) * (values[below + 1] - values[below])
        total += 2 * cosine * value / MEAN_POINTS
    return total


def main():
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), "ggx_albedo.inc")
    means = []
    with open(path, "w") as out:
        out.write("// Written by write_ggx_albedo.py, which says what these are.\n")

        def write(row):
            for first in range(0, STEPS, 16):
                out.write(" ".join("%.5f," % e for e in row[first:first + 16]) + "\n")

        for i in range(STEPS):
            alpha = alpha_of(i)
            places = [k / (STEPS - 1) for k in range(STEPS)]
            row = [sent_on(min(1.0, alpha * s / (1 + alpha - s)), alpha) for s in places]
            write(row)
            means.append(mean(row, alpha))
        write(means)


if __name__ == "__main__":
    main()
