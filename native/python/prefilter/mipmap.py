"""Mipmaps of a texture on a surface (chapter 7)."""

from collections.abc import Callable, Sequence

import numpy as np
import numpy.typing as npt

from . import _native
from .arrays import FloatArray, as_image, as_threads
from .surface import Surface

ProgressCallback = Callable[[float], bool | None]
Wrap = str | tuple[str, str]
Bounds = tuple[float | None, float | None]


def mipmaps(
    image: npt.ArrayLike,
    surface: Surface | Sequence[Surface] | None = None,
    *,
    filter: str = "pam-bilinear",
    wrap: Wrap = "clamp",
    bounds: Bounds | None = (0.0, 1.0),
    levels: int | None = None,
    premultiplied: bool = False,
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> list[FloatArray]:
    """The levels of an image's mipmap, each right for the surface that wears it.

    "pam-bilinear" minimises, level by level, the integral over the surface of the squared
    difference between a bilinear lookup of the level and one of the image (section 7.3), within
    the bounds. "pam-box" takes means over the surface (equation 7.1). The other filters work in
    texture space: "box", "tent", "lanczos3", and with "-covered" behind them the same over texels
    that some triangle touches. Texels that the surface does not read have no influence on the
    "pam-" and "-covered" filters; they are filled from what is around them (push-pull).

    Args:
        image: (height, width, 1 to 4 channels), scene-linear, row 0 at v = 0. Sides are powers of
            two, at least 2.
        surface: One surface, or several that share the image. Not needed for the plain filters.
        filter: One of the names above.
        wrap: What lookups read outside of the image: "clamp", "repeat" or "border" (zero, and
            surface outside of the unit square weighs nothing), or a pair of these for u and v.
        bounds: (low, high) that texels of the levels may take; either may be None, and None stands
            for both. "pam-bilinear" solves under them, the other filters are clipped.
        levels: How many levels to return, level 0 included; None = down to 1 x 1.
        premultiplied: Whether the colours of a 4-channel image are multiplied by alpha already, or
            its fourth channel is no coverage: then every channel is filtered as it stands.
            Otherwise they are multiplied for filtering and divided afterwards.
        progress: Called with the fraction done, in [0, 1]; may return False to stop.
        threads: How many to use; 0 = all processors. Results do not depend on it.

    Returns:
        The levels, float32 (height, width, channels), level 0 first; it is a copy of the image.
        Each has half the sides of the one before, never less than 1.

    Raises:
        ValueError: An argument is out of range, or a texel that counts is not finite.
        Cancelled: The progress callback returned False.
    """
    low, high = _bounds(bounds)
    return _native.mipmaps(
        as_image("image", image),
        _surfaces(surface),
        _name("filter", filter),
        _wrap(wrap),
        low,
        high,
        _level_count(levels),
        bool(premultiplied),
        _progress(progress),
        as_threads(threads),
    )


def mipmap_error(
    levels: Sequence[npt.ArrayLike],
    image: npt.ArrayLike,
    surface: Surface | Sequence[Surface],
    mip_values: npt.ArrayLike,
    *,
    wrap: Wrap = "clamp",
    progress: ProgressCallback | None = None,
    threads: int = 0,
) -> npt.NDArray[np.float64]:
    """How far a mipmap is from its image over the surface, at any mip value (figure 7.7).

    The root mean square, over the surface's area and the channels, of the difference between a
    trilinear lookup of the levels and a bilinear lookup of the image. It is exact: the integrals
    come from moments, not from samples.

    Args:
        levels: Level 0 first, sizes as `mipmaps` returns them; coarse ones may be left out.
        image: The image that they stand for.
        surface: One surface, or several that share the image.
        mip_values: Numbers of any shape; 0 is the first level. Those below 0 or past the last level
            read the nearest one, as on a GPU.
        wrap: As for `mipmaps`.
        progress: As for `mipmaps`.
        threads: As for `mipmaps`.

    Returns:
        The error at each mip value, float64, in the shape of `mip_values`.

    Raises:
        ValueError: An argument is out of range, or a texel that the surface reads is not finite.
        Cancelled: The progress callback returned False.
    """
    try:
        values = np.asarray(mip_values, np.float64)
    except (TypeError, ValueError) as error:
        raise ValueError(f"mip_values: numbers are needed: {error}") from error
    if not isinstance(levels, Sequence):
        raise ValueError(f"levels: a {type(levels).__name__}; a list of arrays is needed")
    errors = _native.mipmap_error(
        [as_image(f"levels: level {k}", level) for k, level in enumerate(levels)],
        as_image("image", image),
        _surfaces(surface),
        values.ravel().tolist(),
        _wrap(wrap),
        _progress(progress),
        as_threads(threads),
    )
    return np.array(errors).reshape(values.shape)


def _surfaces(surface: Surface | Sequence[Surface] | None) -> list[Surface]:
    if surface is None:
        return []
    surfaces = [surface] if isinstance(surface, Surface) else surface
    if not isinstance(surfaces, Sequence):
        raise ValueError(f"surface: a {type(surface).__name__}; a Surface or a list is needed")
    for found in surfaces:
        if not isinstance(found, Surface):
            raise ValueError(f"surface: holds a {type(found).__name__}; a Surface is needed")
    return list(surfaces)


def _name(argument: str, name: object) -> str:
    if not isinstance(name, str):
        raise ValueError(f"{argument}: {name!r}; a name is needed")
    return name.encode(errors="replace").decode()


def _wrap(wrap: Wrap) -> tuple[str, str]:
    pair = (wrap, wrap) if isinstance(wrap, str) else wrap
    if not _is_pair(pair) or not all(isinstance(mode, str) for mode in pair):
        raise ValueError(f"wrap: {wrap!r}; one name, or a pair of names for u and v, is needed")
    return _name("wrap", pair[0]), _name("wrap", pair[1])


def _bounds(bounds: Bounds | None) -> Bounds:
    pair = (None, None) if bounds is None else bounds
    if not _is_pair(pair) or not all(
        limit is None or isinstance(limit, int | float | np.number) for limit in pair
    ):
        raise ValueError(f"bounds: {bounds!r}; a pair (low, high) of numbers or None is needed")
    low, high = pair
    return (None if low is None else float(low), None if high is None else float(high))


def _is_pair(value: object) -> bool:
    return isinstance(value, Sequence | np.ndarray) and len(value) == 2


def _progress(progress: ProgressCallback | None) -> ProgressCallback | None:
    if progress is not None and not callable(progress):
        raise ValueError(f"progress: {progress!r}; a callable of one number is needed, or None")
    return progress


def _level_count(levels: int | None) -> int:
    if levels is None:
        return 0
    if isinstance(levels, bool) or not isinstance(levels, int | np.integer) or levels < 1:
        raise ValueError(f"levels: {levels!r}; a whole number of at least 1 is needed, or None")
    # More than any image has, yet an int for the native module, whose message knows the image.
    return min(int(levels), 2**30)
