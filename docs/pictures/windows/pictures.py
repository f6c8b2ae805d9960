# SPDX-License-Identifier: GPL-3.0-or-later

"""The photographs of Blender's windows, and the panels in them."""

import json
import re
import struct
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

FOLDER = Path(__file__).resolve().parents[1]
KEYWORD = "Panels"
_SIGNATURE = b"\x89PNG\r\n\x1a\n"


@dataclass(frozen=True)
class Photograph:
    """A photograph of a window.

    Attributes:
        panels: The panels that it shows, and with them those below.
        scene: The function of scenes.py that makes the scene.
        opened: Panels that are closed by default, and open in the photograph.
        unfolded: Whether the parts of the panel are open, which start closed.
        since: The first Blender that has the panels.
    """

    panels: tuple[str, ...]
    scene: str
    opened: tuple[str, ...] = ()
    unfolded: bool = False
    since: tuple[int, int] = (4, 2)


def _panel(name: str, scene: str = "mesh", **more: Any) -> Photograph:
    return Photograph((f"PREFILTER_PT_{name}",), scene, (f"PREFILTER_PT_{name}",), **more)


CROPPED = {
    "welcome": _panel("welcome"),
    "bake": _panel("bake"),
    "bake_unfolded": _panel("bake", unfolded=True),
    "bake_all_images": _panel("model"),
    "bake_all_images_unfolded": _panel("model", unfolded=True),
    "preview": _panel("preview"),
    "error_plot": _panel("error"),
    "texel_use": _panel("texel_use"),
    "texture_cache": _panel("texture_cache", "cache", since=(5, 2)),
    "nothing": _panel("nothing", "nothing"),
    "voxelize": _panel("voxelize_sidebar"),
    "voxelize_unfolded": _panel("voxelize_sidebar", unfolded=True),
    "boolean": _panel("boolean_sidebar"),
    "reconstruct": _panel("reconstruct", "points"),
    "reconstruct_unfolded": _panel("reconstruct", "points", unfolded=True),
    "rasterize": _panel("rasterize", "text"),
    "rasterize_unfolded": _panel("rasterize", "text", unfolded=True),
    "rasterize_svg": _panel("shapes"),
    "resize": _panel("resize"),
    "resample": _panel("resample"),
    "preview_plane": _panel("plane"),
    "sampling_table": _panel("sampling_table"),
}
"""Photographs of one panel: `panels/NAME-VERSION.png`, in every Blender."""

WHOLE = {
    "panel": Photograph(("PREFILTER_PT_bake",), "image"),
    "preview": Photograph(("PREFILTER_PT_preview",), "levels", opened=("PREFILTER_PT_preview",)),
    "weights": Photograph(
        ("PREFILTER_PT_texel_use",), "weights", opened=("PREFILTER_PT_texel_use",)
    ),
    "voxelize": Photograph(
        ("PREFILTER_PT_voxelize_sidebar", "PREFILTER_PT_boolean_sidebar"), "voxels"
    ),
    "report": Photograph(("PREFILTER_PT_voxel_report",), "report"),
    "rasterize": Photograph(("PREFILTER_PT_rasterize", "PREFILTER_PT_drawn"), "shapes"),
    "plane": Photograph(("PREFILTER_PT_plane",), "plane", opened=("PREFILTER_PT_plane",)),
    "on_model": Photograph(
        ("PREFILTER_PT_on_model",), "on_model", opened=("PREFILTER_PT_on_model",)
    ),
    "welcome": Photograph(
        ("PREFILTER_PT_welcome",), "demonstration", opened=("PREFILTER_PT_welcome",)
    ),
    "model": Photograph(("PREFILTER_PT_model",), "model", opened=("PREFILTER_PT_model",)),
    "gltf": Photograph((), "gltf"),
}
"""Photographs of a window: `NAME.png`."""


def version_of(picture: Path) -> tuple[int, int]:
    """Returns the version of the Blender in which a photograph of a panel was taken."""
    major, minor = re.findall(r"-(\d+)\.(\d+)$", picture.stem)[0]
    return int(major), int(minor)


def read_text(picture: Path) -> dict[str, object]:
    """Returns the list of panel contents in a photograph; empty if it has none."""
    data = picture.read_bytes()
    position = len(_SIGNATURE)
    while position < len(data):
        size, kind = struct.unpack_from(">I4s", data, position)
        chunk = data[position + 8 : position + 8 + size]
        keyword, _, rest = chunk.partition(b"\0")
        if kind == b"zTXt" and keyword == KEYWORD.encode():
            return json.loads(zlib.decompress(rest[1:]))
        position += size + 12
    return {}
