# SPDX-License-Identifier: GPL-3.0-or-later

"""Libraries that resize images of floats in memory, each with one thread; rows from the bottom."""

import importlib
import os
from collections.abc import Callable
from typing import Any

Resize = Callable[[Any, int, int, str], Any]
"""Gets (h, w, c) float32 values, the new width and height, and a filter as ours are called."""


def prefilter() -> tuple[Resize, frozenset[str]]:
    """Ours, which filters every channel unchanged."""
    module = importlib.import_module("prefilter")

    def resize(image: Any, width: int, height: int, filter: str) -> Any:
        return module.resize(image, width, height, filter=filter, premultiplied=True, threads=1)

    return resize, frozenset(module.RESIZE_FILTERS)


def pillow() -> tuple[Resize, frozenset[str]]:
    """Pillow, which resizes floats one channel at a time."""
    numpy = importlib.import_module("numpy")
    image_module = importlib.import_module("PIL.Image")
    filters = {"box": "BOX", "tent": "BILINEAR", "lanczos3": "LANCZOS"}

    def resize(image: Any, width: int, height: int, filter: str) -> Any:
        method = image_module.Resampling[filters[filter]]
        channels = [
            image_module.fromarray(image[..., c]).resize((width, height), method)
            for c in range(image.shape[2])
        ]
        return numpy.stack([numpy.asarray(channel) for channel in channels], axis=2)

    return resize, frozenset(filters)


def openimageio() -> tuple[Resize, frozenset[str]]:
    """OpenImageIO's `resize`, which `oiiotool --resize` calls."""
    oiio = importlib.import_module("OpenImageIO")
    filters = {
        "box": "box",
        "tent": "triangle",
        "lanczos3": "lanczos3",
        "mitchell": "mitchell",
        "radial3": "radial-lanczos3",
    }

    def resize(image: Any, width: int, height: int, filter: str) -> Any:
        roi = oiio.ROI(0, width, 0, height, 0, 1, 0, image.shape[2])
        # Width 0 gives filters the width that suits this ratio.
        made = oiio.ImageBufAlgo.resize(oiio.ImageBuf(image), filters[filter], 0.0, roi, 1)
        if made.has_error:
            raise OSError(made.geterror())
        return made.get_pixels("float")

    return resize, frozenset(filters)


def libvips() -> tuple[Resize, frozenset[str]]:
    """Libvips, without the box filter that it puts before others by default."""
    os.environ["VIPS_CONCURRENCY"] = "1"
    pyvips = importlib.import_module("pyvips")
    pyvips.cache_set_max(0)
    filters = {"tent": "linear", "lanczos3": "lanczos3", "mitchell": "mitchell"}

    def resize(image: Any, width: int, height: int, filter: str) -> Any:
        source = pyvips.Image.new_from_array(image)
        scales = width / image.shape[1], height / image.shape[0]
        made = source.resize(scales[0], vscale=scales[1], kernel=filters[filter], gap=0)
        return made.numpy().reshape(height, width, image.shape[2])

    return resize, frozenset(filters)


def opencv() -> tuple[Resize, frozenset[str]]:
    """OpenCV's INTER_AREA, its only filter that is as wide as the new pixels."""
    cv2 = importlib.import_module("cv2")
    cv2.setNumThreads(1)

    def resize(image: Any, width: int, height: int, filter: str) -> Any:
        made = cv2.resize(image, (width, height), interpolation=cv2.INTER_AREA)
        return made.reshape(height, width, image.shape[2])

    return resize, frozenset({"box"})


LIBRARIES: dict[str, Callable[[], tuple[Resize, frozenset[str]]]] = {
    "prefilter": prefilter,
    "Pillow": pillow,
    "OpenImageIO": openimageio,
    "libvips": libvips,
    "OpenCV": opencv,
}


def found() -> dict[str, tuple[Resize, frozenset[str]]]:
    """Returns the libraries that this Python can import, and their filters."""
    made = {}
    for name, make in LIBRARIES.items():
        try:
            made[name] = make()
        except (ImportError, OSError):
            continue
    return made
