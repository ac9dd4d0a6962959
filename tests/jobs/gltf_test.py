"""Real glTF files: triangles, bounds and area are those that another reader finds, at several times of their clips."""
import json
import os
import pathlib
import subprocess
import unittest

import gltf_reader
from rayfarm_job import ASSETS

FACTS = os.environ.get("MESH_FACTS", "build/mesh_facts")


class RealFiles(unittest.TestCase):
    def test_hold_what_another_reader_finds(self):
        files = sorted(p for p in (ASSETS / "gltf").rglob("*") if p.suffix in (".glb", ".gltf")) if ASSETS.exists() else []
        if not files:
            print("shared/assets/gltf is not there")
            raise SystemExit(77)
        for path in files:
            last = 0
            for part in (0, 0.37, 0.8):
                milliseconds = round(part * last)
                run = subprocess.run([FACTS, path, str(milliseconds)], capture_output=True, text=True, timeout=60)
                self.assertEqual(run.returncode, 0, f"{path}: {run.stderr}")
                ours, other = json.loads(run.stdout), gltf_reader.facts(path, milliseconds / 1000)
                last = ours["last"]
                with self.subTest(file=path.name, milliseconds=milliseconds):
                    self.assertEqual(ours["triangles"], other["triangles"])
                    if other["triangles"] == 0:
                        continue
                    size = max(h - l for l, h in zip(other["low"], other["high"]))
                    for a, b in zip(ours["low"] + ours["high"], other["low"] + other["high"]):
                        self.assertAlmostEqual(a, b, delta=1e-5 * size)
                    self.assertAlmostEqual(ours["area"], other["area"], delta=1e-5 * other["area"])
                if last == 0:
                    break


if __name__ == "__main__":
    unittest.main()
