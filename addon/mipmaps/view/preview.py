"""The levels that editors draw in the place of an image: computed, kept, and when they are stale.

They are kept by the image's session_uid, which an undo does not change, and no datablock is held.
"""

from collections.abc import Iterable
from dataclasses import dataclass, field, replace

import bpy
from bpy.app.handlers import persistent

from ...bridge.images import FloatArray
from ...core.alpha import associated
from ...core.jobs import Progress, parts
from ..bake import Bake
from ..choices import Settings

_WRAPS = ("clamp", "repeat", "border")


@dataclass
class Preview:
    """The levels of one image, with some filters.

    Attributes:
        image_uid: The image's session_uid.
        settings: What the levels were computed with.
        levels: By filter, level 0 first: (height, width, 3 or 4) scene-linear values, with colours
            multiplied by alpha where that is coverage.
        wrap: What lookups read outside of the image along u and v.
        blends: Whether alpha is coverage.
        decodes_after: Whether lookups interpolate encoded texels, and decode afterwards.
        objects: The names of the objects that wear the image.
        is_stale: Whether the image or an object has changed since.
    """

    image_uid: int
    settings: Settings
    levels: dict[str, list[FloatArray]]
    wrap: tuple[str, str]
    blends: bool
    decodes_after: bool
    objects: frozenset[str]
    is_stale: bool = False
    textures: dict[tuple[str, int], object] = field(default_factory=dict)

    @property
    def last_level(self) -> int:
        """The number of the coarsest level."""
        return min(len(levels) for levels in self.levels.values()) - 1

    @property
    def wrap_numbers(self) -> tuple[int, int]:
        """The wrap modes as the shader counts them."""
        return _WRAPS.index(self.wrap[0]), _WRAPS.index(self.wrap[1])


_previews: dict[int, Preview] = {}


def settings_for_preview(settings: Settings) -> Settings:
    """Returns settings without what does not change a level."""
    return replace(settings, levels=0, use_images=True, filepath="")


def compute(source: Bake, image_uid: int, filters: Iterable[str], progress: Progress) -> Preview:
    """Computes the levels with each filter; raises what `Bake.compute` does.

    Args:
        source: What was read from Blender.
        image_uid: The session_uid of its image.
        filters: Keys of `choices.FILTERS`, that of the settings first.
        progress: Called with the fraction done.
    """
    linear = source.linear(progress)
    names = list(dict.fromkeys(filters))
    levels = {}
    for name, part in zip(names, parts(progress, len(names)), strict=True):
        levels[name] = source.filtered(linear, name, part)
    picture = source.picture
    if picture.alpha_is_straight:
        levels = {name: [associated(level) for level in made] for name, made in levels.items()}
    # Level 0 is the image, whatever the filter.
    first = levels[names[0]][0]
    for made in levels.values():
        made[0] = first
    return Preview(
        image_uid=image_uid,
        settings=settings_for_preview(source.settings),
        levels=levels,
        wrap=source.wrap,
        blends=picture.alpha_is_coverage,
        decodes_after=source.reader != "linear",
        objects=frozenset(source.objects),
    )


def keep(preview: Preview) -> None:
    """Makes editors draw a preview in the place of its image."""
    _previews[preview.image_uid] = preview


def find(image: bpy.types.Image | None) -> Preview | None:
    """Returns the preview of an image, if there is one."""
    return None if image is None else _previews.get(image.session_uid)


def drop(image: bpy.types.Image) -> None:
    """Forgets the preview of an image."""
    _previews.pop(image.session_uid, None)


def redraw() -> None:
    """Has every Image editor drawn again."""
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "IMAGE_EDITOR":
                area.tag_redraw()


@persistent
def _drop_all(*_: object) -> None:
    _previews.clear()


@persistent
def _mark_stale(_: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    if not _previews:
        return
    for update in depsgraph.updates:
        changed = update.id.original
        if isinstance(changed, bpy.types.Image):
            preview = find(changed)
            if preview is not None:
                preview.is_stale = True
        elif isinstance(changed, bpy.types.Object) and (
            update.is_updated_geometry or update.is_updated_transform
        ):
            for preview in _previews.values():
                preview.is_stale |= changed.name in preview.objects


def register() -> None:
    """Adds the handlers."""
    bpy.app.handlers.load_pre.append(_drop_all)
    bpy.app.handlers.depsgraph_update_post.append(_mark_stale)


def unregister() -> None:
    """Removes the handlers and forgets the previews."""
    bpy.app.handlers.depsgraph_update_post.remove(_mark_stale)
    bpy.app.handlers.load_pre.remove(_drop_all)
    _drop_all()
