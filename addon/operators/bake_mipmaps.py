"""`prefilter.bake_mipmaps`: the levels of an image, right for the meshes that wear it."""

import time
from typing import Any

import bpy
import prefilter
from bpy.props import StringProperty

from .. import bake
from ..bridge import images
from ..jobs import Job
from ..settings import BakeProperties

_TICK_SECONDS = 0.1


class PREFILTER_OT_bake_mipmaps(BakeProperties, bpy.types.Operator):
    """Bakes the levels of an image."""

    bl_idname = "prefilter.bake_mipmaps"
    bl_label = "Bake Mipmaps"
    bl_description = (
        "Make the mipmap levels of the image, weighted by the surface of the selected meshes that "
        "use it"
    )
    bl_options = {"REGISTER", "UNDO"}

    image: StringProperty(
        name="Image",
        description="The image to bake; the image of the editor if empty",
        options={"SKIP_SAVE"},
    )

    _job: Job[None] | None = None
    _running = False

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Tells whether there is an image to bake."""
        if PREFILTER_OT_bake_mipmaps._running:
            cls.poll_message_set("A bake is running; press Esc to cancel it")
            return False
        if context.area is not None and context.area.type == "IMAGE_EDITOR":
            if context.space_data.image is None:
                cls.poll_message_set("Open an image in this editor first")
                return False
        elif not bpy.data.images:
            cls.poll_message_set("There is no image in this file")
            return False
        return True

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the settings in the redo panel."""
        del context
        self.draw_in(self.layout)

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Bakes and waits."""
        try:
            baking = bake.Bake.read(*self._what_to_read(context))
            baking.compute(lambda _: True)
            self._finish(baking)
        except bake.FAILURES as error:
            return self._fail(error)
        return {"FINISHED"}

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Bakes in a thread, with progress and Esc to cancel."""
        del event
        if bpy.app.background:
            return self.execute(context)
        try:
            self._reading = bake.Bake.reading(*self._what_to_read(context))
            self._go_on_reading()
        except bake.FAILURES as error:
            return self._fail(error)
        PREFILTER_OT_bake_mipmaps._running = True
        manager = context.window_manager
        manager.progress_begin(0, 100)
        self._timer = manager.event_timer_add(_TICK_SECONDS, window=context.window)
        manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Shows progress, and writes the result once the thread is done."""
        if self._job is None:
            return self._modal_reading(context, event)
        if event.type == "ESC" and event.value == "PRESS":
            self._job.cancel()
            return {"RUNNING_MODAL"}
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        if not self._job.is_done:
            self._show(context, f"Baking mipmaps of '{self._bake.image_name}'", self._job.progress)
            return {"PASS_THROUGH"}
        self._leave(context)
        try:
            self._job.result()
            self._finish(self._bake)
        except prefilter.Cancelled:
            self.report({"INFO"}, f"Bake of '{self._bake.image_name}' cancelled")
            return {"CANCELLED"}
        except bake.FAILURES as error:
            return self._fail(error)
        for area in context.screen.areas if context.screen else ():
            area.tag_redraw()
        return {"FINISHED"}

    def cancel(self, context: bpy.types.Context) -> None:
        """Stops the thread when Blender ends the operator, such as for another file."""
        if self._job is None:
            self._reading.close()
            self._leave(context)
            return
        self._job.cancel()
        try:
            self._job.result()
        except prefilter.Cancelled:
            pass
        except bake.FAILURES as error:
            self.report({"WARNING"}, str(error))
        finally:
            self._bake.discard()
            self._leave(context)

    def _modal_reading(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Reads frame after frame; nothing may change meanwhile, so no event is passed on."""
        if event.type == "ESC" and event.value == "PRESS":
            self._reading.close()
            self._leave(context)
            self.report({"INFO"}, "Bake cancelled")
            return {"CANCELLED"}
        if event.type != "TIMER":
            return {"RUNNING_MODAL"}
        try:
            self._go_on_reading()
        except bake.FAILURES as error:
            self._leave(context)
            return self._fail(error)
        if self._job is None:
            self._show(context, "Reading frames", self._read_fraction)
        return {"RUNNING_MODAL"}

    def _go_on_reading(self) -> None:
        """Reads for a tick's time; starts the thread once everything is read."""
        end = time.monotonic() + _TICK_SECONDS
        try:
            while time.monotonic() < end:
                self._read_fraction = next(self._reading)
        except StopIteration as done:
            self._bake = done.value
            self._job = Job(self._bake.compute)

    def _show(self, context: bpy.types.Context, what: str, fraction: float) -> None:
        percent = round(100 * fraction)
        context.window_manager.progress_update(percent)
        context.workspace.status_text_set(f"{what}: {percent} %   Esc: Cancel")

    def _what_to_read(self, context: bpy.types.Context) -> tuple[Any, ...]:
        if self.image:
            image = images.find(self.image)
        else:
            image = getattr(context.space_data, "image", None)
        if image is None:
            raise ValueError("image: no name is given, and the editor shows no image")
        view_layer = context.view_layer
        objects = [obj for obj in view_layer.objects if obj.select_get() or obj.mode == "EDIT"]
        return image, objects, self.to_settings(), context.evaluated_depsgraph_get()

    def _finish(self, baking: bake.Bake) -> None:
        outcome = baking.write()
        for warning in outcome.warnings:
            self.report({"WARNING"}, warning)
        self.report({"INFO"}, outcome.summary)

    def _fail(self, error: BaseException) -> set[str]:
        self.report({"ERROR"}, str(error))
        return {"CANCELLED"}

    def _leave(self, context: bpy.types.Context) -> None:
        PREFILTER_OT_bake_mipmaps._running = False
        context.window_manager.event_timer_remove(self._timer)
        context.window_manager.progress_end()
        if context.workspace is not None:
            context.workspace.status_text_set(None)
