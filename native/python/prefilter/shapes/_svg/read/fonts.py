# SPDX-License-Identifier: GPL-3.0-or-later

"""Fonts for text, opened at the first text."""

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


class FontSources:
    """Font files and folders.

    Args:
        places: Files and folders, which are checked at once; None for the system's fonts.

    Raises:
        ValueError: A file or folder is missing, or a file is no readable font.
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

    def with_rules(self, rules: "Sequence[FontRule]", warnings: Warnings) -> "FontSources":
        """Returns a copy with fonts of `@font-face` rules; unusable ones cause warnings."""
        if not rules:
            return self
        extended = copy(self)
        extended._rules, extended._warnings = rules, warnings
        extended.__dict__.pop("fonts", None)
        return extended

    @cached_property
    def fonts(self) -> "Fonts":
        """The available fonts."""
        # fontTools loads slowly, and drawings without text do not need it.
        from ..._fonts.collection import Fonts

        if not self._rules:
            return Fonts(self._places)
        from .font_faces import read_font_faces

        return Fonts(self._places, read_font_faces(self._rules, self._warnings))
