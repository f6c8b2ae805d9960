# SPDX-License-Identifier: GPL-3.0-or-later

"""Which font a text gets: by family, width, slant and weight, as CSS chooses."""

import os
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import islice
from pathlib import Path

from .faces import DAMAGED, Face, UnreadableFontError, faces_in
from .folders import files_in, system_folders
from .font import Font
from .substitutes import GENERIC, MONO, SAME_ADVANCES, SANS, SERIF, from_fontconfig, generic

# The first that is there stands for each of them.
_ALIKE = (("calibri", "carlito", *SANS), ("cambria", "caladea", *SERIF), SANS, SERIF, MONO)
# Of a slanted face that is made: that of browsers.
_SKEW = 0.25
_MAX_TRIED = 400
# Characters of Unicode that are pictures, such as emoji.
_PICTURES = range(0x1F000, 0x20000)


@dataclass(frozen=True, slots=True)
class Wanted:
    """What a text asks for.

    Attributes:
        families: Names, the best first; generic ones among them.
        weight: From 1 to 1000.
        stretch: In percent of the normal width.
        slant: "normal", "italic" or "oblique".
        variations: Values of axes beside these.
        size: In pixels, for fonts that have other letters where they are small.
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
        places: Files and folders; None for those of the system, looked for once they are needed.
        own: Those of a drawing itself, which come before others of their families.

    Raises:
        ValueError: A file is no font that can be read, or there is no such file or folder.
    """

    def __init__(
        self, places: Iterable[str | os.PathLike[str]] | None, own: Sequence[Face] = ()
    ) -> None:
        self._own = tuple(own)
        self._places = None if places is None else tuple(Path(each) for each in places)
        self._damaged: dict[Path, str] = {}
        self._faces = None
        if self._places is not None:
            self._faces = tuple(_listed(self._places, self._damaged))
        self._families: dict[str, list[Face]] = {}
        self._first: dict[Wanted, tuple[list[Font], list[str]]] = {}
        self._others: dict[tuple[int, Wanted], Font | None] = {}
        self._opened: dict[tuple[Face, tuple[tuple[str, float], ...], float], Font | None] = {}

    @property
    def faces(self) -> tuple[Face, ...]:
        """All of them."""
        if self._faces is None:
            self._faces, damaged = _system_faces()
            self._damaged |= damaged
        return self._faces

    def take_damaged(self) -> dict[Path, str]:
        """Files that were left out since this was last asked, and what is wrong with each."""
        found, self._damaged = self._damaged, {}
        return found

    def first(self, wanted: Wanted) -> tuple[list[Font], list[str]]:
        """The fonts of the families that are there, best first, and the names of those missing.

        Names behind the first family that is there are not missed. Where none is there, there is
        a font that stands for the first of them.
        """
        if wanted not in self._first:
            self._first[wanted] = self._of_families(wanted)
        return self._first[wanted]

    def _of_families(self, wanted: Wanted) -> tuple[list[Font], list[str]]:
        found: list[Font] = []
        missing: list[str] = []
        for name in wanted.families:
            fonts = self._own_fonts(name, wanted)
            faces = self._of_family(name) if not fonts else ()
            font = self._open(faces, wanted) if faces else None
            if font is None and not fonts:
                # It is as good, and yet another one.
                font = self._open(self._with_same_advances(name), wanted)
                if font is not None and not found:
                    missing.append(name)
            if font is not None:
                fonts = [font]
            if fonts:
                found.extend(fonts)
            elif not found and name.lower() not in GENERIC:
                missing.append(name)
        if not found:
            opened = (self._open(faces, wanted) for faces in self._stand_ins(missing[:1]))
            found = list(islice((font for font in opened if font is not None), 1))
        return found, missing

    def _own_fonts(self, name: str, wanted: Wanted) -> list[Font]:
        """Those of a drawing, of one family: several where each has some of its letters."""
        faces = [face for face in self._own if name.lower() in face.families]
        if not faces:
            return []
        best = nearest(faces, wanted)
        like = (best.weight, best.stretch, best.slant)
        opened = (
            self._open([face], wanted)
            for face in faces
            if (face.weight, face.stretch, face.slant) == like
        )
        return [font for font in opened if font is not None]

    def with_character(self, code: int, wanted: Wanted) -> Font | None:
        """A font that shows a character, of any family; None where none does."""
        key = (code, wanted)
        if key not in self._others:
            self._others[key] = self._found_with(code, wanted)
        return self._others[key]

    def _found_with(self, code: int, wanted: Wanted) -> Font | None:
        """Fonts with colors come first for pictures such as emoji, and last for other letters."""
        seen: set[str] = set()
        other: Font | None = None
        for face in self.faces:
            if face.family in seen:
                continue
            seen.add(face.family)
            if len(seen) > _MAX_TRIED:
                break
            font = self._open(self._of_family(face.family), wanted)
            if font is not None and font.shows(code):
                if font.is_colored == (code in _PICTURES):
                    return font
                other = other or font
        return other

    def _of_family(self, name: str) -> Sequence[Face]:
        if not self._families:
            for face in self.faces:
                for family in face.families:
                    self._families.setdefault(family, []).append(face)
        key = name.lower()
        if key not in GENERIC:
            return self._families.get(key, ())
        if faces := self._from_fontconfig(key):
            return faces
        return next((self._families[each] for each in generic(key) if each in self._families), ())

    def _from_fontconfig(self, name: str) -> Sequence[Face]:
        """What fontconfig takes for a family, where the fonts are those of the system."""
        if self._places is not None:
            return ()
        for path, index in from_fontconfig(name):
            try:
                face = next((each for each in faces_in(path) if each.index == index), None)
            except (UnreadableFontError, OSError):
                continue
            if face is not None:
                return self._families.get(face.family.lower(), [face])
        return ()

    def _with_same_advances(self, name: str) -> Sequence[Face]:
        """What stands for a family that is missing, with lines of the same length."""
        groups = [group for group in SAME_ADVANCES if name.lower() in group]
        if not groups:
            return ()
        faces = self._from_fontconfig(name)
        if faces:
            return faces if not groups[0].isdisjoint(faces[0].families) else ()
        others = (self._of_family(each) for each in sorted(groups[0]))
        return next((each for each in others if each), ())

    def _stand_ins(self, missing: Sequence[str]) -> Iterator[Sequence[Face]]:
        """Yields what is most like the families that are missing: as wide, else with serifs."""
        for name in missing:
            yield self._from_fontconfig(name)
            for group in _ALIKE:
                if name.lower() in group:
                    yield from map(self._of_family, group)
        for name in ("serif", "sans-serif", *dict.fromkeys(face.family for face in self.faces)):
            yield self._of_family(name)

    def _open(self, faces: Sequence[Face], wanted: Wanted) -> Font | None:
        """The font of a family that is nearest to what is wanted; None where none can be read."""
        left = list(faces)
        while left:
            face = nearest(left, wanted)
            location = _location(face, wanted)
            is_slanted = face.slant != "normal" or any(
                location.get(tag, 0.0) != 0.0 for tag in ("slnt", "ital")
            )
            skew = _SKEW if wanted.slant != "normal" and not is_slanted else 0.0
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
            left.remove(face)
        return None


def nearest(faces: Sequence[Face], wanted: Wanted) -> Face:
    """The face that CSS chooses of a family: by width, then slant, then weight.

    See "Matching font styles" in CSS Fonts, level 4.
    """
    left = list(faces)
    widths = {face: _width_rank(face.stretch, wanted.stretch) for face in left}
    left = [face for face in left if widths[face] == min(widths.values())]
    slants = {
        "normal": ("normal", "oblique", "italic"),
        "italic": ("italic", "oblique", "normal"),
        "oblique": ("oblique", "italic", "normal"),
    }[wanted.slant]
    best = min(slants.index(face.slant) for face in left)
    left = [face for face in left if slants.index(face.slant) == best]
    return min(left, key=lambda face: _weight_rank(face.weight, wanted.weight))


def _width_rank(span: tuple[float, float], wanted: float) -> tuple[int, float]:
    low, high = span
    if low <= wanted <= high:
        return 0, 0.0
    is_narrower = high < wanted
    distance = wanted - high if is_narrower else low - wanted
    return (1 if is_narrower == (wanted <= 100.0) else 2), distance


def _weight_rank(span: tuple[float, float], wanted: float) -> tuple[int, float]:
    low, high = span
    if low <= wanted <= high:
        return 0, 0.0
    below = high < wanted
    distance = wanted - high if below else low - wanted
    if wanted < 400.0 or wanted > 500.0:
        return (1 if below == (wanted < 400.0) else 2), distance
    # What is usual: heavier ones up to 500 first, then lighter ones.
    if not below and low <= 500.0:
        return 1, distance
    return (2 if below else 3), distance


def _location(face: Face, wanted: Wanted) -> dict[str, float]:
    asked = {"wght": wanted.weight, "wdth": wanted.stretch, "opsz": wanted.size}
    if wanted.slant == "italic" and "ital" in face.axes:
        asked["ital"] = 1.0
    elif wanted.slant != "normal" and "slnt" in face.axes:
        asked["slnt"] = -14.0
    asked.update(wanted.variations)
    return {
        tag: min(max(asked.get(tag, usual), low), high)
        for tag, (low, usual, high) in face.axes.items()
    }


def _listed(places: Sequence[Path], damaged: dict[Path, str]) -> Iterator[Face]:
    """Yields the faces in files, which must be fonts, and folders, which may hold others."""
    for place in places:
        if place.is_dir():
            yield from _faces_of(files_in(place), damaged)
            continue
        try:
            found = faces_in(place)
        except UnreadableFontError as error:
            raise ValueError(f"fonts: '{place}' is no font that can be read: {error}") from None
        except FileNotFoundError:
            raise ValueError(f"fonts: there is no file or folder '{place}'") from None
        if not found:
            raise ValueError(f"fonts: '{place}' has no outlines")
        yield from found


def _faces_of(files: Iterable[Path], damaged: dict[Path, str]) -> Iterator[Face]:
    """Yields the faces in files; `damaged` gets those that cannot be read."""
    for file in files:
        try:
            yield from faces_in(file)
        except UnreadableFontError as error:
            damaged[file] = str(error)
        except OSError as error:
            damaged[file] = error.strerror or DAMAGED


@lru_cache(maxsize=1)
def _system_faces() -> tuple[tuple[Face, ...], dict[Path, str]]:
    """Those of the system, looked for once, and the files that cannot be read."""
    files = dict.fromkeys(file for folder in system_folders() for file in files_in(folder))
    damaged: dict[Path, str] = {}
    return tuple(_faces_of(files, damaged)), damaged
