# SPDX-License-Identifier: GPL-3.0-or-later

"""The buttons that cancel and pause jobs, as properties.

Blender reports the property under the mouse, but not the operator. Their number is fixed, because
drawn buttons keep pointing to the memory of their properties.
"""

import bpy
from bpy.props import BoolVectorProperty, PointerProperty

from .translations import CONTEXT

SLOTS = 32
"""The largest number of jobs: the largest size of Blender's vector properties."""
_NAMES = frozenset({"use_cancel", "use_pause"})
_taken: set[int] = set()


class PREFILTER_PG_switches(bpy.types.PropertyGroup):
    """The buttons of all jobs, each at the index of its job."""

    use_cancel: BoolVectorProperty(
        name="Cancel",
        translation_context=CONTEXT,
        description="Stop and discard the result, or take the work out of the queue. Esc does the "
        "same to what runs",
        size=SLOTS,
    )
    use_pause: BoolVectorProperty(
        name="Pause",
        translation_context=CONTEXT,
        description="Hold the work until this is pressed again: its threads then leave the "
        "processor to others, and its memory stays in use. Work that waits is passed by",
        size=SLOTS,
    )


class Switches:
    """The buttons of a job."""

    def __init__(self, context: bpy.types.Context) -> None:
        """Reserves the buttons at a free index.

        Raises:
            ValueError: Too many jobs exist.
        """
        free = [index for index in range(SLOTS) if index not in _taken]
        if not free:
            raise ValueError(f"{SLOTS} jobs wait already; wait for one to end, or cancel one")
        self._index = free[0]
        self._is_released = False
        _taken.add(self._index)
        self._reset(context)

    def is_cancelled(self, context: bpy.types.Context) -> bool:
        """Returns whether Cancel was pressed."""
        return bool(_all(context).use_cancel[self._index])

    def is_paused(self, context: bpy.types.Context) -> bool:
        """Returns whether Pause is pressed."""
        return bool(_all(context).use_pause[self._index])

    def press_cancel(self, context: bpy.types.Context) -> None:
        """Presses Cancel."""
        _all(context).use_cancel[self._index] = True

    def draw_cancel(
        self, layout: bpy.types.UILayout, context: bpy.types.Context, text: str | None = None
    ) -> None:
        """Draws Cancel."""
        layout.prop(
            _all(context), "use_cancel", index=self._index, text=text, icon="X", toggle=True
        )

    def draw_pause(self, layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
        """Draws Pause, with the icon of the action that a press would cause."""
        icon = "PLAY" if self.is_paused(context) else "PAUSE"
        layout.prop(_all(context), "use_pause", index=self._index, text="", icon=icon, toggle=True)

    def release(self, context: bpy.types.Context) -> None:
        """Frees the index; a second call does nothing."""
        if not self._is_released:
            self._is_released = True
            _taken.discard(self._index)
            self._reset(context)

    def _reset(self, context: bpy.types.Context) -> None:
        _all(context).use_cancel[self._index] = False
        _all(context).use_pause[self._index] = False


def taken() -> int:
    """Returns the number of running and waiting jobs."""
    return len(_taken)


def is_job_button(path: str) -> bool:
    """Returns whether a property path is one of these buttons."""
    return path.rpartition(".")[2].partition("[")[0] in _NAMES


def register() -> None:
    """Registers the buttons."""
    bpy.utils.register_class(PREFILTER_PG_switches)
    bpy.types.WindowManager.prefilter_switches = PointerProperty(type=PREFILTER_PG_switches)


def unregister() -> None:
    """Removes them."""
    del bpy.types.WindowManager.prefilter_switches
    bpy.utils.unregister_class(PREFILTER_PG_switches)


def _all(context: bpy.types.Context) -> PREFILTER_PG_switches:
    return context.window_manager.prefilter_switches
