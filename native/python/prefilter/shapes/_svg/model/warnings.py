# SPDX-License-Identifier: GPL-3.0-or-later

"""What was found in a drawing and is not in its shapes."""

from dataclasses import dataclass, replace
from typing import Literal

Kind = Literal["unsupported", "broken"]


@dataclass(frozen=True, slots=True)
class SvgWarning:
    """Something in a file that its shapes do not show, or not as it is meant.

    Attributes:
        kind: "unsupported": the file is right, and other programs may show it. "broken": the file
            is wrong there.
        name: Of the element or property, as it stands in the file.
        effect: What became of it: "left out", "ignored", ...
        line: Where it is, the first time.
        count: How often it is there.
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
    """Collects warnings, the same ones as one."""

    def __init__(self) -> None:
        self._found: dict[tuple[Kind, str, str], SvgWarning] = {}

    def unsupported(self, name: str, effect: str, line: int) -> None:
        self._add("unsupported", name, effect, line)

    def broken(self, name: str, effect: str, line: int) -> None:
        self._add("broken", name, effect, line)

    def _add(self, kind: Kind, name: str, effect: str, line: int) -> None:
        key = (kind, name, effect)
        known = self._found.get(key)
        if known is None:
            self._found[key] = SvgWarning(kind, name, effect, line)
        else:
            self._found[key] = replace(known, count=known.count + 1)

    def all(self) -> tuple[SvgWarning, ...]:
        return tuple(self._found.values())
