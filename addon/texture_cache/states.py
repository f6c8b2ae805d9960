# SPDX-License-Identifier: GPL-3.0-or-later

"""The states of a scene's images in the texture cache, for panels; opens no files."""

import time
from collections import Counter
from dataclasses import dataclass

import bpy

from ..bridge import images, rendered
from ..bridge.files import tx
from ..core.scene_cache import SceneCache
from ..core.translations import marked, tr

WORDS = {
    "baked": marked("baked"),
    "stale": marked("stale"),
    "missing": marked("not baked"),
    "packed": marked("packed"),
    "unfit": marked("without a file"),
}
"""The name of each state."""

_SECONDS = 1.0  # How long states of files are cached.


@dataclass(frozen=True)
class ImageState:
    """The name of an image, and its state, a key of `WORDS`."""

    name: str
    state: str


@dataclass
class _SceneImages:
    """The images of a scene with their source files, or with a state if they have none."""

    files: list[tuple[str, list[tx.Source] | str]]
    states: list[ImageState]
    time: float = 0.0


def states(context: bpy.types.Context) -> list[ImageState]:
    """Returns the states of the images that meshes show in renders of the scene."""
    images = _images.get(context)
    if images is None:
        return []
    now = time.monotonic()
    if now > images.time + _SECONDS or not images.states:
        images.states = [ImageState(name, _state(files)) for name, files in images.files]
        images.time = now
    return images.states


def current_states(context: bpy.types.Context) -> list[ImageState]:
    """Returns the same as `states`, without the cache."""
    images = _find_images(context.scene, context.evaluated_depsgraph_get())
    return [ImageState(name, _state(files)) for name, files in images.files]


def summary(images: list[ImageState]) -> str:
    """Returns the number of images in each state, such as "2 baked, 1 stale"."""
    counts = Counter(image.state for image in images)
    return ", ".join(f"{counts[key]} {tr(word)}" for key, word in WORDS.items() if counts[key])


def refresh() -> None:
    """Clears the cache, as after a bake."""
    _images.clear()


def _state(files: list[tx.Source] | str) -> str:
    if isinstance(files, str):
        return files
    found = {tx.state(source) for source in files}
    return next(state for state in ("missing", "stale", "baked") if state in found)


def _find_images(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> _SceneImages:
    files: list[tuple[str, list[tx.Source] | str]] = []
    for image, viewers in rendered.viewers(scene, depsgraph).items():
        if viewers.others or not viewers.objects:
            continue
        sources: list[tx.Source] | str
        if image.packed_files and images.kind_that_is_no_still(image) is None:
            sources = "packed"
        else:
            try:
                sources = list(tx.sources(image).values())
            except ValueError:
                sources = "unfit"
        files.append((image.name, sources))
    return _SceneImages(files, [])


_images = SceneCache(_find_images)
