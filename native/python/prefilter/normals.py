"""Mipmaps of normal maps, and the roughness that takes what averaging normals loses."""

import re
from collections.abc import Iterator, Sequence
from typing import cast, overload

import numpy as np
import numpy.typing as npt

from . import _native
from ._border.arguments import ProgressCallback, Wrap, as_progress, as_wrap
from ._border.arrays import FloatArray, as_image, as_threads, check_shape
from .mipmap import mipmaps
from .surface import Surface, as_surfaces
from .texture_use import fill_unused, texel_weights

# A texel of neutral grey decodes to a vector of this length at most, for 8 bits a channel.
_NO_DIRECTION = 0.02

_TEXELS_A_BAND = 1 << 17

_MEANS = {
    "pam-bilinear": "pam-box",
    "pam-trilinear": "pam-box",
    "pam-box": "pam-box",
    "box-covered": "box-covered",
    "tent-covered": "box-covered",
    "lanczos3-covered": "box-covered",
}


@overload
def normal_mipmaps(
    normals: npt.ArrayLike,
    surface: Surface | Sequence[Surface] | None = None,
    *,
    roughness: None = None,
    filter: str = "pam-bilinear",
    wrap: Wrap = "clamp",
    encoded: bool = True,
    levels: int | None = None,
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> list[FloatArray]: ...
@overload
def normal_mipmaps(
    normals: npt.ArrayLike,
    surface: Surface | Sequence[Surface] | None = None,
    *,
    roughness: npt.ArrayLike,
    filter: str = "pam-bilinear",
    wrap: Wrap = "clamp",
    encoded: bool = True,
    levels: int | None = None,
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> tuple[list[FloatArray], list[FloatArray]]: ...
def normal_mipmaps(
    normals: npt.ArrayLike,
    surface: Surface | Sequence[Surface] | None = None,
    *,
    roughness: npt.ArrayLike | None = None,
    filter: str = "pam-bilinear",
    wrap: Wrap = "clamp",
    encoded: bool = True,
    levels: int | None = None,
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> list[FloatArray] | tuple[list[FloatArray], list[FloatArray]]:
    """The levels of a normal map: filtered as vectors, and of length 1 again.

    Where the normals under a texel differ, their mean is shorter than 1, and the surface looks
    rougher from afar. With a roughness, that goes into its levels: if L is the length of the mean
    of the normals in a texel, the texel gets

        alpha^2 = (mean of alpha^2) + 2 (1 - L),    alpha = roughness^2,    at most 1.

    The normals are taken for a von Mises-Fisher distribution. Its mean has the length
    L = coth k - 1 / k, so its concentration k is 1 / (1 - L) but for e^(-2 k), and it spreads as
    much as a lobe with alpha^2 = 2 / k. Squares of widths add up, as in LEAN mapping.

    The convention, OpenGL or DirectX, does not matter: levels have that of the map.

    Args:
        normals: (height, width, 3). Tangent or object space. Lengths count for nothing; a vector
            that is shorter than 0.02 has no direction, and is taken for (0, 0, 1).
        surface: As for `mipmaps`.
        roughness: None, a number, or (height, width, 1) of the size of the normals, as the
            Principled BSDF takes it; clamped to [0, 1].
        filter: As for `mipmaps`, for the normals. The means for the roughness are over a texel's
            surface ("pam-box") for the "pam-" filters, and else those of "box" or "box-covered".
        wrap: As for `mipmaps`.
        encoded: Whether a component c is stored as (c + 1) / 2, in the map and in the levels.
        levels: As for `mipmaps`.
        progress: As for `mipmaps`.
        threads: As for `mipmaps`.

    Returns:
        The levels of the normals, level 0 as it was given; with a roughness, a pair of them and the
        levels of the roughness.

    Raises:
        ValueError: An argument is out of range, or a texel that counts is not finite.
        Cancelled: The progress callback returned False.
    """
    image = as_image("normals", normals)
    check_shape("normals", image, ("height", "width", 3))
    rough = None if roughness is None else _as_roughness(roughness, image.shape[:2])
    report = as_progress(progress)
    share = 1.0 if rough is None else 0.5
    vectors = _decoded(image, encoded, _part(report, 0.0, 0.2 * share))
    try:
        directions = cast(
            "list[FloatArray]",
            mipmaps(
                vectors,
                surface,
                filter=filter,
                wrap=wrap,
                bounds=None,
                levels=levels,
                progress=_part(report, 0.2 * share, share),
                threads=threads,
            ),
        )
    except ValueError as error:
        raise ValueError(re.sub("^image:", "normals:", str(error))) from error
    made = [image.copy()]
    for level in directions[1:]:
        above = _above(level, vectors, surface, wrap, _held(report, share), threads)
        unit = np.empty_like(level)
        for band in _bands(level.shape, _held(report, share)):
            unit[band] = _unit(above[band])
        made.append((unit + 1) / 2 if encoded else unit)
    del directions
    if rough is None:
        return made

    filled, mean = rough, _MEANS.get(filter, "box")
    if mean != "box":
        vectors, filled = (
            fill_unused(image, as_surfaces(surface), wrap=wrap, progress=part, threads=threads)
            for image, part in (
                (vectors, _part(report, 0.5, 0.58)),
                (rough, _part(report, 0.58, 0.65)),
            )
        )
    _check_finite("roughness", filled)
    shown = _native.lookup_means(
        vectors,
        np.clip(filled, 0, 1),
        as_wrap(wrap),
        _NO_DIRECTION,
        _part(report, 0.65, 0.8),
        as_threads(threads),
    )
    means = cast(
        "list[FloatArray]",
        mipmaps(
            shown,
            surface,
            filter=mean,
            wrap=wrap,
            bounds=None,
            levels=levels,
            premultiplied=True,
            progress=_part(report, 0.8, 0.95),
            threads=threads,
        ),
    )
    rougher = [rough.copy()]
    for level in means[1:]:
        rougher.append(np.empty((*level.shape[:2], 1), np.float32))
        for band in _bands(level.shape, _held(report, 0.95)):
            rougher[-1][band] = _roughness_of(level[band])
    if report is not None and report(1.0) is False:
        raise _native.Cancelled("cancelled")
    return made, rougher


def _as_roughness(roughness: npt.ArrayLike, size: tuple[int, int]) -> FloatArray:
    if np.ndim(roughness) == 0:
        number = np.asarray(roughness)
        if number.dtype.kind not in "fiu" or not 0 <= number <= 1:
            raise ValueError(f"roughness: {roughness!r}; a number in [0, 1] or an image is needed")
        return np.full((*size, 1), number, np.float32)
    image = as_image("roughness", roughness)
    check_shape("roughness", image, (*size, 1))
    return image


def _unit(vectors: np.ndarray) -> FloatArray:
    """The vectors with length 1; those that are not finite become NaN."""
    with np.errstate(over="ignore", invalid="ignore"):
        lengths = np.linalg.norm(vectors.astype(np.float64), axis=2, keepdims=True)
        unit = vectors / np.maximum(lengths, _NO_DIRECTION)
    unit[lengths[..., 0] < _NO_DIRECTION] = (0, 0, 1)
    return np.asarray(unit, np.float32)


def _decoded(image: FloatArray, encoded: bool, progress: ProgressCallback | None) -> FloatArray:
    vectors = np.empty_like(image)
    for band in _bands(image.shape, progress):
        vectors[band] = _unit(2 * image[band] - 1 if encoded else image[band])
    return vectors


def _roughness_of(means: FloatArray) -> FloatArray:
    """Roughness from the mean difference of unit normals to (0, 0, 1), and the mean alpha^2.

    A unit vector n differs from (0, 0, 1) by d with |d|^2 = -2 d_z. So the variance of the normals,
    1 - L^2, is -2 E[d_z] - |E[d]|^2.
    """
    values = means.astype(np.float64)
    variance = -2 * values[..., 2:3] - (values[..., :3] ** 2).sum(axis=2, keepdims=True)
    variance = np.clip(variance, 0, 1)
    lost = variance / (1 + np.sqrt(1 - variance))  # 1 - L, without cancellation.
    return np.asarray(np.clip(values[..., 3:] + 2 * lost, 0, 1) ** 0.25, np.float32)


def _above(
    level: FloatArray,
    vectors: FloatArray,
    surface: Surface | Sequence[Surface] | None,
    wrap: Wrap,
    progress: ProgressCallback | None,
    threads: int,
) -> FloatArray:
    """The level without what least squares overshoot: z below 0 where the map has none."""
    if level[..., 2].min() >= 0:
        return level
    below = vectors[..., 2] < 0
    if below.any() and surface is not None:
        height, width = below.shape
        weights = texel_weights(
            surface, width, height, wrap=wrap, progress=progress, threads=threads
        )
        below &= weights > 0
    lowest = np.array((-np.inf, -np.inf, 0), np.float32)
    return level if below.any() else np.maximum(level, lowest)


def _held(progress: ProgressCallback | None, fraction: float) -> ProgressCallback | None:
    return None if progress is None else lambda _: progress(fraction)


def _check_finite(name: str, image: FloatArray) -> None:
    bad = np.argwhere(~np.isfinite(image))
    if len(bad):
        row, column, _ = bad[0]
        raise ValueError(
            f"{name}: the texel in row {row}, column {column} holds {image[row, column, 0]}; "
            f"texels that count must be finite"
        )


def _bands(shape: tuple[int, ...], progress: ProgressCallback | None) -> Iterator[slice]:
    """Rows that are quick to work on, with the progress told between them."""
    rows = max(1, _TEXELS_A_BAND // shape[1])
    for start in range(0, shape[0], rows):
        if progress is not None and progress(start / shape[0]) is False:
            raise _native.Cancelled("cancelled")
        yield slice(start, min(start + rows, shape[0]))


def _part(progress: ProgressCallback | None, start: float, end: float) -> ProgressCallback | None:
    if progress is None:
        return None
    return lambda fraction: progress(start + (end - start) * fraction)
