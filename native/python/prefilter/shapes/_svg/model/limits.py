# SPDX-License-Identifier: GPL-3.0-or-later

"""How large drawings may become, so that a small file cannot take all memory or all time."""

MOST_USED = 250_000
MOST_SEGMENTS = 2_000_000
MOST_MEASURED = 1_000_000
MOST_TEXELS = 1 << 26
TOO_MANY_USED = "<use>, masks, patterns and markers repeat more than {} elements"
MOST_CHARACTERS = 100_000
# What a dash becomes has about so many.
_SEGMENTS_PER_DASH = 4.0


class TooLargeError(ValueError):
    """A drawing has more of something than it may have; the message says of what."""


class Budget:
    """Counts what a drawing consists of, with all that is repeated.

    Args:
        elements: In the file.
    """

    def __init__(self, elements: int) -> None:
        self._elements_left = elements + MOST_USED
        self._segments_left = float(MOST_SEGMENTS)
        self._measured_left = MOST_MEASURED
        self._texels_left = MOST_TEXELS
        self._characters_left = MOST_CHARACTERS

    def take_element(self) -> None:
        """Counts an element that is drawn. Raises TooLargeError where there are too many."""
        self._elements_left -= 1
        if self._elements_left < 0:
            raise TooLargeError(TOO_MANY_USED.format(MOST_USED))

    def take_measured(self) -> None:
        """Counts an element whose box is needed, for another one. Raises TooLargeError likewise."""
        self._measured_left -= 1
        if self._measured_left < 0:
            raise TooLargeError(f"boxes around groups of more than {MOST_MEASURED} elements")

    def take_texels(self, count: int) -> None:
        """Counts texels of images. Raises TooLargeError likewise."""
        self._texels_left -= count
        if self._texels_left < 0:
            raise TooLargeError(f"images of more than {MOST_TEXELS} pixels")

    def take_characters(self, count: int) -> None:
        """Counts characters of text. Raises TooLargeError likewise."""
        self._characters_left -= count
        if self._characters_left < 0:
            raise TooLargeError(
                f"more than {MOST_CHARACTERS} characters of text, with those that <use> repeats"
            )

    def take_segments(self, count: int, dashes: float) -> None:
        """Counts lines and curves that are drawn, and dashes. Raises TooLargeError likewise."""
        self._segments_left -= count + _SEGMENTS_PER_DASH * dashes
        if self._segments_left < 0.0:
            raise TooLargeError(
                f"more than {MOST_SEGMENTS} lines and curves, with those that <use> repeats, "
                f"and {_SEGMENTS_PER_DASH:g} for each dash"
            )
