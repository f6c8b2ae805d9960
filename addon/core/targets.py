# SPDX-License-Identifier: GPL-3.0-or-later

"""The selection at a button press, for work in the queue that starts later."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

import bpy

from .translations import tr

_KINDS = {"OBJECT": "objects", "IMAGE": "images"}
_override: Sequence[bpy.types.Object] | None = None
"""The selected objects, while work from the queue starts."""


@dataclass(frozen=True)
class _Ref:
    """A reference to a data-block, which may be renamed, replaced by undo, or deleted."""

    kind: str
    name: str
    uid: int

    @classmethod
    def of(cls, block: bpy.types.ID) -> "_Ref":
        return cls(block.id_type, block.name, block.session_uid)

    def find(self) -> bpy.types.ID | None:
        blocks = getattr(bpy.data, _KINDS[self.kind])
        named = blocks.get(self.name)
        if named is not None and named.session_uid == self.uid:
            return named
        return next((block for block in blocks if block.session_uid == self.uid), None)


@dataclass(frozen=True)
class Targets:
    """The selection at a button press, and the objects or images to work on.

    Attributes:
        mode: The mode of the context.
    """

    mode: str
    _scene: tuple[int, str]
    _required: Sequence[_Ref]
    _visible: Sequence[_Ref]
    _selected: Sequence[_Ref]
    _active: _Ref | None

    @classmethod
    def of(cls, context: bpy.types.Context, required: Sequence[bpy.types.ID]) -> "Targets":
        """Stores the selection.

        Args:
            context: The context.
            required: Images or objects that the work needs.
        """
        active = context.active_object
        return cls(
            context.mode,
            _scene_and_layer(context),
            [_Ref.of(block) for block in required],
            [_Ref.of(obj) for obj in context.selected_objects],
            [_Ref.of(obj) for obj in selected(context)],
            _Ref.of(active) if active is not None else None,
        )

    @property
    def name(self) -> str:
        """The target in a few words; empty if there is none."""
        if len(self._required) == 1:
            return self._required[0].name
        return tr("{} objects").format(len(self._required)) if self._required else ""

    def resolve(self, context: bpy.types.Context) -> list[bpy.types.ID]:
        """Returns the images or objects that the work needs.

        Raises:
            ValueError: One is deleted or hidden, or the window shows another scene.
        """
        if _scene_and_layer(context) != self._scene:
            raise ValueError("The window shows another scene or view layer than when it was queued")
        resolved = []
        for ref in self._required:
            block = ref.find()
            title = f"{ref.kind.lower()} '{ref.name}'"
            if block is None:
                raise ValueError(f"{title} was deleted while this waited")
            if ref.kind == "OBJECT" and not block.visible_get():
                raise ValueError(f"{title} was hidden while this waited")
            resolved.append(block)
        return resolved

    @contextmanager
    def override_selection(self, context: bpy.types.Context) -> Iterator[None]:
        """Overrides the selection of the context with the stored one, without deleted objects."""
        global _override
        layer = context.view_layer.objects

        def existing(refs: Sequence[_Ref]) -> list[bpy.types.Object]:
            return [obj for ref in refs if (obj := ref.find()) and obj.name in layer]

        active = self._active.find() if self._active is not None else None
        visible = existing(self._visible)
        before, _override = _override, existing(self._selected)
        try:
            with context.temp_override(
                active_object=active,
                object=active,
                selected_objects=visible,
                selected_editable_objects=visible,
            ):
                yield
        finally:
            _override = before


def selected(context: bpy.types.Context) -> Sequence[bpy.types.Object]:
    """Returns the selected objects; for work from the queue, those of the button press."""
    if _override is not None:
        return _override
    return [obj for obj in context.view_layer.objects if obj.select_get()]


def _scene_and_layer(context: bpy.types.Context) -> tuple[int, str]:
    return context.scene.session_uid, context.view_layer.name
