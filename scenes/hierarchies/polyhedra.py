"""Polyhedra about the origin, as (points, faces); faces run counter-clockwise seen from outside.

Conway's operations make the regular, semi-regular and star-shaped ones from an icosahedron and an octahedron.
"""
import math

from vectors import add, cross, times, unit

GOLDEN = (1 + math.sqrt(5)) / 2


def mean(points):
    return times(1 / len(points), tuple(map(sum, zip(*points))))


def of_faces(polygons):
    """Joins corners that are the same."""
    places, points, faces = {}, [], []
    for polygon in polygons:
        face = []
        for p in polygon:
            key = tuple(round(x, 6) + 0.0 for x in p)
            if key not in places:
                places[key] = len(points)
                points.append(p)
            face.append(places[key])
        faces.append(tuple(face))
    return points, faces


def corners_around(poly):
    """For each point the faces about it, in turn: [(face, next point), …]."""
    points, faces = poly
    after = {}
    for k, face in enumerate(faces):
        for i, p in enumerate(face):
            after[p, face[i - 1]] = (k, face[(i + 1) % len(face)])  # about p: from the edge to its last point to the next edge
    around = []
    for p in range(len(points)):
        begin = next(q for (a, q) in after if a == p)
        ring, q = [], begin
        while True:
            k, q_next = after[p, q]
            ring.append((k, q))
            q = q_next
            if q == begin:
                break
        around.append(ring[::-1])
    return around


def scaled(poly, radius=1.0):
    points, faces = poly
    largest = max(math.hypot(*p) for p in points)
    return [times(radius / largest, p) for p in points], faces


def icosahedron():
    t = GOLDEN
    points = [(-1, t, 0), (1, t, 0), (-1, -t, 0), (1, -t, 0), (0, -1, t), (0, 1, t), (0, -1, -t), (0, 1, -t), (t, 0, -1), (t, 0, 1),
              (-t, 0, -1), (-t, 0, 1)]
    faces = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2), (10, 7, 6), (7, 1, 8),
             (3, 9, 4), (3, 4, 2),
             (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    return scaled((points, faces))


def octahedron():
    return ([(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)],
            [(2, 4, 0), (2, 1, 4), (2, 5, 1), (2, 0, 5), (3, 0, 4), (3, 4, 1), (3, 1, 5), (3, 5, 0)])


def dual(poly):
    """By polar reciprocation, so its faces are planar."""
    points, faces = poly
    poles = []
    for face in faces:
        a, b, c = (points[i] for i in face[:3])
        n = unit(cross(add(b, times(-1, a)), add(c, times(-1, a))))
        poles.append(times(1 / sum(x * y for x, y in zip(n, a)), n))
    return scaled((poles, [tuple(k for k, _ in ring) for ring in corners_around(poly)]))


def kis(poly, height):
    """A pyramid on each face; its apex stands at the face's mean times `height`."""
    points, faces = poly
    apexes = [times(height, mean([points[i] for i in face])) for face in faces]
    triangles = [(face[i - 1], face[i], len(points) + k) for k, face in enumerate(faces) for i in range(len(face))]
    return scaled((points + apexes, triangles))


def ambo(poly):
    """Cuts corners off as far as the middles of edges."""
    points, faces = poly
    inner = [[mean([points[face[i - 1]], points[face[i]]]) for i in range(len(face))] for face in faces]
    corner = [[mean([points[p], points[q]]) for _, q in ring] for p, ring in enumerate(corners_around(poly))]
    return scaled(of_faces(inner + corner))


def truncate(poly, part=1 / 3):
    """Cuts corners off at a part of each edge."""
    points, faces = poly

    def at(a, b):
        return add(times(1 - part, points[a]), times(part, points[b]))
    inner = [[q for i in range(len(face)) for q in (at(face[i - 1], face[i]), at(face[i], face[i - 1]))] for face in faces]
    corner = [[at(p, q) for _, q in ring] for p, ring in enumerate(corners_around(poly))]
    return scaled(of_faces(inner + corner))


def geodesic(poly):
    """Four triangles for each, their corners on a sphere."""
    points, faces = poly
    polygons = []
    for a, b, c in ([points[i] for i in face] for face in faces):
        ab, bc, ca = (unit(add(p, q)) for p, q in ((a, b), (b, c), (c, a)))
        polygons += [[unit(a), ab, ca], [ab, unit(b), bc], [ca, bc, unit(c)], [ab, bc, ca]]
    return of_faces(polygons)


def torus(around, across, thickness):
    """Quadrilaterals, planar because rings are regular."""
    def at(i, j):
        a, b = 2 * math.pi * i / around, 2 * math.pi * j / across
        r = 1 - thickness + thickness * math.cos(b)
        return r * math.cos(a), thickness * math.sin(b), -r * math.sin(a)
    return of_faces([[at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)] for i in range(around) for j in range(across)])


def trefoil(along, across, thickness):
    """A knotted tube of 2 along across triangles."""
    def knot(k):
        t = 2 * math.pi * k / along
        return (math.sin(t) + 2 * math.sin(2 * t)) / 3.6, (math.cos(t) - 2 * math.cos(2 * t)) / 3.6, -math.sin(3 * t) / 3.6

    def at(k, j):
        forward = unit(add(knot(k + 0.01), times(-1, knot(k - 0.01))))
        aside = unit(cross(forward, (0.0, 0.0, 1.0)))
        up = cross(aside, forward)
        angle = 2 * math.pi * j / across
        return add(knot(k), times(thickness, add(times(math.cos(angle), aside), times(math.sin(angle), up))))
    triangles = []
    for k in range(along):
        for j in range(across):
            a, b, c, d = at(k, j), at(k + 1, j), at(k + 1, j + 1), at(k, j + 1)
            triangles += [[a, b, c], [a, c, d]]
    return of_faces(triangles)
