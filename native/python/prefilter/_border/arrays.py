# SPDX-License-Identifier: GPL-3.0-or-later

"""Checks and conversions of arrays for the native module."""

from collections.abc import Sequence
from typing import Any, TypeAlias, TypeVar

import numpy as np
import numpy.typing as npt

from .arguments import WHOLE, as_items

# Counts are passed as int; larger ones mean the same.
_LARGEST_INT = 2**30

# Larger values could overflow in filters.
_LARGEST_VALUE = np.float32(1e30)

_MESH_NAMES = ("positions", "triangles")

Value = TypeVar("Value", bound=np.generic)

FloatArray: TypeAlias = npt.NDArray[np.float32]

_IMAGE_TYPES = (
    "floating-point numbers, uint8 (a 255th each), uint16 (a 65535th each) or bool are needed"
)


def as_floats(
    name: str, array: npt.ArrayLike, shape: Sequence[int | str], dtype: npt.DTypeLike
) -> np.ndarray:
    """Returns a C-contiguous array of `dtype`, not copied if it already is one.

    `shape` gives the length of each axis, or a name where any length will do. Integers keep their
    values. Raises ValueError where the shape differs or the values are no real numbers.
    """
    values = as_array(name, array)
    if not is_real(values):
        raise ValueError(f"{name}: dtype {values.dtype}; real numbers are needed")
    check_shape(name, values, shape)
    with np.errstate(over="ignore"):  # Too large values become infinite and are refused later.
        return np.ascontiguousarray(values, dtype)


def as_indices(name: str, array: npt.ArrayLike, shape: Sequence[int | str]) -> np.ndarray:
    """Returns a C-contiguous int64 array. Raises ValueError unless it holds integers."""
    values = as_array(name, array)
    if values.size and values.dtype.kind not in "iu":
        raise ValueError(f"{name}: dtype {values.dtype}; integers are needed")
    check_shape(name, values, shape)
    if values.dtype == np.uint64 and values.size and int(values.max()) > np.iinfo(np.int64).max:
        raise ValueError(f"{name}: found {values.max()}; 63 bits are the most")
    return np.ascontiguousarray(values, np.int64)


def as_mesh(
    positions: npt.ArrayLike, triangles: npt.ArrayLike, *, names: Sequence[str] = _MESH_NAMES
) -> tuple[np.ndarray, np.ndarray]:
    """Returns C-contiguous arrays of a mesh, not copied if they already are.

    Positions become float32 or float64, (vertices, 3), and triangles int32 or int64,
    (triangles, 3). Raises ValueError as `as_floats` and `as_indices` do.
    """
    points = as_array(names[0], positions)
    dtype = np.float32 if points.dtype in (np.float16, np.float32) else np.float64
    points = as_floats(names[0], points, ("vertices", 3), dtype)
    indices = as_array(names[1], triangles)
    if indices.dtype != np.int32:
        return points, as_indices(names[1], indices, ("triangles", 3))
    check_shape(names[1], indices, ("triangles", 3))
    return points, np.ascontiguousarray(indices)


def as_labels(name: str, array: npt.ArrayLike, count: int, of: str) -> np.ndarray:
    """Returns C-contiguous int32 labels, one for each of `count` things; `of` names these.

    Raises ValueError unless there are `count` integers that fit int32.
    """
    values = as_array(name, array)
    if not np.issubdtype(values.dtype, np.integer):
        raise ValueError(f"{name}: dtype {values.dtype}; integers are needed")
    check_shape(name, values, (of,))
    if len(values) != count:
        raise ValueError(f"{name}: found {len(values)} for {count} {of}; one each is needed")
    if values.dtype != np.int32 and len(values):
        limits = np.iinfo(np.int32)
        lowest, highest = int(values.min()), int(values.max())
        if lowest < limits.min or highest > limits.max:
            raise ValueError(f"{name}: found {lowest} to {highest}; 32 bits are the most")
    return np.ascontiguousarray(values, np.int32)


def as_corner_uvs(
    name: str, uvs: npt.ArrayLike, triangles: np.ndarray, vertices: int, dtype: npt.DTypeLike
) -> np.ndarray:
    """Returns UVs of the triangles' corners, (triangles, 3, 2), from UVs of corners or vertices.

    UVs of vertices have shape (vertices, 2). Indices are not checked. Raises ValueError for other
    shapes, or values that are no real numbers.
    """
    values = as_array(name, uvs)
    corners = (len(triangles), 3, 2)
    if is_real(values) and values.shape not in (corners, (vertices, 2)):
        raise ValueError(
            f"{name}: shape {values.shape}; {corners} for the triangles' corners or "
            f"{(vertices, 2)} for the vertices is needed"
        )
    if values.ndim != 2 or not vertices:
        return as_floats(name, values, corners, dtype)
    of_vertices = as_floats(name, values, (vertices, 2), dtype)
    return np.take(of_vertices, triangles, axis=0, mode="clip")


def as_image(name: str, array: npt.ArrayLike) -> FloatArray:
    """Returns a float32 image of shape (height, width, channels).

    Texels of uint8 are divided by 255, those of uint16 by 65535; False is 0 and True 1. An image of
    two axes has one channel; see `in_form_of`. A list of whole numbers may hold only 0 and 1,
    because only an array's type says how to scale others. Raises ValueError for other shapes or
    types, or if there are no texels.
    """
    texels = as_texels(name, array)
    image: FloatArray = texels
    if texels.dtype != np.float32:
        image = np.divide(texels, np.iinfo(texels.dtype).max, dtype=np.float32)
    return image


def as_images(levels: Sequence[npt.ArrayLike]) -> list[FloatArray]:
    """Returns each of several levels as `as_image` does."""
    if not isinstance(levels, Sequence):
        raise ValueError(f"levels: a {type(levels).__name__}; a list of arrays is needed")
    items = as_items("levels", levels, "a list of images")
    return [as_image(f"levels: level {k}", level) for k, level in enumerate(items)]


def as_texels(name: str, array: npt.ArrayLike) -> npt.NDArray[Any]:
    """Returns an image as `as_image` does, but leaves texels of uint8 and uint16 unscaled."""
    values = as_array(name, array)
    if values.dtype.kind == "i" and isinstance(array, list | tuple):
        others = values[(values != 0) & (values != 1)]
        if len(others):
            raise ValueError(
                f"{name}: a list of whole numbers, among them {others[0]}; only 0 and 1 are "
                "allowed in lists, others in arrays of uint8 or uint16, or written as 1.0"
            )
        values = values.astype(np.float32)
    if values.dtype.kind not in "fb" and values.dtype not in (np.uint8, np.uint16):
        raise ValueError(f"{name}: dtype {values.dtype}; {_IMAGE_TYPES}")
    if values.ndim not in (2, 3):
        raise ValueError(
            f"{name}: shape {values.shape}; (height, width) or (height, width, channels) is needed"
        )
    if 0 in values.shape:
        raise ValueError(f"{name}: shape {values.shape} holds no pixels; at least one is needed")
    stored = values.dtype if values.dtype.kind == "u" else np.float32
    with np.errstate(over="ignore"):  # Too large values become infinite and are refused later.
        texels = np.ascontiguousarray(values, stored)
    return texels[:, :, None] if texels.ndim == 2 else texels


def in_form_of(array: npt.ArrayLike, image: npt.NDArray[Value]) -> npt.NDArray[Value]:
    """Returns a result (..., channels), without the last axis if the input image had none."""
    return image[..., 0] if np.ndim(array) == 2 else image


def is_real(array: np.ndarray) -> bool:
    """Whether the values are real numbers; bool does not count."""
    return array.dtype.kind in "iuf"


def check_texels(name: str, image: np.ndarray) -> None:
    """Raises ValueError if a value is not finite or is beyond 1e30."""
    beyond = ~(np.abs(image) <= _LARGEST_VALUE)
    if beyond.any():
        row, column, channel = np.argwhere(beyond)[0]
        raise ValueError(
            f"{name}: the texel in row {row}, column {column} holds {image[row, column, channel]:g}"
            f" in channel {channel}; texels must be finite, and at most 1e30"
        )


def check_shape(name: str, array: np.ndarray, shape: Sequence[int | str]) -> None:
    """Raises ValueError unless the array has the shape; a name allows any length."""
    fits = array.ndim == len(shape) and all(
        isinstance(needed, str) or length == needed
        for length, needed in zip(array.shape, shape, strict=True)
    )
    if not fits:
        lengths = ", ".join(str(length) for length in shape) + ("," if len(shape) == 1 else "")
        raise ValueError(f"{name}: shape {array.shape}; ({lengths}) is needed")


def as_threads(threads: int) -> int:
    """Returns a checked number of threads; 0 stands for all processors."""
    if isinstance(threads, bool) or not isinstance(threads, WHOLE) or threads < 0:
        raise ValueError(
            f"threads: {threads!r}; a whole number is needed, 0 meaning all processors"
        )
    return min(int(threads), _LARGEST_INT)


def as_array(name: str, array: npt.ArrayLike) -> np.ndarray:
    """Returns an array in native byte order. Raises ValueError where it is none."""
    try:
        values = np.asarray(array)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{name}: found no array: {error}") from error
    return values if values.dtype.isnative else values.astype(values.dtype.newbyteorder("="))
