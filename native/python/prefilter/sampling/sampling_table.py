# SPDX-License-Identifier: GPL-3.0-or-later

"""Tables that reproduce a filter with few texels (chapter 6)."""

import json
import os
from functools import partial
from importlib import resources
from typing import Any, BinaryIO, NamedTuple

import numpy as np
import numpy.typing as npt

from .. import _native
from .._border.arguments import (
    Check,
    ProgressCallback,
    as_int,
    as_name,
    as_number,
    as_one_of,
    as_progress,
    set_options,
)
from .._border.arrays import as_threads
from .._border.input import as_path, open_file
from .._border.names import Kernel
from ..files.staging import as_target, write_output
from ._shaders import gpu, osl
from .levels import SAMPLING_FILTERS

STANDARD_TEXELS = (4, 6, 8)
"""How many texels the tables have that come with the package, one for each filter."""

STANDARD_TARGETS = (("tent", "box"),)
"""Filters of levels and targets of which there are such tables too."""

_FORMAT = "prefilter sampling table"
_VERSION = 1
_LEVELS = (3, 2, 1)

_CHECKS: dict[str, Check] = {
    "filter": partial(as_name, "filter"),
    "texels": partial(as_int, "texels", allowed="a whole number from 2 to 16 is needed"),
    "degree": partial(as_int, "degree", allowed="1 or 2 is needed"),
    "ramp_weight": partial(as_number, "ramp_weight"),
    "spectrum": partial(as_name, "spectrum"),
    "target": lambda target: "" if target is None else as_name("target", target),
}


class TableSection(NamedTuple):
    """The sets of texels and their weights where so many levels are available.

    A sample lies in a cell, a texel of the coarser one of the two levels around its mip value. Its
    place (x, y) in the cell is folded by the symmetries of the square to 0 <= y <= x <= 1/2; f is
    how far the mip value is above the finer level, 0 to 1. The filter is 2^(f - 1) cells wide. With
    one level only the cell is a texel of level 0, the filter is as wide as that, and f is x y.

    Subdomain (i, j, k) covers x from i / J, y from j / J and f from k / K on, of subdomains (J, J,
    K); they are numbered k c (c + 1) / 2 + i (i + 1) / 2 + j with c = (J + 1) // 2 and j <= i < c.

    Attributes:
        levels: How many levels are available: the cell's and those below it.
        offsets: (subdomains, texels, 3), whole numbers: of each texel how many levels it is below
            the cell's, and its column and row there, from the cell's low corner. Texels within the
            cell have 0 to 2^below - 1.
        coefficients: (subdomains, texels, terms) of the weights as polynomials in x, y and f: of 1,
            x, y, f, and for degree 2 also xx, yy, ff, xy, xf, yf.
        errors: (subdomains): equation 6.3, by the table's `spectrum`, integrated over the
            subdomain.
        trilinear_errors: The same of trilinear interpolation.
        gaps: (subdomains): how much lower what `build` minimizes may be for another set, as a
            share of it; 0 where the set is proven to be the best. None for tables that are not
            certified.
    """

    levels: int
    offsets: npt.NDArray[np.int32]
    coefficients: npt.NDArray[np.float64]
    errors: npt.NDArray[np.float64]
    trilinear_errors: npt.NDArray[np.float64]
    gaps: npt.NDArray[np.float64] | None


class SamplingTable:
    """Which few texels of a mipmap make up a filter of any place and scale, with which weights.

    Made by `build`, `load` or `standard`, not by calling the class.

    The levels must be filtered with the same kernel: see `sampling_levels`.
    """

    def __init__(self, native: _native.SamplingTable) -> None:
        self._native = native

    @classmethod
    def build(
        cls,
        filter: Kernel = "lanczos2",
        *,
        texels: int = 8,
        subdomains: tuple[int, int, int] = (4, 4, 2),
        degree: int = 1,
        ramp_weight: float = 5.0,
        spectrum: str = "natural",
        target: str | None = None,
        certify: bool = False,
        progress: ProgressCallback | None = None,
        threads: int = 0,
    ) -> "SamplingTable":
        """Finds the sets of texels and the weights with the least errors (section 6.2).

        The error is the mean square of what samples are off, over images of a spectrum and over a
        subdomain. For "white" images, whose values have nothing to do with each other, that is the
        integral over the plane of the squared difference between the filter and the weighted sum of
        the texels' filters (equation 6.4). In "natural" ones the power falls with the square of the
        frequency, from 16 to 1/16 of a cell, so that slow differences count more. Sets are
        found by exchanging one texel at a time, from many starts, until no exchange helps. Where
        the finest of the levels is the image itself, that is, for two levels and for one, integrals
        are sums over its texels.

        Args:
            filter: A name of `SAMPLING_FILTERS`: what the levels are filtered with.
            texels: How many each sample reads, 2 to 16.
            subdomains: Parts of a cell along x, the same along y, and parts from level to level; 1
                to 16 each.
            degree: Of the weights, as polynomials of the place and the scale: 1 or 2.
            ramp_weight: How much it counts that ramps come out as they are, 0 to 10^6: the squared
                distance, in cells, between a sample and the weighted center of its texels is
                multiplied by it and added to what is minimized. With 0, that is the error alone,
                and samples of smooth images step where the set of texels changes.
            spectrum: "natural": what images are like, with edges and gradients. "white": noise, as
                in the dissertation.
            target: What samples are to be, a name of `SAMPLING_FILTERS`; None: the levels' filter.
                "box" is the mean over a pixel, to which tables with levels of "tent" come closer
                than those with levels of "box".
            certify: Whether to prove how far from the best the sets are at most, by branch and
                bound; `TableSection.gaps` then says so. Takes a second for the tent, minutes for
                Lanczos 2 with 8 texels, and up to half an hour where there is no proof in the end.
            progress: Called with the fraction done; may return False to stop.
            threads: How many to use; 0 = all processors. Results do not depend on it.

        Raises:
            ValueError: An argument is out of range.
            Cancelled: The progress callback returned False.
        """
        shape = set_options(_native.TableShape(), _CHECKS, locals())
        shape.grid, shape.slices = _as_subdomains(subdomains)
        return cls(
            _native.build_sampling_table(
                shape, bool(certify), as_progress(progress), as_threads(threads)
            )
        )

    @classmethod
    def standard(
        cls, filter: Kernel = "lanczos2", texels: int = 8, *, target: str | None = None
    ) -> "SamplingTable":
        """A table that comes with the package: `build` with its defaults has made it.

        Args:
            filter: A name of `SAMPLING_FILTERS`.
            texels: 4, 6 or 8.
            target: None, or with the filter "tent" also "box": the mean over a pixel.

        Raises:
            ValueError: There is no such table.
        """
        name = as_one_of("filter", as_name("filter", filter), SAMPLING_FILTERS)
        if texels not in STANDARD_TEXELS:
            raise ValueError(
                f"texels: {texels!r}; standard tables have 4, 6 or 8. SamplingTable.build makes "
                "others"
            )
        if target not in (None, name):
            if (name, target) not in STANDARD_TARGETS:
                raise ValueError(
                    f"target: {target!r} with levels of '{name}'; standard tables have 'box' with "
                    "levels of 'tent', else None. SamplingTable.build makes others"
                )
            name = f"{name}-{target}"
        file = resources.files(__package__) / "tables" / f"{name}-{int(texels)}.json"
        return cls(_parsed(file.read_bytes()))

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> "SamplingTable":
        """Reads a table that `save` has written.

        Raises:
            ValueError: The file holds no table, or one that no sample can be taken with.
            OSError: The file cannot be read.
        """
        source = as_path(path)
        with open_file(source) as file:
            data = file.read()
        try:
            return cls(_parsed(data))
        except ValueError as error:
            raise ValueError(f"path: '{source}' holds no sampling table: {error}") from error

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the table as a JSON file, in place of one that may be there.

        The object in it has the members "format" ("prefilter sampling table"), "version" (1),
        "filter", "texels", "subdomains", "degree", "ramp_weight", "spectrum" ("white" where it is
        absent), "target" (null: the filter itself), and "sections", a list of objects with the
        attributes of `TableSection`, for 3, 2 and 1 levels; "gaps" is null without a certificate.

        Raises:
            ValueError: That is no path.
            OSError: The file cannot be written.
        """
        target = as_target(path)
        text = _formatted(self)

        def write(file: BinaryIO) -> None:
            file.write(text.encode())

        write_output(target, write)

    @property
    def filter(self) -> str:
        """The name of the filter that the levels are to be made with."""
        return self._native.shape.filter

    @property
    def target(self) -> str:
        """The name of the filter that it reproduces: that of the levels, or another one."""
        return self._native.shape.target or self.filter

    @property
    def texels(self) -> int:
        """How many each sample reads."""
        return self._native.shape.texels

    @property
    def subdomains(self) -> tuple[int, int, int]:
        """Parts of a cell along x and y, and parts from level to level."""
        shape = self._native.shape
        return shape.grid, shape.grid, shape.slices

    @property
    def degree(self) -> int:
        """Of the weights, as polynomials of the place and the scale."""
        return self._native.shape.degree

    @property
    def ramp_weight(self) -> float:
        """How much it counted, when it was built, that ramps come out as they are."""
        return self._native.shape.ramp_weight

    @property
    def spectrum(self) -> str:
        """What it took images to be when it was built: "natural" or "white"."""
        return self._native.shape.spectrum

    @property
    def error_ratio(self) -> float:
        """The error as a share of trilinear interpolation's, where three levels are available.

        Both are integrals of equation 6.3, by the `spectrum`, over all places and scales, of
        filters of integral 1.
        """
        return self._native.error_ratio(3)

    @property
    def error_ratios(self) -> dict[int, float]:
        """`error_ratio` where three, two and one levels are available.

        Infinite where trilinear interpolation has no error and the table has one.
        """
        return {levels: self._native.error_ratio(levels) for levels in _LEVELS}

    @property
    def largest_jump(self) -> float:
        """The largest step of a sample across a border of subdomains, with three levels available.

        Sets of texels change from subdomain to subdomain, so samples are not quite continuous. This
        is the largest step there is for any image with values from 0 to 1: for the image that fits
        the difference of both sets' filters best. In photographs steps are far smaller.
        """
        return self._native.largest_jump(3)

    @property
    def largest_jumps(self) -> dict[int, float]:
        """`largest_jump` where three, two and one levels are available.

        The borders where one level more becomes available count for the fewer ones.
        """
        return {levels: self._native.largest_jump(levels) for levels in _LEVELS}

    @property
    def gaps(self) -> npt.NDArray[np.float64] | None:
        """`TableSection.gaps` where three levels are available."""
        return self.section(3).gaps

    def section(self, levels: int) -> TableSection:
        """The texels and weights where so many levels are available.

        Raises:
            ValueError: `levels` is not 1, 2 or 3.
        """
        if levels not in _LEVELS:
            raise ValueError(f"levels: {levels!r}; 1, 2 or 3 is needed")
        offsets, coefficients, errors, trilinear_errors, gaps = self._native.section(levels)
        certified = gaps if len(gaps) > 0 else None
        return TableSection(levels, offsets, coefficients, errors, trilinear_errors, certified)

    def glsl(self, *, name: str = "prefilter") -> str:
        """GLSL source that samples textures by this table, to be included in shaders.

        For GLSL 3.30 and ES 3.00, and later. It declares functions (`prefilter_sample`,
        `prefilter_mip_value`, `prefilter_pick`), constants and macros, and neither a version nor
        uniforms; a comment at its beginning describes them. Its use is free of any conditions.

        Args:
            name: What all its names begin with, macros in upper case, so that a shader can hold
                several tables. Letters, digits and single underscores, beginning with a letter.

        Raises:
            ValueError: That is no such name.
        """
        return gpu.glsl(self, name)

    def hlsl(self, *, name: str = "prefilter") -> str:
        """HLSL source for shader model 4.0 and later; see `glsl`."""
        return gpu.hlsl(self, name)

    def osl(self, *, name: str = "prefilter") -> str:
        """The source of an OSL shader, called `name`, that samples picture files by this table.

        One file holds one level; a comment at its beginning describes the shader's parameters. Its
        use is free of any conditions.

        Raises:
            ValueError: `name` is no name as `glsl` takes it.
        """
        return osl.osl(self, name)

    def __repr__(self) -> str:
        """What tells it from other tables."""
        of = self.filter if self.target == self.filter else f"{self.target} from {self.filter}"
        return (
            f"<SamplingTable {of}, {self.texels} texels, subdomains {self.subdomains}, "
            f"degree {self.degree}, ramp weight {self.ramp_weight:g}, {self.spectrum}>"
        )


def _as_subdomains(subdomains: tuple[int, int, int]) -> tuple[int, int]:
    allowed = "three whole numbers from 1 to 16, the first two equal, are needed"
    try:
        along_x, along_y, slices = subdomains
    except (TypeError, ValueError):
        raise ValueError(f"subdomains: {subdomains!r}; {allowed}") from None
    grid = as_int("subdomains", along_x, allowed)
    if as_int("subdomains", along_y, allowed) != grid:
        raise ValueError(f"subdomains: {subdomains!r}; {allowed}")
    return grid, as_int("subdomains", slices, allowed)


def _formatted(table: SamplingTable) -> str:
    """JSON with a line for each subdomain."""

    def rows(array: np.ndarray) -> str:
        lines = ",\n".join(f"   {json.dumps(row)}" for row in array.tolist())
        return f"[\n{lines}]"

    sections = []
    for levels in _LEVELS:
        section = table.section(levels)
        gaps = None if section.gaps is None else section.gaps.tolist()
        sections.append(
            f'  {{"levels": {levels},\n'
            f'  "offsets": {rows(section.offsets)},\n'
            f'  "coefficients": {rows(section.coefficients)},\n'
            f'  "errors": {json.dumps(section.errors.tolist())},\n'
            f'  "trilinear_errors": {json.dumps(section.trilinear_errors.tolist())},\n'
            f'  "gaps": {json.dumps(gaps)}}}'
        )
    head = {
        "format": _FORMAT,
        "version": _VERSION,
        "filter": table.filter,
        "texels": table.texels,
        "subdomains": list(table.subdomains),
        "degree": table.degree,
        "ramp_weight": table.ramp_weight,
        "spectrum": table.spectrum,
        "target": None if table.target == table.filter else table.target,
    }
    members = [f"{json.dumps(name)}: {json.dumps(value)}" for name, value in head.items()]
    joined = ",\n".join(sections)
    return "{" + ",\n ".join([*members, f'"sections": [\n{joined}]']) + "}\n"


def _parsed(data: bytes) -> _native.SamplingTable:
    """The table of a file's contents. Raises ValueError where they are none."""
    try:
        found = json.loads(data)
    except json.JSONDecodeError as error:
        raise ValueError(f"no JSON from line {error.lineno}, column {error.colno} on") from None
    except (UnicodeDecodeError, RecursionError):
        raise ValueError("it is no JSON") from None
    name = _member(found, "format", str)
    version = _member(found, "version", int)
    if (name, version) != (_FORMAT, _VERSION):
        raise ValueError(
            f"it is '{name}' of version {version}; '{_FORMAT}' of {_VERSION} is needed"
        )
    shape = _native.TableShape()
    shape.filter = _member(found, "filter", str)
    shape.texels = _count(found, "texels")
    shape.degree = _count(found, "degree")
    shape.grid, shape.slices = _as_subdomains(_member(found, "subdomains", list))
    shape.ramp_weight = as_number("ramp_weight", _member(found, "ramp_weight", int, float))
    # Files of before there was a choice have neither.
    shape.spectrum = _member({"spectrum": "white", **found}, "spectrum", str)
    shape.target = _member({"target": None, **found}, "target", str, type(None)) or ""
    sections = _member(found, "sections", list)
    if len(sections) != len(_LEVELS):
        raise ValueError(f"sections: found {len(sections)}; {len(_LEVELS)} are needed")
    return _native.SamplingTable(
        shape,
        tuple(
            _section(section, levels, shape.texels)
            for section, levels in zip(sections, _LEVELS, strict=True)
        ),
    )


def _section(found: Any, levels: int, texels: int) -> tuple[np.ndarray, ...]:
    if _member(found, "levels", int) != levels:
        raise ValueError(f"levels: found {found['levels']}, in the place of {levels}")
    offsets = _array(found, "offsets")
    if not np.array_equal(offsets, np.rint(offsets)) or np.abs(offsets).max(initial=0) > 2**15:
        raise ValueError("offsets: small whole numbers are needed")
    if offsets.ndim != 3 or offsets.shape[1:] != (texels, 3):
        raise ValueError(f"offsets: shape {offsets.shape}; (subdomains, {texels}, 3) is needed")
    errors = [_array(found, name) for name in ("errors", "trilinear_errors")]
    gaps = np.zeros(0) if found.get("gaps") is None else _array(found, "gaps")
    return (offsets.astype(np.int32), _array(found, "coefficients"), *errors, gaps)


def _array(found: Any, name: str) -> npt.NDArray[np.float64]:
    try:
        array = np.array(_member(found, name, list), np.float64)
    except (TypeError, ValueError, OverflowError):
        raise ValueError(f"{name}: lists of numbers, of equal lengths, are needed") from None
    if not np.isfinite(array).all():
        raise ValueError(f"{name}: a value is not finite")
    return array


def _count(found: Any, name: str) -> int:
    return as_int(name, _member(found, name, int), "a small whole number is needed")


def _member(found: Any, name: str, *kinds: type) -> Any:
    if not isinstance(found, dict) or name not in found:
        raise ValueError(f"it has no '{name}'")
    value = found[name]
    if not isinstance(value, kinds):
        allowed = " or ".join(kind.__name__ for kind in kinds)
        raise ValueError(f"'{name}' is a {type(value).__name__}; a {allowed} is needed")
    return value
