# SPDX-License-Identifier: GPL-3.0-or-later

"""Storing a key and a short text inside mesh files, in a comment or header of each format."""

import json
import re
import struct
from pathlib import Path
from typing import Any

_MOST_HEADER = 1 << 16
_STL_HEADER = 80
_GLB_HEADER = struct.Struct("<4sIIII")
_JSON = 0x4E4F534A


def with_note(kind: str, data: bytes, key: str, text: str) -> bytes:
    """Adds `key=text` to a file: as a comment, as the STL header, or as GLB asset extras.

    Args:
        kind: "ply", "obj", "stl" (binary) or "glb".
        data: The file.
        key: A word.
        text: Letters and digits; for STL, key and text must fit into 80 bytes.
    """
    note = f"{key}={text}".encode()
    if kind == "ply":
        first, rest = data.split(b"\n", 1)
        return b"%s\ncomment %s\n%s" % (first, note, rest)
    if kind == "obj":
        return b"# %s\n%s" % (note, data)
    if kind == "stl":
        assert len(note) <= _STL_HEADER
        return note.ljust(_STL_HEADER) + data[_STL_HEADER:]
    scene, rest = _split_glb(data)
    scene.setdefault("asset", {}).setdefault("extras", {})[key] = text
    said = json.dumps(scene, separators=(",", ":")).encode()
    said += b" " * (-len(said) % 4)
    whole = _GLB_HEADER.size + len(said) + len(rest)
    return _GLB_HEADER.pack(b"glTF", 2, whole, len(said), _JSON) + said + rest


def note_of(path: Path, key: str) -> str:
    """Returns the text that a file stores under a key; empty if absent.

    Raises:
        ValueError: The file is damaged.
        OSError: It cannot be read.
    """
    if path.suffix.lower() == ".glb":
        value: Any = _split_glb(path.read_bytes())[0]
        for name in ("asset", "extras", key):
            value = value.get(name) if isinstance(value, dict) else None
        return value if isinstance(value, str) else ""
    with path.open("rb") as file:
        header = file.read(_STL_HEADER if path.suffix.lower() == ".stl" else _MOST_HEADER)
    header = header.partition(b"end_header")[0]
    said = re.search(rb"\b%s=([0-9A-Za-z]+)" % re.escape(key.encode()), header)
    return said[1].decode() if said else ""


def _split_glb(data: bytes) -> tuple[dict[str, Any], bytes]:
    """Returns the JSON of a GLB file, and the bytes that follow it.

    Raises:
        ValueError: The file is damaged.
    """
    try:
        magic, version, _, size, kind = _GLB_HEADER.unpack_from(data)
        end = _GLB_HEADER.size + size
        scene = json.loads(data[_GLB_HEADER.size : end])
    except (struct.error, ValueError) as error:
        raise ValueError("damaged GLB file") from error
    if (magic, version, kind) != (b"glTF", 2, _JSON) or not isinstance(scene, dict):
        raise ValueError("damaged GLB file")
    return scene, data[end:]
