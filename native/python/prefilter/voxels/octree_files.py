# SPDX-License-Identifier: GPL-3.0-or-later

"""Files of octrees: NumPy archives (.npz) of the cells, level by level."""

import errno
import io
import math
import os
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np
import numpy.typing as npt

from .. import _native
from .._border.input import as_path, open_file
from ..files.staging import as_target, write_output

if TYPE_CHECKING:
    import zipfile

_FORMAT = "prefilter octree 2"
_LONGEST_HEADER = 256
_NO_FAULT_OF_THE_DISK = (None, errno.EINVAL)  # EINVAL: a damaged file may cause an invalid seek.

_Levels = list[tuple[npt.NDArray[np.float32], npt.NDArray[np.uint8]]]


def write_octree(path: str | os.PathLike[str], octree: _native.Octree) -> None:
    """Writes an octree to a file, replacing an earlier one; see `Octree.save`."""
    levels = _native.levels_of(octree)
    arrays: dict[str, Any] = {
        "format": np.array(_FORMAT),
        "depth": np.array(octree.depth, np.int64),
        "bounds": np.array(octree.bounds, np.float64),
        "root": np.array(octree.root, np.float32),
        "levels": np.array(len(levels), np.int64),
    }
    for k, (blocks, split) in enumerate(levels):
        arrays[f"values{k}"] = blocks
        arrays[f"split{k}"] = split

    def write(file: BinaryIO) -> None:
        np.savez_compressed(file, **arrays)

    write_output(as_target(path), write)


def read_octree(path: str | os.PathLike[str]) -> _native.Octree:
    """Reads an octree written by `write_octree`; see `Octree.load`."""
    source = as_path(path)
    with open_file(source) as file:
        try:
            return _native.make_octree(*_contents(file))
        except MemoryError:
            raise
        except Exception as error:  # zipfile and zlib may raise almost anything for damaged files.
            if isinstance(error, OSError) and error.errno not in _NO_FAULT_OF_THE_DISK:
                raise OSError(error.errno, error.strerror, source) from error
            raise ValueError(f"path: '{source}' holds no octree: {error}") from error


def _contents(
    file: BinaryIO,
) -> tuple[_Levels, float, tuple[list[float], list[float]], int]:
    import zipfile

    archive = zipfile.ZipFile(file)
    file_format = str(_array(archive, "format", np.dtype(f"<U{len(_FORMAT)}"), ()))
    if file_format != _FORMAT:
        raise ValueError(f"its format is {file_format!r}; {_FORMAT!r} is needed")
    depth = int(_array(archive, "depth", np.dtype(np.int64), ()))
    if not 0 <= depth <= _native.MAX_DEPTH:
        raise ValueError(f"its depth is {depth}; 0 to {_native.MAX_DEPTH} are allowed")
    low, high = _array(archive, "bounds", np.dtype(np.float64), (2, 3)).tolist()
    root = float(_array(archive, "root", np.dtype(np.float32), ()))
    levels: _Levels = []
    blocks = 1
    count = int(_array(archive, "levels", np.dtype(np.int64), ()))
    if not 0 <= count <= depth:
        raise ValueError(f"it has {count} levels; 0 to its depth, {depth}, are allowed")
    for k in range(count):
        split = _array(archive, f"split{k}", np.dtype(np.uint8), (blocks,))
        values = _array(archive, f"values{k}", np.dtype(np.float32), (blocks, 8))
        levels.append((values, split))
        blocks = int(np.unpackbits(split).sum(dtype=np.int64))
    return levels, root, (low, high), depth


def _array(
    archive: "zipfile.ZipFile", name: str, dtype: np.dtype, shape: tuple[int, ...]
) -> np.ndarray:
    """Returns an array of the archive, unpacked only if its size is as expected."""
    try:
        member = archive.getinfo(f"{name}.npy")
    except KeyError:
        raise ValueError(f"it has no '{name}'") from None
    expected = dtype.itemsize * math.prod(shape)
    if not expected < member.file_size <= expected + _LONGEST_HEADER:
        raise ValueError(
            f"'{name}' takes {member.file_size} bytes; {expected} and a header are expected"
        )
    data = archive.read(member)
    file = io.BytesIO(data)
    np.lib.format.read_magic(file)
    stored_shape, is_transposed, kind = np.lib.format.read_array_header_1_0(file)
    if stored_shape != shape or kind != dtype or (is_transposed and len(shape) > 1):
        raise ValueError(
            f"'{name}' is {kind} of shape {stored_shape}; {dtype} of {shape} is expected"
        )
    if len(data) - file.tell() != expected:
        raise ValueError(f"'{name}' has {len(data) - file.tell()} bytes; {expected} are expected")
    return np.frombuffer(data, dtype, offset=file.tell()).reshape(shape)
