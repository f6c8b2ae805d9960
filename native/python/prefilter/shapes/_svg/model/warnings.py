# SPDX-License-Identifier: GPL-3.0-or-later

"""Warnings about parts of a drawing that are wrong or not supported."""

from dataclasses import dataclass, replace
from typing import Literal

Kind = Literal["unsupported", "broken"]


@dataclass(frozen=True, slots=True)
class SvgWarning:
    """A part of a drawing that its shapes do not show, or show differently.

    Attributes:
        kind: "unsupported" if the file is right and other programs may show it, "broken" if the
            file is wrong.
        name: The element or property, as written in the file.
        effect: The consequence: "left out", "ignored", ...
        line: Line of the first occurrence.
        count: Number of occurrences.
    """

    kind: Kind
    name: str
    effect: str
    line: int
    count: int = 1

    def __str__(self) -> str:
        often = f", {self.count} times" if self.count > 1 else ""
        where = "first in line" if self.count > 1 else "in line"
        return f"{self.name}: {self.effect} ({where} {self.line}{often})"


class Warnings:
    """Collects warnings and merges equal ones."""

    def __init__(self) -> None:
        self._by_key: dict[tuple[Kind, str, str], SvgWarning] = {}

    def unsupported(self, name: str, effect: str, line: int) -> None:
        self._add("unsupported", name, effect, line)

    def broken(self, name: str, effect: str, line: int) -> None:
        self._add("broken", name, effect, line)

    def _add(self, kind: Kind, name: str, effect: str, line: int) -> None:
        key = (kind, name, effect)
        known = self._by_key.get(key)
        if known is None:
            self._by_key[key] = SvgWarning(kind, name, effect, line)
        else:
            self._by_key[key] = replace(known, count=known.count + 1)

    def all(self) -> tuple[SvgWarning, ...]:
        return tuple(self._by_key.values())
