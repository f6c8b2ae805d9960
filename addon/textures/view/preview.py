# SPDX-License-Identifier: GPL-3.0-or-later

"""Previews: the levels that editors draw in place of an image."""

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
    """The levels of one image, by one or several filters.

    Attributes:
        image_uid: The image's session_uid.
        settings: The settings of the bake.
        levels: The levels by filter, level 0 first: (height, width, 3 or 4) scene-linear values,
            with colors multiplied by alpha if alpha is coverage.
        wrap: The wrap modes along u and v.
        blends: Whether alpha is coverage.
        decodes_after: Whether lookups interpolate encoded texels, and decode afterward.
        objects: The names of the objects that use the image.
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
        """Returns whether an object uses the image."""
        return name in self.objects

    @property
    def last_level(self) -> int:
        """The number of the coarsest level."""
        return min(len(levels) for levels in self.levels.values()) - 1

    @property
    def wrap_numbers(self) -> tuple[int, int]:
        """The wrap modes as numbers for the shader."""
        return _WRAPS.index(self.wrap[0]), _WRAPS.index(self.wrap[1])


_previews: Previews[Preview] = Previews()
keep, find, drop = _previews.keep, _previews.find, _previews.drop
register, unregister = _previews.register, _previews.unregister
VIEW = View(_previews, "prefilter_view", "use_preview")


class PreviewWork:
    """The computation of a preview, as a `Work`."""

    def __init__(self, source: "Source", image_uid: int, filters: Iterable[str]) -> None:
        """Stores the arguments of `compute`."""
        self._source = source
        self._image_uid = image_uid
        self._filters = list(filters)
        self._preview: Preview | None = None

    @property
    def image_name(self) -> str:
        """The name of the image."""
        return self._source.image_name

    def compute(self, progress: Progress) -> None:
        """Computes the levels, on any thread."""
        self._preview = compute(self._source, self._image_uid, self._filters, progress)

    def write(self) -> Outcome:
        """Stores the preview for the editors."""
        assert self._preview is not None
        keep(self._preview)
        return Outcome(
            Sentence("Computed levels 0 to {}", self._preview.last_level),
            warnings=self._source.warnings,
        )

    def discard(self) -> None:
        """Does nothing: no files are staged."""


def settings_for_preview(settings: Settings) -> Settings:
    """Returns the settings with fields that do not affect levels set to fixed values."""
    from prefilter.workflows.textures import lookups

    return replace(lookups.resolved(settings), levels=0, use_images=True, filepath="")


def compute(
    source: "Source", image_uid: int, filters: Iterable[str], progress: Progress
) -> Preview:
    """Computes the levels with each filter; raises the same exceptions as `Source.filtered`.

    Args:
        source: The image and its surfaces.
        image_uid: The session_uid of the image.
        filters: Keys of `choices.FILTERS`, beginning with the filter of the settings.
        progress: Called with the fraction done.
    """
    linear = source.linear(progress)
    names = list(dict.fromkeys(filters))
    levels = {}
    for name, part in zip(names, parts(progress, len(names)), strict=True):
        levels[name] = source.filtered(linear, name, part)
    picture = source.picture
    if picture.alpha_is_straight:
        levels = {name: [associated(level) for level in own] for name, own in levels.items()}
    # Level 0 is the image, whatever the filter.
    first = levels[names[0]][0]
    for own in levels.values():
        own[0] = first
    return Preview(
        image_uid=image_uid,
        settings=settings_for_preview(source.settings),
        levels=levels,
        wrap=source.wrap,
        blends=picture.alpha_is_coverage,
        decodes_after=source.reader != "linear",
        objects=frozenset(source.objects),
    )
