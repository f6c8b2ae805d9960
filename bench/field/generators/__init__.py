# SPDX-License-Identifier: GPL-3.0-or-later

"""Ordinary inputs in bulk: each is a file with a JSON file of known facts beside it.

The JSON file has the input's name plus `.truth.json`. Its keys, all optional:

    must_work   whether a refusal is wrong
    must_say    patterns that the output has to have, such as the name of a warning
    closed, parts, genus, volume    of the right result of Voxelize, in the units of the file
    shape, spacing, noise           the sampled shape, for the result of Reconstruct Surface
    covered_share, color            of a drawing: of its box, and of its opaque pixels
    images                          how many images the right glTF file has
"""

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from bench.field.generators import clouds, drawings, meshes, models, pictures

_GENERATORS: dict[str, tuple[Callable[[Path, np.random.Generator], Mapping[str, Any]], float]] = {
    "mesh": (meshes.write, 0.36),
    "cloud": (clouds.write, 0.18),
    "picture": (pictures.write, 0.26),
    "drawing": (drawings.write, 0.12),
    "model": (models.write, 0.08),
}
"""Functions that write a file at a path without an extension, and their shares of all files."""
_TRUTH = ".truth.json"


def generate(folder: Path, count: int, seed: int) -> list[Path]:
    """Writes files, each of which follows from the seed and its number; returns their paths."""
    folder.mkdir(parents=True, exist_ok=True)
    written = []
    for order, (kind, (write, share)) in enumerate(_GENERATORS.items()):
        for number in range(max(1, round(count * share))):
            random = np.random.default_rng([seed, order, number])
            stem = folder / f"{kind}_{number:04}"
            for earlier in folder.glob(f"{stem.name}.*"):
                earlier.unlink()
            truth = write(stem, random)
            path = next(p for p in folder.glob(f"{stem.name}.*") if not p.name.endswith(_TRUTH))
            Path(f"{path}{_TRUTH}").write_text(json.dumps(truth), encoding="utf-8")
            written.append(path)
    return written


def truth_of(path: Path) -> Mapping[str, Any]:
    """Returns the known facts about a file; empty for one that was not generated."""
    known = Path(f"{path}{_TRUTH}")
    return json.loads(known.read_text(encoding="utf-8")) if known.exists() else {}
