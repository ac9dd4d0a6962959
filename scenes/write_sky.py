#!/usr/bin/env python3
"""Writes sky.hdr (Radiance RGBE, linear Rec. 709): a clear afternoon sky with its sun over dull ground, all directions.

Columns run from +x over +z, the first row is the zenith. Numbers are radiance relative to a white screen.
"""
import math
import os
import struct

WIDTH, HEIGHT = 192, 96
SUN = (2.2, 0.62)  # longitude and height, radians
SUN_RADIUS = 0.035


def direction(longitude, height):
    return (math.cos(height) * math.cos(longitude), math.sin(height), math.cos(height) * math.sin(longitude))


def radiance(longitude, height):
    toward_sun = math.acos(max(-1, min(1, sum(a * b for a, b in zip(direction(longitude, height), direction(*SUN))))))
    if height < 0:
        return tuple(c * (0.5 + 0.5 * math.exp(6 * height)) for c in (0.16, 0.15, 0.13))
    up = math.sin(height) ** 0.45
    sky = [low + up * (high - low) for low, high in zip((0.95, 0.88, 0.80), (0.16, 0.32, 0.75))]
    glow = 0.9 * math.exp(-4 * toward_sun)
    sun = 900 if toward_sun < SUN_RADIUS else 0
    return tuple(s + tint * (glow + sun) for s, tint in zip(sky, (1.0, 0.85, 0.62)))


def rgbe(color):
    largest = max(color)
    if largest < 1e-32:
        return b"\0\0\0\0"
    mantissa, exponent = math.frexp(largest)
    scale = mantissa * 256 / largest
    return struct.pack("4B", *(int(c * scale) for c in color), exponent + 128)


def main():
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), "sky.hdr")
    with open(path, "wb") as out:
        out.write(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y %d +X %d\n" % (HEIGHT, WIDTH))
        for row in range(HEIGHT):
            height = math.pi * (0.5 - (row + 0.5) / HEIGHT)
            line = [rgbe(radiance(2 * math.pi * (column + 0.5) / WIDTH, height)) for column in range(WIDTH)]
            out.write(struct.pack(">HH", 0x0202, WIDTH))  # run-length form, without runs
            for channel in range(4):
                values = bytes(texel[channel] for texel in line)
                for begin in range(0, WIDTH, 128):
                    part = values[begin:begin + 128]
                    out.write(bytes([len(part)]) + part)


if __name__ == "__main__":
    main()
