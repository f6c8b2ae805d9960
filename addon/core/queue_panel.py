# SPDX-License-Identifier: GPL-3.0-or-later

"""The queue in the tab: waiting, running and ended jobs, with buttons to pause and cancel."""

import bpy

from . import queue
from .queue import QueuedJob, State
from .registration import Step, classes, registration
from .runs import redraw_panels
from .sidebar import ImagePanel, Tab, note
from .translations import CONTEXT, tr

_ICONS = {
    State.WAITING: "TIME",
    State.DONE: "CHECKMARK",
    State.FAILED: "ERROR",
    State.CANCELLED: "CANCEL",
}


class PREFILTER_OT_clear_queue(bpy.types.Operator):
    """Removes ended jobs from the list."""

    bl_idname = "prefilter.clear_queue"
    bl_label = "Clear Queue"
    bl_description = "Remove finished work from the list. Waiting and running work stays"
    bl_options = frozenset({"INTERNAL"})

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Returns whether a job has ended."""
        del context
        if not queue.has_ended():
            cls.poll_message_set(tr("Nothing in the queue has ended"))
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Removes them."""
        queue.clear()
        redraw_panels(context)
        return {"FINISHED"}


class _QueuePanel:
    bl_label = "Queue"
    bl_translation_context = CONTEXT
    # Last, because the panel comes and goes, and must not move a button from under the mouse.
    bl_order = 1000

    layout: bpy.types.UILayout

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Returns whether the queue has jobs."""
        del context
        return bool(queue.listed())

    def draw_header_preset(self, context: bpy.types.Context) -> None:
        """Draws the button that clears the list."""
        del context
        if queue.has_ended():
            self.layout.operator(
                PREFILTER_OT_clear_queue.bl_idname, text="", icon="X", emboss=False
            )

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the jobs."""
        column = self.layout.column()
        for job in queue.listed():
            _draw_job(column.column(align=True), context, job)


class PREFILTER_PT_queue(_QueuePanel, Tab, bpy.types.Panel):
    """The queue in the 3D view."""


class PREFILTER_PT_queue_of_images(_QueuePanel, ImagePanel, bpy.types.Panel):
    """The queue in the Image editor."""


def _draw_job(layout: bpy.types.UILayout, context: bpy.types.Context, job: QueuedJob) -> None:
    row = layout.row(align=True)
    if job.run is not None:
        row.progress(factor=job.run.fraction, text=f"{job.run.text}: {job.title}")
    else:
        row.label(text=job.title, icon=_ICONS[job.state])
        state = row.row()
        state.alignment = "RIGHT"
        is_held = job.is_active and job.switches.is_paused(context)
        state.label(text=tr("Paused" if is_held else job.state.value))
    if job.is_active:
        job.switches.draw_pause(row, context)
        job.switches.draw_cancel(row, context, text="")
    if job.message:
        note(layout, context, job.message, "BLANK1")


@bpy.app.handlers.persistent
def _clear_queue(*_: object) -> None:
    queue.clear()


register, unregister = registration(
    classes(PREFILTER_OT_clear_queue, PREFILTER_PT_queue, PREFILTER_PT_queue_of_images),
    Step(
        lambda: bpy.app.handlers.load_post.append(_clear_queue),
        lambda: bpy.app.handlers.load_post.remove(_clear_queue),
    ),
)
