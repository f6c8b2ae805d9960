# SPDX-License-Identifier: GPL-3.0-or-later

"""Which images of a scene have PAM levels in the texture cache, for panels: no file is opened."""

import time
from collections import Counter
from dataclasses import dataclass

import bpy

from ..bridge import images, rendered
from ..bridge.files import tx
from ..core.remembered import Remembered
from ..core.translations import marked, tr

WORDS = {
    "baked": marked("baked"),
    "stale": marked("stale"),
    "missing": marked("not baked"),
    "packed": marked("packed"),
    "unfit": marked("without a file"),
}
"""What is said of an image in each state."""

_SECONDS = 1.0  # How long what the file system says is believed.


@dataclass(frozen=True)
class ImageState:
    """An image and a key of `WORDS`."""

    name: str
    state: str


@dataclass
class _Known:
    """The images of a scene with their files, or the state of those that have none."""

    files: list[tuple[str, list[tx.Source] | str]]
    states: list[ImageState]
    time: float = 0.0


def states(context: bpy.types.Context) -> list[ImageState]:
    """Returns the states of the images that meshes show in renders of the scene."""
    known = _images.get(context)
    if known is None:
        return []
    now = time.monotonic()
    if now > known.time + _SECONDS or not known.states:
        known.states = [ImageState(name, _state(files)) for name, files in known.files]
        known.time = now
    return known.states


def states_now(context: bpy.types.Context) -> list[ImageState]:
    """Returns what `states` does, of what is there at this moment."""
    files = _look(context.scene, context.evaluated_depsgraph_get()).files
    return [ImageState(name, _state(found)) for name, found in files]


def summary(found: list[ImageState]) -> str:
    """Returns how many images are in which state, such as "2 baked, 1 stale"."""
    counts = Counter(one.state for one in found)
    return ", ".join(f"{counts[key]} {tr(word)}" for key, word in WORDS.items() if counts[key])


def look_again() -> None:
    """Has the file system asked again, after a bake."""
    _images.forget()


def _state(files: list[tx.Source] | str) -> str:
    if isinstance(files, str):
        return files
    found = {tx.state(source) for source in files}
    return next(state for state in ("missing", "stale", "baked") if state in found)


def _look(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> _Known:
    files: list[tuple[str, list[tx.Source] | str]] = []
    for image, seen in rendered.viewers(scene, depsgraph).items():
        if seen.others or not seen.objects:
            continue
        found: list[tx.Source] | str
        if image.packed_files and images.kind_that_is_no_still(image) is None:
            found = "packed"
        else:
            try:
                found = list(tx.sources(image).values())
            except ValueError:
                found = "unfit"
        files.append((image.name, found))
    return _Known(files, [])


_images = Remembered(_look)
