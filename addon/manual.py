# SPDX-License-Identifier: GPL-3.0-or-later

"""The installed manual: its address, and the pages of operators and settings.

Blender opens the page from the context menu of a button (Online Manual), and with F1 over it.
"""

from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from types import ModuleType

import bpy

FOLDER = Path(__file__).with_name("manual")
_OWN = {
    "queue": ("confirm_cancel", "clear_queue", "switches"),
    "preferences": (
        *("add_preset", "apply_preset", "reset_settings", "import_preset", "export_preset"),
        *("assign_shortcut", "remove_shortcut"),
    ),
}
"""The pages of operators and settings that belong to no subject; see `Manual`."""


def page(name: str = "README") -> str:
    """Returns the address of a page: the installed file, or the website if there is none."""
    path = FOLDER / f"{name}.html"
    return path.as_uri() if path.exists() else _website()


class Manual:
    """The pages of all operators and settings.

    Each subject has `MANUAL`, which maps names of pages in docs/ to the names of its operators and
    property groups, without the prefixes `prefilter.` and `PREFILTER_PG_`.
    """

    def __init__(self, subjects: Sequence[ModuleType]) -> None:
        """Collects `MANUAL` from the packages of the subjects."""
        self._tables: list[Mapping[str, Sequence[str]]] = [subject.MANUAL for subject in subjects]

    def register(self) -> None:
        """Registers the pages with Blender."""
        bpy.utils.register_manual_map(self.pages)

    def unregister(self) -> None:
        """Unregisters them."""
        bpy.utils.unregister_manual_map(self.pages)

    def pages(self) -> tuple[str, tuple[tuple[str, str], ...]]:
        """Returns the address of the manual, and pairs of name patterns and files, for Blender."""
        if not FOLDER.exists():
            return "", ()
        pairs = []
        for table in (*self._tables, _OWN):
            for page_name, names in table.items():
                file = f"{page_name}.html"
                for name in names:
                    for pattern in (f"bpy.ops.prefilter.{name}", f"bpy.types.prefilter_pg_{name}"):
                        pairs += [(pattern, file), (f"{pattern}.*", file)]
        pairs.append(("bpy.types.prefilter_ap_preferences.*", "preferences.html"))
        return f"{FOLDER.as_uri()}/", tuple(pairs)


@cache
def _website() -> str:
    import tomllib

    manifest = Path(__file__).with_name("blender_manifest.toml").read_text(encoding="utf-8")
    return tomllib.loads(manifest)["website"]
