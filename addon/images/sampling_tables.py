# SPDX-License-Identifier: GPL-3.0-or-later

"""Sampling tables as text data-blocks or files."""

import bpy
from prefilter.workflows.images import table_making

from ..core.outcome import Outcome
from .choices import TableSettings

_TEXT_KEY = "prefilter_sampling_table"


class TableMaking(table_making.TableMaking):
    """A table, written to files or to a text data-block.

    `write` runs on the main thread; `compute` uses no Blender data and runs on any thread.
    """

    text: bpy.types.Text | None = None

    def write(self) -> Outcome:
        """Puts the files into place, or writes the text.

        Raises:
            OSError: A file cannot be put into place.
        """
        if self.targets:
            return super().write()
        table = self.table
        is_same = table.target == table.filter
        filters = table.filter if is_same else f"{table.filter}-{table.target}"
        name = f"{filters}-{table.texels}.{self.settings.language}"
        self.text = _write_text(name, self.source)
        return self.outcome([self.text.name])


def effort(settings: TableSettings) -> float:
    """Estimates the duration, in any unit."""
    columns = (settings.grid + 1) // 2
    parts = columns * (columns + 1) / 2 * settings.slices
    return parts * settings.texels**2 * settings.degree**3 * (30.0 if settings.use_certify else 1.0)


def _write_text(name: str, source: str) -> bpy.types.Text:
    """Writes a text data-block, replacing an earlier table of the same name."""
    earlier = (text for text in bpy.data.texts if text.get(_TEXT_KEY) == name)
    text = next(earlier, None) or bpy.data.texts.new(name)
    text[_TEXT_KEY] = name
    text.from_string(source)
    # Otherwise editors would scroll to the end.
    text.cursor_set(0)
    return text
