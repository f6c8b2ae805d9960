# SPDX-License-Identifier: GPL-3.0-or-later

"""Makes a picture of docs/engines.md: exported models in three.js and in Babylon.js.

usage: python3 viewers.py FOLDER MODULES [MODELS]

MODULES is a node_modules with three, @babylonjs/core and @babylonjs/loaders; MODELS the folder that
bench/textures/viewers/models.py has filled, of the kinds plain and fitted. Leaves
FOLDER/viewers.png. Fails where a level of a texture has not arrived.
"""

import sys
from pathlib import Path

import numpy as np
from sheets import encoded, sheet

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from bench.textures.viewers import three_js

SHOWN = ("BoomBox", "DamagedHelmet", "Duck")
SIDE, SCALE = 96, 4
PART = (slice(14, 82), slice(14, 82))
PAGES = {"three.js": "three_js.html", "Babylon.js": "babylon_js.html"}
KINDS = {"plain": "{}, its own mipmaps", "fitted": "{}, exported mipmaps"}


def main(folder: Path, modules: Path, models: Path) -> None:
    """Makes the picture."""
    tasks = [three_js.task(model, kind, SIDE, 1) for model in SHOWN for kind in KINDS]
    columns = {}
    for viewer, page in PAGES.items():
        answer = three_js.drawn(tasks, modules, models, page=page)
        print(viewer, answer["revision"])
        for task, result in zip(tasks, answer["results"], strict=True):
            model, kind = task["name"].split()
            check(viewer, model, kind, result["textures"])
            (frame,) = three_js.frames_of(result, SIDE)
            shown = encoded(frame)[PART].repeat(SCALE, axis=0).repeat(SCALE, axis=1)
            columns[model, viewer, kind] = np.ascontiguousarray(shown)
    cells = [
        (columns[model, viewer, kind], title.format(viewer))
        for model in SHOWN
        for viewer in PAGES
        for kind, title in KINDS.items()
    ]
    sheet(cells, columns=len(PAGES) * len(KINDS)).save(folder / "viewers.png")


def check(viewer: str, model: str, kind: str, textures: list[dict[str, object]]) -> None:
    """Prints the number of loaded levels per texture; exits if one is missing."""
    for texture in textures if kind == "fitted" else ():
        sides = (texture["width"], texture["height"])
        levels = [tuple(level[:2]) for level in texture["levels"]]
        whole = [
            tuple(max(1, side >> number) for side in sides)
            for number in range(max(sides).bit_length())
        ]
        print(f"{viewer}, {model}, {texture['slot']}: {len(levels)} of {len(whole)} levels")
        if levels != whole:
            sys.exit(f"{viewer}, {model}, {texture['slot']}: found {levels}")


if __name__ == "__main__":
    models = Path(sys.argv[3]) if len(sys.argv) > 3 else three_js.FOLDER
    main(Path(sys.argv[1]), Path(sys.argv[2]), models)
