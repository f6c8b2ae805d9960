# SPDX-License-Identifier: GPL-3.0-or-later

"""Kinds of input files."""

from pathlib import Path

MESH, MODEL, CLOUD, PICTURE, DRAWING = "mesh", "model", "cloud", "picture", "drawing"
_BY_EXTENSION = {
    MESH: (".stl", ".off"),
    MODEL: (".gltf", ".glb"),
    CLOUD: (".xyz", ".pts", ".pcd", ".ptx", ".las", ".laz", ".e57"),
    PICTURE: (".png", ".jpg", ".jpeg", ".tif", ".tiff", ".exr", ".hdr", ".tga", ".bmp", ".webp"),
    DRAWING: (".svg", ".svgz"),
}
_HEADER_BYTES = 65536


def kind_of(path: Path) -> str | None:
    """Returns the kind of a file; None for a file that Prefilter does not read."""
    extension = path.suffix.lower()
    for kind, extensions in _BY_EXTENSION.items():
        if extension in extensions:
            return kind
    if extension == ".ply":
        return MESH if _has_faces(path) else CLOUD
    if extension == ".obj":
        return MESH if _obj_has_faces(path) else None
    return None


def _has_faces(path: Path) -> bool:
    with path.open("rb") as file:
        header = file.read(_HEADER_BYTES).partition(b"end_header")[0]
    for line in header.splitlines():
        words = line.split()
        if words[:2] == [b"element", b"face"] and len(words) == 3:
            return words[2] != b"0"
    return b"tristrips" in header


def _obj_has_faces(path: Path) -> bool:
    with path.open("rb") as file:
        return any(line.startswith(b"f ") for line in file)
