# SPDX-License-Identifier: GPL-3.0-or-later

"""What an operator does that works for a while: the functions of which its own class has some."""

from collections.abc import Callable, Generator, Iterable, Sequence
from typing import Any, TypeVar

import bpy

from .jobs import Progress
from .outcome import Outcome
from .translations import report

LONG_WORK = "long work"
"""The line of what takes minutes: levels and surfaces."""
Compute = Callable[[Progress], Any]
T = TypeVar("T")


def read_at_once(steps: Generator[float, None, T]) -> T:
    """Does all steps of a reading, and returns what it does."""
    while True:
        try:
            next(steps)
        except StopIteration as done:
            return done.value


class Doing:
    """A mixin: what `BackgroundOperator` asks for, as far as one answer suits most operators."""

    doing: str
    """What the status bar says that goes on."""
    line = ""
    """Operators of the same line wait for each other, where a user presses the button of one while
    another works. One without a line is refused while it works itself."""

    is_alone = False
    """Whether nothing else may change meanwhile, such as what strokes of a brush would be lost."""

    def read(self, context: bpy.types.Context) -> Compute:
        """Reads from Blender, and returns what then runs in a thread."""
        raise NotImplementedError

    def reading(self, context: bpy.types.Context) -> Generator[float, None, Compute]:
        """Does what `read` does in steps, where it may take long, and yields the fraction done.

        It may then run after the operator's own result is in place.
        """
        return self.read(context)
        yield

    def following(self, context: bpy.types.Context) -> Generator[float, None, Compute] | None:
        """Returns what reads the next part of the work, as `reading` does the first; None at the
        end. A part is read once that before it is computed."""
        del context
        return None

    def making(self) -> Generator[None, None, None]:
        """Makes in steps what `finish` then puts into place, where that takes long.

        Nothing else may happen in between. `finish` makes what is not made, as in a redo.
        """
        return
        yield

    def finish(self, context: bpy.types.Context, result: Any) -> str:
        """Writes the result of the last part to Blender, and returns what to report."""
        raise NotImplementedError

    def discard(self) -> None:
        """Lets go of what was read and made, however little that is, when `finish` fails or is
        not to come."""

    def releaser(self) -> Callable[[], None]:
        """Returns what does `discard` in another thread, when the operator is gone already."""
        return lambda: None

    def load(self) -> Any:
        """Returns what `duration` needs to know about what was read and computed."""

    def duration(self, load: Any) -> float:
        """Returns how long the present settings take, in a unit of the operator's own.

        Args:
            load: What `load` returned after an earlier run on the same input.
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
        """Returns whether the operator is the one that Adjust Last Operation adjusts.

        Blender polls it in the state that its result has left, and undoes that afterward: what was
        selected may be hidden or gone. A poll has to let it pass; `read` says what is amiss.
        """
        last = context.active_operator
        return last is not None and last.bl_idname == cls.bl_rna.identifier

    def follow_scene(self, context: bpy.types.Context) -> None:
        """Sets the settings that a key, a search or a drop leaves as the scene has them."""

    def targets(self, context: bpy.types.Context) -> Sequence[bpy.types.ID]:
        """Returns the images or objects of the context that the work cannot do without.

        Raises:
            ValueError: There are none.
        """
        del context
        return ()

    def aim(self, targets: Sequence[bpy.types.ID]) -> None:
        """Takes what `targets` has returned, once work that has waited begins; it may have got
        other names."""

    def complete_settings(self) -> None:
        """Sets the settings that the caller has left, where they are not as declared."""

    def handed_on(self) -> dict[str, Any]:
        """Returns what another operator gets that does the same."""
        return {name: getattr(self, name) for name in self._setting_names()}

    def tell(self, outcome: Outcome) -> str:
        """Reports what is good to know beside the summary, and returns that."""
        self.warn(outcome.warnings)
        for note in outcome.notes:
            self.report({"INFO"}, report(note))
        return outcome.summary

    def warn(self, warnings: Iterable[str]) -> None:
        """Reports what was left out, and the like."""
        for warning in warnings:
            self.report({"WARNING"}, report(warning))

    @classmethod
    def _key(cls) -> str:
        return cls.bl_idname

    def _setting_names(self) -> list[str]:
        properties = self.properties.bl_rna.properties
        return [item.identifier for item in properties if not (item.is_hidden or item.is_readonly)]
