# SPDX-License-Identifier: GPL-3.0-or-later

"""Faces of font files: family, weight, width, slant and axes, from tables without glyphs."""

import io
import logging
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

from fontTools.ttLib import TTCollection, TTFont

from .bitmaps import has_bitmaps
from .woff import as_sfnt

# Percentages of the normal width, by usWidthClass.
_WIDTHS = (100.0, 50.0, 62.5, 75.0, 87.5, 100.0, 112.5, 125.0, 150.0, 200.0)
_FAMILY_NAMES = (16, 1, 21)
OUTLINES = ("glyf", "CFF ", "CFF2")
_MAX_FACES = 256
DAMAGED = "it is damaged, or no font"
"""Message for files whose tables cannot be read."""


@dataclass(frozen=True, slots=True, eq=False)
class Face:
    """A face in a font file.

    Attributes:
        family: Name in messages.
        families: All names of its family, in lower case.
        weight: Lowest and highest weight.
        stretch: Lowest and highest width, in percent of the normal one.
        slant: "normal", "italic" or "oblique".
        axes: Lowest, default and highest value of variable axes, by tag.
        data: Contents of an embedded font.
    """

    path: Path
    index: int
    family: str
    families: frozenset[str]
    weight: tuple[float, float]
    stretch: tuple[float, float]
    slant: str
    axes: Mapping[str, tuple[float, float, float]]
    data: bytes | None = None

    def open(self) -> Any:
        """Opens the font; tables are read when needed."""
        return TTFont(_source(self.path, self.data), fontNumber=self.index, lazy=True)

    def contents(self) -> bytes:
        """Returns the font as TrueType or OpenType."""
        data = self.path.read_bytes() if self.data is None else self.data
        if data[:4] not in (b"wOFF", b"wOF2"):
            return data
        font, file = self.open(), io.BytesIO()
        font.flavor = None
        font.save(file)
        return file.getvalue()


def _source(path: Path, data: bytes | None) -> str | io.BytesIO:
    return str(path) if data is None else io.BytesIO(data)


# fontTools logs details of damage, which Python would print without a handler.
logging.getLogger("fontTools").addHandler(logging.NullHandler())


class UnreadableFontError(ValueError):
    """A file is no readable font; the message says why."""


@lru_cache(maxsize=65536)
def _read_faces(path: Path, stamp: tuple[int, int]) -> tuple[Face, ...]:
    """`stamp` is the file's time and size, so that changed files are read again."""
    try:
        with path.open("rb") as file:
            is_collection = file.read(4) == b"ttcf"
        count = 1
        if is_collection:
            with TTCollection(str(path), lazy=True) as collection:
                count = len(collection.fonts)
        faces = (_face(path, index) for index in range(min(count, _MAX_FACES)))
        return tuple(face for face in faces if face is not None)
    except OSError:
        raise
    except ImportError:
        raise UnreadableFontError("WOFF 2 needs the Python package brotli") from None
    except Exception:
        raise UnreadableFontError(DAMAGED) from None


def read_faces(path: Path) -> tuple[Face, ...]:
    """Returns the faces of a file that have outlines or bitmaps.

    Raises:
        UnreadableFontError: The file is no font, or damaged.
        OSError: The file cannot be read.
    """
    status = path.stat()
    return _read_faces(path, (status.st_mtime_ns, status.st_size))


def read_embedded_face(data: bytes, name: str) -> Face:
    """Reads an embedded font; `name` is its family in messages.

    Raises:
        UnreadableFontError: The bytes are no font.
    """
    try:
        sfnt = as_sfnt(data)
    except Exception as error:
        raise UnreadableFontError(str(error)[:200] or type(error).__name__) from None
    try:
        face = _face(Path(name), 0, sfnt)
    except Exception:
        raise UnreadableFontError(DAMAGED) from None
    if face is None:
        raise UnreadableFontError("it has no outlines")
    return face


def _face(path: Path, index: int, data: bytes | None = None) -> Face | None:
    with TTFont(_source(path, data), fontNumber=index, lazy=True) as font:
        is_drawn = any(tag in font for tag in OUTLINES) or has_bitmaps(font)
        if not is_drawn or "cmap" not in font:
            return None
        names = _family_names(font["name"]) if "name" in font else []
        family = names[0] if names else path.stem
        axes = {}
        if "fvar" in font:
            axes = {
                axis.axisTag: (axis.minValue, axis.defaultValue, axis.maxValue)
                for axis in font["fvar"].axes
            }
        os2, bits = font.get("OS/2"), font["head"].macStyle
        weight = float(os2.usWeightClass) if os2 else 700.0 if bits & 1 else 400.0
        stretch = _WIDTHS[os2.usWidthClass if os2 and os2.usWidthClass < len(_WIDTHS) else 0]
        selection = os2.fsSelection if os2 else 0
        is_italic, is_oblique = bool(selection & 1 or bits & 2), bool(selection & (1 << 9))
        return Face(
            path,
            index,
            family,
            frozenset(name.lower() for name in (*names, path.stem if not names else family)),
            _axis_range(axes, "wght", weight),
            _axis_range(axes, "wdth", stretch),
            "oblique" if is_oblique else "italic" if is_italic else "normal",
            axes,
            data,
        )


def _family_names(table: Any) -> list[str]:
    """Returns the names of a family; the English typographic one first."""
    names: list[str] = []
    for number in _FAMILY_NAMES:
        english = table.getDebugName(number)
        others = [
            record.toUnicode(errors="replace") for record in table.names if record.nameID == number
        ]
        names.extend(name.strip() for name in ([english] if english else []) + others)
    return list(dict.fromkeys(name for name in names if name))


def _axis_range(
    axes: Mapping[str, tuple[float, float, float]], tag: str, value: float
) -> tuple[float, float]:
    return (axes[tag][0], axes[tag][2]) if tag in axes else (value, value)
