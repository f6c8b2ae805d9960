# SPDX-License-Identifier: GPL-3.0-or-later

"""Opening of drawings."""

import os
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager

from ..model.gradients import Colors
from ..model.limits import TooLargeError
from ..model.warnings import Warnings
from ..read.document import read_document
from ..read.fonts import FontSources
from .drawing import Drawing


def open_drawing(
    source: str | os.PathLike[str] | bytes,
    *,
    colors: Colors,
    reads_files: bool,
    report: Callable[[float], None],
    fonts: Iterable[str | os.PathLike[str]] | None,
) -> tuple[str, Drawing, Warnings]:
    """Reads a drawing, with images in its folder if `reads_files`. See `prefilter.read_svg`.

    Returns:
        Its name in messages, the drawing, and warnings.
    """
    places = FontSources(fonts)
    document = read_document(source, lambda share: report(0.3 * share))
    if not reads_files:
        document.folder = None
    warnings = Warnings()
    with as_value_errors(document.name):
        drawing = Drawing(
            document, colors, warnings, lambda share: report(0.3 + 0.7 * share), places
        )
    return document.name, drawing, warnings


@contextmanager
def as_value_errors(name: str) -> Iterator[None]:
    """Converts limit and recursion errors into a ValueError that names the drawing."""
    try:
        yield
    except RecursionError:
        raise ValueError(f"{name}: values, styles or groups are nested too deeply") from None
    except TooLargeError as error:
        raise ValueError(f"{name}: {error}") from None
