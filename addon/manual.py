# SPDX-License-Identifier: GPL-3.0-or-later

"""The manual that comes along: where it is, and which page is about which operator and setting.

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
"""What belongs to no subject; see `Manual`."""


def page(name: str = "README") -> str:
    """Returns the address of a page: of a file that comes along, else of the website."""
    path = FOLDER / f"{name}.html"
    return path.as_uri() if path.exists() else _website()


class Manual:
    """Which page is about what: each subject says that of its own.

    A subject has `MANUAL`: by the name of a page in docs/, the names of its operators and of its
    groups of properties, without the prefixes `prefilter.` and `PREFILTER_PG_`.
    """

    def __init__(self, subjects: Sequence[ModuleType]) -> None:
        """Takes the packages of the subjects."""
        self._tables: list[Mapping[str, Sequence[str]]] = [one.MANUAL for one in subjects]

    def register(self) -> None:
        """Makes the pages known to Blender."""
        bpy.utils.register_manual_map(self.pages)

    def unregister(self) -> None:
        """Takes them back."""
        bpy.utils.unregister_manual_map(self.pages)

    def pages(self) -> tuple[str, tuple[tuple[str, str], ...]]:
        """Returns what Blender asks for: where the manual is, and patterns with what is at each."""
        if not FOLDER.exists():
            return "", ()
        found = []
        for table in (*self._tables, _OWN):
            for which, names in table.items():
                for name in names:
                    for pattern in (f"bpy.ops.prefilter.{name}", f"bpy.types.prefilter_pg_{name}"):
                        found += [(pattern, f"{which}.html"), (f"{pattern}.*", f"{which}.html")]
        found.append(("bpy.types.prefilter_ap_preferences.*", "preferences.html"))
        return f"{FOLDER.as_uri()}/", tuple(found)


@cache
def _website() -> str:
    import tomllib

    manifest = Path(__file__).with_name("blender_manifest.toml").read_text(encoding="utf-8")
    return tomllib.loads(manifest)["website"]
