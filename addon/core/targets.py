# SPDX-License-Identifier: GPL-3.0-or-later

"""What a press of a button is about, for work that begins later: the selection may change."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

import bpy

from .translations import tr

_KINDS = {"OBJECT": "objects", "IMAGE": "images"}
_now: Sequence[bpy.types.Object] | None = None
"""What counts as selected, while work begins that has waited."""


@dataclass(frozen=True)
class _Ref:
    """A data-block, which may be renamed, replaced by undo, or gone."""

    kind: str
    name: str
    uid: int

    @classmethod
    def of(cls, block: bpy.types.ID) -> "_Ref":
        return cls(block.id_type, block.name, block.session_uid)

    def find(self) -> bpy.types.ID | None:
        blocks = getattr(bpy.data, _KINDS[self.kind])
        found = blocks.get(self.name)
        if found is not None and found.session_uid == self.uid:
            return found
        return next((block for block in blocks if block.session_uid == self.uid), None)


@dataclass(frozen=True)
class Targets:
    """What was selected, and of that what the work is about, when a button was pressed.

    Attributes:
        mode: The mode of the context.
    """

    mode: str
    _scene: tuple[int, str]
    _wanted: Sequence[_Ref]
    _visible: Sequence[_Ref]
    _selected: Sequence[_Ref]
    _active: _Ref | None

    @classmethod
    def of(cls, context: bpy.types.Context, wanted: Sequence[bpy.types.ID]) -> "Targets":
        """Notes what is selected.

        Args:
            context: The context.
            wanted: Images or objects that the work cannot do without.
        """
        active = context.active_object
        return cls(
            context.mode,
            _place(context),
            [_Ref.of(block) for block in wanted],
            [_Ref.of(obj) for obj in context.selected_objects],
            [_Ref.of(obj) for obj in selected(context)],
            _Ref.of(active) if active is not None else None,
        )

    @property
    def name(self) -> str:
        """What the work is about, in few words; empty if that is nothing that was chosen."""
        if len(self._wanted) == 1:
            return self._wanted[0].name
        return tr("{} objects").format(len(self._wanted)) if self._wanted else ""

    def found(self, context: bpy.types.Context) -> list[bpy.types.ID]:
        """Returns what the work cannot do without.

        Raises:
            ValueError: Something of that is gone or hidden, or the window shows another scene.
        """
        if _place(context) != self._scene:
            raise ValueError("The window shows another scene or view layer than when it was queued")
        found = []
        for ref in self._wanted:
            block = ref.find()
            what = f"{ref.kind.lower()} '{ref.name}'"
            if block is None:
                raise ValueError(f"{what} was deleted while this waited")
            if ref.kind == "OBJECT" and not block.visible_get():
                raise ValueError(f"{what} was hidden while this waited")
            found.append(block)
        return found

    @contextmanager
    def selecting(self, context: bpy.types.Context) -> Iterator[None]:
        """Has the context say that what was selected is, as far as it is still there."""
        global _now
        layer = context.view_layer.objects

        def there(refs: Sequence[_Ref]) -> list[bpy.types.Object]:
            return [obj for ref in refs if (obj := ref.find()) and obj.name in layer]

        active = self._active.find() if self._active is not None else None
        visible = there(self._visible)
        before, _now = _now, there(self._selected)
        try:
            with context.temp_override(
                active_object=active,
                object=active,
                selected_objects=visible,
                selected_editable_objects=visible,
            ):
                yield
        finally:
            _now = before


def selected(context: bpy.types.Context) -> Sequence[bpy.types.Object]:
    """Returns the objects that are selected, or were when the button was pressed."""
    if _now is not None:
        return _now
    return [obj for obj in context.view_layer.objects if obj.select_get()]


def _place(context: bpy.types.Context) -> tuple[int, str]:
    return context.scene.session_uid, context.view_layer.name
