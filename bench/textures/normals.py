# SPDX-License-Identifier: GPL-3.0-or-later

"""Measures by how many degrees the levels of normal maps are off, over gathered models.

Usage: blender --background --python-exit-code 1 --python bench/textures/normals.py -- [MODEL...]
       (--data FOLDER names the folder of the models)

The models have no normal maps, so each gets one from its picture: brightness for height. The
normals of lookups, normalized as in shaders, are compared at random points of the surface. Ends
with status 1 if a level of "pam-bilinear" is farther off than the same level of "box".
"""

import argparse
import sys
from pathlib import Path

import numpy as np
import prefilter
from numpy.typing import NDArray

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from bench.report import Report, add_json_option
from bench.textures import sampling, subjects

FILTERS = ("box", "pam-bilinear")
LEVELS = range(1, 7)
POINTS = 400_000
STEEPNESS = 0.3  # The standard deviation of the slopes.


def main() -> None:
    """Measures the models of the command line."""
    parser = argparse.ArgumentParser(prog="normals.py", description=__doc__.splitlines()[0])
    models = subjects.MODELS
    parser.add_argument("models", nargs="*", default=models)
    data = Path(__file__).resolve().parents[3] / "shared" / "data" / "textured"
    parser.add_argument("--data", type=Path, default=data)
    add_json_option(parser)
    options = parser.parse_args(sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else [])
    report, rows, holds = Report(), [], True
    for model in options.models:
        for subject in subjects.load(options.data / model, "auto"):
            errors = measured(subject)
            for name in FILTERS:
                rows.append([subject.name, name, *(f"{error:.2f}" for error in errors[name])])
            holds &= bool((errors["pam-bilinear"] < errors["box"]).all())
    head = ("model", "filter", *(f"level {level}" for level in LEVELS))
    report.table("Deviation from the full map, in degrees", head, rows, "angles")
    report.verdict(holds, "pam-bilinear is closer than box at every level of every model")
    report.finish(options.json)


def measured(subject: subjects.Subject) -> dict[str, NDArray[np.float64]]:
    """Returns the root mean square of the angle, in degrees, for each filter and level."""
    wrap = subject.wrap
    normals = bumps(subject.image)
    points = sampling.random_points(subject.corners, subject.uvs, POINTS)
    shown = unit(2 * sampling.lookup(normals, points, wrap) - 1)
    errors = {}
    for name in FILTERS:
        made = prefilter.normal_mipmaps(normals, subject.surfaces, filter=name, wrap=wrap)
        squares = []
        for level in LEVELS:
            # Levels are kept in bytes.
            stored = np.round(made[level] * 255).astype(np.float32) / 255
            found = unit(2 * sampling.lookup(stored, points, wrap) - 1)
            cosines = np.clip((shown * found).sum(axis=1), -1, 1)
            squares.append((np.degrees(np.arccos(cosines)) ** 2).mean())
        errors[name] = np.sqrt(squares)
    return errors


def bumps(image: NDArray[np.float32]) -> NDArray[np.float32]:
    """Returns an encoded normal map whose heights are the brightness of an image."""
    height = image[..., :3].astype(float).mean(axis=2)
    slopes = np.stack(
        [(np.roll(height, 1, axis) - np.roll(height, -1, axis)) / 2 for axis in (1, 0)], axis=2
    )
    slopes *= STEEPNESS / slopes.std()
    vectors = unit(np.concatenate([slopes, np.ones((*height.shape, 1))], axis=2))
    return np.round((vectors + 1) / 2 * 255).astype(np.float32) / 255


def unit(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns the vectors with length 1."""
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


main()
