#!/usr/bin/env python3
"""Writes the scenes on which the thesis and Weghorst, Hooper and Greenberg compare hierarchies.

    scenes/hierarchies/write_scenes.py [FOLDER]     (the folder of this file, if left out)
"""
import argparse
import pathlib
import sys

import camera
import office
import pencils
import polygons
import pool_room
import shapes
import thesis

SCENES = {"beach_house": thesis.beach_house, "primitives": thesis.primitives, "plant": thesis.plant,
          "pencils_1": lambda: pencils.pencils(1), "pencils_2": lambda: pencils.pencils(2), "pencils_3": lambda: pencils.pencils(3),
          "polygons": polygons.polygons, "camera": camera.camera, "office": office.office, "pool_room": pool_room.pool_room}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path, nargs="?", default=pathlib.Path(__file__).resolve().parent)
    folder = parser.parse_args().folder
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name, scene in SCENES.items():
            (folder / f"{name}.yaml").write_text(shapes.text_of(scene()), encoding="utf-8", newline="\n")
    except OSError as error:
        sys.exit(f"can't write {error.filename}: {error.strerror}")


if __name__ == "__main__":
    main()
