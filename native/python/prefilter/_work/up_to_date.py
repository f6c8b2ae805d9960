# SPDX-License-Identifier: GPL-3.0-or-later

"""Whether files were made of just what they would be made of now; KTX 2 files keep that."""

import hashlib
import json
import os
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any
from urllib.parse import unquote

from .._native import VERSION

KEY = "PrefilterInputs"
"""Under which key KTX 2 files keep the fingerprint."""

ENDING = ".ktx2"


def fingerprint(sources: Iterable[str | os.PathLike[str]], settings: Mapping[str, Any]) -> str:
    """Returns a number, as text, of what is read and of how it is used.

    The contents of files count, and not their names or times.

    Args:
        sources: The files, in their order; what glTF files refer to counts as well.
        settings: All that decides what is made of them.

    Raises:
        OSError: A file cannot be read.
    """
    found = hashlib.sha256(json.dumps([VERSION, settings], sort_keys=True).encode())
    for source in sources:
        for path in (Path(source), *_referred(Path(source))):
            data = path.read_bytes()
            found.update(len(data).to_bytes(8, "little"))
            found.update(data)
    return found.hexdigest()


def is_up_to_date(targets: Sequence[Path], number: str) -> bool:
    """Tells whether files are all there, and have been made of what has this fingerprint."""
    from ..textures.ktx2_metadata import read_metadata

    try:
        return all(read_metadata(target).get(KEY) == number for target in targets)
    except (OSError, ValueError):
        return False


def _referred(path: Path) -> list[Path]:
    """Returns the buffers of a glTF file that are files by themselves."""
    if path.suffix.lower() != ".gltf":
        return []
    try:
        buffers = json.loads(path.read_bytes()).get("buffers", [])
        names = [unquote(one.get("uri", "data:")) for one in buffers]
    except (ValueError, AttributeError, TypeError):
        return []  # Its reader says what is wrong.
    return [path.parent / name for name in names if not name.startswith("data:")]
