#!/usr/bin/env python3
"""Writes smoke.nrrd: the density of a plume of smoke that rises, sways and comes apart, 48 × 88 × 48 cells of 8 bits.

Every cell's value is a function of its place alone: noise from a hash of whole numbers, no random state.
"""
import math
import os

NX, NY, NZ = 48, 88, 48


def hashed(x, y, z):
    """In [0, 1), from whole numbers."""
    n = (x * 73856093 ^ y * 19349663 ^ z * 83492791) & 0xFFFFFFFF
    n = (n ^ n >> 16) * 0x45D9F3B & 0xFFFFFFFF
    n = (n ^ n >> 16) * 0x45D9F3B & 0xFFFFFFFF
    return (n ^ n >> 16) / 2**32


def noise(x, y, z):
    """Values at whole numbers, joined smoothly."""
    i, j, k = math.floor(x), math.floor(y), math.floor(z)
    u, v, w = (t * t * (3 - 2 * t) for t in (x - i, y - j, z - k))
    total = 0
    for a, p in ((0, 1 - u), (1, u)):
        for b, q in ((0, 1 - v), (1, v)):
            for c, r in ((0, 1 - w), (1, w)):
                total += p * q * r * hashed(i + a, j + b, k + c)
    return total


def turbulence(x, y, z, octaves):
    return sum(noise(x * 2**o, y * 2**o, z * 2**o + 17 * o) / 2**o for o in range(octaves)) / (2 - 2 ** (1 - octaves))


def density(x, y, z):
    """At a height y from 0 to 1; x and z from -1 to 1 across."""
    # The column sways as a whole, more the higher it is, then curls on a smaller scale.
    x += 0.75 * y**1.2 * (noise(2.6 * y + 0.2, 0.5, 4.0) - 0.42) * 2
    z += 0.75 * y**1.2 * (noise(2.3 * y, 8.5, 1.0) - 0.5) * 2
    for scale, bend in ((2.0, 0.75), (4.5, 0.34)):
        p, q, r = scale * x, scale * 1.6 * y, scale * z
        x, z = (x + bend * y**0.9 * (noise(p, q, r) - 0.5), z + bend * y**0.9 * (noise(p + 31, q, r) - 0.5))
    radius = 0.045 + 0.20 * y**1.2
    core = math.exp(-((x * x + z * z) / (radius * radius)) ** 0.8)
    wisps = turbulence(5 * x, 7 * y, 5 * z + 5, 4)
    value = 1.15 * core * (0.10 / (0.10 + y)) ** 0.45 * max(0.0, 1 + 4.2 * y**0.35 * (wisps - 0.5))
    fade = min(1.0, ((1 - y) / 0.45) ** 1.5, y / 0.012)
    edge = min(1.0, (1 - max(abs(x), abs(z))) / 0.15)
    return max(0.0, min(1.0, value * max(0.0, fade) * max(0.0, edge)))


def main():
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), "smoke.nrrd")
    with open(path, "wb") as out:
        out.write(b"NRRD0004\n# written by write_smoke.py\ntype: uint8\ndimension: 3\nsizes: %d %d %d\nencoding: raw\n\n" % (NX, NY, NZ))
        for z in range(NZ):
            for y in range(NY):
                out.write(bytes(round(255 * density(2 * (x + 0.5) / NX - 1, (y + 0.5) / NY, 2 * (z + 0.5) / NZ - 1))
                                for x in range(NX)))


if __name__ == "__main__":
    main()
