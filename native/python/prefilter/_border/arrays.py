"""Arrays as the native module takes them, checked once, here at the border."""

from collections.abc import Sequence
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

# What the native module takes as an int; larger counts mean the same to it.
_LARGEST_INT = 2**30

# What can be filtered without overflow.
_LARGEST_VALUE = np.float32(1e30)

_MESH_NAMES = ("positions", "triangles")

FloatArray: TypeAlias = npt.NDArray[np.float32]


def as_floats(
    name: str, array: npt.ArrayLike, shape: Sequence[int | str], dtype: npt.DTypeLike
) -> np.ndarray:
    """The array as a C-contiguous one of `dtype`, not copied where it is one.

    `shape` gives the length of each axis, or a name where any length will do.
    Raises ValueError where the shape differs or the values are not floating-point numbers.
    """
    found = as_array(name, array)
    if found.dtype not in (np.float32, np.float64):
        raise ValueError(f"{name}: dtype {found.dtype}; float32 or float64 is needed")
    check_shape(name, found, shape)
    with np.errstate(over="ignore"):  # What is too large becomes infinite, and is refused as that.
        return np.ascontiguousarray(found, dtype)


def as_indices(name: str, array: npt.ArrayLike, shape: Sequence[int | str]) -> np.ndarray:
    """The array as C-contiguous int64. Raises ValueError where it holds no integers."""
    found = as_array(name, array)
    if not np.issubdtype(found.dtype, np.integer):
        raise ValueError(f"{name}: dtype {found.dtype}; integers are needed")
    check_shape(name, found, shape)
    return np.ascontiguousarray(found, np.int64)


def as_mesh(
    positions: npt.ArrayLike, triangles: npt.ArrayLike, *, names: Sequence[str] = _MESH_NAMES
) -> tuple[np.ndarray, np.ndarray]:
    """The arrays of a mesh, C-contiguous, and not copied where they are.

    Positions are float32 or float64, (vertices, 3), and triangles int32 or int64, (triangles, 3).
    Raises ValueError as `as_floats` and `as_indices` do.
    """
    points = as_array(names[0], positions)
    points = as_floats(names[0], points, ("vertices", 3), points.dtype)
    indices = as_array(names[1], triangles)
    if indices.dtype != np.int32:
        return points, as_indices(names[1], indices, ("triangles", 3))
    check_shape(names[1], indices, ("triangles", 3))
    return points, np.ascontiguousarray(indices)


def as_labels(name: str, array: npt.ArrayLike, count: int, of: str) -> np.ndarray:
    """The array as C-contiguous int32, a number for each of `count` things; `of` says of what.

    Raises ValueError where it holds no integers, others than int32 has, or not as many.
    """
    found = as_array(name, array)
    if not np.issubdtype(found.dtype, np.integer):
        raise ValueError(f"{name}: dtype {found.dtype}; integers are needed")
    check_shape(name, found, (of,))
    if len(found) != count:
        raise ValueError(f"{name}: found {len(found)} for {count} {of}; one each is needed")
    if found.dtype != np.int32 and len(found):
        limits = np.iinfo(np.int32)
        lowest, highest = int(found.min()), int(found.max())
        if lowest < limits.min or highest > limits.max:
            raise ValueError(f"{name}: found {lowest} to {highest}; 32 bits are the most")
    return np.ascontiguousarray(found, np.int32)


def as_image(name: str, array: npt.ArrayLike) -> np.ndarray:
    """A float32 image of shape (height, width, channels)."""
    image = as_floats(name, array, ("height", "width", "channels"), np.float32)
    if 0 in image.shape:
        raise ValueError(f"{name}: shape {image.shape} holds no pixels; at least one is needed")
    return image


def as_float_image(name: str, array: npt.ArrayLike) -> np.ndarray:
    """A float32 image of shape (height, width, channels); bytes (uint8) stand for a 255th each."""
    if isinstance(array, np.ndarray) and array.dtype == np.uint8:
        return as_bytes(name, array) / np.float32(255)
    return as_image(name, array)


def as_bytes(name: str, image: np.ndarray) -> np.ndarray:
    """An uint8 image of shape (height, width, channels)."""
    check_shape(name, image, ("height", "width", "channels"))
    if 0 in image.shape:
        raise ValueError(f"{name}: shape {image.shape} holds no pixels; at least one is needed")
    return np.ascontiguousarray(image)


def check_texels(name: str, image: np.ndarray) -> None:
    """Raises ValueError where a value is not finite or beyond 1e30."""
    beyond = ~(np.abs(image) <= _LARGEST_VALUE)
    if beyond.any():
        row, column, channel = np.argwhere(beyond)[0]
        raise ValueError(
            f"{name}: the texel in row {row}, column {column} holds {image[row, column, channel]:g}"
            f" in channel {channel}; texels must be finite, and at most 1e30"
        )


def check_shape(name: str, array: np.ndarray, shape: Sequence[int | str]) -> None:
    """Raises ValueError unless the array has the shape; a name fits any length."""
    fits = array.ndim == len(shape) and all(
        isinstance(wanted, str) or found == wanted
        for found, wanted in zip(array.shape, shape, strict=True)
    )
    if not fits:
        wanted = ", ".join(str(length) for length in shape) + ("," if len(shape) == 1 else "")
        raise ValueError(f"{name}: shape {array.shape}; ({wanted}) is needed")


def as_threads(threads: int) -> int:
    """A number of threads; 0 stands for all processors."""
    if isinstance(threads, bool) or not isinstance(threads, int | np.integer) or threads < 0:
        raise ValueError(
            f"threads: {threads!r}; a whole number is needed, 0 meaning all processors"
        )
    return min(int(threads), _LARGEST_INT)


def as_array(name: str, array: npt.ArrayLike) -> np.ndarray:
    """Any array. Raises ValueError where it is none."""
    try:
        return np.asarray(array)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{name}: found no array: {error}") from error
