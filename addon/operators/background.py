"""What the operators share that read an image and its surfaces, and then work for a while."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any, ClassVar

import bpy
import prefilter

from .. import bake, texture_cache
from ..bridge import derived, images
from ..choices import Settings
from ..jobs import Job, Progress

Work = Callable[[Progress], Any]
TICK_SECONDS = 0.1
"""How often a running operator looks at its thread."""


def image_to_read(
    context: bpy.types.Context, name: str, *, pictured: bool = False
) -> bpy.types.Image:
    """Returns the image of a name, or that of the editor if the name is empty.

    Args:
        context: The context.
        name: The image's name, or empty.
        pictured: Whether an image is meant where the editor shows a picture about it, such as its
            error plot.

    Raises:
        ValueError: There is no such image.
    """
    if name:
        return images.find(name)
    shown = getattr(context.space_data, "image", None)
    image = (derived.pictured(shown) if pictured else None) or shown
    if image is None:
        raise ValueError("image: no name is given, and the editor shows no image")
    return image


def selected_objects(context: bpy.types.Context) -> list[bpy.types.Object]:
    """Returns the objects that are selected or in Edit Mode."""
    return [obj for obj in context.view_layer.objects if obj.select_get() or obj.mode == "EDIT"]


def read_source(
    context: bpy.types.Context, name: str, settings: Settings, *, needs_surface: bool = True
) -> bake.Bake:
    """Reads an image and the selected objects that wear it.

    Args:
        context: The context.
        name: The image's name; empty for that of the editor. Where the editor shows a picture about
            an image, such as its error plot, that image is meant.
        settings: How the image wraps, and more.
        needs_surface: Whether a surface is needed whatever the filter.

    Raises:
        ValueError: There is no such image, or no surface.
    """
    image = image_to_read(context, name, pictured=True)
    images.check_untiled(image)
    return bake.Bake.read(
        image,
        selected_objects(context),
        replace(
            settings, use_images=True, filepath="", levels=0, roughness="", roughness_filepath=""
        ),
        context.evaluated_depsgraph_get(),
        needs_surface=needs_surface,
    )


def show_in_editor(context: bpy.types.Context, image: bpy.types.Image) -> None:
    """Shows an image in the editor that the operator was called from."""
    if context.area is not None and context.area.type == "IMAGE_EDITOR":
        context.space_data.image = image


class BackgroundOperator:
    """A mixin: reads and writes on the main thread, and works in another with progress and Esc.

    A subclass has `doing`, `read` and `finish`. Called from a script, it waits.
    """

    doing: ClassVar[str]
    """What the status bar says that goes on."""

    _running: ClassVar[set[str]] = set()
    _job: Job[Any] | None = None

    def read(self, context: bpy.types.Context) -> Work:
        """Reads from Blender, and returns what then runs in a thread."""
        raise NotImplementedError

    def finish(self, context: bpy.types.Context, result: Any) -> str:
        """Writes a result to Blender, and returns what to report."""
        raise NotImplementedError

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Tells whether there is an image, and whether the operator does not run already."""
        if cls.bl_idname in BackgroundOperator._running:
            cls.poll_message_set("It is running; press Esc to cancel it")
            return False
        if context.area is not None and context.area.type == "IMAGE_EDITOR":
            if context.space_data.image is None:
                cls.poll_message_set("Open an image in this editor first")
                return False
        elif not bpy.data.images:
            cls.poll_message_set("There is no image in this file")
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Works and waits."""
        try:
            work = self.read(context)
            self.report({"INFO"}, self.finish(context, work(lambda _: True)))
        except bake.FAILURES as error:
            return self._fail(error)
        return {"FINISHED"}

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Works in a thread, with progress and Esc to cancel."""
        del event
        if bpy.app.background:
            return self.execute(context)
        try:
            work = self.read(context)
        except bake.FAILURES as error:
            return self._fail(error)
        self._start(work)
        return self._enter(context)

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Shows progress, and writes the result once the thread is done."""
        if event.type == "ESC" and event.value == "PRESS":
            self._job.cancel()
            return {"RUNNING_MODAL"}
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        if not self._job.is_done:
            self._show(context, self.doing, self._job.progress)
            return {"PASS_THROUGH"}
        self._leave(context)
        try:
            self.report({"INFO"}, self.finish(context, self._job.result()))
        except prefilter.Cancelled:
            self.report({"INFO"}, f"{self.doing} cancelled")
            return {"CANCELLED"}
        except bake.FAILURES as error:
            return self._fail(error)
        for area in context.screen.areas if context.screen else ():
            area.tag_redraw()
        return {"FINISHED"}

    def cancel(self, context: bpy.types.Context) -> None:
        """Stops the thread when Blender ends the operator, such as for another file."""
        try:
            if self._job is not None:
                self._job.cancel()
                self._job.result()
        except prefilter.Cancelled:
            pass
        except bake.FAILURES as error:
            self.report({"WARNING"}, str(error))
        finally:
            self.discard()
            self._leave(context)

    def discard(self) -> None:
        """Lets go of what was read and made, when `finish` is not to come."""

    def warn(self, source: bake.Bake | bake.Outcome | texture_cache.Outcome) -> None:
        """Reports what was left out when the surfaces were read, and the like."""
        for warning in source.warnings:
            self.report({"WARNING"}, warning)

    def _fail(self, error: BaseException) -> set[str]:
        self.report({"ERROR"}, str(error))
        return {"CANCELLED"}

    def _key(self) -> str:
        return type(self).bl_idname

    def _start(self, work: Work) -> None:
        self._job = Job(work)

    def _enter(self, context: bpy.types.Context) -> set[str]:
        BackgroundOperator._running.add(self._key())
        manager = context.window_manager
        manager.progress_begin(0, 100)
        self._timer = manager.event_timer_add(TICK_SECONDS, window=context.window)
        manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def _show(self, context: bpy.types.Context, what: str, fraction: float) -> None:
        percent = round(100 * fraction)
        context.window_manager.progress_update(percent)
        context.workspace.status_text_set(f"{what}: {percent} %   Esc: Cancel")

    def _leave(self, context: bpy.types.Context) -> None:
        BackgroundOperator._running.discard(self._key())
        context.window_manager.event_timer_remove(self._timer)
        context.window_manager.progress_end()
        if context.workspace is not None:
            context.workspace.status_text_set(None)
