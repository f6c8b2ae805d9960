# SPDX-License-Identifier: GPL-3.0-or-later

"""Sampling tables as texts of Blender, or as files."""

import bpy
from prefilter.workflows.resampling import table_making

from ..core.outcome import Outcome
from .choices import TableSettings

_TEXT_KEY = "prefilter_sampling_table"


class TableMaking(table_making.TableMaking):
    """One table, and files of it, or a text.

    `write` belongs on the main thread; `compute` touches no Blender data and runs on any thread.
    """

    text: bpy.types.Text | None = None

    def write(self) -> Outcome:
        """Puts the files into place, or writes the text.

        Raises:
            OSError: It cannot be.
        """
        if self.targets:
            return super().write()
        table = self.table
        of = table.filter if table.target == table.filter else f"{table.filter}-{table.target}"
        name = f"{of}-{table.texels}.{self.settings.language}"
        self.text = _write_text(name, self.source)
        return self.outcome([self.text.name])


def effort(settings: TableSettings) -> float:
    """Returns about how long it takes, in a unit of its own."""
    columns = (settings.grid + 1) // 2
    parts = columns * (columns + 1) / 2 * settings.slices
    return parts * settings.texels**2 * settings.degree**3 * (30.0 if settings.use_certify else 1.0)


def _write_text(name: str, source: str) -> bpy.types.Text:
    """Writes a text, over the one that was written before under this name."""
    ours = (text for text in bpy.data.texts if text.get(_TEXT_KEY) == name)
    found = next(ours, None) or bpy.data.texts.new(name)
    found[_TEXT_KEY] = name
    found.from_string(source)
    # Else editors scroll to the end.
    found.cursor_set(0)
    return found
