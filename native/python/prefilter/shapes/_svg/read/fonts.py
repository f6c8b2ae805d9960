# SPDX-License-Identifier: GPL-3.0-or-later

"""Where the fonts of a drawing are; none is opened before there is text."""

import os
from collections.abc import Iterable, Sequence
from copy import copy
from functools import cached_property
from typing import TYPE_CHECKING

from ...._border.input import as_path
from ..model.warnings import Warnings

if TYPE_CHECKING:
    from ..._fonts.collection import Fonts
    from .text_style import FontRule


class FontPlaces:
    """Files and folders of fonts.

    Args:
        places: Those that were given; they are looked at at once. None for those of the system.

    Raises:
        ValueError: There is no such file or folder, or no font that can be read in a file.
    """

    def __init__(self, places: Iterable[str | os.PathLike[str]] | None) -> None:
        is_list = isinstance(places, Iterable) and not isinstance(places, str | bytes)
        if places is not None and not is_list:
            raise ValueError(f"fonts: {places!r}; a list of files and folders is needed")
        self._rules: Sequence[FontRule] = ()
        self._warnings = Warnings()
        self._places = None
        if places is not None:
            try:
                self._places = [as_path(place) for place in places]
            except ValueError as error:
                raise ValueError(f"fonts{str(error).removeprefix('path')}") from None
        if self._places:
            _ = self.fonts

    def with_rules(self, rules: "Sequence[FontRule]", warnings: Warnings) -> "FontPlaces":
        """The same, and fonts of a drawing itself; warns of those that cannot be had."""
        if not rules:
            return self
        found = copy(self)
        found._rules, found._warnings = rules, warnings
        found.__dict__.pop("fonts", None)
        return found

    @cached_property
    def fonts(self) -> "Fonts":
        """The fonts that are there."""
        # fontTools takes a while to load, which drawings without text need not wait for.
        from ..._fonts.collection import Fonts

        if not self._rules:
            return Fonts(self._places)
        from .font_faces import own_faces

        return Fonts(self._places, own_faces(self._rules, self._warnings))
