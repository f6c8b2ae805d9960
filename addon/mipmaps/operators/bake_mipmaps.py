"""`prefilter.bake_mipmaps`: the levels of an image, right for the meshes that wear it."""

import time
from typing import Any

import bpy
from bpy.props import StringProperty

from ...core.operator import TICK_SECONDS, Work
from ...core.outcome import FAILURES
from .. import reading, users
from ..choices import TEXTURE_SPACE_FILTERS
from ..properties import BakeProperties
from .source import ImageOperator, image_to_read


class PREFILTER_OT_bake_mipmaps(BakeProperties, ImageOperator, bpy.types.Operator):
    """Bakes the levels of an image; unlike others, reads in steps, as there may be many frames."""

    bl_idname = "prefilter.bake_mipmaps"
    bl_label = "Bake Mipmaps"
    bl_description = (
        "Make the mipmap levels of the image, weighted by the surface of the meshes that use it"
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

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the settings in the redo panel."""
        del context
        self.draw_in(self.layout)

    def read(self, context: bpy.types.Context) -> Work:
        """Copies the image and its surfaces."""
        self._bake = reading.read(*self._what_to_read(context))
        return self._bake.compute

    def finish(self, context: bpy.types.Context, result: None) -> str:
        """Puts the levels into place."""
        del context, result
        return self.tell(self._bake.write())

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Reads in steps, then bakes in a thread, with progress and Esc to cancel."""
        del event
        if bpy.app.background:
            return self.execute(context)
        try:
            self._reading = reading.reading(*self._what_to_read(context))
            self._go_on_reading()
        except FAILURES as error:
            return self._fail(error)
        return self._enter(context)

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Shows progress, and writes the result once the thread is done."""
        if self._job is None:
            return self._modal_reading(context, event)
        return super().modal(context, event)

    def discard(self) -> None:
        """Takes the scene back to its frame, and removes what was staged."""
        self._reading.close()
        if self._job is not None:
            self._bake.discard()

    def _modal_reading(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Reads frame after frame; nothing may change meanwhile, so no event is passed on."""
        if event.type == "ESC" and event.value == "PRESS":
            self.discard()
            self._leave(context)
            self.report({"INFO"}, f"{self.doing} cancelled")
            return {"CANCELLED"}
        if event.type != "TIMER":
            return {"RUNNING_MODAL"}
        try:
            self._go_on_reading()
        except FAILURES as error:
            self._leave(context)
            return self._fail(error)
        if self._job is None:
            self._show(context, "Reading frames", self._read_fraction)
        return {"RUNNING_MODAL"}

    def _go_on_reading(self) -> None:
        """Reads for a tick's time; starts the thread once everything is read."""
        end = time.monotonic() + TICK_SECONDS
        try:
            while time.monotonic() < end:
                self._read_fraction = next(self._reading)
        except StopIteration as done:
            self._bake = done.value
            self.doing = f"Baking mipmaps of '{self._bake.image_name}'"
            self._start(self._bake.compute)

    def _what_to_read(self, context: bpy.types.Context) -> tuple[Any, ...]:
        image, settings = image_to_read(context, self.image), self.to_settings()
        objects, warnings = users.objects_to_read(context, image, settings.objects)
        self.warn(warnings)
        return image, objects, settings, context.evaluated_depsgraph_get()
