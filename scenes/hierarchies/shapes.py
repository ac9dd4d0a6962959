"""Shapes, nodes and text of the scenes: a node is what stands in the object tree of a YAML scene, as a dictionary."""
import colorsys
import math
import re

# ---- vectors ----------------------------------------------------------------------------------------------------


def add(a, b):
    return tuple(x + y for x, y in zip(a, b))


def times(s, a):
    return tuple(s * x for x in a)


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


# ---- nodes ------------------------------------------------------------------------------------------------------


def sphere(center, radius):
    return {"sphere": {"center": center, "radius": radius}}


def cylinder(base, top, radius):
    return {"cylinder": {"base": base, "top": top, "radius": radius}}


def box(low, high):
    """Six polygons."""
    return {"box": {"min": low, "max": high}}


def polygon(*points):
    return {"polygon": {"points": list(points)}}


def quad(corner, a, b):
    """A parallelogram by a corner and two edges; seen from a x b."""
    return polygon(corner, add(corner, a), add(add(corner, a), b), add(corner, b))


def mesh(points, faces, smooth=None):
    return {"polygons": {"points": points, "faces": faces, **({"smooth": smooth} if smooth else {})}}


def lathe(sides, *profile, smooth=None):
    """`sides` polygons for each line of a profile that begins and ends on the axis or is a ring."""
    return {"lathe": {"profile": list(profile), "sides": sides, **({"smooth": smooth} if smooth else {})}}


def disc(sides, radius, bottom, top):
    """A closed cylinder of sides + 2 polygons."""
    return lathe(sides, (radius, bottom), (radius, top))


def frustum(base, low, top, high):
    """Six polygons between two rectangles (least x, most x, least z, most z) at two heights."""
    points = [(x, y, z) for (x0, x1, z0, z1), y in ((base, low), (top, high)) for x, z in ((x0, z1), (x1, z1), (x1, z0), (x0, z0))]
    return mesh(points, [(3, 2, 1, 0), (4, 5, 6, 7), (0, 1, 5, 4), (2, 3, 7, 6), (1, 2, 6, 5), (3, 0, 4, 7)])


def prism(outline, low, high):
    """corners + 2 polygons between two heights; `outline` in x and z, in any direction."""
    n = len(outline)
    area = sum(outline[k - 1][0] * outline[k][1] - outline[k][0] * outline[k - 1][1] for k in range(n))
    around = outline if area < 0 else outline[::-1]  # counter-clockwise seen from above
    points = [(x, low, z) for x, z in around] + [(x, high, z) for x, z in around]
    return mesh(points, [tuple(range(n))[::-1], tuple(range(n, 2 * n))] + [(k, (k + 1) % n, n + (k + 1) % n, n + k) for k in range(n)])


def move(*steps):
    """Steps of a transform: (x, y, z) translates, ("x", degrees) turns about an axis, a number scales."""
    def step(s):
        if isinstance(s, (int, float)):
            return {"scale": s}
        if isinstance(s[0], str):
            return {"rotate": {"axis": [int(s[0] == axis) for axis in "xyz"], "degrees": s[1]}}
        return {"translate": s}
    return {"transform": [step(s) for s in steps]}


def item(name, material, *shapes, at=None):
    """A thing of one or more shapes (a node each, maybe with a material of its own); `at`: a transform by `move`."""
    node = {"name": name, **({"material": material} if material else {}), **(at or {})}
    return {**node, **shapes[0]} if len(shapes) == 1 and "material" not in shapes[0] else {**node, "group": list(shapes)}


def of(material, shape):
    return {"material": material, **shape}


def view(location, look_at, field_of_view, width=256, height=240):
    """Of Weghorst, Hooper and Greenberg's size, if no other is given."""
    return {"location": location, "look_at": look_at, "field_of_view": field_of_view, "aspect": f"{width / height:.9g}",
            "resolution": [width, height]}


def cluster(name, *elements, at=None):
    return {"name": name, **(at or {}), "group": list(elements)}


def items(node):
    """The names of a tree's items: named nodes without named ones below them."""
    below = [name for child in node.get("group", []) for name in items(child)]
    return below or ([node["name"]] if "name" in node else [])


def hue(h, s, v):
    """A linear colour from hue, saturation and value, each from 0 to 1."""
    return tuple(round(c ** 2.2, 3) for c in colorsys.hsv_to_rgb(h, s, v))


# ---- text -------------------------------------------------------------------------------------------------------


def number(value):
    text = f"{value:.5f}".rstrip("0").rstrip(".") if isinstance(value, float) else str(value)
    return "0" if text == "-0" else text


def flow(value):
    if isinstance(value, dict):
        return "{" + ", ".join(f"{number(k)}: {flow(v)}" for k, v in value.items()) + "}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(flow(v) for v in value) + "]"
    return number(value)


def wrapped(text, indent, width=120):
    """Breaks lines at spaces."""
    lines, line = [], ""
    for word in text.split(" "):
        if line and len(line) + 1 + len(word) > width - indent:
            lines.append(line)
            line = word
        else:
            line = f"{line} {word}" if line else word
    return ("\n" + " " * indent).join([*lines, line])


def tree(node, indent, anchors):
    """The lines of a node. A group of the same shapes as an earlier one refers to it."""
    if "group" not in node:
        return [" " * indent + "- " + wrapped(flow(node), indent + 4)]
    lines = [" " * (indent + 2) + f"{k}: {flow(v)}" for k, v in node.items() if k != "group"]
    lines[0] = " " * indent + "- " + lines[0].lstrip()
    shapes = flow(node["group"])
    if shapes in anchors:
        return [*lines, " " * (indent + 2) + f"group: *{anchors[shapes]}"]
    anchors[shapes] = node["name"].replace(" ", "_")
    lines.append(" " * (indent + 2) + f"group: &{anchors[shapes]}")
    for child in node["group"]:
        lines += tree(child, indent + 4, anchors)
    return lines


def text_of(scene):
    """A YAML file: `comment`, then the keys of the format, `scene` being a list of nodes."""
    lines = ["# " + line for line in scene["comment"]]
    for key, value in scene.items():
        if key in ("comment", "scene"):
            continue
        if key in ("materials", "textures"):
            lines += [f"{key}:", *(f"  {name}: {flow(entry)}" for name, entry in value.items())]
        elif key == "lights":
            lines += ["lights:", *(f"  - {flow(light)}" for light in value)]
        else:
            lines.append(f"{key}: {wrapped(flow(value), 2)}")
    lines.append("scene:")
    anchors = {}
    for node in scene["scene"]:
        lines += tree(node, 2, anchors)
    used = {anchor for anchor in anchors.values() if any(line.endswith(f"group: *{anchor}") for line in lines)}
    lines = [re.sub(r"group: &(\S+)$", lambda m: m[0] if m[1] in used else "group:", line) for line in lines]
    return "\n".join(lines) + "\n"
