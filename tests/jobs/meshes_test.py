"""Meshes without a scene: render, check, info, compile and convert take their files."""
import math
import struct

from rayfarm_job import JobTest, main


def torus(columns=48, rows=24):
    """Vertices about the z axis, with normals, and quadrilaterals; tilted, so that no side is like another."""
    points, normals, faces = [], [], []
    for i in range(columns):
        for j in range(rows):
            a, b = 2 * math.pi * i / columns, 2 * math.pi * j / rows
            normal = (math.cos(b) * math.cos(a), math.cos(b) * math.sin(a), math.sin(b))
            points.append((2 * math.cos(a) + 0.7 * normal[0], 2 * math.sin(a) + 0.7 * normal[1], 0.7 * normal[2] + math.cos(a)))
            normals.append(normal)
            faces.append([i * rows + j, (i + 1) % columns * rows + j, (i + 1) % columns * rows + (j + 1) % rows, i * rows + (j + 1) % rows])
    return points, normals, faces


def triangles(faces):
    return [t for f in faces for t in ((f[0], f[1], f[2]), (f[0], f[2], f[3]))]


def obj(points, faces):
    return "".join(f"v {x!r} {y!r} {z!r}\n" for x, y, z in points) + "".join("f " + " ".join(str(i + 1) for i in f) + "\n" for f in faces)


def off(points, faces):
    return f"OFF\n{len(points)} {len(faces)} 0\n" + "".join(f"{x!r} {y!r} {z!r}\n" for x, y, z in points) + \
        "".join(f"{len(f)} " + " ".join(map(str, f)) + "\n" for f in faces)


def ply(points, faces, order):
    word = {"<": "little", ">": "big"}[order]
    head = f"ply\nformat binary_{word}_endian 1.0\nelement vertex {len(points)}\nproperty float x\nproperty float y\nproperty float z\n" \
           f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    return head.encode() + b"".join(struct.pack(order + "3f", *p) for p in points) + \
        b"".join(struct.pack(f"{order}B{len(f)}i", len(f), *f) for f in faces)


def stl(points, faces):
    body = b"".join(struct.pack("<12fH", 0, 0, 0, *points[a], *points[b], *points[c], 0) for a, b, c in triangles(faces))
    return b"solid but binary".ljust(80) + struct.pack("<I", len(body) // 50) + body


SMALL = ["--size", "64x48", "--samples", "2"]


class Meshes(JobTest):
    def setUp(self):
        super().setUp()
        self.points, _, self.faces = torus()

    def put(self, name, content):
        path = self.folder / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    def pixels(self, scene, *options, ranks=1):
        return self.render(ranks, scene, *SMALL, *options, name="out.exr")["image"]["sha256_pixels"]

    def test_all_formats_of_a_mesh_are_the_same_picture_on_any_number_of_ranks(self):
        files = [self.put("a.obj", obj(self.points, self.faces)), self.put("a.off", off(self.points, self.faces)),
                 self.put("little.ply", ply(self.points, self.faces, "<")), self.put("big.ply", ply(self.points, self.faces, ">"))]
        one = self.pixels(files[0])
        for path in files[1:]:
            self.assertEqual(self.pixels(path), one, path)
        self.assertEqual(self.pixels(files[2], ranks=3), one)

    def test_the_scene_that_convert_writes_is_the_same_picture(self):
        (self.folder / "models").mkdir()
        for path in (self.put("models/it's a ring.stl", stl(self.points, self.faces)), self.put("models/a.ply", ply(self.points, self.faces, "<"))):
            scene = self.folder / "scene.yaml"
            result = self.run_alone("convert", path, scene)
            self.assertEqual((result.code, result.stdout), (0, f"{scene}\n"), result.stderr)
            self.assertIn("'models/", scene.read_text())
            self.assertEqual(self.pixels(scene), self.pixels(path))
            self.assertEqual(self.run_alone("check", scene).code, 0)
            again = self.run_alone("convert", path, scene)
            self.assertEqual(again.code, 2)
            self.assertIn("--force", again.stderr)
            scene.write_text("mine")
            self.assertEqual(self.run_alone("convert", path, scene, "--force").code, 0)
            self.assertNotEqual(scene.read_text(), "mine")
            scene.unlink()

    def test_up_turns_a_mesh(self):
        turned = self.put("turned.ply", ply([(x, z, -y) for x, y, z in self.points], self.faces, "<"))
        mesh = self.put("a.ply", ply(self.points, self.faces, "<"))
        self.assertEqual(self.pixels(mesh, "--up", "z"), self.pixels(turned))
        self.assertNotEqual(self.pixels(mesh), self.pixels(turned))
        scene = self.folder / "up.yaml"
        self.assertEqual(self.run_alone("convert", "--up", "z", mesh, scene).code, 0)
        self.assertEqual(self.pixels(scene), self.pixels(turned))
        self.assertIn("`--up` is of meshes", self.run_alone("check", scene, "--up", "y").stderr)

    def test_convert_keeps_what_a_gltf_file_has_of_its_own(self):
        for name in ("BoxTextured.glb", "cameras/Cameras.gltf", "CornellBox.glb", "AnimatedMorphCube/AnimatedMorphCube.gltf"):
            model = self.asset("gltf/" + name)
            scene = self.folder / "scene.yaml"
            self.assertEqual(self.run_alone("convert", model, scene, "--force").code, 0)
            self.assertEqual(self.pixels(scene), self.pixels(model), name)

    def test_convert_refuses_what_it_can_not_do(self):
        mesh = self.put("a.off", off(self.points, self.faces))
        for arguments, code, text in (((mesh, self.folder / "a.png"), 2, "must end in .yaml"),
                                      ((self.folder / "a.fbx", self.folder / "a.yaml"), 2, "no model that Rayfarm reads"),
                                      ((self.folder / "none.ply", self.folder / "a.yaml"), 3, "none.ply"),
                                      ((self.put("b.ply", "ply\n"), self.folder / "a.yaml"), 3, "b.ply:")):
            result = self.run_alone("convert", *arguments)
            self.assertEqual(result.code, code, result.stderr)
            self.assertIn(text, result.stderr)
            self.assertFalse((self.folder / "a.yaml").exists())

    def test_other_commands_take_meshes(self):
        mesh = self.put("a.stl", stl(self.points, self.faces))
        self.assertIn("no problems found", self.run_alone("check", mesh).stderr)
        info = self.run_alone("info", mesh)
        self.assertEqual(info.code, 0, info.stderr)
        # z is up in STL: the ring's height becomes y.
        high, deep = max(p[2] for p in self.points), max(p[1] for p in self.points)
        line = next(line for line in info.stdout.splitlines() if line.strip().startswith("model: 2304 polygons"))
        self.assertIn(f"y {-high:g} to {high:g}, z {-deep:g} to {deep:g}", line)
        self.assertIn("  lighting path\n", info.stdout)
        self.assertRegex(info.stdout, r"(?m)^  lamp: luminaire")
        part = self.folder / "a.rfp"
        self.assertEqual(self.run_alone("compile", mesh, "-o", part).code, 0)
        tree = self.run_alone("info", part).stdout
        self.assertNotIn("lamp", tree)
        self.assertIn("polygons 2304 ", tree)

    def test_the_command_line_comes_before_what_a_quick_look_asks_for(self):
        mesh = self.put("a.off", off(self.points, self.faces))
        self.assertNotEqual(self.pixels(mesh, "--lighting", "whitted"), self.pixels(mesh))

    def test_broken_meshes_end_in_an_error_with_a_place(self):
        whole = ply(self.points, self.faces, "<")
        for name, content, text in (("a.ply", whole[:-5], "cut off"), ("b.ply", whole.replace(b"vertex 1152", b"vertex 4000000000"), "cut off"),
                                    ("c.stl", stl(self.points, self.faces)[:-5], "cut off"),
                                    ("d.off", off(self.points, self.faces) .replace("\n4 ", "\n4 99999 ", 1), "d.off:"),
                                    ("e.fbx", "x", "export it as .glb")):
            result = self.run_alone("check", self.put(name, content), limit=20)
            self.assertEqual(result.code, 3, result.stderr)
            self.assertIn(text, result.stderr)


if __name__ == "__main__":
    main()
