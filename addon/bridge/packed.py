# SPDX-License-Identifier: GPL-3.0-or-later

"""Unpacking of images in the .blend file to files beside it."""

from pathlib import Path

import bpy

from ..core.file_names import clean_name
from .files import staging
from .images import kind_that_is_no_still, tile_numbers

FOLDER = "textures"
"""The folder beside the .blend file, the same as of Blender's own Unpack."""

_STARTS = (
    (b"\x89PNG", ".png"),
    (b"\xff\xd8\xff", ".jpg"),
    (b"\x76\x2f\x31\x01", ".exr"),
    (b"II*\0", ".tif"),
    (b"MM\0*", ".tif"),
    (b"#?", ".hdr"),
    (b"BM", ".bmp"),
    (b"DDS ", ".dds"),
)


def unpack(image: bpy.types.Image) -> list[Path]:
    """Writes a packed image to files beside the .blend file, and makes the image use them.

    A file with other contents is never replaced: the new one gets a number. A file with the same
    contents is reused.

    Returns:
        The file, or the files of the tiles.

    Raises:
        ValueError: The image cannot be unpacked.
        OSError: The .blend file has no folder yet, or a file cannot be written.
    """
    who = f"image '{image.name}'"
    kind = kind_that_is_no_still(image)
    if kind is not None:
        raise ValueError(f"{who}: found {kind}; a picture file is needed")
    if image.library is not None:
        raise ValueError(f"{who} is packed in another .blend file; unpack it there")
    if image.is_dirty:
        raise ValueError(f"{who}: has changes that are not packed; save it")
    if not bpy.data.filepath:
        raise OSError(
            f"{who} is packed; save the .blend file first, because images are unpacked beside it"
        )
    folder = Path(bpy.path.abspath(f"//{FOLDER}"))
    folder.mkdir(exist_ok=True)
    tiles = {file.tile_number: file.packed_file.data for file in image.packed_files}
    is_tiled = bool(tile_numbers(image))
    if not is_tiled:
        tiles = {0: next(iter(tiles.values()))}
    stem = _stem(image)
    ending = _ending(image, next(iter(tiles.values())))
    for number in range(1000):
        base = f"{stem}.{number:03d}" if number else stem
        names = {tile: f"{base}.{tile}{ending}" if tile else f"{base}{ending}" for tile in tiles}
        paths = {tile: folder / name for tile, name in names.items()}
        if all(_is_free_for(path, tiles[tile]) for tile, path in paths.items()):
            break
    new = {tile: path for tile, path in paths.items() if not path.exists()}
    staged: list[staging.StagedFile] = []
    try:
        for tile, path in new.items():
            staging.check_writable(path)
            staged.append(staging.stage_data(path, tiles[tile]))
        staging.commit_all(staged)
    finally:
        for file in staged:
            file.discard()
    colorspace, alpha_mode = image.colorspace_settings.name, image.alpha_mode
    name = f"{base}.<UDIM>{ending}" if is_tiled else paths[0].name
    image.unpack(method="REMOVE")
    image.filepath = f"//{FOLDER}/{name}"
    image.colorspace_settings.name, image.alpha_mode = colorspace, alpha_mode
    image.reload()
    return list(paths.values())


def _is_free_for(path: Path, data: bytes) -> bool:
    return not path.exists() or (path.is_file() and path.read_bytes() == data)


def _stem(image: bpy.types.Image) -> str:
    base, ending = image.name, Path(image.name).suffix
    if ending.lower() in bpy.path.extensions_image:
        base = base.removesuffix(ending)
    return clean_name(base)


def _ending(image: bpy.types.Image, data: bytes) -> str:
    if data[:4] == b"RIFF" and data[8:12] == b"WEBP":
        return ".webp"
    extension = next((ending for start, ending in _STARTS if data.startswith(start)), "")
    return extension or Path(image.filepath).suffix.lower() or ".tga"
