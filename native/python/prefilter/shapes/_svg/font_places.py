# SPDX-License-Identifier: GPL-3.0-or-later

"""Where the fonts of a drawing are; none is opened before there is text."""

import os
from collections.abc import Iterable
from functools import cached_property
from typing import TYPE_CHECKING

from ..._border.input import as_path

if TYPE_CHECKING:
    from .._fonts.collection import Fonts


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
        self._places = None
        if places is not None:
            try:
                self._places = [as_path(place) for place in places]
            except ValueError as error:
                raise ValueError(f"fonts{str(error).removeprefix('path')}") from None
        if self._places:
            _ = self.fonts

    @cached_property
    def fonts(self) -> "Fonts":
        """The fonts that are there."""
        # fontTools takes a while to load, which drawings without text need not wait for.
        from .._fonts.collection import Fonts

        return Fonts(self._places)
