"""Alpha-tested cut-outs: levels that keep as much of the surface as the image does."""

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np
import numpy.typing as npt

from . import _native
from ._border.arguments import ProgressCallback, Wrap, as_progress, as_wrap
from ._border.arrays import FloatArray, as_image, as_threads
from .surface import Surface, as_surfaces
from .texture_use import texel_weights

_TOLERANCE = 1e-3
_SAMPLES = 8  # Lookups along each side of a texel, at least.
_FINEST_GRID = 4096
_COARSEST_GRID = 512
_HALVINGS = 14
_SMALLEST_BEND = 2.0**-_HALVINGS
_ROOM = (1 / 16, 1 / 64, 1 / 256)  # Of the bend, from a jump of the share.


def keep_coverage(
    levels: Sequence[npt.ArrayLike],
    surface: Surface | Sequence[Surface] | None = None,
    *,
    threshold: float = 0.5,
    wrap: Wrap = "clamp",
    premultiplied: bool = False,
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> list[FloatArray]:
    """Levels whose alpha test keeps the share of the surface that level 0's keeps.

    A cut-out shows where a lookup's alpha is at least a threshold. Filtered alpha drifts to its
    mean, so that leaves and fences get thinner or thicker level by level. Here the alpha of each
    level is mapped by a curve that rises, of two straight pieces: 0 and 1 stay, and some value goes
    to the threshold: that which gives the coverage of level 0. Where even the smallest such value
    shows too little, as with thresholds near 1, alpha of 0 rises too, but not to the threshold.

    Coverage is the share of the surface's area, or of the image where there is no surface, where a
    bilinear lookup's alpha is at least the threshold. A level that has it within 0.001 stays as it
    is; others get it as closely as they can: one of few texels may have to show all or nothing.

    Args:
        levels: Level 0 first, as `mipmaps` returns them: (height, width, 4) with alpha as the
            fourth channel, or (height, width, 1), which is alpha.
        surface: One surface, or several that share the image.
        threshold: The alpha that is still shown; above 0, at most 1.
        wrap: As for `mipmaps`.
        premultiplied: Whether colours are multiplied by alpha; then they change along with it.
        progress: As for `mipmaps`.
        threads: As for `mipmaps`.

    Returns:
        The levels, float32; level 0 is a copy.

    Raises:
        ValueError: An argument is out of range, or alpha is not finite in a level above 0.
        Cancelled: The progress callback returned False.
    """
    images = _as_levels(levels)
    limit = _as_threshold(threshold)
    modes, count = as_wrap(wrap), as_threads(threads)
    report = as_progress(progress)
    grid = _area_grid(images[0].shape[1::-1], surface, modes, report, count)

    def share(grid: FloatArray, done: float, alpha: FloatArray) -> float:
        # How many of these a level takes is not known before: progress rises between levels.
        hold = None if report is None else lambda _: report(done)
        cells = np.array(grid.shape[1::-1])
        samples = -(-_SAMPLES * np.array(alpha.shape[1::-1]) // cells).max()
        return _native.covered_share(alpha, grid, max(1, int(samples)), limit, modes, hold, count)

    wanted = share(grid, 0.3, _alpha(images[0]))
    kept = [images[0].copy()]
    done = 0.4
    for image in images[1:]:
        grid = _coarser(grid, image.shape[1::-1])
        kept.append(_kept(image, limit, wanted, partial(share, grid, done), premultiplied))
        # A level has a quarter of the texels of the one before.
        done += 0.75 * (1 - done)
    if report is not None and report(1.0) is False:
        raise _native.Cancelled("cancelled")
    return kept


def _kept(
    image: FloatArray,
    threshold: float,
    wanted: float,
    share: Callable[[FloatArray], float],
    premultiplied: bool,
) -> FloatArray:
    alpha = np.clip(_alpha(image), 0, 1)
    kept = image.copy()
    found = share(alpha)
    if abs(found - wanted) > _TOLERANCE:
        bend = _bend(found, wanted, threshold, lambda bend: share(_bent(alpha, bend, threshold)))
        kept[..., -1:] = _bent(alpha, bend, threshold)
        if premultiplied and image.shape[2] > 1:
            kept[..., :-1] *= kept[..., -1:] / np.where(alpha > 0, alpha, 1)
    return kept


def _bent(alpha: FloatArray, bend: float, threshold: float) -> FloatArray:
    """Alpha on a curve through (0, 0), (bend, threshold) and (1, 1).

    Below 0, where all alpha but 0 is above the threshold, 0 rises: to the threshold at -1.
    """
    q = min(max(bend, _SMALLEST_BEND), 1 - _SMALLEST_BEND)
    below = alpha * (threshold / q)
    above = 1 - (1 - alpha) * ((1 - threshold) / (1 - q))
    bent = np.where(alpha <= q, below, above)
    return np.maximum(bent, -bend * threshold).astype(np.float32)


def _bend(found: float, wanted: float, threshold: float, share: Callable[[float], float]) -> float:
    """The bend that gives the share wanted. The threshold itself bends nothing, and gives `found`.

    The share falls as the bend rises. It may jump over what is wanted: then the closer side of the
    jump is taken, and left some room, so that the rounding of a byte image tips no texel.
    """
    ends = [-1.0, threshold] if found < wanted else [threshold, 1.0]
    shares = [1.0, found] if found < wanted else [found, share(1.0)]
    for _ in range(_HALVINGS):
        middle = sum(ends) / 2
        reached = share(middle)
        if abs(reached - wanted) <= _TOLERANCE:
            return middle
        side = 0 if reached > wanted else 1
        ends[side], shares[side] = middle, reached
    side = int(abs(shares[1] - wanted) < abs(shares[0] - wanted))
    away = (-1, 1)[side]
    for room in _ROOM:
        bend = min(max(ends[side] + away * room, -1.0), 1.0)
        if abs(share(bend) - shares[side]) <= _TOLERANCE:
            return bend
    return ends[side]


def _area_grid(
    size: Sequence[int],
    surface: Surface | Sequence[Surface] | None,
    wrap: tuple[str, str],
    progress: ProgressCallback | None,
    threads: int,
) -> FloatArray:
    """The surface's area in each cell of a grid over the texture, whose sides are powers of two."""
    width, height = (
        min(max(1 << (side - 1).bit_length(), _COARSEST_GRID), _FINEST_GRID) for side in size
    )
    if surface is None or not as_surfaces(surface):
        return np.ones((height, width, 1), np.float32)
    share = None if progress is None else lambda fraction: progress(0.3 * fraction)
    weights = texel_weights(surface, width, height, wrap=wrap, progress=share, threads=threads)
    return weights[..., None]


def _coarser(grid: FloatArray, size: Sequence[int]) -> FloatArray:
    """The grid as coarse as a level of that size allows."""
    for axis, side in ((1, size[0]), (0, size[1])):
        while grid.shape[axis] // 2 >= max(_SAMPLES * side, _COARSEST_GRID):
            halves = np.moveaxis(grid, axis, 0)
            grid = np.ascontiguousarray(np.moveaxis(halves[::2] + halves[1::2], 0, axis))
    return grid


def _alpha(image: FloatArray) -> FloatArray:
    return np.ascontiguousarray(image[..., -1:])


def _as_levels(levels: Sequence[npt.ArrayLike]) -> list[FloatArray]:
    if not isinstance(levels, Sequence) or not levels:
        found = "an empty list" if isinstance(levels, Sequence) else f"a {type(levels).__name__}"
        raise ValueError(f"levels: {found}; a list of arrays, level 0 first, is needed")
    images = [as_image(f"levels: level {k}", level) for k, level in enumerate(levels)]
    channels = images[0].shape[2]
    for number, image in enumerate(images):
        if image.shape[2] not in (1, 4) or image.shape[2] != channels:
            raise ValueError(
                f"levels: level {number} has {image.shape[2]} channels; all need 4, the last of "
                f"them alpha, or all 1"
            )
        if number > 0 and not np.isfinite(image[..., -1]).all():
            raise ValueError(f"levels: level {number} holds alpha that is not finite")
    return images


def _as_threshold(threshold: float) -> float:
    is_number = isinstance(threshold, int | float | np.number) and not isinstance(threshold, bool)
    if not is_number or not 0 < threshold <= 1:
        raise ValueError(f"threshold: {threshold!r}; a number above 0 and at most 1 is needed")
    return float(threshold)
