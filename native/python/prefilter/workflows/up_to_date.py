# SPDX-License-Identifier: GPL-3.0-or-later

"""Fingerprints of inputs, stored in output files, to detect files that are up to date."""

import hashlib
import json
import os
import re
import struct
from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import unquote

from .._native import VERSION
from ..files.replacing import recover
from . import mesh_extensions

if TYPE_CHECKING:
    from numpy.typing import NDArray

KEY = "PrefilterInputs"
"""Key of the fingerprint in files; TIFF files have it in their description."""

LEVELS = (".ktx2", ".exr", ".tif", ".tiff", ".tx")
"""Extensions of level files that can store it: DDS cannot, and PNG makes several files."""
PICTURES = (".png", ".exr")
"""Extensions of single pictures that can store it."""
MESHES = mesh_extensions.WRITABLE
"""Extensions of mesh files that can store it."""
IN_DESCRIPTION = re.compile(rf" ?\b{KEY}=([0-9a-f]{{64}})\b")
"""The fingerprint in the description of a TIFF file."""
_GZIP = b"\x1f\x8b"
# Text, whose fonts are files; addresses; and escapes or entities that may stand for either.
_ELSEWHERE = re.compile(
    rb"<!ENTITY|\\|<([\w.-]+:)?text\b|@import|(href|src|url)\s*[=(]\s*[\"']?\s*(?!#|data:|[\"'\s])",
    re.IGNORECASE,
)
_EXR_MAGIC = 20000630
_MOST_HEADER = 1 << 20


def fingerprint(sources: Iterable[str | os.PathLike[str]], settings: Mapping[str, Any]) -> str:
    """Returns a fingerprint, as text, of inputs and settings.

    It depends on the files' contents, not on their names or times.

    Args:
        sources: The files, in order; buffers that glTF files refer to are included.
        settings: All settings that affect the result.

    Raises:
        OSError: A file cannot be read.
    """
    digest = _hash_of_settings(settings)
    for source in sources:
        for path in (Path(source), *referred_files(Path(source))):
            data = path.read_bytes()
            digest.update(len(data).to_bytes(8, "little"))
            digest.update(data)
    return str(digest.hexdigest())


def fingerprint_of(arrays: Iterable["NDArray[Any]"], settings: Mapping[str, Any]) -> str:
    """Returns a fingerprint of arrays and settings."""
    digest = _hash_of_settings(settings)
    for array in arrays:
        digest.update(f"{array.dtype.str} {array.shape} ".encode())
        if array.size:
            digest.update((array if array.flags.c_contiguous else array.copy()).data.cast("B"))
    return str(digest.hexdigest())


def arrays_of(read: Any) -> "Iterator[NDArray[Any]]":
    """Yields all arrays and values in nested dataclasses and containers, for `fingerprint_of`."""
    import numpy as np

    if isinstance(read, np.ndarray):
        yield read
    elif is_dataclass(read):
        for field in fields(read):
            yield from arrays_of(getattr(read, field.name))
    elif isinstance(read, Mapping):
        yield from arrays_of(sorted(read.items()))
    elif isinstance(read, Set):
        yield from arrays_of(sorted(read))
    elif isinstance(read, Sequence) and not isinstance(read, str):
        yield np.array(len(read))
        for item in read:
            yield from arrays_of(item)
    else:
        yield np.frombuffer(repr(read).encode(), np.uint8)


def is_self_contained(drawing: str | os.PathLike[str]) -> bool:
    """Tells whether an SVG file is self-contained: no text, and no reference to another file.

    In doubt, returns False.

    Raises:
        OSError: The file cannot be read.
    """
    data = Path(drawing).read_bytes()
    if data[:2] == _GZIP:
        from ..shapes._svg.read.document import decompress

        try:
            data = b"".join(decompress(data, str(drawing)))
        except ValueError:
            return False
    return b"\0" not in data and _ELSEWHERE.search(data) is None


def is_up_to_date(targets: Sequence[Path], number: str) -> bool:
    """Tells whether all files exist and store this fingerprint."""
    for target in targets:
        recover(target.parent)
    try:
        return bool(targets) and all(stored_fingerprint(target) == number for target in targets)
    except (OSError, ValueError):
        return False


def stored_fingerprint(path: Path) -> str:
    """Returns the fingerprint stored in a file; empty if there is none.

    Raises:
        ValueError: The file is damaged, or of a format that cannot store one.
        OSError: It cannot be read.
    """
    ending = path.suffix.lower()
    if ending == ".ktx2":
        from ..textures.ktx2_metadata import read_metadata

        return read_metadata(path).get(KEY, "")
    if ending == ".png":
        from .files import png

        with path.open("rb") as file:
            return png.texts(file).get(KEY, "")
    if ending == ".exr":
        with path.open("rb") as file:
            return _exr_text(file.read(_MOST_HEADER), KEY)
    if ending in MESHES:
        from .files.mesh_notes import note_of

        return note_of(path, KEY)
    from .openimageio import text_attribute

    match = IN_DESCRIPTION.search(text_attribute(path, "ImageDescription"))
    return match[1] if match else ""


def _hash_of_settings(settings: Mapping[str, Any]) -> Any:
    return hashlib.sha256(json.dumps([VERSION, settings], sort_keys=True).encode())


def _exr_text(header: bytes, key: str) -> str:
    """Returns a text attribute from the header of an OpenEXR file; empty if absent."""
    if len(header) < 8 or struct.unpack_from("<I", header)[0] != _EXR_MAGIC:
        raise ValueError("no OpenEXR file")
    at = 8
    try:
        while header[at]:
            name, kind = header[at:].split(b"\0", 2)[:2]
            at += len(name) + len(kind) + 2
            (size,) = struct.unpack_from("<I", header, at)
            at += 4
            if name == key.encode():
                return header[at : at + size].decode("utf-8", "replace")
            at += size
    except (IndexError, ValueError, struct.error) as error:
        raise ValueError("damaged OpenEXR file") from error
    return ""


def referred_files(path: Path) -> list[Path]:
    """Returns the external buffers of a glTF file."""
    if path.suffix.lower() != ".gltf":
        return []
    try:
        buffers = json.loads(path.read_bytes()).get("buffers", [])
        names = [unquote(buffer.get("uri", "data:")) for buffer in buffers]
    except (ValueError, AttributeError, TypeError):
        return []  # The mesh reader reports the error.
    return [path.parent / name for name in names if not name.startswith("data:")]
