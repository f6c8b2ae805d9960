"""`prefilter.bake_texture_cache`: PAM levels for Cycles, for every image of the scene."""

import bpy
import prefilter

from .. import bake, texture_cache
from ..bridge import tx_files
from ..jobs import Job

_TICK_SECONDS = 0.1


class PREFILTER_OT_bake_texture_cache(bpy.types.Operator):
    """Bakes PAM into Cycles' texture cache."""

    bl_idname = "prefilter.bake_texture_cache"
    bl_label = "Bake PAM into Texture Cache"
    bl_description = (
        "Make the texture cache of the scene's images, and replace its levels with ones that are "
        "right for the meshes that wear them. Overwrites cache files; when an image file changes, "
        "Blender makes its cache file anew, and it has to be baked again"
    )
    bl_options = {"REGISTER", "UNDO"}

    _job: Job[None] | None = None
    _running = False

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Tells whether this Blender has a texture cache, and there is an image to bake."""
        if PREFILTER_OT_bake_texture_cache._running:
            cls.poll_message_set("A bake is running; press Esc to cancel it")
            return False
        if not tx_files.is_available():
            cls.poll_message_set(texture_cache.NEEDED)
            return False
        if context.scene is None or not bpy.data.images:
            cls.poll_message_set("There is no image in this file")
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Bakes and waits."""
        try:
            baking = self._read(context)
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
            self._bake = self._read(context)
        except bake.FAILURES as error:
            return self._fail(error)
        self._job = Job(self._bake.compute)
        PREFILTER_OT_bake_texture_cache._running = True
        manager = context.window_manager
        manager.progress_begin(0, 100)
        self._timer = manager.event_timer_add(_TICK_SECONDS, window=context.window)
        manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Shows progress, and puts the files into place once the thread is done."""
        if event.type == "ESC" and event.value == "PRESS":
            self._job.cancel()
            return {"RUNNING_MODAL"}
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        if not self._job.is_done:
            percent = round(100 * self._job.progress)
            context.window_manager.progress_update(percent)
            context.workspace.status_text_set(
                f"Baking PAM into the texture cache: {percent} %   Esc: Cancel"
            )
            return {"PASS_THROUGH"}
        self._leave(context)
        try:
            self._job.result()
            self._finish(self._bake)
        except prefilter.Cancelled:
            self.report({"INFO"}, "Bake into the texture cache cancelled")
            return {"CANCELLED"}
        except bake.FAILURES as error:
            return self._fail(error)
        return {"FINISHED"}

    def cancel(self, context: bpy.types.Context) -> None:
        """Stops the thread when Blender ends the operator, such as for another file."""
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

    def _read(self, context: bpy.types.Context) -> texture_cache.CacheBake:
        return texture_cache.CacheBake.read(context.scene, context.evaluated_depsgraph_get())

    def _finish(self, baking: texture_cache.CacheBake) -> None:
        outcome = baking.write()
        for warning in outcome.warnings:
            self.report({"WARNING"}, warning)
        self.report({"INFO"}, outcome.summary)

    def _fail(self, error: BaseException) -> set[str]:
        self.report({"ERROR"}, str(error))
        return {"CANCELLED"}

    def _leave(self, context: bpy.types.Context) -> None:
        PREFILTER_OT_bake_texture_cache._running = False
        context.window_manager.event_timer_remove(self._timer)
        context.window_manager.progress_end()
        if context.workspace is not None:
            context.workspace.status_text_set(None)
