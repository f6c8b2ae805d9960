# SPDX-License-Identifier: GPL-3.0-or-later

"""Font selection by family, width, slant and weight, as in CSS."""

import os
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import islice
from pathlib import Path

from .faces import DAMAGED, Face, UnreadableFontError, read_faces
from .folders import list_font_files, system_folders
from .font import Font
from .substitutes import (
    GENERIC,
    MONO,
    SAME_ADVANCES,
    SANS,
    SERIF,
    from_fontconfig,
    generic_families,
)

# Groups of similar families. The first available one substitutes any of the group.
_SIMILAR_FAMILIES = (
    ("calibri", "carlito", *SANS),
    ("cambria", "caladea", *SERIF),
    SANS,
    SERIF,
    MONO,
)
# Synthetic slant, as in browsers.
_SKEW = 0.25
_MAX_FAMILIES_TRIED = 400
# Unicode block of pictographs, such as emoji.
_PICTOGRAPHS = range(0x1F000, 0x20000)


@dataclass(frozen=True, slots=True)
class FontQuery:
    """Criteria for selecting a font.

    Attributes:
        families: Names in order of preference, including generic ones.
        weight: 1 to 1000.
        stretch: Percentage of the normal width.
        slant: "normal", "italic" or "oblique".
        variations: Values of further axes.
        size: In pixels, for fonts with optical sizes.
    """

    families: tuple[str, ...]
    weight: float = 400.0
    stretch: float = 100.0
    slant: str = "normal"
    variations: tuple[tuple[str, float], ...] = ()
    size: float = 16.0


class Fonts:
    """Fonts in files and folders.

    Args:
        places: Files and folders; None for the system's, which are searched when needed.
        embedded: Embedded fonts, which take precedence within their families.

    Raises:
        ValueError: A file is no readable font, or a file or folder does not exist.
    """

    def __init__(
        self, places: Iterable[str | os.PathLike[str]] | None, embedded: Sequence[Face] = ()
    ) -> None:
        self._embedded = tuple(embedded)
        self._places = None if places is None else tuple(Path(each) for each in places)
        self._damaged: dict[Path, str] = {}
        self._faces = None
        if self._places is not None:
            self._faces = tuple(_load_faces(self._places, self._damaged))
        self._families: dict[str, list[Face]] = {}
        self._matches: dict[FontQuery, tuple[list[Font], list[str]]] = {}
        self._others: dict[tuple[int, FontQuery], Font | None] = {}
        self._opened: dict[tuple[Face, tuple[tuple[str, float], ...], float], Font | None] = {}

    @property
    def faces(self) -> tuple[Face, ...]:
        """All faces that are not embedded."""
        if self._faces is None:
            self._faces, damaged = _system_faces()
            self._damaged |= damaged
        return self._faces

    def take_damaged(self) -> dict[Path, str]:
        """Returns files left out since the last call, with reasons."""
        damaged, self._damaged = self._damaged, {}
        return damaged

    def match(self, query: FontQuery) -> tuple[list[Font], list[str]]:
        """Returns the fonts of available families in order of preference, and missing families.

        Families after the first available one do not count as missing. If none is available, the
        result has a substitute for the first one.
        """
        if query not in self._matches:
            self._matches[query] = self._match_families(query)
        return self._matches[query]

    def _match_families(self, query: FontQuery) -> tuple[list[Font], list[str]]:
        fonts_found: list[Font] = []
        missing: list[str] = []
        for name in query.families:
            fonts = self._embedded_fonts(name, query)
            faces = self._faces_of_family(name) if not fonts else ()
            font = self._open(faces, query) if faces else None
            if font is None and not fonts:
                # A font with the same advances is good enough, but the family is missing.
                font = self._open(self._with_same_advances(name), query)
                if font is not None and not fonts_found:
                    missing.append(name)
            if font is not None:
                fonts = [font]
            if fonts:
                fonts_found.extend(fonts)
            elif not fonts_found and name.lower() not in GENERIC:
                missing.append(name)
        if not fonts_found:
            opened = (self._open(faces, query) for faces in self._substitutes(missing[:1]))
            fonts_found = list(islice((font for font in opened if font is not None), 1))
        return fonts_found, missing

    def _embedded_fonts(self, name: str, query: FontQuery) -> list[Font]:
        """Returns embedded fonts of a family; several may each have some of its characters."""
        faces = [face for face in self._embedded if name.lower() in face.families]
        if not faces:
            return []
        best = match_face(faces, query)
        like = (best.weight, best.stretch, best.slant)
        opened = (
            self._open([face], query)
            for face in faces
            if (face.weight, face.stretch, face.slant) == like
        )
        return [font for font in opened if font is not None]

    def with_character(self, code: int, query: FontQuery) -> Font | None:
        """Returns a font of any family that has a character; None if there is none."""
        key = (code, query)
        if key not in self._others:
            self._others[key] = self._find_with(code, query)
        return self._others[key]

    def _find_with(self, code: int, query: FontQuery) -> Font | None:
        """Colored fonts come first for pictographs, and last for other characters."""
        seen: set[str] = set()
        other: Font | None = None
        for face in self.faces:
            if face.family in seen:
                continue
            seen.add(face.family)
            if len(seen) > _MAX_FAMILIES_TRIED:
                break
            font = self._open(self._faces_of_family(face.family), query)
            if font is not None and font.shows(code):
                if font.is_colored == (code in _PICTOGRAPHS):
                    return font
                other = other or font
        return other

    def _faces_of_family(self, name: str) -> Sequence[Face]:
        if not self._families:
            for face in self.faces:
                for family in face.families:
                    self._families.setdefault(family, []).append(face)
        key = name.lower()
        if key not in GENERIC:
            return self._families.get(key, ())
        if faces := self._from_fontconfig(key):
            return faces
        return next(
            (self._families[each] for each in generic_families(key) if each in self._families), ()
        )

    def _from_fontconfig(self, name: str) -> Sequence[Face]:
        """Returns fontconfig's matches for a family, if the fonts are the system's."""
        if self._places is not None:
            return ()
        for path, index in from_fontconfig(name):
            try:
                face = next((each for each in read_faces(path) if each.index == index), None)
            except (UnreadableFontError, OSError):
                continue
            if face is not None:
                return self._families.get(face.family.lower(), [face])
        return ()

    def _with_same_advances(self, name: str) -> Sequence[Face]:
        """Returns a substitute with the same advances as a missing family."""
        groups = [group for group in SAME_ADVANCES if name.lower() in group]
        if not groups:
            return ()
        faces = self._from_fontconfig(name)
        if faces:
            return faces if not groups[0].isdisjoint(faces[0].families) else ()
        others = (self._faces_of_family(each) for each in sorted(groups[0]))
        return next((each for each in others if each), ())

    def _substitutes(self, missing: Sequence[str]) -> Iterator[Sequence[Face]]:
        """Yields substitutes for missing families, similar ones first."""
        for name in missing:
            yield self._from_fontconfig(name)
            for group in _SIMILAR_FAMILIES:
                if name.lower() in group:
                    yield from map(self._faces_of_family, group)
        for name in ("serif", "sans-serif", *dict.fromkeys(face.family for face in self.faces)):
            yield self._faces_of_family(name)

    def _open(self, faces: Sequence[Face], query: FontQuery) -> Font | None:
        """Opens the best face of a family that is readable; None if none is."""
        remaining = list(faces)
        while remaining:
            face = match_face(remaining, query)
            location = _location(face, query)
            is_slanted = face.slant != "normal" or any(
                location.get(tag, 0.0) != 0.0 for tag in ("slnt", "ital")
            )
            skew = _SKEW if query.slant != "normal" and not is_slanted else 0.0
            key = (face, tuple(sorted(location.items())), skew)
            if key not in self._opened:
                try:
                    self._opened[key] = Font(face, location, skew)
                except Exception:
                    self._opened[key] = None
                    self._damaged[face.path] = DAMAGED
            font = self._opened[key]
            if font is not None:
                return font
            remaining.remove(face)
        return None


def match_face(faces: Sequence[Face], query: FontQuery) -> Face:
    """Selects a face of a family by width, then slant, then weight.

    See "Matching font styles" in CSS Fonts, level 4.
    """
    candidates = list(faces)
    widths = {face: _width_rank(face.stretch, query.stretch) for face in candidates}
    candidates = [face for face in candidates if widths[face] == min(widths.values())]
    slants = {
        "normal": ("normal", "oblique", "italic"),
        "italic": ("italic", "oblique", "normal"),
        "oblique": ("oblique", "italic", "normal"),
    }[query.slant]
    best = min(slants.index(face.slant) for face in candidates)
    candidates = [face for face in candidates if slants.index(face.slant) == best]
    return min(candidates, key=lambda face: _weight_rank(face.weight, query.weight))


def _width_rank(span: tuple[float, float], desired: float) -> tuple[int, float]:
    low, high = span
    if low <= desired <= high:
        return 0, 0.0
    is_narrower = high < desired
    distance = desired - high if is_narrower else low - desired
    return (1 if is_narrower == (desired <= 100.0) else 2), distance


def _weight_rank(span: tuple[float, float], desired: float) -> tuple[int, float]:
    low, high = span
    if low <= desired <= high:
        return 0, 0.0
    below = high < desired
    distance = desired - high if below else low - desired
    if desired < 400.0 or desired > 500.0:
        return (1 if below == (desired < 400.0) else 2), distance
    # Normal weights prefer heavier faces up to 500, then lighter ones.
    if not below and low <= 500.0:
        return 1, distance
    return (2 if below else 3), distance


def _location(face: Face, query: FontQuery) -> dict[str, float]:
    axis_values = {"wght": query.weight, "wdth": query.stretch, "opsz": query.size}
    if query.slant == "italic" and "ital" in face.axes:
        axis_values["ital"] = 1.0
    elif query.slant != "normal" and "slnt" in face.axes:
        axis_values["slnt"] = -14.0
    axis_values.update(query.variations)
    return {
        tag: min(max(axis_values.get(tag, default), low), high)
        for tag, (low, default, high) in face.axes.items()
    }


def _load_faces(places: Sequence[Path], damaged: dict[Path, str]) -> Iterator[Face]:
    """Yields the faces in files, which must be fonts, and in folders, which may hold others."""
    for place in places:
        if place.is_dir():
            yield from _faces_of(list_font_files(place), damaged)
            continue
        try:
            faces = read_faces(place)
        except UnreadableFontError as error:
            raise ValueError(f"fonts: '{place}' is no font that can be read: {error}") from None
        except FileNotFoundError:
            raise ValueError(f"fonts: there is no file or folder '{place}'") from None
        if not faces:
            raise ValueError(f"fonts: '{place}' has no outlines")
        yield from faces


def _faces_of(files: Iterable[Path], damaged: dict[Path, str]) -> Iterator[Face]:
    """Yields the faces in files; collects unreadable files in `damaged`."""
    for file in files:
        try:
            yield from read_faces(file)
        except UnreadableFontError as error:
            damaged[file] = str(error)
        except OSError as error:
            damaged[file] = error.strerror or DAMAGED


@lru_cache(maxsize=1)
def _system_faces() -> tuple[tuple[Face, ...], dict[Path, str]]:
    """Returns the system's faces, searched once, and unreadable files."""
    files = dict.fromkeys(file for folder in system_folders() for file in list_font_files(folder))
    damaged: dict[Path, str] = {}
    return tuple(_faces_of(files, damaged)), damaged
