"""Shapes, nodes and text of the scenes: a node is what stands in the object tree of a YAML scene, as a dictionary."""
import colorsys

from placing import BOX_FACES, moved
from vectors import add, twice_area

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


def lathe(sides, *profile):
    """`sides` smooth polygons for each line of a profile, and one for each end off the axis."""
    return {"lathe": {"profile": list(profile), "sides": sides}}


def disc(sides, radius, bottom, top):
    """A closed cylinder of sides + 2 polygons."""
    return lathe(sides, (radius, bottom), (radius, top))


def frustum(base, low, top, high):
    """Six polygons between two rectangles (least x, most x, least z, most z) at two heights."""
    points = [(x, y, z) for (x0, x1, z0, z1), y in ((base, low), (top, high)) for x, z in ((x0, z1), (x1, z1), (x1, z0), (x0, z0))]
    return mesh(points, BOX_FACES)


def prism(outline, low, high):
    """corners + 2 polygons between two heights; `outline` in x and z, in any direction."""
    n = len(outline)
    around = outline if twice_area(outline) < 0 else outline[::-1]  # counter-clockwise seen from above
    points = [(x, low, z) for x, z in around] + [(x, high, z) for x, z in around]
    return mesh(points, [tuple(range(n))[::-1], tuple(range(n, 2 * n))] + [(k, (k + 1) % n, n + (k + 1) % n, n + k) for k in range(n)])


def item(name, material, *shapes, at=None):
    """A thing of one or more shapes (a node each, maybe with a material of its own); `at`: where it is moved, by `move`."""
    node = {"name": name, **({"material": material} if material else {})}
    is_single = len(shapes) == 1 and "material" not in shapes[0]
    return placed({**node, **shapes[0]} if is_single else {**node, "group": list(shapes)}, at)


def placed(node, at):
    return moved(node, at) if at else node


def of(material, shape):
    return {"material": material, **shape}


def view(location, look_at, field_of_view, width=256, height=240):
    """Of Weghorst, Hooper and Greenberg's size, if no other is given."""
    return {"location": location, "look_at": look_at, "field_of_view": field_of_view, "aspect": f"{width / height:.9g}",
            "resolution": [width, height]}


def cluster(name, *elements, at=None):
    return placed({"name": name, "group": list(elements)}, at)


def items(node):
    """The names of a tree's items: named nodes without named ones below them."""
    below = [name for child in node.get("group", []) for name in items(child)]
    return below or ([node["name"]] if "name" in node else [])


def hue(h, s, v):
    """A linear colour from hue, saturation and value, each from 0 to 1."""
    return tuple(round(c ** 2.2, 3) for c in colorsys.hsv_to_rgb(h, s, v))


# ---- text -------------------------------------------------------------------------------------------------------


def number(value, digits):
    text = f"{value:.{digits}f}".rstrip("0").rstrip(".") if isinstance(value, float) else str(value)
    return "0" if text == "-0" else text


def flow(value, digits=5):
    """Five digits after the point leave small faces planar; three turn a normal by no more than 0.05 degrees."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{k}: {flow(v, 3 if k == 'normals' else digits)}" for k, v in value.items()) + "}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(flow(v, digits) for v in value) + "]"
    return number(value, digits)


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


def tree(node, indent):
    """The lines of a node."""
    if "group" not in node:
        return [" " * indent + "- " + wrapped(flow(node), indent + 4)]
    lines = [" " * (indent + 2) + f"{k}: {flow(v)}" for k, v in node.items() if k != "group"]
    lines[0] = " " * indent + "- " + lines[0].lstrip()
    return [*lines, " " * (indent + 2) + "group:", *(line for child in node["group"] for line in tree(child, indent + 4))]


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
    for node in scene["scene"]:
        lines += tree(node, 2)
    return "\n".join(lines) + "\n"
