# SPDX-License-Identifier: GPL-3.0-or-later

"""Limits on the size of drawings, so that a small file cannot take all memory or all time."""

MAX_USED = 250_000
MAX_SEGMENTS = 2_000_000
MAX_MEASURED = 1_000_000
MAX_TEXELS = 1 << 26
TOO_MANY_USED = "<use>, masks, patterns and markers repeat more than {} elements"
MAX_CHARACTERS = 100_000
# Typical number of segments of a stroked dash.
_SEGMENTS_PER_DASH = 4.0


class TooLargeError(ValueError):
    """A drawing exceeds a limit; the message says which."""


class Budget:
    """Counts the parts of a drawing, repeated ones included. Methods raise TooLargeError at a
    limit.

    Args:
        elements: Number of elements in the file.
    """

    def __init__(self, elements: int) -> None:
        self._elements_left = elements + MAX_USED
        self._segments_left = float(MAX_SEGMENTS)
        self._measured_left = MAX_MEASURED
        self._texels_left = MAX_TEXELS
        self._characters_left = MAX_CHARACTERS

    def take_element(self) -> None:
        """Counts an element that is drawn."""
        self._elements_left -= 1
        if self._elements_left < 0:
            raise TooLargeError(TOO_MANY_USED.format(MAX_USED))

    def take_measured(self) -> None:
        """Counts an element measured for the bounding box of another one."""
        self._measured_left -= 1
        if self._measured_left < 0:
            raise TooLargeError(f"boxes around groups of more than {MAX_MEASURED} elements")

    def take_texels(self, count: int) -> None:
        """Counts texels of images."""
        self._texels_left -= count
        if self._texels_left < 0:
            raise TooLargeError(f"images of more than {MAX_TEXELS} pixels")

    def take_characters(self, count: int) -> None:
        """Counts characters of text."""
        self._characters_left -= count
        if self._characters_left < 0:
            raise TooLargeError(
                f"more than {MAX_CHARACTERS} characters of text, with those that <use> repeats"
            )

    def take_segments(self, count: int, dashes: float) -> None:
        """Counts segments to draw, and dashes."""
        self._segments_left -= count + _SEGMENTS_PER_DASH * dashes
        if self._segments_left < 0.0:
            raise TooLargeError(
                f"more than {MAX_SEGMENTS} lines and curves, with those that <use> repeats, "
                f"and {_SEGMENTS_PER_DASH:g} for each dash"
            )
