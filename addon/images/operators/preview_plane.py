# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.preview_plane` and `prefilter.end_plane`: trilinear lookups and table lookups on a
tilted plane."""

import bpy

from ...bridge.image_operator import ImageOperator
from ...bridge.views import EndsView
from ...core.operator import BackgroundOperator
from ...core.operator_hooks import Compute
from ...core.preferences import preference
from ...core.properties import single_property
from ...core.wording import Sentence
from ..choices import PlaneSettings
from ..view import plane


class PREFILTER_OT_preview_plane(ImageOperator, BackgroundOperator, bpy.types.Operator):
    """Computes the levels of an image, and shows them on a plane in the editors."""

    bl_idname = "prefilter.preview_plane"
    bl_label = "Preview Plane"
    bl_description = (
        "Draw a plane tiled with the image: to the left by trilinear interpolation of its "
        "mipmap, to the right by a sampling table. The image itself does not change"
    )
    bl_options = {"REGISTER"}
    activity = "Computing levels"

    filter: single_property(PlaneSettings, "filter")

    def read(self, context: bpy.types.Context) -> Compute:
        """Copies the image."""
        from ..new_picture import read

        image = self.chosen_image(context)
        self._name = image.name
        picture, uid, filter_name = read(image), image.session_uid, self.filter
        threads = preference("threads", 0)
        return lambda progress: plane.compute(picture, uid, filter_name, progress, threads)

    def finish(self, context: bpy.types.Context, result: plane.Plane) -> str:
        """Shows the plane in the editors."""
        plane.keep(result)
        plane.VIEW.show(context, self._name)
        return Sentence("Computed {} levels of '{}'", result.level_count, self._name)


class PREFILTER_OT_end_plane(EndsView, bpy.types.Operator):
    """Deletes the preview plane of the editor's image."""

    bl_idname = "prefilter.end_plane"
    bl_label = "End Preview Plane"
    bl_description = "Show the image itself again, and free the memory of its levels"
    bl_options = {"REGISTER"}
    view = plane.VIEW
    nothing = "The editor's image has no preview plane"
