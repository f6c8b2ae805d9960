# SPDX-License-Identifier: GPL-3.0-or-later

"""The report on what a result was made of, in the 3D view's tab, with buttons that select."""

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
    """Parts, cavities and genus before and after, and the places that were changed."""

    bl_label = "Voxel Report"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Tells whether the active object has a report, or is what one is about."""
        from .memory import made_of

        result = made_of(context.active_object)
        is_fitting = context.mode in {"OBJECT", "EDIT_MESH"}
        return is_fitting and result is not None and result.prefilter_found.is_there

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the panel."""
        from .memory import made_of

        result = made_of(context.active_object)
        if result is None:
            return
        found = result.prefilter_found
        column = self.layout.column(align=True)
        rows = [(_PARTS, found.parts), (_CAVITIES, found.cavities), (_GENUS, found.genus)]
        if len(set(found.cavities)) == 1:
            del rows[1]
        for label, numbers in rows:
            before, after = ("?" if number < 0 else str(number) for number in numbers)
            column.label(text=f"{tr(label)}: {before} \N{RIGHTWARDS ARROW} {after}")
        if found.advice:
            note(self.layout, context, found.advice, "INFO")
        column = self.layout.column(align=True)
        for i, place in enumerate(found.places):
            text = f"{tr(_LABELS[place.kind])}: {place.count}"
            if place.operand:
                text = f"{place.operand}, {text}"
            icon = _ICONS.get(place.kind, "FACESEL")
            operator = PREFILTER_OT_select_found.bl_idname
            column.operator(operator, text=text, icon=icon, translate=False).index = i


register, unregister = registration(classes(PREFILTER_PT_voxel_report))
