# SPDX-License-Identifier: GPL-3.0-or-later

"""Makes the picture of docs/engines.md: exported models in three.js.

usage: python3 three_js.py FOLDER MODULES [MODELS]

MODULES is a node_modules with three, MODELS the folder that bench/textures/viewers/models.py has
filled. Leaves FOLDER/three_js.png.
"""

import sys
from pathlib import Path

import numpy as np
from sheets import encoded, sheet

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from bench.textures.viewers import three_js

SHOWN = {"Duck": (slice(18, 76), slice(12, 80)), "BoomBox": (slice(20, 78), slice(16, 84))}
SIDE, SCALE = 96, 5
KINDS = {"plain": "mipmaps of three.js", "fitted": "exported mipmaps"}


def main(folder: Path, modules: Path, models: Path) -> None:
    """Makes the picture."""
    cells = []
    for model, part in SHOWN.items():
        tasks = [three_js.task(model, "plain", SIDE, 1, nearest=True)]
        tasks += [three_js.task(model, kind, SIDE, 1) for kind in KINDS]
        answer = three_js.drawn(tasks, modules, models)
        titles = ["64 lookups of the image", *KINDS.values()]
        for result, title in zip(answer["results"], titles, strict=True):
            (frame,) = three_js.frames_of(result, SIDE)
            shown = encoded(frame)[part].repeat(SCALE, axis=0).repeat(SCALE, axis=1)
            cells.append((np.ascontiguousarray(shown), title))
    sheet(cells, columns=3).save(folder / "three_js.png")


if __name__ == "__main__":
    models = Path(sys.argv[3]) if len(sys.argv) > 3 else three_js.FOLDER
    main(Path(sys.argv[1]), Path(sys.argv[2]), models)
