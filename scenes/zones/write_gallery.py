#!/usr/bin/env python3
"""Writes what gallery.yaml hangs on its walls, painting_1.png to painting_6.png, and gallery_mist.yaml, which is gallery.yaml with a medium.

    python3 scenes/zones/write_gallery.py [FOLDER]

The pictures are functions of place alone: noise comes from a hash of whole numbers. Colours below are sRGB, from 0 to 1.
"""
import math
import os
import struct
import sys
import zlib

HERE = os.path.dirname(os.path.abspath(__file__))


def hashed(x, y, seed=0):
    """In [0, 1), from whole numbers."""
    n = (x * 73856093 ^ y * 19349663 ^ seed * 83492791) & 0xFFFFFFFF
    n = (n ^ n >> 16) * 0x45D9F3B & 0xFFFFFFFF
    n = (n ^ n >> 16) * 0x45D9F3B & 0xFFFFFFFF
    return (n ^ n >> 16) / 2**32


def noise(x, y, seed=0, octaves=4):
    """Values at whole numbers, joined smoothly, at several scales: about 0.5."""
    total, weight = 0.0, 0.0
    for octave in range(octaves):
        i, j = math.floor(x), math.floor(y)
        u, v = (t * t * (3 - 2 * t) for t in (x - i, y - j))
        corner = [[hashed(i + a, j + b, seed + octave) for a in (0, 1)] for b in (0, 1)]
        low, high = (row[0] + u * (row[1] - row[0]) for row in corner)
        total += 0.5**octave * (low + v * (high - low))
        weight += 0.5**octave
        x, y = 2 * x + 17.3, 2 * y + 5.7
    return total / weight


def between(a, b, t):
    t = min(1.0, max(0.0, t))
    return tuple(p + t * (q - p) for p, q in zip(a, b))


def smooth(low, high, x):
    t = min(1.0, max(0.0, (x - low) / (high - low)))
    return t * t * (3 - 2 * t)


def hexed(text):
    return tuple(int(text[i:i + 2], 16) / 255 for i in (0, 2, 4))


def fields(x, y):
    """Two fields of colour with soft edges on a third."""
    wobble = 0.03 * (noise(9 * x, 9 * y, 3) - 0.5)
    ground = between(hexed("7a1712"), hexed("9c2a17"), noise(4 * x, 4 * y, 1))
    side = smooth(0.07, 0.13, x + wobble) * smooth(0.07, 0.13, 1 - x + wobble)
    upper = side * smooth(0.06, 0.11, y + wobble) * smooth(0.40, 0.45, 1 - y + wobble)
    lower = side * smooth(0.64, 0.69, y + wobble) * smooth(0.06, 0.11, 1 - y + wobble)
    color = between(ground, between(hexed("e0882a"), hexed("eeb04a"), noise(3 * x, 7 * y, 5)), upper)
    return between(color, between(hexed("37101d"), hexed("541a2a"), noise(3 * x, 7 * y, 9)), lower)


def grid(x, y):
    """Black bars and a few filled rectangles."""
    bars_x, bars_y = (0.0, 0.16, 0.38, 0.86, 1.0), (0.0, 0.22, 0.52, 0.83, 1.0)
    if any(abs(x - bar) < 0.014 for bar in bars_x[1:-1]) or any(abs(y - bar) < 0.018 for bar in bars_y[1:-1]):
        return hexed("141414")
    column = sum(x > bar for bar in bars_x) - 1
    row = sum(y > bar for bar in bars_y) - 1
    filled = {(2, 1): "c22018", (2, 0): "c22018", (0, 2): "1d3f94", (3, 3): "e8c01f", (1, 3): "20242c", (0, 0): "e8c01f"}
    return hexed(filled.get((column, row), "ece8dc"))


def rings(x, y):
    """Squares of concentric rings."""
    column, row = math.floor(4 * x), math.floor(3 * y)
    u, v = 4 * x - column - 0.5, 3 * y - row - 0.5
    palette = [hexed(c) for c in ("1f3b57", "d1495b", "edae49", "00798c", "f4ead5", "8d3b72", "30638e", "e07a3f", "3d7a4f")]
    radius = math.hypot(u, v) + 0.03 * (noise(14 * x, 14 * y, 2) - 0.5)
    ring = sum(radius > edge for edge in (0.12, 0.22, 0.31, 0.40, 0.47))
    return palette[int(9 * hashed(column + 5, row + 9, 7 * ring + 1))]


def waves(x, y):
    """Stripes that swell and lean."""
    phase = 26 * x + 2.6 * math.sin(5.2 * y + 1.5 * math.sin(3 * x)) + 1.2 * math.sin(11 * x)
    stripe = smooth(-0.25, 0.25, math.sin(2.2 * phase))
    return between(hexed("0e1a24"), between(hexed("f2efe4"), hexed("8fb8c4"), y), stripe)


def hills(x, y):
    """Hills behind hills, and a low sun."""
    color = between(hexed("33527a"), hexed("f3b06a"), y / 0.62)
    sun = math.hypot(1.4 * (x - 0.64), y - 0.42)
    color = between(hexed("fff0c2"), color, smooth(0.055, 0.062, sun) * (1 - 0.5 * math.exp(-9 * sun)))
    tones = ("c48a78", "8a6a7c", "4f5470", "2c3b4c", "16242c")
    for k, tone in enumerate(tones):
        top = 0.50 + 0.1 * k - 0.22 * (noise(2.2 * x + 3.1 * k, 0.5, 20 + k, 5) - 0.4)
        color = between(color, hexed(tone), smooth(0, 0.006, y - top))
    return color


def balls(x, y):
    """What every ray tracer draws first: two balls over a chequered floor."""
    eye, ray = (0.0, 1.0, -4.0), [1.6 * (x - 0.5), -1.2 * (y - 0.5) - 0.05, 1.35]
    weight, color = 1.0, (0.0, 0.0, 0.0)
    for _ in range(4):
        size = math.sqrt(sum(c * c for c in ray))
        ray = [c / size for c in ray]
        nearest, ball = 1e9, None
        for center, radius in (((-0.55, 1.0, 0.3), 0.85), ((0.95, 0.62, -0.7), 0.55)):
            apart = [o - c for o, c in zip(eye, center)]
            b = sum(p * q for p, q in zip(apart, ray))
            inside = b * b - sum(p * p for p in apart) + radius * radius
            if inside > 0 and 1e-6 < -b - math.sqrt(inside) < nearest:
                nearest, ball = -b - math.sqrt(inside), (center, radius)
        if not ball:
            if ray[1] < 0:
                t = -eye[1] / ray[1]
                px, pz = eye[0] + t * ray[0], eye[2] + t * ray[2]
                tile = hexed("d8402a") if (math.floor(px) + math.floor(pz)) % 2 else hexed("f2d25a")
                shade = min(1.0, min(0.35 + 0.9 * smooth(0.2, 1.5, math.hypot(px - cx, pz - cz) / r)
                                     for cx, cz, r in ((-0.75, 0.5, 0.85), (0.8, -0.5, 0.55))))
                seen = between(tuple(shade * c for c in tile), hexed("9cc3e6"), t / 34)
            else:
                seen = between(hexed("9cc3e6"), hexed("2a5fa8"), 1.6 * ray[1])
            return tuple(c + weight * s for c, s in zip(color, seen))
        center, radius = ball
        eye = tuple(o + nearest * d for o, d in zip(eye, ray))
        normal = [(p - c) / radius for p, c in zip(eye, center)]
        facing = sum(n * d for n, d in zip(normal, ray))
        ray = [d - 2 * facing * n for d, n in zip(ray, normal)]
        light = max(0.0, sum(a * b for a, b in zip(ray, (-0.5, 0.75, -0.43)))) ** 40
        color = tuple(c + weight * (0.9 * light + 0.06 * t) for c, t in zip(color, (0.3, 0.4, 0.5)))
        weight *= 0.78
    return color


PAINTINGS = ((fields, 180, 240), (grid, 240, 180), (rings, 288, 216), (waves, 240, 180), (hills, 288, 192), (balls, 256, 192))


def png(width, height, rows):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">2I5B", width, height, 8, 2, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(b"".join(b"\0" + row for row in rows), 9)) + chunk(b"IEND", b""))


def painted(paint, width, height):
    """Four points a pixel."""
    for j in range(height):
        row = bytearray()
        for i in range(width):
            points = [paint((i + a) / width, (j + b) / height) for a in (0.25, 0.75) for b in (0.25, 0.75)]
            row += bytes(min(255, max(0, int(255 * sum(p[c] for p in points) / 4 + 0.5))) for c in range(3))
        yield bytes(row)


MIST = """# The gallery of gallery.yaml with mist in it, after Figure 8 of Shirley, Sung and Brown (1991): a medium in zones of its own, which keep
# what it scatters; the lamps' beams show. write_gallery.py writes this file.
#   rayfarm render scenes/zones/gallery_mist.yaml -o scenes/zones/gallery_mist.png --lighting zonal --zone-rays 8000000 --zone-samples 256 --samples 625
media: [{box: {min: [-3.5, 0, -8], max: [3.5, 4.2, 3]}, scattering: 0.05, absorption: 0.003}]
"""


def mist():
    """The gallery behind another beginning."""
    with open(os.path.join(HERE, "gallery.yaml"), encoding="utf-8") as gallery:
        lines = gallery.readlines()
    while lines[0].startswith("#"):
        lines.pop(0)
    return MIST + "".join(lines)


def main():
    folder = sys.argv[1] if len(sys.argv) > 1 else HERE
    with open(os.path.join(folder, "gallery_mist.yaml"), "w", encoding="utf-8") as out:
        out.write(mist())
    for k, (paint, width, height) in enumerate(PAINTINGS):
        with open(os.path.join(folder, "painting_%d.png" % (k + 1)), "wb") as out:
            out.write(png(width, height, painted(paint, width, height)))


if __name__ == "__main__":
    main()
