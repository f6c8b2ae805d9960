# SPDX-License-Identifier: GPL-3.0-or-later

"""The manual that comes along: where it is, and which page is about which operator and setting.

Blender opens the page from the context menu of a button (Online Manual), and with F1 over it.
"""

from functools import cache
from pathlib import Path

import bpy

FOLDER = Path(__file__).with_name("manual")
_PAGES = {
    "bake": "bake",
    "bake_mipmaps": "bake",
    "bake_model": "bake",
    "model": "bake",
    "remove_levels": "bake",
    "bake_texture_cache": "texture_cache",
    "view": "view",
    "preview_levels": "view",
    "end_preview": "view",
    "plot_error": "view",
    "show_weights": "view",
    "show_source": "view",
    "fill_unused": "view",
    "resize": "resize",
    "resize_image": "resize",
    "resample": "resample",
    "resample_image": "resample",
    "plane": "resample",
    "preview_plane": "resample",
    "end_plane": "resample",
    "sampling_table": "shaders",
    "reconstruct": "scans",
    "rasterize": "shapes",
    "rasterize_svg": "shapes",
    "drawn": "shapes",
    "update_drawn": "shapes",
    "voxelize": "voxels",
    "boolean": "voxels",
    "add_preset": "preferences",
}
"""The page of an operator, and of the settings in a group of properties."""


def page(name: str = "README") -> str:
    """Returns the address of a page: of a file that comes along, else of the website."""
    path = FOLDER / f"{name}.html"
    return path.as_uri() if path.exists() else _website()


def pages() -> tuple[str, tuple[tuple[str, str], ...]]:
    """Returns what Blender asks a manual for: where it is, and patterns with what is at each."""
    if not FOLDER.exists():
        return "", ()
    found = []
    for name, which in _PAGES.items():
        for pattern in (f"bpy.ops.prefilter.{name}", f"bpy.types.prefilter_pg_{name}"):
            found += [(pattern, f"{which}.html"), (f"{pattern}.*", f"{which}.html")]
    found.append(("bpy.types.prefilter_ap_preferences.*", "preferences.html"))
    return f"{FOLDER.as_uri()}/", tuple(found)


def register() -> None:
    """Makes the pages known to Blender."""
    bpy.utils.register_manual_map(pages)


def unregister() -> None:
    """Takes them back."""
    bpy.utils.unregister_manual_map(pages)


@cache
def _website() -> str:
    import tomllib

    manifest = Path(__file__).with_name("blender_manifest.toml").read_text(encoding="utf-8")
    return tomllib.loads(manifest)["website"]
