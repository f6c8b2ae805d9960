# SPDX-License-Identifier: GPL-3.0-or-later

"""Libraries that reduce images of bytes in memory by Lanczos 3, each with one thread.

Each gets (h, w, 3 or 4) bytes, the new width and height, and whether they are filtered in linear
light. A fourth channel is straight alpha. fast_image_resize and pic-scale come from rust_resizers/,
whose library the environment names.
"""

import ctypes
import importlib
import os
from collections.abc import Callable
from functools import partial
from typing import Any

Resize = Callable[[Any, int, int, bool], Any]

RUST_LIBRARY = "PREFILTER_RUST_RESIZERS"
"""The path of librust_resizers.so."""


def prefilter() -> Resize:
    """Ours."""
    module = importlib.import_module("prefilter")

    def resize(image: Any, width: int, height: int, srgb: bool) -> Any:
        return module.resize(image, width, height, encoding="srgb" if srgb else "linear", threads=1)

    return resize


def libvips() -> Resize:
    """Libvips, which filters alpha as it does colors unless it is told to multiply and divide."""
    os.environ["VIPS_CONCURRENCY"] = "1"
    pyvips = importlib.import_module("pyvips")
    pyvips.cache_set_max(0)

    def resize(image: Any, width: int, height: int, srgb: bool) -> Any:
        rows, columns, channels = image.shape
        made = pyvips.Image.new_from_memory(image.data, columns, rows, channels, "uchar")
        made = made.copy(interpretation="srgb")
        if srgb:
            made = made.colourspace("scrgb")
        if channels == 4:
            made = made.premultiply()
        made = made.resize(width / columns, vscale=height / rows, kernel="lanczos3", gap=0)
        if channels == 4:
            made = made.unpremultiply()
        if srgb:
            made = made.colourspace("srgb")
        return made.cast("uchar").numpy()

    return resize


def _rust(function: str) -> Resize:
    library = ctypes.CDLL(os.environ[RUST_LIBRARY])
    numpy = importlib.import_module("numpy")
    call = getattr(library, function)
    size = ctypes.c_size_t
    pointer = ctypes.c_void_p
    call.argtypes = [pointer, size, size, pointer, size, size, size, ctypes.c_bool]
    call.restype = None

    def resize(image: Any, width: int, height: int, srgb: bool) -> Any:
        rows, columns, channels = image.shape
        made = numpy.empty((height, width, channels), numpy.uint8)
        source, target = image.ctypes.data, made.ctypes.data
        call(source, columns, rows, target, width, height, channels, srgb)
        return made

    return resize


LIBRARIES: dict[str, Callable[[], Resize]] = {
    "prefilter": prefilter,
    "libvips": libvips,
    "fast_image_resize": partial(_rust, "fir_resize"),
    "pic-scale": partial(_rust, "pic_scale_resize"),
}


def found() -> dict[str, Resize]:
    """Returns the available libraries."""
    made = {}
    for name, make in LIBRARIES.items():
        try:
            made[name] = make()
        except (ImportError, OSError, KeyError):
            continue
    return made
