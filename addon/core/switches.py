# SPDX-License-Identifier: GPL-3.0-or-later

"""The buttons that cancel and pause jobs, as properties.

Blender tells over which property the mouse is, but not over which operator. They are of fixed
number, as buttons that Blender has drawn go on pointing to where properties were.
"""

import bpy
from bpy.props import BoolVectorProperty, PointerProperty

from .translations import CONTEXT

SLOTS = 32
"""How many jobs there may be at once; Blender's vectors have no more numbers."""
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
    """The buttons of one job."""

    def __init__(self, context: bpy.types.Context) -> None:
        """Takes two that no other job has.

        Raises:
            ValueError: There are too many jobs.
        """
        free = [index for index in range(SLOTS) if index not in _taken]
        if not free:
            raise ValueError(f"{SLOTS} jobs wait already; wait for one to end, or cancel one")
        self._index = free[0]
        self._is_released = False
        _taken.add(self._index)
        self._reset(context)

    def is_cancelled(self, context: bpy.types.Context) -> bool:
        """Tells whether someone has pressed Cancel."""
        return bool(_all(context).use_cancel[self._index])

    def is_paused(self, context: bpy.types.Context) -> bool:
        """Tells whether Pause is pressed."""
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
        """Draws Pause, which looks as what its press leads to."""
        icon = "PLAY" if self.is_paused(context) else "PAUSE"
        layout.prop(_all(context), "use_pause", index=self._index, text="", icon=icon, toggle=True)

    def release(self, context: bpy.types.Context) -> None:
        """Leaves them to others; another call does nothing."""
        if not self._is_released:
            self._is_released = True
            _taken.discard(self._index)
            self._reset(context)

    def _reset(self, context: bpy.types.Context) -> None:
        _all(context).use_cancel[self._index] = False
        _all(context).use_pause[self._index] = False


def taken() -> int:
    """Returns how many jobs run or wait."""
    return len(_taken)


def is_one(path: str) -> bool:
    """Tells whether a property, by its path, is one of these buttons."""
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
