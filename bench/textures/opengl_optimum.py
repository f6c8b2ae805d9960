# SPDX-License-Identifier: GPL-3.0-or-later

"""Finds the least error that levels can have with one trilinear lookup per pixel.

Usage: PYTHONPATH=PACKAGE python3 bench/textures/opengl_optimum.py [MODEL] [--frames N]
       (--help lists the options; bench/textures/opengl_models.py has to be run before, in Blender)

All levels are solved for, by least squares over the pixels of frames from all around: their lookups
against the image's means over the pixels' footprints, and with `balance` times as much weight the
changes from one frame to the next. They are measured on other frames, as bench/textures/opengl.py
does, at 64 pixels, where there are more pixels than texels; a model has to have one image.
"""

import argparse
import sys
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
import scipy.sparse
from numpy.typing import NDArray

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from bench.report import Report, add_json_option
from bench.textures import opengl, opengl_renderer
from bench.textures.opengl_renderer import Model, Renderer, Texels
from bench.textures.sampling import wrapped

Floats = NDArray[np.float64]
Matrix = scipy.sparse.csr_array

SIZE = 64
SIZES = (46, 92)
START = "pam-bilinear:footprint=1"
KNOWN = (opengl.BASELINE, "pam-bilinear", START, "pam-trilinear:footprint=1")
BALANCES = (0.0, 0.5, 1.0, 2.0)
STEPS = 80
PULL = 1e-4  # Toward where it starts, for texels that hardly any frame reads.
PLACES = "vec4(uv, textureQueryLod(levels, uv).y, 1.0)"


@dataclass(frozen=True)
class Equations:
    """The equations matrix @ texels = values, a row per pixel."""

    matrix: Matrix
    values: Floats

    def rms(self, texels: Floats) -> float:
        """Returns the residual of the equations."""
        return float(np.sqrt(np.mean((self.matrix @ texels - self.values) ** 2)))

    def normal(self) -> tuple[Matrix, Floats]:
        """Returns the normal equations, over the number of rows."""
        count = len(self.values)
        return self.matrix.T @ self.matrix / count, self.matrix.T @ self.values / count


def main() -> None:
    """Measures the model of the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("model", nargs="?", default="spot")
    parser.add_argument("--frames", type=int, default=500)
    parser.add_argument("--folder", type=Path, default=opengl.FOLDER, help="default: %(default)s")
    add_json_option(parser)
    options = parser.parse_args()
    options.views, options.sizes = 2, (SIZE,)
    model = Model.read(options.folder / f"{options.model}.npz")
    renderer = Renderer(model)
    truth = opengl.references(renderer, model, options)[SIZE]

    def measured(levels: list[Texels]) -> NDArray[np.float64]:
        textures = renderer.textures([levels])
        draw = partial(opengl.shown, renderer, textures, SIZE, opengl.MODES["one"])
        frames = opengl.drawn(options.views, draw)
        return np.array([truth.error(frames, "piece"), truth.flicker(frames, "piece")])

    made = {name: opengl.baked(model, 0, name) for name in KNOWN}
    base = measured(made[opengl.BASELINE])
    rows = [[name, opengl.pair(measured(levels) / base)] for name, levels in made.items()]
    still, moving = equations(renderer, model, made[START], options.frames)
    for balance in BALANCES:
        levels = solved(made[START], still, moving, balance)
        rows.append([f"optimum, balance {balance}", opengl.pair(measured(levels) / base)])
    title = f"{options.model}, {SIZE} pixels, {opengl.MASKS['piece']}; error / flicker"
    report = Report()
    report.table(f"{title}, of {opengl.BASELINE}'s", ["levels", "one"], rows, "levels")
    report.write(options.json)


def equations(
    renderer: Renderer, model: Model, levels: list[Texels], count: int
) -> tuple[Equations, Equations]:
    """Returns the equations of the frames, and of the changes to the frames after them."""
    random = np.random.default_rng(5)
    textures = renderer.textures([levels])
    still, moving = [], []
    for frame in range(count):
        size = round(SIZES[1] * (SIZES[0] / SIZES[1]) ** ((frame + 0.5) / count))
        angle = random.uniform(0, 2 * np.pi)
        first, second = (seen(renderer, textures, a, size) for a in (angle, angle + opengl.STEP))
        still.append(of_pixels(model, levels, *first, first[2]))
        both = first[2] & second[2]
        before, after = (of_pixels(model, levels, *shown, both) for shown in (first, second))
        change = after.values - before.values
        moving.append(Equations((after.matrix - before.matrix).tocsr(), change))
    return joined(still), joined(moving)


def seen(
    renderer: Renderer, textures: list, angle: float, size: int
) -> tuple[Texels, Texels, NDArray[np.bool_]]:
    """Returns pixel positions, their true colors, and which see a single piece of the model."""
    pieces = renderer.draw(textures, angle, opengl.PIECES * size, result=opengl_renderer.PLACE)
    full = {"filters": opengl_renderer.FULL, "result": opengl_renderer.exact(opengl.REFERENCE)}
    places = renderer.draw(textures, angle, size, result=PLACES)
    alone = opengl_renderer.in_one_piece(pieces, opengl.PIECES) & (places[..., 3] == 1)
    return places, renderer.draw(textures, angle, size, **full), alone


def of_pixels(
    model: Model,
    levels: list[Texels],
    places: Texels,
    values: Texels,
    _: NDArray[np.bool_],
    chosen: NDArray[np.bool_],
) -> Equations:
    """Returns the equations of some pixels."""
    u, v, mip_values = places[chosen][:, :3].astype(float).T
    starts = np.cumsum([0] + [level.shape[0] * level.shape[1] for level in levels])
    mip_values = np.clip(mip_values, 0, len(levels) - 1)
    row = np.arange(len(u))
    entries = []
    for number, level in enumerate(levels):
        share = np.maximum(1 - np.abs(mip_values - number), 0)
        height, width = level.shape[:2]
        x, y = u * width - 0.5, v * height - 0.5
        i, j = np.floor(x).astype(int), np.floor(y).astype(int)
        for dy, b in ((0, 1 - y + j), (1, y - j)):
            for dx, a in ((0, 1 - x + i), (1, x - i)):
                wrap = model.wraps[0]
                texel = wrapped(j + dy, height, wrap) * width + wrapped(i + dx, width, wrap)
                near = share > 0
                entries.append((row[near], starts[number] + texel[near], (share * a * b)[near]))
    rows, columns, weights = map(np.concatenate, zip(*entries, strict=True))
    matrix = scipy.sparse.csr_array((weights, (rows, columns)), (len(u), starts[-1]))
    return Equations(matrix, values[chosen][:, :3].astype(float))


def joined(parts: list[Equations]) -> Equations:
    """Returns all equations as one system."""
    matrix = scipy.sparse.vstack([part.matrix for part in parts]).tocsr()
    return Equations(matrix, np.concatenate([part.values for part in parts]))


def solved(
    start: list[Texels], still: Equations, moving: Equations, balance: float
) -> list[Texels]:
    """Returns the levels, by conjugate gradients; level 0 is the image."""
    flat = np.concatenate([level.reshape(-1, 3) for level in start]).astype(float)
    weight = balance * (still.rms(flat) / moving.rms(flat)) ** 2
    (matrix, right), (other_matrix, other_right) = still.normal(), moving.normal()
    matrix, right = matrix + weight * other_matrix, right + weight * other_right
    diagonal = matrix.diagonal()
    pull = PULL * diagonal[diagonal > 0].mean()
    free = np.ones((len(flat), 1))
    free[: start[0].shape[0] * start[0].shape[1]] = 0
    scale = free / (diagonal + pull)[:, None]
    texels = flat.copy()
    residual = right - matrix @ texels
    direction = scale * residual
    size = (residual * direction).sum(axis=0)
    for _ in range(STEPS):
        image = matrix @ direction + pull * direction
        length = size / (direction * image).sum(axis=0)
        texels = texels + length * direction
        residual = residual - length * image
        scaled = scale * residual
        size, before = (residual * scaled).sum(axis=0), size
        direction = scaled + size / before * direction
    ends = np.cumsum([level.shape[0] * level.shape[1] for level in start])[:-1]
    parts = np.split(texels.clip(0, 1).astype(np.float32), ends)
    return [part.reshape(level.shape) for part, level in zip(parts, start, strict=True)]


if __name__ == "__main__":
    main()
