"""Puts nodes at their places by moving their points.

A node with a transform would be a part with a hierarchy of its own; what is compared here are structures of whole scenes. So scenes hold
coordinates of the world alone, and what its numbers can't say turned (boxes, lathes) becomes as many polygons.
"""
import math

from vectors import add, dot, times, twice_area, unit

X, Y, Z = (1, 0, 0), (0, 1, 0), (0, 0, 1)


class Motion:
    """Turns, a scale and a way, in the order in which they are given."""

    def __init__(self, steps):
        """Steps: (x, y, z) translates, ("x", degrees) turns about an axis, a number scales."""
        self.scale, self.rows, self.way = 1, [X, Y, Z], (0, 0, 0)
        for step in steps:
            if isinstance(step, (int, float)):
                self.scale, self.way = step * self.scale, times(step, self.way)
            elif isinstance(step[0], str):
                turn = self.turn("xyz".index(step[0]), math.radians(step[1]))
                self.way = tuple(dot(row, self.way) for row in turn)
                columns = list(zip(*self.rows))
                self.rows = [tuple(dot(row, column) for column in columns) for row in turn]
            else:
                self.way = add(self.way, step)

    @staticmethod
    def turn(axis, angle):
        rows = [list(row) for row in (X, Y, Z)]
        i, j = (axis + 1) % 3, (axis + 2) % 3
        rows[i][i] = rows[j][j] = math.cos(angle)
        rows[j][i] = math.sin(angle)
        rows[i][j] = -rows[j][i]
        return rows

    def turns(self):
        return self.rows != [X, Y, Z]

    def direction(self, a):
        return tuple(dot(row, a) for row in self.rows)

    def point(self, p):
        return add(times(self.scale, self.direction(p)), self.way)


def move(*steps):
    return Motion(steps)


def moved(node, motion):
    """The node with all that is in it where the motion takes it."""
    *kept, (kind, shape) = node.items()
    return {**dict(kept), **KINDS[kind](shape, motion)}


def moved_box(box, motion):
    low, high = box["min"], box["max"]
    if not motion.turns():
        return {"box": {"min": motion.point(low), "max": motion.point(high)}}
    points = [(x, y, z) for y in (low[1], high[1]) for x, z in ((low[0], high[2]), (high[0], high[2]), (high[0], low[2]), (low[0], low[2]))]
    return moved_mesh({"points": points, "faces": BOX_FACES}, motion)


# Of eight points: four below from the left front one on, counter-clockwise seen from above, and those over them.
BOX_FACES = [(3, 2, 1, 0), (4, 5, 6, 7), (0, 1, 5, 4), (2, 3, 7, 6), (1, 2, 6, 5), (3, 0, 4, 7)]


def moved_mesh(mesh, motion):
    normals = {"normals": [motion.direction(n) for n in mesh["normals"]]} if "normals" in mesh else {}
    return {"polygons": {**mesh, "points": [motion.point(p) for p in mesh["points"]], **normals}}


KINDS = {
    "group": lambda nodes, m: {"group": [moved(node, m) for node in nodes]},
    "sphere": lambda s, m: {"sphere": {"center": m.point(s["center"]), "radius": m.scale * s["radius"]}},
    "cylinder": lambda c, m: {"cylinder": {"base": m.point(c["base"]), "top": m.point(c["top"]), "radius": m.scale * c["radius"]}},
    "polygon": lambda p, m: {"polygon": {"points": [m.point(q) for q in p["points"]]}},
    "polygons": moved_mesh,
    "box": moved_box,
    "lathe": lambda lathe, m: moved_mesh(mesh_of_lathe(**lathe), m),
}


def mesh_of_lathe(profile, sides):
    """The polygons and normals that Rayfarm makes of a lathe: sharp where the profile turns by more than 30 degrees."""
    is_ring = profile[0] == profile[-1]
    loop = profile[:-1] if is_ring else [*profile, *((0, y) for r, y in (profile[-1], profile[0]) if r > 0)]
    outward = 1 if twice_area(loop) > 0 else -1  # outside lies to the right of who follows the profile
    lines = list(zip(profile, profile[1:]))
    across = [unit((outward * (y1 - y0), outward * (r0 - r1))) for (r0, y0), (r1, y1) in lines]
    indices = {}  # of points with normals

    def around(p, step):
        angle = 2 * math.pi * (step % sides) / sides
        return p[0] * math.cos(angle), p[1], p[0] * math.sin(angle)

    def normal(line, point):
        """In the profile, of a line at a point of the profile that it begins or ends in."""
        own = across[line]
        beyond = line + 1 if point > line else line - 1
        if profile[point][0] == 0:
            other = (-own[0], own[1])  # it goes on on the other side of the axis
        elif is_ring or 0 <= beyond < len(lines):
            other = across[beyond % len(lines)]
        else:
            return own  # there is a lid
        return unit(add(own, other)) if dot(own, other) >= math.cos(math.radians(30)) else own

    def corner(line, point, face, step):
        # A tip has no direction of its own: its normal is that of the face's middle.
        p = profile[point]
        key = around(p, step), around(normal(line, point), step if p[0] else face + 0.5)
        return indices.setdefault(key, len(indices))

    faces = []
    for line, ((r0, _), (r1, _)) in enumerate(lines):
        for k in range(sides):
            face = [corner(line, line, k, k), corner(line, line + 1, k, k)]
            face += [corner(line, line + 1, k, k + 1)] if r1 > 0 else []
            face += [corner(line, line, k, k + 1)] if r0 > 0 else []
            faces.append(face[::outward])
    for end, up in ((profile[0], -outward), (profile[-1], outward)):
        if end[0] > 0 and not is_ring:  # a lid; steps run clockwise seen from above
            faces.append([indices.setdefault((around(end, k), (0, up, 0)), len(indices)) for k in range(sides)][::-up])
    return {"points": [p for p, _ in indices], "faces": faces, "normals": [n for _, n in indices]}
