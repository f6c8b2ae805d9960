# SPDX-License-Identifier: GPL-3.0-or-later

"""What editors draw in the place of an image: kept, and told when the image or an object changes.

Previews are kept by the image's session_uid, which an undo does not change, and no datablock is
held.
"""

from typing import Generic, Protocol, TypeVar

import bpy
from bpy.app.handlers import persistent


class Preview(Protocol):
    """What is kept of an image."""

    image_uid: int
    """The image's session_uid."""
    is_stale: bool
    """Whether the image, or what else it was made of, has changed since."""

    def depends_on(self, name: str) -> bool:
        """Tells whether it was made of an object of this name."""


T = TypeVar("T", bound=Preview)


class Previews(Generic[T]):
    """Those of one kind, at most one for an image."""

    def __init__(self) -> None:
        """Keeps none."""
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
        """Returns how many are kept."""
        return len(self._kept)

    def keep(self, preview: T) -> None:
        """Keeps a preview in the place of an earlier one of the same image."""
        self._kept[preview.image_uid] = preview

    def find(self, image: bpy.types.Image | None) -> T | None:
        """Returns the preview of an image, if there is one."""
        return None if image is None else self._kept.get(image.session_uid)

    def drop(self, image: bpy.types.Image) -> None:
        """Forgets the preview of an image."""
        self._kept.pop(image.session_uid, None)

    def register(self) -> None:
        """Adds the handlers."""
        bpy.app.handlers.load_pre.append(self._drop_all)
        bpy.app.handlers.depsgraph_update_post.append(self._follow)

    def unregister(self) -> None:
        """Removes the handlers and forgets the previews."""
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
