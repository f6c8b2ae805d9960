# SPDX-License-Identifier: GPL-3.0-or-later

"""The numbers of a sampling table in the form of shaders, common to all languages."""

import re
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from ..._border.arguments import as_name

FARTHEST_OFFSET = 64
"""Largest offset of a texel from its cell, in either direction (sampling_table.h)."""

_NAME = re.compile(r"[A-Za-z][A-Za-z0-9]*(_[A-Za-z0-9]+)*")
_LINE_LENGTH = 100


class Section(Protocol):
    """The part of a TableSection that shaders need."""

    @property
    def offsets(self) -> npt.NDArray[Any]: ...
    @property
    def coefficients(self) -> npt.NDArray[np.float64]: ...


class Table(Protocol):
    """The part of a SamplingTable that shaders need."""

    @property
    def filter(self) -> str: ...
    @property
    def target(self) -> str: ...
    @property
    def texels(self) -> int: ...
    @property
    def subdomains(self) -> tuple[int, int, int]: ...
    @property
    def degree(self) -> int: ...
    def section(self, levels: int) -> Section: ...


@dataclass(frozen=True)
class TableNumbers:
    """The sections for one, two and three levels, concatenated.

    Attributes:
        offsets: By subdomain and texel: x + 64, y + 64 and `finer`, at bits 0, 8 and 16.
        coefficients: By subdomain and texel, and by term.
    """

    filter: str
    target: str
    texels: int
    grid: int
    slices: int
    degree: int
    offsets: list[int]
    coefficients: npt.NDArray[np.float32]

    @classmethod
    def of(cls, table: Table) -> "TableNumbers":
        sections = [table.section(levels) for levels in (1, 2, 3)]
        offsets = np.concatenate([np.reshape(section.offsets, (-1, 3)) for section in sections])
        return cls(
            filter=table.filter,
            target=table.target,
            texels=table.texels,
            grid=table.subdomains[0],
            slices=table.subdomains[2],
            degree=table.degree,
            offsets=[
                (x + FARTHEST_OFFSET) | (y + FARTHEST_OFFSET) << 8 | finer << 16
                for finer, x, y in offsets.tolist()
            ],
            coefficients=np.concatenate(
                [
                    np.reshape(section.coefficients, (-1, np.shape(section.coefficients)[-1]))
                    for section in sections
                ]
            ).astype(np.float32),
        )

    @property
    def columns(self) -> int:
        return (self.grid + 1) // 2

    @property
    def subdomains_of_slice(self) -> int:
        return self.columns * (self.columns + 1) // 2

    @property
    def nbytes(self) -> int:
        return 4 * (len(self.offsets) + self.coefficients.size)

    def constants(self) -> dict[str, int]:
        """Returns the table's sizes, by their names in templates."""
        return {
            "texels": self.texels,
            "grid": self.grid,
            "last_column": self.columns - 1,
            "subdomains_of_slice": self.subdomains_of_slice,
            "slices": self.slices,
            "last_slice": self.slices - 1,
            "rows": len(self.offsets),
        }

    def about(self) -> str:
        """Returns a description of the table."""
        return (
            f"{self.texels} texels, {self.grid} x {self.grid} x {self.slices} subdomains, "
            f"{'linear' if self.degree == 1 else 'quadratic'} weights; {self.nbytes} bytes"
        )


def checked_name(name: object) -> str:
    """Checks a prefix of shader identifiers."""
    text = as_name("name", name)
    if not _NAME.fullmatch(text) or text.startswith("gl_"):
        raise ValueError(
            f"name: {text!r}; letters, digits and single underscores are needed, a letter first, "
            "and not gl_"
        )
    return text


def number(value: np.float32) -> str:
    """Returns the shortest decimal representation of a float, with a point or an exponent."""
    return str(value)


def wrapped(items: Iterable[str], indent: str = "    ") -> str:
    """Joins items by commas, in lines of limited length."""
    lines: list[str] = []
    line = indent
    for item in items:
        if len(line) + len(item) + 2 > _LINE_LENGTH:
            lines.append(line.rstrip())
            line = indent
        line += f"{item}, "
    lines.append(line.removesuffix(", "))
    return "\n".join(lines)


def commented(text: str) -> str:
    """Returns text as comment lines that begin with two slashes."""
    return "\n".join(f"// {line}".rstrip() for line in text.strip("\n").split("\n"))
