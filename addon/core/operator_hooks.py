# SPDX-License-Identifier: GPL-3.0-or-later

"""The methods that an operator running in the background may override."""

from collections.abc import Callable, Generator, Iterable, Sequence
from typing import Any, TypeVar

import bpy

from .jobs import Progress
from .outcome import Outcome
from .translations import report

LONG_WORK = "long work"
"""Queue of the operators that take minutes, such as bakes and reconstructions."""
Compute = Callable[[Progress], Any]
T = TypeVar("T")


def run_steps(steps: Generator[float, None, T]) -> T:
    """Runs a generator to its end, and returns its return value."""
    while True:
        try:
            next(steps)
        except StopIteration as stop:
            return stop.value


class OperatorHooks:
    """A mixin: the methods that `BackgroundOperator` calls, with defaults for most of them."""

    activity: str
    """The activity as the status bar names it."""
    queue_name = ""
    """Operators with the same queue run one after another. An operator without a queue is refused
    while it is running already."""

    is_alone = False
    """Whether the user may not edit anything meanwhile, because the edits, such as brush strokes,
    would be lost."""

    def read(self, context: bpy.types.Context) -> Compute:
        """Reads from Blender, and returns the function to run in a thread."""
        raise NotImplementedError

    def read_steps(self, context: bpy.types.Context) -> Generator[float, None, Compute]:
        """Does the same as `read`, in steps if it may take long, and yields the fraction done.

        A redo may run it while the operator's previous result is still in place.
        """
        return self.read(context)
        yield

    def read_next_part(self, context: bpy.types.Context) -> Generator[float, None, Compute] | None:
        """Returns a generator that reads the next part of the work, like `read_steps` for the first
        part; None at the end. A part is read after the previous one is computed."""
        del context
        return None

    def build_steps(self) -> Generator[None, None, None]:
        """Builds the results in steps, if that takes long, before `finish` puts them into place.

        Events are blocked meanwhile. A redo skips the steps: `finish` then builds the results.
        """
        return
        yield

    def finish(self, context: bpy.types.Context, result: Any) -> str:
        """Writes the result of the last part to Blender, and returns what to report."""
        raise NotImplementedError

    def discard(self) -> None:
        """Releases everything read or built so far, when `finish` fails or will not be called."""

    def discarder(self) -> Callable[[], None]:
        """Returns a function that does the same as `discard`, from another thread and after Blender
        has freed the operator."""
        return lambda: None

    def load(self) -> Any:
        """Returns what `duration` needs to know about the finished work, such as its size."""

    def duration(self, load: Any) -> float:
        """Returns how long the work takes with the present settings, in any unit.

        Args:
            load: The value of `load` after an earlier run on the same input.
        """
        del load
        return 1.0

    def draw_settings(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        """Draws the settings in the redo panel."""
        del context
        layout.use_property_split = True
        layout.use_property_decorate = False
        for name in self._setting_names():
            layout.prop(self, name)

    @classmethod
    def may_be_redone(cls, context: bpy.types.Context) -> bool:
        """Returns whether Adjust Last Operation shows this operator.

        Blender polls it before it undoes the result, when the selected objects may be hidden or
        gone. So the poll has to succeed, and `read` reports the error.
        """
        last = context.active_operator
        return last is not None and last.bl_idname == cls.bl_rna.identifier

    def follow_scene(self, context: bpy.types.Context) -> None:
        """Copies settings from the scene for a call by a key, a search or a drop."""

    def targets(self, context: bpy.types.Context) -> Sequence[bpy.types.ID]:
        """Returns the images or objects of the context that the work needs.

        Raises:
            ValueError: There are none.
        """
        del context
        return ()

    def retarget(self, targets: Sequence[bpy.types.ID]) -> None:
        """Sets the operator to the results of `targets`, whose names may have changed while it was
        in the queue."""

    def complete_settings(self) -> None:
        """Sets the settings that the caller has not set and whose defaults depend on others."""

    def restart_settings(self) -> dict[str, Any]:
        """Returns the settings with which a second operator repeats the work."""
        return {name: getattr(self, name) for name in self._setting_names()}

    def report_outcome(self, outcome: Outcome) -> str:
        """Reports warnings and notes, and returns the summary."""
        self.warn(outcome.warnings)
        for note in outcome.notes:
            self.report({"INFO"}, report(note))
        return outcome.summary

    def warn(self, warnings: Iterable[str]) -> None:
        """Reports warnings."""
        for warning in warnings:
            self.report({"WARNING"}, report(warning))

    @classmethod
    def _key(cls) -> str:
        return cls.bl_idname

    def _setting_names(self) -> list[str]:
        properties = self.properties.bl_rna.properties
        return [item.identifier for item in properties if not (item.is_hidden or item.is_readonly)]
