"""scenes/rayfarm.schema.json says what the loader accepts: the same keys in every map, the same words, and all scenes."""
import json
import re
import unittest

from rayfarm_job import JobTest, SCENES, main

try:
    import jsonschema
    import yaml
except ImportError:
    jsonschema = None

VIEW = "view: {location: [0, 0, 5], look_at: [0, 0, 0]}\n"
SPHERE = "sphere: {center: [0, 0, 0], radius: 1}"
# For each map that the schema defines, scenes in which ZZZ is a key of such a map that does not exist: the loader then
# names those that do, as far as they can stand beside the others.
MAPS = {
    "": ["scene: []\nZZZ: 1"],
    "view": ["scene: []\nview: {location: [0, 0, 5], look_at: [0, 0, 0], ZZZ: 1}"],
    "lens": ["scene: []\nview: {location: [0, 0, 5], look_at: [0, 0, 0], lens: {radius: 1, focus: 1, ZZZ: 1}}"],
    "render": ["scene: []\nrender: {ZZZ: 1}"],
    "spectrum": ["scene: []\nambient: {spectrum: E, ZZZ: 1}"],
    "environment": ["scene: []\nenvironment: {file: sky.png, ZZZ: 1}"],
    "light": ["scene: []\nlights: [{position: [0, 0, 1], ZZZ: 1}]",
              "scene: []\nlights: [{position: [0, 0, 1], direction: [0, 0, 1], angle: 1, ZZZ: 1}]",
              "scene: []\nlights: [{position: [0, 0, 1], ies: lamp.ies, ZZZ: 1}]"],
    "medium": ["scene: []\nmedia: [{box: {min: [0, 0, 0], max: [1, 1, 1]}, ZZZ: 1}]"],
    "box": ["scene: [{box: {min: [0, 0, 0], max: [1, 1, 1], ZZZ: 1}}]"],
    "density_grid": ["scene: []\nmedia: [{box: {min: [0, 0, 0], max: [1, 1, 1]}, absorption: 1, "
                     "grid: {file: grid.raw, size: [1, 1, 1], type: uint8, ZZZ: 1}}]"],
    "texture": ["scene: []\ntextures: {t: {kind: checker, ZZZ: 1}}", "scene: []\ntextures: {t: {kind: bricks, ZZZ: 1}}",
                "scene: []\ntextures: {t: {kind: image, file: sky.png, ZZZ: 1}}",
                "scene: []\ntextures: {t: {kind: array, size: [1, 1, 1], values: [1], ZZZ: 1}}"],
    "number_texture": ["scene: []\nmaterials: {m: {principled: {metallic: {texture: {kind: noise}, ZZZ: 1}}}}"],
    "color_texture": ["scene: []\nmaterials: {m: {principled: {base_color: {texture: {kind: noise}, ZZZ: 1}}}}"],
    "normal_texture": ["scene: []\nmaterials: {m: {principled: {normal: {texture: {kind: noise}, ZZZ: 1}}}}"],
    "principled": ["scene: []\nmaterials: {m: {principled: {opacity: 0.5, ZZZ: 1}}}"],
    "conductor_constants": ["scene: []\nmaterials: {m: {conductor: {n: 1, k: 1, ZZZ: 1}}}",
                            "scene: []\nmaterials: {m: {conductor: {metal: gold, ZZZ: 1}}}"],
    "dielectric_constants": ["scene: []\nmaterials: {m: {dielectric: {index: 1.5, ZZZ: 1}}}"],
    "polished": ["scene: []\nmaterials: {m: {polished: {ZZZ: 1}}}"],
    "translucent": ["scene: []\nmaterials: {m: {translucent: {ZZZ: 1}}}"],
    "luminaire": ["scene: []\nmaterials: {m: {luminaire: {emission: 1, ies: lamp.ies, ZZZ: 1}}}"],
    "mix": ["scene: []\nmaterials: {m: {mix: {a: {}, b: {}, by: {kind: noise}, ZZZ: 1}}}"],
    "bump": ["scene: []\nmaterials: {m: {bump: {texture: {kind: noise}, height: 1, ZZZ: 1}}}"],
    "material": ["scene: []\nmaterials: {m: {ZZZ: 1}}", "scene: []\nmaterials: {m: {transmit: 0.1, interior: 0.5, ZZZ: 1}}"],
    "sphere": ["scene: [{sphere: {center: [0, 0, 0], radius: 1, ZZZ: 1}}]"],
    "polygon": ["scene: [{polygon: {points: [[0, 0, 0], [1, 0, 0], [0, 1, 0]], ZZZ: 1}}]"],
    "cylinder": ["scene: [{cylinder: {base: [0, 0, 0], top: [0, 1, 0], radius: 1, ZZZ: 1}}]"],
    "cone": ["scene: [{cone: {base: [0, 0, 0], apex: [0, 1, 0], base_radius: 1, ZZZ: 1}}]"],
    "quadric": ["scene: [{quadric: {coefficients: [1, 1, 1, 0, 0, 0, 0, 0, 0, -1], ZZZ: 1}}]"],
    "triangles": ["scene: [{triangles: {points: [[0, 0, 0], [1, 0, 0], [0, 1, 0]], triangles: [[0, 1, 2]], ZZZ: 1}}]"],
    "polygons": ["scene: [{polygons: {points: [[0, 0, 0], [1, 0, 0], [0, 1, 0]], faces: [[0, 1, 2]], ZZZ: 1}}]"],
    "lathe": ["scene: [{lathe: {profile: [[1, 0], [1, 1]], sides: 8, ZZZ: 1}}]"],
    "extrude": ["scene: [{extrude: {polygon: [[0, 0], [1, 0], [0, 1]], height: 1, ZZZ: 1}}]"],
    "patch": ["scene: [{patch: {points: [[0, 0, 0], [1, 0, 0], [1, 1, 1], [0, 1, 0]], ZZZ: 1}}]"],
    "bezier": ["scene: [{bezier: {points: [[0, 0, 0], [1, 0, 0], [0, 1, 0]], patches: [[0, 1, 1, 2, 0, 1, 1, 2, 0, 1, 1, 2, 0, 1, 1, 2]], ZZZ: 1}}]"],
    "mesh": ["scene: [{mesh: {file: tri.obj, ZZZ: 1}}]"],
    "rotation_about_axis": [f"scene: [{{{SPHERE}, transform: {{rotate: {{axis: [0, 1, 0], degrees: 1, ZZZ: 1}}}}}}]"],
    "orientation": [f"scene: [{{{SPHERE}, transform: {{orient: {{axis: [0, 1, 0], degrees: 1, ZZZ: 1}}}}}}]"],
    "transform_step": [f"scene: [{{{SPHERE}, transform: {{translate: [0, 1, 0], ZZZ: 1}}}}]"],
    "sah": [f"scene: [{{{SPHERE}, structure: {{sah: {{ZZZ: 1}}}}}}]"],
    "thesis": [f"scene: [{{{SPHERE}, structure: {{thesis: {{volumes: spheres, ZZZ: 1}}}}}}]"],
    "regular": [f"scene: [{{{SPHERE}, structure: {{regular: {{ZZZ: 1}}}}}}]"],
    "adaptive": [f"scene: [{{{SPHERE}, structure: {{adaptive: {{ZZZ: 1}}}}}}]"],
    "object_structure": [f"scene: [{{{SPHERE}, structure: {{object: {{ZZZ: 1}}}}}}]"],
    "structure_with_options": [f"scene: [{{{SPHERE}, structure: {{ZZZ: {{}}}}}}]"],
    "part_file": ["scene: [{use: {file: part.rfp, ZZZ: 1}}]"],
    "node": [f"scene: [{{{SPHERE}, ZZZ: 1}}]"],
}


@unittest.skipIf(jsonschema is None, "python3-jsonschema and python3-yaml are not installed")
class Schema(JobTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.schema = json.loads((SCENES / "rayfarm.schema.json").read_text())
        jsonschema.Draft7Validator.check_schema(cls.schema)
        cls.validator = jsonschema.Draft7Validator(cls.schema)

    def problems(self, text):
        """Of a scene, by the schema; keys of maps are words there, as JSON has no others."""
        def with_words(value):
            if isinstance(value, dict):
                return {key if isinstance(key, str) else f"{key:g}": with_words(v) for key, v in value.items()}
            return [with_words(v) for v in value] if isinstance(value, list) else value
        return [error.message for error in self.validator.iter_errors(with_words(yaml.safe_load(text)))]

    def write_files(self):
        self.write("tri.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        self.write("lamp.ies", "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 2 1 1 1 0 0 0\n1 1 100\n0 90\n0\n100 50\n")
        (self.folder / "grid.raw").write_bytes(b"\1")
        part = self.write("part.yaml", VIEW + f"scene: [{{{SPHERE}}}]\n")
        self.assertEqual(self.run_alone("compile", part, "-o", self.folder / "part.rfp").code, 0)
        self.assertEqual(self.run_alone("render", part, "-o", self.folder / "sky.png", "--size", "4x2").code, 0)

    def known_keys(self, text):
        if "view:" not in text:
            text = VIEW + text
        result = self.run_alone("check", self.write("s.yaml", text + "\n"))
        self.assertEqual(result.code, 3, text)
        found = re.search(r"'ZZZ'.*\(known: (.*?)\)", result.stderr)
        self.assertTrue(found, f"{text}: {result.stderr}")
        return set(found.group(1).split(", "))

    def test_every_map_has_the_keys_that_the_loader_knows(self):
        self.write_files()
        maps = {name for name, d in self.schema["definitions"].items() if "properties" in d} | {""}
        self.assertEqual(maps, set(MAPS))
        for name, texts in MAPS.items():
            properties = (self.schema["definitions"][name] if name else self.schema)["properties"]
            keys = {key.replace("_", "-") for key in properties} if name == "render" else set(properties)
            known = set().union(*(self.known_keys(text) for text in texts))
            self.assertEqual(keys, known, name or "the scene")
            for text in texts:
                self.assertTrue(self.problems(text if "view:" in text else VIEW + text), text)

    def test_words_are_those_of_the_loader(self):
        """Each list of words in the schema that stands under a key of `render`, of a texture or of a view."""
        for name, form in (("render", "scene: []\nrender: {{{}: zzz}}"), ("texture", "scene: []\ntextures: {{t: {{{}: zzz}}}}"),
                           ("view", "scene: []\nview: {{location: [0, 0, 5], look_at: [0, 0, 0], {}: zzz}}")):
            for key, value in self.schema["definitions"][name]["properties"].items():
                if "enum" not in value or key in ("encoding", "part", "map"):
                    continue
                text = form.format(key)
                result = self.run_alone("check", self.write("s.yaml", (text if "view:" in text else VIEW + text) + "\n"))
                self.assertEqual(result.code, 3, text)
                found = re.search(r"\(known: (.*?)\)|choose ([^\s;]*)", result.stderr)
                self.assertTrue(found, result.stderr)
                words = re.split(r", |\|", found.group(1) or found.group(2))
                self.assertEqual(set(value["enum"]), set(words), key)

    def test_scenes_are_as_it_says(self):
        files = sorted(SCENES.rglob("*.yaml"))
        self.assertGreater(len(files), 30)
        for file in files:
            self.assertEqual(self.problems(file.read_text())[:1], [], file)

    def test_wrong_scenes_are_not(self):
        for text in (VIEW, VIEW + "scene: [{sphere: {center: [0, 0], radius: 1}}]", VIEW + "scene: []\nbackground: '#ff80'",
                     VIEW + "scene: []\nmaterials: {m: {conductor: iron}}", VIEW + "scene: []\nrender: {samples: 0}",
                     VIEW + "scene: []\nlights: [{color: 1}]", VIEW + "scene: []\nframes: [1]",
                     VIEW + f"scene: [{{{SPHERE}, transform: {{rotate: [1, 2]}}}}]"):
            self.assertEqual(self.run_alone("check", self.write("s.yaml", text + "\n")).code, 3, text)
            if text != VIEW:  # a file that is only included needs no scene
                self.assertTrue(self.problems(text), text)


if __name__ == "__main__":
    main()
