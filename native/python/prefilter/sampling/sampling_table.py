# SPDX-License-Identifier: GPL-3.0-or-later

"""Sampling tables, which reproduce a filter with few texels (chapter 6)."""

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
"""Numbers of texels of the tables that come with the package, one table for each filter."""

STANDARD_TARGETS = (("tent", "box"),)
"""Pairs of level filter and target that the package has tables for, too."""

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
    """The sets of texels and their weights, for a number of available levels.

    A sample lies in a cell, a texel of the coarser one of the two levels around its mip value. Its
    position (x, y) in the cell is folded by the symmetries of the square to 0 <= y <= x <= 1/2; f
    is the distance of the mip value from the finer level, 0 to 1. The filter is 2^(f - 1) cells
    wide. If only one level is available, the cell is a texel of level 0, the filter is one cell
    wide, and f is x y.

    Subdomain (i, j, k) begins at x = i / J, y = j / J and f = k / K, for subdomains (J, J, K);
    they are numbered k c (c + 1) / 2 + i (i + 1) / 2 + j with c = (J + 1) // 2 and j <= i < c.

    Attributes:
        levels: Number of available levels: the cell's and finer ones.
        offsets: (subdomains, texels, 3) integers: for each texel, the number of levels below the
            cell's, and its column and row there, from the cell's low corner. Texels within the cell
            have 0 to 2^below - 1.
        coefficients: (subdomains, texels, terms), coefficients of the weights, polynomials in x, y
            and f with the terms 1, x, y, f, and for degree 2 also xx, yy, ff, xy, xf, yf.
        errors: (subdomains): equation 6.3, with the table's `spectrum`, integrated over the
            subdomain.
        trilinear_errors: The same for trilinear interpolation.
        gaps: (subdomains): largest relative improvement of the objective of `build` that another
            set may achieve; 0 if the set is proven optimal. None for tables without certificate.
    """

    levels: int
    offsets: npt.NDArray[np.int32]
    coefficients: npt.NDArray[np.float64]
    errors: npt.NDArray[np.float64]
    trilinear_errors: npt.NDArray[np.float64]
    gaps: npt.NDArray[np.float64] | None


class SamplingTable:
    """Sets of few texels, and their weights, that reproduce a filter at any position and scale.

    Use `build`, `load` or `standard` to make one, not the constructor.

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

        The error is the mean square error of samples, over images of a spectrum and over a
        subdomain. For "white" images, whose values are independent, that is the integral over the
        plane of the squared difference between the filter and the weighted sum of the texels'
        filters (equation 6.4). The power of "natural" images falls with the square of the
        frequency, from 16 to 1/16 of a cell, so that low frequencies have more weight. Sets are
        found by exchanging one texel at a time, from many starts, until no exchange helps. Where
        the finest level is the image itself, that is, with two levels or one, integrals are sums
        over its texels.

        Args:
            filter: A name of `SAMPLING_FILTERS`: the filter of the levels.
            texels: Number of texels per sample, 2 to 16.
            subdomains: Parts of a cell along x, the same along y, and parts from level to level; 1
                to 16 each.
            degree: Degree of the weights, polynomials of position and scale: 1 or 2.
            ramp_weight: Weight of the reproduction of ramps, 0 to 10^6: multiplies the squared
                distance, in cells, between a sample and the weighted center of its texels, which is
                added to the objective. With 0, the objective is the error alone, and samples of
                smooth images jump where the set of texels changes.
            spectrum: "natural": images with edges and gradients. "white": noise, as in the
                dissertation.
            target: The filter to reproduce, a name of `SAMPLING_FILTERS`; None: the levels' filter.
                "box" is the mean over a pixel, which tables with levels of "tent" approximate
                better than tables with levels of "box".
            certify: Whether to bound the distance of the sets from the optimum, by branch and
                bound; see `TableSection.gaps`. Takes a second for the tent, minutes for Lanczos 2
                with 8 texels, and up to half an hour if there is no proof in the end.
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
        """A table that comes with the package, made by `build` with its defaults.

        Args:
            filter: A name of `SAMPLING_FILTERS`.
            texels: 4, 6 or 8.
            target: None, or with the filter "tent" also "box": the mean over a pixel.

        Raises:
            ValueError: There is no such table.
            FileNotFoundError: The table of a new filter has not been made yet.
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
        try:
            text = file.read_bytes()
        except FileNotFoundError as error:
            raise FileNotFoundError(
                f"sampling table '{file.name}': missing; scripts/sampling_tables.py makes it"
            ) from error
        return cls(_parsed(text))

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> "SamplingTable":
        """Reads a table written by `save`.

        Raises:
            ValueError: The file holds no valid table.
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
        """Writes the table as a JSON file, replacing an earlier one.

        Its object has the members "format" ("prefilter sampling table"), "version" (1), "filter",
        "texels", "subdomains", "degree", "ramp_weight", "spectrum" ("white" if absent), "target"
        (null: the filter itself), and "sections", a list of objects with the attributes of
        `TableSection`, for 3, 2 and 1 levels; "gaps" is null without a certificate.

        Raises:
            ValueError: The argument is no path.
            OSError: The file cannot be written.
        """
        target = as_target(path)
        text = _formatted(self)

        def write(file: BinaryIO) -> None:
            file.write(text.encode())

        write_output(target, write)

    @property
    def filter(self) -> str:
        """The name of the filter of the levels."""
        return self._native.shape.filter

    @property
    def target(self) -> str:
        """The name of the filter that is reproduced, which may differ from that of the levels."""
        return self._native.shape.target or self.filter

    @property
    def texels(self) -> int:
        """Number of texels per sample."""
        return self._native.shape.texels

    @property
    def subdomains(self) -> tuple[int, int, int]:
        """Parts of a cell along x and y, and parts from level to level."""
        shape = self._native.shape
        return shape.grid, shape.grid, shape.slices

    @property
    def degree(self) -> int:
        """Degree of the weights, polynomials of position and scale."""
        return self._native.shape.degree

    @property
    def ramp_weight(self) -> float:
        """Weight of the reproduction of ramps when it was built."""
        return self._native.shape.ramp_weight

    @property
    def spectrum(self) -> str:
        """Spectrum of images assumed when it was built: "natural" or "white"."""
        return self._native.shape.spectrum

    @property
    def error_ratio(self) -> float:
        """The error divided by that of trilinear interpolation, with three levels available.

        Both are integrals of equation 6.3, with the `spectrum`, over all positions and scales, for
        filters of integral 1.
        """
        return self._native.error_ratio(3)

    @property
    def error_ratios(self) -> dict[int, float]:
        """`error_ratio` with three, two and one levels available.

        Infinite if only trilinear interpolation has no error.
        """
        return {levels: self._native.error_ratio(levels) for levels in _LEVELS}

    @property
    def largest_jump(self) -> float:
        """The largest jump of a sample across a border of subdomains, with three levels available.

        The set of texels changes between subdomains, so samples are not quite continuous. This is
        the largest jump for any image with values from 0 to 1, that is for the image that matches
        the difference of both sets' filters. In photographs jumps are far smaller.
        """
        return self._native.largest_jump(3)

    @property
    def largest_jumps(self) -> dict[int, float]:
        """`largest_jump` with three, two and one levels available.

        Borders where the number of levels changes count for the smaller number.
        """
        return {levels: self._native.largest_jump(levels) for levels in _LEVELS}

    @property
    def gaps(self) -> npt.NDArray[np.float64] | None:
        """`TableSection.gaps` with three levels available."""
        return self.section(3).gaps

    def section(self, levels: int) -> TableSection:
        """The texels and weights for a number of available levels.

        Raises:
            ValueError: `levels` is not 1, 2 or 3.
        """
        if levels not in _LEVELS:
            raise ValueError(f"levels: {levels!r}; 1, 2 or 3 is needed")
        offsets, coefficients, errors, trilinear_errors, gaps = self._native.section(levels)
        certified = gaps if len(gaps) > 0 else None
        return TableSection(levels, offsets, coefficients, errors, trilinear_errors, certified)

    def glsl(self, *, name: str = "prefilter") -> str:
        """GLSL source that samples textures by this table, for inclusion in shaders.

        For GLSL 3.30 and ES 3.00, and later. It declares functions (`prefilter_sample`,
        `prefilter_mip_value`, `prefilter_pick`), constants and macros, and neither a version nor
        uniforms; a comment at its beginning describes them. Its use is free of any conditions.

        Args:
            name: Prefix of all its names, macros in upper case, so that a shader can include
                several tables. Letters, digits and single underscores, beginning with a letter.

        Raises:
            ValueError: The name is not allowed.
        """
        return gpu.glsl(self, name)

    def hlsl(self, *, name: str = "prefilter") -> str:
        """HLSL source for shader model 4.0 and later; see `glsl`."""
        return gpu.hlsl(self, name)

    def osl(self, *, name: str = "prefilter") -> str:
        """OSL source of a shader, called `name`, that samples picture files by this table.

        One file holds one level; a comment at its beginning describes the shader's parameters. Its
        use is free of any conditions.

        Raises:
            ValueError: The name is not allowed; see `glsl`.
        """
        return osl.osl(self, name)

    def __repr__(self) -> str:
        """The parameters of the table."""
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
    """Returns JSON with a line for each subdomain."""

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
    """Parses a file's contents. Raises ValueError if they are no table."""
    try:
        table = json.loads(data)
    except json.JSONDecodeError as error:
        raise ValueError(f"no JSON from line {error.lineno}, column {error.colno} on") from None
    except (UnicodeDecodeError, RecursionError):
        raise ValueError("it is no JSON") from None
    name = _member(table, "format", str)
    version = _member(table, "version", int)
    if (name, version) != (_FORMAT, _VERSION):
        raise ValueError(
            f"it is '{name}' of version {version}; '{_FORMAT}' of {_VERSION} is needed"
        )
    shape = _native.TableShape()
    shape.filter = _member(table, "filter", str)
    shape.texels = _count(table, "texels")
    shape.degree = _count(table, "degree")
    shape.grid, shape.slices = _as_subdomains(_member(table, "subdomains", list))
    shape.ramp_weight = as_number("ramp_weight", _member(table, "ramp_weight", int, float))
    # Absent in files from before these parameters existed.
    shape.spectrum = _member({"spectrum": "white", **table}, "spectrum", str)
    shape.target = _member({"target": None, **table}, "target", str, type(None)) or ""
    sections = _member(table, "sections", list)
    if len(sections) != len(_LEVELS):
        raise ValueError(f"sections: found {len(sections)}; {len(_LEVELS)} are needed")
    return _native.SamplingTable(
        shape,
        tuple(
            _section(section, levels, shape.texels)
            for section, levels in zip(sections, _LEVELS, strict=True)
        ),
    )


def _section(section: Any, levels: int, texels: int) -> tuple[np.ndarray, ...]:
    if _member(section, "levels", int) != levels:
        raise ValueError(f"levels: found {section['levels']}, in the place of {levels}")
    offsets = _array(section, "offsets")
    if not np.array_equal(offsets, np.rint(offsets)) or np.abs(offsets).max(initial=0) > 2**15:
        raise ValueError("offsets: small whole numbers are needed")
    if offsets.ndim != 3 or offsets.shape[1:] != (texels, 3):
        raise ValueError(f"offsets: shape {offsets.shape}; (subdomains, {texels}, 3) is needed")
    errors = [_array(section, name) for name in ("errors", "trilinear_errors")]
    gaps = np.zeros(0) if section.get("gaps") is None else _array(section, "gaps")
    return (offsets.astype(np.int32), _array(section, "coefficients"), *errors, gaps)


def _array(json_object: Any, name: str) -> npt.NDArray[np.float64]:
    try:
        array = np.array(_member(json_object, name, list), np.float64)
    except (TypeError, ValueError, OverflowError):
        raise ValueError(f"{name}: lists of numbers, of equal lengths, are needed") from None
    if not np.isfinite(array).all():
        raise ValueError(f"{name}: a value is not finite")
    return array


def _count(json_object: Any, name: str) -> int:
    return as_int(name, _member(json_object, name, int), "a small whole number is needed")


def _member(json_object: Any, name: str, *kinds: type) -> Any:
    if not isinstance(json_object, dict) or name not in json_object:
        raise ValueError(f"it has no '{name}'")
    value = json_object[name]
    if not isinstance(value, kinds):
        allowed = " or ".join(kind.__name__ for kind in kinds)
        raise ValueError(f"'{name}' is a {type(value).__name__}; a {allowed} is needed")
    return value
