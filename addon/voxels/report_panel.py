# SPDX-License-Identifier: GPL-3.0-or-later

"""Panel of the report on a result's sources, with buttons that select faces and edges."""

import bpy

from ..core.registration import classes, registration
from ..core.sidebar import Tab, note
from ..core.translations import marked, tr
from .operators.select_found import PREFILTER_OT_select_found

_LABELS = {
    "THIN": marked("Thin Faces"),
    "LOST": marked("Lost Faces"),
    "OPEN": marked("Open Edges"),
    "TURNED": marked("Flipped Faces"),
}
_PARTS, _CAVITIES, _GENUS = marked("Parts"), marked("Cavities"), marked("Genus")
_ICONS = {"OPEN": "EDGESEL"}


class PREFILTER_PT_voxel_report(Tab, bpy.types.Panel):
    """Parts, cavities and genus before and after, and the faces and edges concerned."""

    bl_label = "Voxel Report"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Whether there is a report on the active object or on its result."""
        from .memory import updatable_result

        result = updatable_result(context.active_object)
        is_fitting = context.mode in {"OBJECT", "EDIT_MESH"}
        return is_fitting and result is not None and result.prefilter_found.is_there

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        from .memory import updatable_result

        result = updatable_result(context.active_object)
        if result is None:
            return
        report = result.prefilter_found
        column = self.layout.column(align=True)
        rows = [(_PARTS, report.parts), (_CAVITIES, report.cavities), (_GENUS, report.genus)]
        if len(set(report.cavities)) == 1:
            del rows[1]
        for label, numbers in rows:
            before, after = ("?" if number < 0 else str(number) for number in numbers)
            column.label(text=f"{tr(label)}: {before} \N{RIGHTWARDS ARROW} {after}")
        if report.advice:
            note(self.layout, context, report.advice, "INFO")
        column = self.layout.column(align=True)
        for i, entry in enumerate(report.places):
            text = f"{tr(_LABELS[entry.kind])}: {entry.count}"
            if entry.operand:
                text = f"{entry.operand}, {text}"
            icon = _ICONS.get(entry.kind, "FACESEL")
            operator = PREFILTER_OT_select_found.bl_idname
            column.operator(operator, text=text, icon=icon, translate=False).index = i


register, unregister = registration(classes(PREFILTER_PT_voxel_report))
