# SPDX-License-Identifier: GPL-3.0-or-later

"""Compares exported models in three.js, in a headless Chromium: its mipmaps, and ours.

Usage: python3 bench/textures/viewers/three_js.py [MODEL...] --modules FOLDER   (--help)

FOLDER is a node_modules with three. bench/textures/viewers/models.py writes the models. Each
turns before a fixed camera, its base color not lit, by one lookup a pixel with the mipmaps that
three.js makes of the exported PNG file, and with those that the exported KTX 2 file holds. Errors
are those to the mean of 8 x 8 pixels without mipmaps, over all pixels that differ from the
background; flicker is the error of the change from frame to frame.
"""

import argparse
import base64
import sys
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[3]))
from bench.report import Report, add_json_option
from bench.textures.viewers.chromium import ask

FOLDER = Path(__file__).resolve().parents[3] / "build/viewers"
MODELS = ("BoomBox", "DamagedHelmet", "Duck", "Suzanne")
KINDS = {"plain": "three.js' own", "fitted": "fitted", "views": "fitted to views"}
SAMPLES = 8
MULTISAMPLES = (4, 0)
WHAT = ("error, 255ths", "/ own", "flicker / own")


def main() -> int:
    """Draws the models of the command line; returns the exit status."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("models", nargs="*", default=MODELS)
    parser.add_argument("--folder", type=Path, default=FOLDER, help="default: %(default)s")
    parser.add_argument("--modules", type=Path, required=True, help="a node_modules with three")
    parser.add_argument("--side", type=int, default=96, help="of the picture, in pixels")
    parser.add_argument("--frames", type=int, default=24)
    add_json_option(parser)
    options = parser.parse_args()
    report = Report()
    rows: list[list[str]] = []
    for model in options.models:
        size = (options.side, options.frames)
        tasks = [task(model, "plain", *size, nearest=True)]
        for multisamples in MULTISAMPLES:
            tasks += [task(model, kind, *size, multisamples=multisamples) for kind in KINDS]
        answer = drawn(tasks, options.modules, options.folder)
        true, *shown = (frames_of(result, options.side) for result in answer["results"])
        _check_levels(report, model, answer["results"][: 1 + len(KINDS)])
        errors = [_errors(frames, true) for frames in shown]
        for number, kind in enumerate(KINDS):
            row = [model if kind == "plain" else "", KINDS[kind]]
            for first in range(0, len(errors), len(KINDS)):
                ratios = np.divide(errors[first + number], errors[first])
                row += [f"{255 * errors[first + number][0]:.2f}", *(f"{one:.3f}" for one in ratios)]
            rows.append(row)
    report.table(
        f"three.js r{answer['revision']}, {options.side} x {options.side} pixels; with and without "
        f"multisampling",
        ["model", "mipmaps", *(f"{one} {what}" for one in ("4x:", "1x:") for what in WHAT)],
        rows,
        name="errors",
    )
    return report.finish(options.json)


def task(
    model: str,
    kind: str,
    side: int,
    frames: int,
    *,
    nearest: bool = False,
    multisamples: int = 4,
) -> dict[str, Any]:
    """Returns a drawing task: a model of one kind in `frames` steps of a turn, `side` pixels wide.

    Args:
        model: Its name.
        kind: One of `KINDS`.
        side: Of the picture.
        frames: How many.
        nearest: Without mipmaps, by the mean of `SAMPLES` x `SAMPLES` pixels.
        multisamples: Where a pixel looks for what covers it; 0 for its center alone.
    """
    return {
        "name": f"{model} {kind}",
        "url": f"/models/{model}.{kind}.glb",
        "side": side,
        "samples": SAMPLES if nearest else 1,
        "frames": frames,
        "anisotropy": 1,
        "nearest": nearest,
        "multisamples": multisamples,
    }


def drawn(
    tasks: list[dict[str, Any]], modules: Path, models: Path, *, page: str = "three_js.html"
) -> dict[str, Any]:
    """Returns a viewer's answer: its `revision`, and `results`, one per task."""
    answer: dict[str, Any] = ask(
        page, {"tasks": tasks}, {"modules": modules, "models": models}, timeout=900
    )
    return answer


def frames_of(result: dict[str, Any], side: int) -> np.ndarray:
    """Frames of (side, side, 3) scene-linear values, the top row first."""
    data = [np.frombuffer(base64.b64decode(text), np.float32) for text in result["frames"]]
    return np.stack(data).reshape(-1, side, side, 3)[:, ::-1].astype(float)


def _encoded(frames: np.ndarray) -> np.ndarray:
    clipped = np.clip(frames, 0, 1)
    return np.where(clipped <= 0.0031308, 12.92 * clipped, 1.055 * clipped ** (1 / 2.4) - 0.055)


def _errors(frames: np.ndarray, true: np.ndarray) -> tuple[float, float]:
    """The root mean square error of the encoded visible pixels, and of their changes."""
    covered = np.abs(true - true[0, 0, 0]).max(axis=3) > 1e-3
    difference = _encoded(frames) - _encoded(true)
    both = covered[1:] & covered[:-1]
    change = np.diff(difference, axis=0)
    return float(np.sqrt(np.mean(difference[covered] ** 2))), float(
        np.sqrt(np.mean(change[both] ** 2))
    )


def _check_levels(report: Report, model: str, results: list[dict[str, Any]]) -> None:
    """Every texture of a fitted file has to arrive with all its levels."""
    for result in results:
        if result["name"].endswith(" plain"):
            continue
        for texture in result["textures"]:
            whole = max(texture["width"], texture["height"]).bit_length()
            found = len(texture["levels"])
            report.verdict(
                texture["compressed"] and found == whole,
                f"{result['name']}, {texture['slot']}: {found} of {whole} levels of "
                f"{texture['width']} x {texture['height']}",
            )


if __name__ == "__main__":
    sys.exit(main())
