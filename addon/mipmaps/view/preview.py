# SPDX-License-Identifier: GPL-3.0-or-later

"""The levels that editors draw in the place of an image: computed, and kept."""

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from ...bridge.previews import Previews
from ...bridge.views import View
from ...core.alpha import associated
from ...core.jobs import Progress, parts
from ...core.outcome import Outcome
from ...core.wording import Sentence
from ..choices import Settings

if TYPE_CHECKING:
    from ...bridge.images import FloatArray
    from ..source import Source

_WRAPS = ("clamp", "repeat", "border")


@dataclass
class Preview:
    """The levels of one image, with some filters.

    Attributes:
        image_uid: The image's session_uid.
        settings: What the levels were computed with.
        levels: By filter, level 0 first: (height, width, 3 or 4) scene-linear values, with colors
            multiplied by alpha where that is coverage.
        wrap: What lookups read outside of the image along u and v.
        blends: Whether alpha is coverage.
        decodes_after: Whether lookups interpolate encoded texels, and decode afterward.
        objects: The names of the objects that wear the image.
        is_stale: Whether the image or an object has changed since.
    """

    image_uid: int
    settings: Settings
    levels: "dict[str, list[FloatArray]]"
    wrap: tuple[str, str]
    blends: bool
    decodes_after: bool
    objects: frozenset[str]
    is_stale: bool = False
    textures: dict[tuple[str, int], object] = field(default_factory=dict)

    def depends_on(self, name: str) -> bool:
        """Tells whether an object wears the image."""
        return name in self.objects

    @property
    def last_level(self) -> int:
        """The number of the coarsest level."""
        return min(len(levels) for levels in self.levels.values()) - 1

    @property
    def wrap_numbers(self) -> tuple[int, int]:
        """The wrap modes as the shader counts them."""
        return _WRAPS.index(self.wrap[0]), _WRAPS.index(self.wrap[1])


_previews: Previews[Preview] = Previews()
keep, find, drop = _previews.keep, _previews.find, _previews.drop
register, unregister = _previews.register, _previews.unregister
VIEW = View(_previews, "prefilter_view", "use_preview")


class PreviewWork:
    """The levels of an image with some filters, as work."""

    def __init__(self, source: "Source", image_uid: int, filters: Iterable[str]) -> None:
        """Takes what `compute` does."""
        self._source = source
        self._image_uid = image_uid
        self._filters = list(filters)
        self._preview: Preview | None = None

    @property
    def image_name(self) -> str:
        """The name of the image."""
        return self._source.image_name

    def compute(self, progress: Progress) -> None:
        """Computes the levels; may run in another thread."""
        self._preview = compute(self._source, self._image_uid, self._filters, progress)

    def write(self) -> Outcome:
        """Keeps the levels for the editors to draw."""
        assert self._preview is not None
        keep(self._preview)
        return Outcome(
            Sentence("Computed levels 0 to {}", self._preview.last_level),
            warnings=self._source.warnings,
        )

    def discard(self) -> None:
        """Does nothing: there are no files."""


def settings_for_preview(settings: Settings) -> Settings:
    """Returns settings without what does not change a level."""
    from prefilter.workflows.mipmaps import lookups

    return replace(lookups.resolved(settings), levels=0, use_images=True, filepath="")


def compute(
    source: "Source", image_uid: int, filters: Iterable[str], progress: Progress
) -> Preview:
    """Computes the levels with each filter; raises what `Source.filtered` does.

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
