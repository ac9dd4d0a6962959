"""rayfarm bake: light of zones in files of other programs."""
import json
import struct

from rayfarm_job import JobTest, SCENES, main

FEW = ["--zone-size", "1", "--zone-rays", "3000", "--zone-samples", "2", "--progress", "none"]
ROOM = """view: {location: [0, 0, 0.9], look_at: [0, 0, -1], field_of_view: 80, aspect: 1}
materials: {wall: {lambertian: [0.7, 0.5, 0.3]}, lamp: {luminaire: {color: 0, emission: 8}}, glass: {dielectric: {index: 1.5}}, mirror: {conductor: {metal: silver}}}
media: [{box: {min: [-1, -1, -1], max: [0, 0, 0]}, scattering: 0.1, absorption: 0}]
scene:
  - {material: wall, polygon: {points: [[-1,-1,-1],[-1,-1,1],[1,-1,1],[1,-1,-1]]}}
  - {material: wall, polygon: {points: [[-1,-1,-1],[1,-1,-1],[1,1,-1],[-1,1,-1]]}}
  - {material: lamp, polygon: {points: [[-0.4,0.98,-0.4],[0.4,0.98,-0.4],[0.4,0.98,0.4],[-0.4,0.98,0.4]]}}
  - {material: glass, sphere: {center: [0,-0.7,0.1], radius: 0.2}}
  - {material: mirror, sphere: {center: [0.6,-0.7,0.1], radius: 0.2}}
"""


def read_glb(data):
    """Chunks, and each mesh as (name, [(positions, colours, indices)]), as glTF 2.0 has them; asserts what the format asks for."""
    magic, version, length = struct.unpack_from("<4sII", data)
    assert (magic, version, length) == (b"glTF", 2, len(data)) and length % 4 == 0
    size, kind = struct.unpack_from("<I4s", data, 12)
    assert kind == b"JSON" and size % 4 == 0
    root = json.loads(data[20 : 20 + size])
    binary_size, kind = struct.unpack_from("<I4s", data, 20 + size)
    binary = data[28 + size :]
    assert kind == b"BIN\0" and binary_size == len(binary) == root["buffers"][0]["byteLength"]

    def values(index):
        accessor = root["accessors"][index]
        view = root["bufferViews"][accessor["bufferView"]]
        width = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}[accessor["type"]]
        letter = {5125: "I", 5126: "f"}[accessor["componentType"]]
        assert view["byteOffset"] % 4 == 0 and view["byteOffset"] + view["byteLength"] <= len(binary)
        assert view["byteLength"] == 4 * width * accessor["count"]
        flat = struct.unpack_from(f"<{width * accessor['count']}{letter}", binary, view["byteOffset"])
        rows = [flat[i : i + width] for i in range(0, len(flat), width)]
        if "min" in accessor:
            assert accessor["min"] == [min(c) for c in zip(*rows)] and accessor["max"] == [max(c) for c in zip(*rows)]
        return rows

    meshes = []
    for mesh in root["meshes"]:
        surfaces = []
        for primitive in mesh["primitives"]:
            positions, colours = (values(primitive["attributes"][name]) for name in ("POSITION", "COLOR_0"))
            indices = [i for (i,) in values(primitive["indices"])]
            assert len(indices) % 3 == 0 and sorted(set(indices)) == list(range(len(positions))) and len(colours) == len(positions)
            assert all(0 <= x <= 1 for c in colours for x in c)
            surfaces.append((positions, colours, indices))
        meshes.append((mesh["name"], surfaces))
    return root, meshes


class BakeTest(JobTest):
    def bake(self, *arguments, expect=0):
        result = self.run_alone("bake", *arguments)
        self.assertEqual(result.code, expect, result.stderr)
        return result.stderr

    def test_vertices(self):
        # zonal.md 6: ".glb: COLOR_0 at zone corners, KHR_materials_unlit". Ranks and files of zones do not show.
        scene = self.write("room.yaml", ROOM)
        one, more, again = (self.folder / name for name in ("one.glb", "more.glb", "again.glb"))
        zones = self.folder / "room.zones"
        told = self.bake(scene, "-o", one, "--zones", zones, *FEW)
        for text in ("vertices are brighter than 1 and clipped", "'mirror'", "'glass'", "1 medium is left out"):
            self.assertIn(text, told)
        self.assertIn("not computed again", self.bake(scene, "-o", again, "--zones", zones, *FEW))
        farm = self.run_farm(3, "bake", scene, "-o", more, *FEW)
        self.assertEqual(farm.code, 0, farm.stderr)
        self.assertEqual(more.read_bytes(), one.read_bytes())
        self.assertEqual(again.read_bytes(), one.read_bytes())
        root, meshes = read_glb(one.read_bytes())
        self.assertTrue(all(m["extensions"] == {"KHR_materials_unlit": {}} for m in root["materials"]))
        names = [name for name, _ in meshes]
        self.assertEqual([name.split(": ")[1] for name in names], ["wall", "lamp", "mirror"])
        (positions, colours, indices), = meshes[0][1]
        self.assertEqual((len(positions), len(indices)), (2 * 9, 3 * 16))  # two squares of two zones by two
        self.assertIn((0.0, -1.0, 0.0), positions)
        self.assertTrue(all(r > g > b > 0 and a == 1 for r, g, b, a in colours))
        self.assertEqual({c for c in meshes[2][1][0][1]}, {(0.0, 0.0, 0.0, 1.0)})
        node = root["nodes"][-1]
        self.assertEqual((node["name"], node["matrix"][12:]), ("view", [0, 0, 0.9, 1]))
        self.assertAlmostEqual(root["cameras"][0]["perspective"]["yfov"], 80 * 3.141592653589793 / 180, places=9)
        # Half as bright.
        self.bake(scene, "-o", more, "--zones", zones, "--exposure", "-1", *FEW)
        darker = read_glb(more.read_bytes())[1][0][1][0][1]
        self.assertTrue(all(abs(d[0] - c[0] / 2) < 1e-6 for d, c in zip(darker, colours)))

    def test_atlas_and_what_goes_wrong(self):
        scene = self.write("room.yaml", ROOM)
        atlas = self.folder / "a.exr"
        told = self.bake(scene, "-o", atlas, "--lighting", "radiosity", *FEW)
        self.assertIn("5 primitives", told)
        data = atlas.read_bytes()
        begin = data.index(b"rayfarm/atlas\0string\0") + len(b"rayfarm/atlas\0string\0")
        (size,) = struct.unpack_from("<i", data, begin)
        layout = json.loads(data[begin + 4 : begin + 4 + size])
        self.assertEqual([layout["materials"][r["material"]] for r in layout["rectangles"]].count("wall"), 2)
        square = next(r for r in layout["rectangles"] if r["points"][0] == [-1, -1, -1])
        self.assertEqual((square["columns"], square["rows"], square["kind"]), (2, 2, "triangle" if len(square["points"]) == 4 else square["kind"]))
        for arguments, code, text in (
            (["-o", self.folder / "a.gltf"], 2, "must end in .glb"),
            (["-o", self.folder / "a.####.glb"], 2, "leave #### out"),
            (["-o", atlas, "--exposure", "1"], 2, "belongs to .glb"),
            (["-o", self.folder / "a.glb", "--lighting", "path"], 2, "radiosity"),
            (["-o", self.folder / "no/where/a.glb"], 2, "there is no folder"),
        ):
            with self.subTest(text):
                self.assertIn(text, self.bake(scene, *arguments, *FEW, expect=code))
        bare = self.write("bare.yaml", "view: {location: [0,0,5], look_at: [0,0,0]}\nmaterials: {m: {conductor: {metal: silver}}}\n"
                                       "scene: [{material: m, sphere: {center: [0,0,0], radius: 1}}]\n")
        self.assertIn("nothing to bake", self.bake(bare, "-o", self.folder / "b.glb", *FEW, expect=3))
        (self.folder / "full.glb").symlink_to("/dev/full")
        self.assertIn("can't be written", self.bake(scene, "-o", self.folder / "full.glb", *FEW, expect=1))
        self.assertEqual(self.leftovers(), [])
        moving = self.bake(SCENES / "animation.yaml", "-o", self.folder / "m.glb", "--frame", "3", "--zone-size", "3", *FEW[2:])
        self.assertIn("at frame 3", moving)


if __name__ == "__main__":
    main()
