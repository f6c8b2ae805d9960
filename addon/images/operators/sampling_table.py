# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.sampling_table`: a sampling table as shader code or a file."""

from typing import TYPE_CHECKING

import bpy

from ...core.operator import WorkOperator
from ..properties import TableProperties

if TYPE_CHECKING:
    from ..sampling_tables import TableMaking


class PREFILTER_OT_sampling_table(TableProperties, WorkOperator, bpy.types.Operator):
    """Makes a sampling table."""

    bl_idname = "prefilter.sampling_table"
    bl_label = "Make Sampling Table"
    bl_description = (
        "Find the few texels of a mipmap that best reproduce a filter at any place and "
        "scale, and write them as shader code, or as a file to use later"
    )
    bl_options = {"REGISTER", "UNDO"}
    activity = "Making a sampling table"

    if TYPE_CHECKING:
        work: TableMaking | None

    def read_work(self, context: bpy.types.Context) -> "TableMaking":
        """Checks the file to write."""
        from ...bridge.files import staging
        from ..sampling_tables import TableMaking

        del context
        settings = self.to_settings()
        if not settings.filepath:
            return TableMaking(settings)
        return TableMaking(
            settings, [staging.check_plain_target(settings.filepath, f".{settings.language}")]
        )

    def finish(self, context: bpy.types.Context, result: None) -> str:
        """Writes the table, and shows the text in the Text editor that called the operator."""
        summary = super().finish(context, result)
        assert self.work is not None
        text, area = self.work.text, context.area
        if text is not None and area is not None and area.type == "TEXT_EDITOR":
            context.space_data.text = text
        return summary

    def duration(self, load: None) -> float:
        """Estimates the duration."""
        from ..sampling_tables import effort

        del load
        return effort(self.to_settings())

    def draw_settings(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        """Draws the settings."""
        del context
        self.draw_in(layout)
