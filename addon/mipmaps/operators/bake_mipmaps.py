# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.bake_mipmaps`: the levels of an image, right for the meshes that wear it."""

from collections.abc import Generator
from typing import Any

import bpy
from bpy.props import StringProperty

from ...core.operator import Compute, WorkOperator
from .. import reading, users
from ..bake import Bake
from ..choices import TEXTURE_SPACE_FILTERS
from ..properties import BakeProperties
from ..udim import TiledBake
from .source import ImageOperator, image_to_read


class PREFILTER_OT_bake_mipmaps(BakeProperties, WorkOperator, ImageOperator, bpy.types.Operator):
    """Bakes the levels of an image; reads in steps, as there may be many frames."""

    bl_idname = "prefilter.bake_mipmaps"
    bl_label = "Bake Mipmaps"
    bl_description = (
        "Make the mipmap levels of the image, weighted by the surface of the objects that use it"
    )
    bl_options = {"REGISTER", "UNDO"}
    doing = "Baking mipmaps"

    image: StringProperty(
        name="Image",
        description="The image to bake; the image of the editor if empty",
        options={"SKIP_SAVE"},
    )

    @classmethod
    def reads_surface(cls, context: bpy.types.Context) -> bool:
        """Tells whether the filter of the panel looks at a surface."""
        return context.scene.prefilter_bake.filter not in TEXTURE_SPACE_FILTERS

    def draw_settings(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        """Draws the settings."""
        del context
        self.draw_in(layout)

    def read_work(self, context: bpy.types.Context) -> Bake | TiledBake:
        """Copies the image and its surfaces."""
        return reading.read(*self._what_to_read(context))

    def reading(self, context: bpy.types.Context) -> Generator[float, None, Compute]:
        """Copies frame after frame."""
        self.work = yield from reading.reading(*self._what_to_read(context))
        self.doing = f"Baking mipmaps of '{self.work.image_name}'"
        return self.work.compute

    def _what_to_read(self, context: bpy.types.Context) -> tuple[Any, ...]:
        image, settings = image_to_read(context, self.image), self.to_settings()
        objects, warnings = users.objects_to_read(context, image, settings.objects)
        self.warn(warnings)
        return image, objects, settings, context.evaluated_depsgraph_get()
