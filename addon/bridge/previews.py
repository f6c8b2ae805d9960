# SPDX-License-Identifier: GPL-3.0-or-later

"""Previews that editors draw instead of an image, marked as stale when datablocks change.

They are stored by the image's session_uid, which undo preserves, and hold no datablocks.
"""

from typing import Generic, Protocol, TypeVar

import bpy
from bpy.app.handlers import persistent


class Preview(Protocol):
    """A preview of an image."""

    image_uid: int
    """The image's session_uid."""
    is_stale: bool
    """Whether the image or an object that it was made of has changed since."""

    def depends_on(self, name: str) -> bool:
        """Whether it was made of the object of this name."""


T = TypeVar("T", bound=Preview)


class Previews(Generic[T]):
    """Previews of one kind, at most one per image."""

    def __init__(self) -> None:
        """Starts empty."""
        self._kept: dict[int, T] = {}

        @persistent
        def drop_all(*_: object) -> None:
            self._kept.clear()

        @persistent
        def mark_stale(_: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
            if self._kept:
                self._mark_stale(depsgraph)

        self._drop_all, self._follow = drop_all, mark_stale

    def __len__(self) -> int:
        """Returns the number of previews."""
        return len(self._kept)

    def keep(self, preview: T) -> None:
        """Stores a preview, and replaces an earlier one of the same image."""
        self._kept[preview.image_uid] = preview

    def find(self, image: bpy.types.Image | None) -> T | None:
        """Returns the preview of an image; None if there is none."""
        return None if image is None else self._kept.get(image.session_uid)

    def drop(self, image: bpy.types.Image) -> None:
        """Removes the preview of an image."""
        self._kept.pop(image.session_uid, None)

    def register(self) -> None:
        """Adds the handlers."""
        bpy.app.handlers.load_pre.append(self._drop_all)
        bpy.app.handlers.depsgraph_update_post.append(self._follow)

    def unregister(self) -> None:
        """Removes the handlers and the previews."""
        bpy.app.handlers.depsgraph_update_post.remove(self._follow)
        bpy.app.handlers.load_pre.remove(self._drop_all)
        self._kept.clear()

    def _mark_stale(self, depsgraph: bpy.types.Depsgraph) -> None:
        for update in depsgraph.updates:
            changed = update.id.original
            if isinstance(changed, bpy.types.Image):
                preview = self.find(changed)
                if preview is not None:
                    preview.is_stale = True
            elif isinstance(changed, bpy.types.Object) and (
                update.is_updated_geometry or update.is_updated_transform
            ):
                for preview in self._kept.values():
                    preview.is_stale |= preview.depends_on(changed.name)
