"""Vectors, and points of the plane in circles."""
import math


def add(a, b):
    return tuple(x + y for x, y in zip(a, b))


def times(s, a):
    return tuple(s * x for x in a)


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def unit(a):
    return times(1 / math.hypot(*a), a)


def on_circle(radius, degrees):
    """A point of the plane; from the first axis toward the second."""
    return radius * math.cos(math.radians(degrees)), radius * math.sin(math.radians(degrees))


def circle(radius, corners, center=(0, 0), first=0.0, last=360.0):
    """Corners of a regular polygon; or of an arc, both ends included."""
    steps = corners if last - first == 360 else corners - 1
    return [add(center, on_circle(radius, first + (last - first) * k / steps)) for k in range(corners)]


def rounded(width, depth, radius, corners):
    """A rectangle about the origin with rounded corners, each of so many points."""
    x, y = width / 2 - radius, depth / 2 - radius
    return [p for k, (cx, cy) in enumerate([(x, y), (-x, y), (-x, -y), (x, -y)])
            for p in circle(radius, corners, (cx, cy), 90 * k, 90 * k + 90)]


def twice_area(polygon):
    """Positive if it runs from the first axis toward the second."""
    return sum(a[0] * b[1] - a[1] * b[0] for a, b in zip([polygon[-1], *polygon], polygon))
