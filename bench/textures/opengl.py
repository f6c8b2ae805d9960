# SPDX-License-Identifier: GPL-3.0-or-later

"""Measures the error and flicker of turning models in OpenGL, by the filter of their levels.

Usage: PYTHONPATH=PACKAGE python3 bench/textures/opengl.py [MODEL...] [--filters FILTER...]
       (--help lists the options; bench/textures/opengl_models.py has to be run before, in Blender)

A model wears its base color, unlit, and turns through 12 frames of 0.4 degrees. The reference
looks up the full image (level 0, bilinear) at 16 x 16 points of each pixel. Against it are lookups
of the levels: one a pixel, 4 x 4 samples a pixel, and one with 16x anisotropy. The error is the
RMSE over the pixels that the model covers fully and the channels, in scene-linear values; flicker
is the root mean square of the difference of consecutive frames minus the reference's difference.

A filter is NAME, or NAME:KEY=VALUE:..., with arguments of `prefilter.mipmaps`, and with
views=LOOKUPS if `prefilter.fit_to_views` goes on from there; or "exact": the mean of the full image
over the footprint of each pixel or sample, which no levels can do better than in one chart.
"""

import argparse
import hashlib
import inspect
import itertools
import json
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
import prefilter
import prefilter.images.mipmaps
import prefilter.images.views
from numpy.typing import NDArray

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from bench.report import Report, add_json_option
from bench.textures import opengl_renderer
from bench.textures.opengl_renderer import Model, Renderer, Texels, averaged

FOLDER = Path(__file__).resolve().parents[2] / "build/opengl"
MODELS = ("spot", "DamagedHelmet", "AntiqueCamera", "FlightHelmet", "BoomBox")
APART = ("ship",)  # Not in the means.
FILTERS = ("box", "lanczos3", "pam-bilinear", "pam-trilinear")
BASELINE = "lanczos3"
SIZES = (200, 64)
FRAMES = 12
STEP = np.radians(0.4)
REFERENCE = 16  # Samples along each side of a pixel.
PIECES = 8  # Samples along a side, to find pixels with several pieces of the model.
EXACT = "exact"


@dataclass(frozen=True)
class Mode:
    """A kind of lookup of levels."""

    about: str
    samples: int = 1  # Along each side of a pixel.
    filters: tuple[int, int] = opengl_renderer.TRILINEAR
    anisotropy: float = 1.0
    result: str = opengl_renderer.LOOKUP


MODES = {
    "one": Mode("one trilinear lookup a pixel"),
    "4x4": Mode("4 x 4 trilinear lookups a pixel", samples=4),
    "16x": Mode("one lookup a pixel with the driver's 16x anisotropy", anisotropy=16.0),
    "probes": Mode(
        "one lookup a pixel with up to 16 trilinear probes, as EXT_texture_filter_anisotropic "
        "describes them",
        result=opengl_renderer.PROBES,
    ),
    "nearest": Mode(
        "one bilinear lookup a pixel in the nearest level", filters=opengl_renderer.NEAREST_LEVEL
    ),
}


@dataclass(frozen=True)
class Truth:
    """The reference pictures.

    Attributes:
        colors: (views, frames, size, size, 3).
        masks: (views, frames, size, size) pixels that count, by the name of the mask.
    """

    colors: Texels
    masks: dict[str, NDArray[np.bool_]]

    def error(self, shown: Texels, mask: str) -> float:
        """Returns the RMSE."""
        differences = (shown - self.colors)[self.masks[mask]]
        return float(np.sqrt(np.mean(differences.astype(float) ** 2)))

    def flicker(self, shown: Texels, mask: str) -> float:
        """Returns the RMS of changes from frame to frame that the truth does not have."""
        both = self.masks[mask][:, 1:] & self.masks[mask][:, :-1]
        changes = np.diff(shown - self.colors, axis=1)[both]
        return float(np.sqrt(np.mean(changes.astype(float) ** 2)))


MASKS = {
    "covered": "pixels that the model covers fully",
    "piece": "pixels that one chart covers fully, without edges of depth",
}


@dataclass(frozen=True)
class Found:
    """Measurements by the key "MASK SIZE MODE"."""

    error: dict[str, float]
    flicker: dict[str, float]


def main() -> None:
    """Measures the models of the command line."""
    options = parse()
    report = Report()
    found: dict[str, dict[str, Found]] = {}
    for name in options.models:
        model = Model.read(options.folder / f"{name}.npz")
        known = Results(options.folder / "results" / f"{name}.json", settings(options))
        missing = [f for f in options.filters if options.fresh or f not in known.found]
        if missing:
            renderer = Renderer(model)
            truth = references(renderer, model, options)
            for filter_ in missing:
                known.add(filter_, measure(renderer, model, filter_, truth, options))
        found[name] = {f: known.found[f] for f in options.filters}
    add_tables(report, found, options)
    report.write(options.json)


def parse() -> argparse.Namespace:
    """Reads the arguments."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("models", nargs="*", default=MODELS)
    parser.add_argument("--filters", nargs="+", default=FILTERS, metavar="FILTER")
    parser.add_argument("--modes", nargs="+", default=tuple(MODES), choices=MODES, metavar="MODE")
    parser.add_argument("--masks", nargs="+", default=tuple(MASKS), choices=MASKS, metavar="MASK")
    parser.add_argument("--sizes", type=int, nargs="+", default=SIZES, metavar="PIXELS")
    parser.add_argument("--views", type=int, default=2, help="starts of the turn")
    parser.add_argument("--fresh", action="store_true", help="repeat measurements of this build")
    parser.add_argument(
        "--folder",
        type=Path,
        default=FOLDER,
        help="of the models; renders and results are kept there too (default: %(default)s)",
    )
    add_json_option(parser)
    options = parser.parse_args()
    if BASELINE not in options.filters:
        options.filters = [BASELINE, *options.filters]
    for model in options.models:
        if not (options.folder / f"{model}.npz").exists():
            parser.error(f"there is no {options.folder / model}.npz: run opengl_models.py")
    return options


def settings(options: argparse.Namespace) -> str:
    """Returns everything but model and filter that results depend on: the build and the drawing."""
    hashed = hashlib.sha256(Path(prefilter._native.__file__).read_bytes())
    for module in (prefilter.images.mipmaps, prefilter.images.views, opengl_renderer):
        hashed.update(inspect.getsource(module).encode())
    hashed.update(repr((options.views, options.sizes, options.modes)).encode())
    return hashed.hexdigest()[:16]


class Results:
    """The results for a model, in a file."""

    def __init__(self, path: Path, settings_: str) -> None:
        """Reads the file, if there is one."""
        self._path, self._settings = path, settings_
        self._all = json.loads(path.read_text()) if path.exists() else {}
        kept = self._all.setdefault(settings_, {})
        self.found = {name: Found(**fields) for name, fields in kept.items()}

    def add(self, name: str, found: Found) -> None:
        """Adds a filter and writes the file."""
        self.found[name] = found
        self._all[self._settings][name] = vars(found)
        self._path.parent.mkdir(parents=True, exist_ok=True)
        self._path.write_text(json.dumps(self._all, indent=1))


def angles(views: int) -> list[list[float]]:
    """Returns the angles of the frames, by view."""
    starts = [0.35 + 2 * np.pi * view / views for view in range(views)]
    return [[start + frame * STEP for frame in range(FRAMES)] for start in starts]


def drawn(views: int, draw: Callable[[float], NDArray]) -> NDArray:
    """Draws all frames."""
    return np.array([[draw(angle) for angle in view] for view in angles(views)])


def references(renderer: Renderer, model: Model, options: argparse.Namespace) -> dict[int, Truth]:
    """Returns the true frames by size, from files if they were drawn before."""
    found = {}
    drawing = (true_frame, Renderer, opengl_renderer.in_one_piece)
    source = "".join(map(inspect.getsource, drawing)) + repr(angles(options.views))
    key = hashlib.sha256(source.encode()).hexdigest()[:12]
    for size in options.sizes:
        path = options.folder / "references" / f"{model.name}-{size}-{key}.npy"
        if not path.exists():
            textures = renderer.textures([[image] for image in model.images])
            draw = partial(true_frame, renderer, textures, size)
            path.parent.mkdir(parents=True, exist_ok=True)
            np.save(path, drawn(options.views, draw))
            for texture in textures:
                texture.release()
        frames = np.load(path)
        masks = {"covered": frames[..., 3] == 1, "piece": frames[..., 4] == 1}
        found[size] = Truth(frames[..., :3], masks)
    return found


def true_frame(renderer: Renderer, textures: list, size: int, angle: float) -> Texels:
    """Returns colors, coverage, and 1 where a pixel has one piece."""
    filters = opengl_renderer.FULL
    samples = renderer.draw(textures, angle, REFERENCE * size, filters=filters)
    places = renderer.draw(textures, angle, PIECES * size, result=opengl_renderer.PLACE)
    frame = averaged(samples, REFERENCE)
    alone = opengl_renderer.in_one_piece(places, PIECES) & (frame[..., 3] == 1)
    return np.concatenate([frame, alone[..., None].astype(np.float32)], axis=2)


def measure(
    renderer: Renderer,
    model: Model,
    filter_: str,
    truth: dict[int, Truth],
    options: argparse.Namespace,
) -> Found:
    """Returns the results of a filter."""
    began = time.monotonic()
    if filter_ == EXACT:
        textures = renderer.textures([[image] for image in model.images])
    else:
        textures = renderer.textures([baked(model, i, filter_) for i in range(len(model.images))])
    baked_in = time.monotonic() - began
    error, flicker = {}, {}
    for size in options.sizes:
        exact: dict[int, Texels] = {}  # By the samples of the mode.
        for name in options.modes:
            mode = MODES[name]
            if filter_ == EXACT:
                result = opengl_renderer.exact(REFERENCE // mode.samples)
                mode = Mode("", samples=mode.samples, filters=opengl_renderer.FULL, result=result)
            frames = exact.get(mode.samples) if filter_ == EXACT else None
            if frames is None:
                frames = drawn(options.views, partial(shown, renderer, textures, size, mode))
            if filter_ == EXACT:
                exact[mode.samples] = frames
            for mask in MASKS:
                error[f"{mask} {size} {name}"] = truth[size].error(frames, mask)
                flicker[f"{mask} {size} {name}"] = truth[size].flicker(frames, mask)
    for texture in textures:
        texture.release()
    seconds = time.monotonic() - began - baked_in
    print(f"{model.name}, {filter_}: {baked_in:.0f} s, {seconds:.0f} s", file=sys.stderr)
    return Found(error, flicker)


def shown(renderer: Renderer, textures: list, size: int, mode: Mode, angle: float) -> Texels:
    """Returns the colors of a frame."""
    samples = renderer.draw(
        textures,
        angle,
        mode.samples * size,
        filters=mode.filters,
        anisotropy=mode.anisotropy,
        result=mode.result,
    )
    return averaged(samples, mode.samples)[..., :3]


def baked(model: Model, image: int, filter_: str) -> list[Texels]:
    """Returns the levels of an image."""
    name, *arguments = filter_.split(":")
    of_image = model.used == image
    vertices, triangles = np.unique(
        model.corners[of_image].reshape(-1, 3), axis=0, return_inverse=True
    )
    surface = prefilter.Surface(vertices, triangles.reshape(-1, 3), model.uvs[of_image])
    options = dict(map(argument, arguments))
    views, wrap = options.pop("views", None), model.wraps[image]
    levels = prefilter.mipmaps(model.images[image], surface, filter=name, wrap=wrap, **options)
    if views is None:
        return levels
    return prefilter.fit_to_views(levels, surface, lookups=views, wrap=wrap)


def argument(text: str) -> tuple[str, object]:
    """Reads KEY=VALUE."""
    key, _, value = text.partition("=")
    for kind in (int, float):
        try:
            return key, kind(value)
        except ValueError:
            pass
    return key, value


def add_tables(
    report: Report, found: dict[str, dict[str, Found]], options: argparse.Namespace
) -> None:
    """Adds tables of shares of the baseline: means over models, then by model and size."""
    for mask in options.masks:
        shares = {
            (name, mode): np.array(
                [
                    [share(of, name, f"{mask} {size} {mode}") for size in options.sizes]
                    for model, of in found.items()
                    if model not in APART
                ]
            )
            for name in options.filters
            for mode in options.modes
        }
        if all(len(array) for array in shares.values()):
            report.table(
                f"Means over models and sizes, {MASKS[mask]}; error / flicker, of {BASELINE}'s",
                ["filter", *options.modes],
                [
                    [name, *(pair(shares[name, mode].mean(axis=(0, 1))) for mode in options.modes)]
                    for name in options.filters
                ],
                f"means, {mask}",
            )
            report.table(
                f"The worst model of each, {MASKS[mask]}",
                ["filter", *options.modes],
                [
                    [
                        name,
                        *(
                            pair(shares[name, mode].mean(axis=1).max(axis=0))
                            for mode in options.modes
                        ),
                    ]
                    for name in options.filters
                ],
                f"worst, {mask}",
            )
    others = [name for name in options.filters if name != BASELINE]
    for mask, mode in itertools.product(options.masks, options.modes):
        rows = []
        for size, (model, of) in itertools.product(options.sizes, found.items()):
            key = f"{mask} {size} {mode}"
            base = f"{of[BASELINE].error[key]:.5f} / {of[BASELINE].flicker[key]:.5f}"
            rows.append(
                [model, str(size), base, *(pair(np.array(share(of, name, key))) for name in others)]
            )
        title = f"{mode}: {MODES[mode].about}; {MASKS[mask]}; shares of {BASELINE}"
        report.table(title, ["model", "pixels", BASELINE, *others], rows, f"models, {mask}, {mode}")


def share(by_filter: dict[str, Found], name: str, key: str) -> tuple[float, float]:
    """Returns error and flicker of a filter as shares of the baseline's."""
    base, other = by_filter[BASELINE], by_filter[name]
    return other.error[key] / base.error[key], other.flicker[key] / base.flicker[key]


def pair(shares: NDArray) -> str:
    """Returns both as text."""
    return f"{shares[0]:.3f} / {shares[1]:.3f}"


if __name__ == "__main__":
    main()
