# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.rasterize`: an image of the selected curves and texts, or of a UV map."""

from typing import TYPE_CHECKING

import bpy

from ...core.translations import marked, tr
from .shape_operator import RasterizesOperator

if TYPE_CHECKING:
    from ..rasterization import Rasterization

_NEEDED = {
    "auto": marked("Select curves or texts, or make a mesh with a UV map the active object"),
    "curves": marked("Select curves or texts"),
    "uv": marked("Make a mesh with a UV map the active object"),
}


class PREFILTER_OT_rasterize(RasterizesOperator, bpy.types.Operator):
    """Rasterizes the selected curves and texts, or the UV map of the active mesh."""

    bl_idname = "prefilter.rasterize"
    bl_label = "Rasterize"
    bl_description = (
        "Make an exact image of the selected curves and texts; if none are selected, a mask "
        "of the area that the faces of the active mesh cover in its UV map"
    )
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Returns whether curves, texts or a UV map can be rasterized."""
        if cls.may_be_redone(context):
            return True
        if not available_source(context, "auto"):
            cls.poll_message_set(tr(_NEEDED["auto"]))
            return False
        return True

    def targets(self, context: bpy.types.Context) -> list[bpy.types.Object]:
        """Returns the curves, or the mesh with the UV map."""
        source = "" if self.source == "svg" else available_source(context, self.source)
        if not source:
            return []
        return [context.active_object] if source == "uv" else chosen_curves(context)

    def read_work(self, context: bpy.types.Context) -> "Rasterization":
        """Copies the selected curves, or the UV map."""
        from ..provenance import Request
        from ..rasterization import Rasterization

        settings = self.to_settings()
        if settings.source == "svg":
            request = Request("svg", filepath=settings.filepath)
        else:
            source = available_source(context, settings.source)
            if not source:
                raise ValueError(tr(_NEEDED[settings.source]))
            objects = [context.active_object] if source == "uv" else chosen_curves(context)
            request = Request(source, objects)
        self.source_drawn = request.source
        return Rasterization.read(request, settings, context)


def available_source(context: bpy.types.Context, source: str) -> str:
    """Returns "curves" or "uv" if it matches `source` and can be rasterized; otherwise empty."""
    from ...bridge.uv_layouts import has_uv_map

    if source != "uv" and chosen_curves(context):
        return "curves"
    if source != "curves" and has_uv_map(context.active_object):
        return "uv"
    return ""


def chosen_curves(context: bpy.types.Context) -> list[bpy.types.Object]:
    """Returns the selected curves and texts, the active one first."""
    from ...bridge.curves import is_curve

    selected = [obj for obj in context.selected_objects if is_curve(obj)]
    return sorted(selected, key=lambda obj: obj != context.active_object)
