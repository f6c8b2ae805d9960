# SPDX-License-Identifier: GPL-3.0-or-later

"""Measures the mip values of OpenGL's lookups on turning models, with and without anisotropy.

Usage: PYTHONPATH=PACKAGE python3 bench/textures/opengl_mip_values.py [MODEL...]
       (--help lists the options; bench/textures/opengl_models.py has to be run before, in Blender)

Models are seen from all around, as bench/textures/opengl.py shows them. A mip value between the
first and the last level has a fraction s; trilinear lookups weigh the finer level by 1 - s and the
coarser by s.
"""

import argparse
import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from bench.report import Report, add_json_option
from bench.textures import opengl_renderer
from bench.textures.opengl import FOLDER, MODELS, SIZES
from bench.textures.opengl_renderer import Model, Renderer

Floats = NDArray[np.float64]

VIEWS = 16
MOST = 16  # Anisotropy.
BINS = 8
WAYS = ("isotropic", "driver, 16x", "probes, 16x")
RATIOS = (0.1, 0.25, 0.5, 0.75, 0.9)


def main() -> None:
    """Measures the models of the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("models", nargs="*", default=MODELS)
    parser.add_argument("--sizes", type=int, nargs="+", default=SIZES, metavar="PIXELS")
    parser.add_argument("--samples", type=int, default=1, help="along each side of a pixel")
    parser.add_argument("--folder", type=Path, default=FOLDER, help="(default: %(default)s)")
    add_json_option(parser)
    options = parser.parse_args()
    report = Report()
    everything: dict[str, list[Floats]] = {way: [] for way in WAYS}
    ratios = []
    for name in options.models:
        renderer = Renderer(model := Model.read(options.folder / f"{name}.npz"))
        of_model: dict[str, list[Floats]] = {way: [] for way in WAYS}
        for size in options.sizes:
            values, ratio = measured(renderer, model, size * options.samples)
            ratios.append((name, size, ratio))
            for way in WAYS:
                of_model[way].append(values[way])
        for way in WAYS:
            everything[way].append(weighted(of_model[way]))
    for way, found in everything.items():
        add_fractions(report, way, options.models, found)
        add_levels(report, way, np.concatenate(found))
    add_ratios(report, ratios)
    report.write(options.json)


def measured(renderer: Renderer, model: Model, size: int) -> tuple[dict[str, Floats], Floats]:
    """Returns the mip values of pixels in each way, and minor / major axes of footprints."""
    textures = []
    for image, wrap in zip(model.images, model.wraps, strict=True):
        levels = [image[:, :, :1]]
        while max(levels[-1].shape) > 1:
            height, width, _ = levels[-1].shape
            levels.append(np.zeros((max(1, height // 2), max(1, width // 2), 1), np.float32))
        textures.append(renderer.texture(levels, wrap))
    found: dict[str, list[Floats]] = {way: [] for way in WAYS}
    ratios = []
    for view in range(VIEWS):
        for way, anisotropy in (("isotropic", 1.0), ("driver, 16x", float(MOST))):
            pixels = renderer.draw(
                textures,
                2 * np.pi * (view + 0.5) / VIEWS,
                size,
                anisotropy=anisotropy,
                result=opengl_renderer.FOOTPRINT,
            )
            pixels = pixels[pixels[..., 3] == 1].astype(float)
            found[way].append(pixels[:, 0])
        major, minor = np.sqrt(np.maximum(pixels[:, 1:3], 1e-20).T)
        ratios.append(minor / major)
        found["probes, 16x"].append(np.log2(major / np.clip(np.ceil(major / minor), 1, MOST)))
    for texture in textures:
        texture.release()
    return {way: np.concatenate(parts) for way, parts in found.items()}, np.concatenate(ratios)


def weighted(parts: list[Floats]) -> Floats:
    """Returns as many values of each part, evenly chosen."""
    count = max(map(len, parts))
    return np.concatenate([np.sort(p)[np.arange(count) * len(p) // count] for p in parts])


def add_fractions(report: Report, way: str, models: list[str], found: list[Floats]) -> None:
    """Adds a histogram of the fractions of mip values above 0, by model."""
    rows = []
    for name, values in (*zip(models, found, strict=True), ("all", np.concatenate(found))):
        s = np.mod(values[values > 0], 1)
        counts = np.histogram(s, BINS, (0, 1))[0] * BINS / len(s)
        moments = ((1 - s) ** 2, s * (1 - s), s**2)
        cells = [f"{np.mean(values > 0):.2f}", *(f"{moment.mean():.3f}" for moment in moments)]
        rows.append([name, *cells, *(f"{count:.2f}" for count in counts)])
    rows.append(["even", "", "0.333", "0.167", "0.333", *["1.00"] * BINS])
    edges = [f"s {k / BINS:.3f}" for k in range(BINS)]
    head = ["model", "above 0", "(1-s)^2", "s(1-s)", "s^2", *edges]
    title = f"Fractions s of mip values, {way}: means, and density by eighths"
    report.table(title, head, rows, f"fractions, {way}")


def add_levels(report: Report, way: str, values: Floats) -> None:
    """Adds a histogram of the fractions by interval of mip values."""
    rows = []
    for level in range(int(max(0, values.max())) + 1):
        s = values[(values > level) & (values <= level + 1)] - level
        if len(s) < 0.005 * len(values):
            continue
        counts = np.histogram(s, BINS, (0, 1))[0] * BINS / len(s)
        moments = ((1 - s) ** 2, s * (1 - s), s**2)
        cells = [f"{len(s) / len(values):.3f}", *(f"{moment.mean():.3f}" for moment in moments)]
        rows.append([f"{level} to {level + 1}", *cells, *(f"{count:.2f}" for count in counts)])
    edges = [f"s {k / BINS:.3f}" for k in range(BINS)]
    head = ["mip values", "share", "(1-s)^2", "s(1-s)", "s^2", *edges]
    report.table(f"Mip values, {way}, all models", head, rows, f"levels, {way}")


def add_ratios(report: Report, ratios: list[tuple[str, int, Floats]]) -> None:
    """Adds quantiles of the axes of footprints."""
    rows = [
        [name, str(size), *(f"{q:.2f}" for q in np.quantile(values, RATIOS))]
        for name, size, values in ratios
    ]
    together = weighted([values for _, _, values in ratios])
    rows.append(["all", "", *(f"{q:.2f}" for q in np.quantile(together, RATIOS))])
    head = ["model", "pixels", *(f"{share:.0%} below" for share in RATIOS)]
    report.table("Footprints: minor axis / major axis", head, rows, "footprints")


if __name__ == "__main__":
    main()
