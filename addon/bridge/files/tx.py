# SPDX-License-Identifier: GPL-3.0-or-later

"""Files of Cycles' texture cache: made by Blender, with levels replaced here.

Format in Blender 5.2: tiles of 64 x 64, 1 or 4 channels, all levels down to 1 x 1, in a TIFF for
integers and an OpenEXR for floats, in both cases named `<image file>.<version>-<MD5>.tx`. Colors
are scene-linear, or sRGB-encoded if Cycles decodes them after its lookup, as for integers in a
color space like sRGB; alpha is associated if it is coverage. An image of one color has one tile.

Cycles uses a file while its modification time equals the image file's, in whole seconds.
"""

import glob
import os
import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from prefilter.workflows.up_to_date import IN_DESCRIPTION, KEY

from .. import images, openimageio
from ..images import FloatArray
from ..openimageio import Check
from . import staging

_ALPHA_TYPES = {
    "STRAIGHT": "straight",
    "PREMUL": "premultiplied",
    "CHANNEL_PACKED": "channel_packed",
    "NONE": "none",
}
_DEFAULT_FOLDER = "blender_tx"
_ENCODED_SPACE = "scene_linear_srgb"
_SOURCE_SPACE = re.compile(r"\(colorspace: ([^,]*), ")
_START_OF_FILE = 1 << 14  # Bytes; the description of level 0 is in them.
_MAKER = b"Blender maketx"
_LARGEST_HALF = 65504.0
# Attributes that OpenImageIO reads from the description of a TIFF, but does not write back.
_DESCRIBED = ("oiio:ConstantColor", "oiio:AverageColor")


@dataclass(frozen=True)
class Source:
    """Source of a cache file: an image file, and the settings of its image datablock.

    Attributes:
        path: The image file.
        colorspace: The datablock's color space.
        is_data: Whether the values are not colors in that space.
        alpha_mode: The datablock's alpha mode.
        cache_folder: The user's folder of cache files: absolute, relative to the image, or empty
            for a folder beside the image.
    """

    path: Path
    colorspace: str
    is_data: bool
    alpha_mode: str
    cache_folder: str

    @property
    def folder(self) -> Path:
        """Folder of a new cache file."""
        return self.path.parent / (self.cache_folder or _DEFAULT_FOLDER)

    @property
    def alpha_is_associated(self) -> bool:
        """Whether the colors of a cache file are multiplied by its fourth channel."""
        return not self.is_data and self.alpha_mode in {"STRAIGHT", "PREMUL"}


@dataclass(frozen=True)
class Texture:
    """A cache file.

    Attributes:
        path: The file.
        stored: Stored values of level 0: (height, width, 1 or 4), row 0 at the bottom.
        is_encoded: Whether colors are sRGB-encoded.
        is_float: Whether the file holds floats.
        is_constant: Whether the image has only one color, and the file one tile.
        made_of: Fingerprint of the sources of its levels, from `stage`; empty for Blender's levels.
    """

    path: Path
    stored: FloatArray
    is_encoded: bool
    is_float: bool
    is_constant: bool
    made_of: str = ""


def is_available() -> bool:
    """Whether this Blender's Cycles makes texture caches."""
    settings = bpy.types.RenderSettings.bl_rna.properties
    return "use_texture_cache" in settings and _maker() is not None


def sources(image: bpy.types.Image) -> dict[int | None, Source]:
    """Returns the sources of an image's cache files, by tile; see `images.files_of`."""
    space = image.colorspace_settings
    folder = bpy.context.preferences.filepaths.texture_cache_directory
    return {
        number: Source(path, space.name, space.is_data, image.alpha_mode, folder)
        for number, path in images.files_of(image).items()
    }


def state(source: Source) -> str:
    """Returns the state of baked levels: "baked", "stale" or "missing".

    If datablocks read an image file in several ways, the cache files of all of them count.
    """
    try:
        time = int(source.path.stat().st_mtime)
        ours = [path.stat() for path in _cache_files(source) if _is_baked(path)]
    except OSError:
        return "missing"
    if any(int(status.st_mtime) == time for status in ours):
        return "baked"
    return "stale" if ours else "missing"


def remove_baked(source: Source) -> list[Path]:
    """Removes the cache files whose levels a bake has replaced, so that Blender makes its own.

    Returns:
        The removed files.

    Raises:
        OSError: A file cannot be removed.
    """
    baked = [path for path in _cache_files(source) if _has_other_levels(path)]
    for path in baked:
        path.unlink()
    return baked


def _cache_files(source: Source) -> list[Path]:
    return list(source.folder.glob(f"{glob.escape(source.path.name)}.*.tx"))


def _has_other_levels(path: Path) -> bool:
    """Whether a file is of Blender's texture cache, but with replaced levels."""
    start = _start_of(path)
    described = (b"oiio:SHA-1", b"oiio:ConstantColor")
    return _MAKER in start and not any(words in start for words in described)


def _start_of(path: Path) -> bytes:
    with path.open("rb") as file:
        return file.read(_START_OF_FILE)


def _is_baked(path: Path) -> bool:
    """Whether a bake has replaced the levels of a file, or it has only one color."""
    status = path.stat()
    return _reads_as_baked(path, status.st_mtime_ns, status.st_size, status.st_ino)


@lru_cache(maxsize=4096)
def _reads_as_baked(path: Path, *_: int) -> bool:
    start = _start_of(path)
    # Blender's files have a hash of the image; ours do not: see `_first_spec`.
    has_levels = b"oiio:SHA-1" not in start or b"oiio:ConstantColor" in start
    return has_levels and _MAKER in start


def make(source: Source) -> Path:
    """Makes Blender write the cache file, unless it is up to date.

    Returns:
        The file that Cycles uses for the image.

    Raises:
        OSError: The image file cannot be read, or the cache file cannot be written.
    """
    folder = source.folder
    while not folder.exists():
        folder = folder.parent
    staging.check_writable(folder / "texture.tx")
    try:
        made = _maker()(
            str(source.path),
            colorspace=source.colorspace,
            alpha_type=_ALPHA_TYPES[source.alpha_mode],
            cache_dir=source.cache_folder,
        )
    except RuntimeError as error:
        raise OSError(
            f"Blender cannot make a texture cache of '{source.path}' in '{source.folder}': {error}"
        ) from error
    staging.check_writable(Path(made))
    return Path(made)


def check(source: Source, path: Path) -> None:
    """Checks that a cache file is complete, as Blender does not report failed writes.

    A broken file is made again, which Blender would not do. If it stays broken it is removed, as
    Cycles would show it.

    Raises:
        OSError: The file is broken, or cannot be made again.
    """
    if _has_other_levels(path):
        return  # It was checked when it was written.
    try:
        _check_whole(path)
    except OSError:
        path.unlink()
        again = make(source)
        try:
            _check_whole(again)
        except OSError:
            again.unlink()
            raise


def _check_whole(path: Path) -> None:
    reader, spec = _open(path)
    reader.close()
    is_constant = spec.getattribute("oiio:ConstantColor") is not None
    openimageio.check_whole(path, 1 if is_constant else max(spec.width, spec.height).bit_length())


def texel_count(path: Path) -> int:
    """Returns the number of texels of level 0 of a cache file.

    Raises:
        OSError: It cannot be read, or it is not a file of Blender's texture cache.
    """
    reader, spec = _open(path)
    reader.close()
    return int(spec.width * spec.height)


def read(path: Path) -> Texture:
    """Reads a cache file.

    Raises:
        OSError: It cannot be read, or it is not a file of Blender's texture cache.
    """
    reader, spec = _open(path)
    try:
        pixels = reader.read_image(0, 0, 0, spec.nchannels, "float")
    finally:
        reader.close()
    if pixels is None:
        raise OSError(f"cannot read '{path}': {openimageio.last_error(reader)}")
    is_float = reader.format_name() == "openexr"
    return Texture(
        path,
        np.ascontiguousarray(pixels[::-1], np.float32),
        not is_float and _source_space(path, spec) == _ENCODED_SPACE,
        is_float,
        spec.getattribute("oiio:ConstantColor") is not None,
        _made_of(spec),
    )


def stage(
    texture: Texture, levels: Sequence[FloatArray], check: Check, *, made_of: str = ""
) -> staging.StagedFile:
    """Stages a cache file with replaced levels.

    Level 0, its metadata and the modification time are preserved.

    Args:
        texture: The file.
        levels: Levels 1, 2, ... in the encoding of `texture.stored`, row 0 at the bottom.
        check: Called before each level.
        made_of: Fingerprint to store in the file for the next bake; see `up_to_date`.

    Raises:
        OSError: The file cannot be written.
    """
    oiio = openimageio.module()
    reader, spec = _open(texture.path)
    time = os.stat(texture.path).st_mtime_ns
    # OpenImageIO chooses the format by the extension.
    extension = ".exr" if texture.is_float else ".tif"

    def write(temporary: Path) -> None:
        full = reader.read_image(0, 0, 0, spec.nchannels, spec.format)
        writer = oiio.ImageOutput.create(str(temporary))
        mode = "AppendMIPLevel" if writer.supports("mipmap") else "AppendSubimage"
        _write(writer, temporary, _first_spec(spec, texture.is_float, made_of), "Create", full)
        for level in levels:
            check()
            if spec.format == oiio.HALF:
                level = level.clip(-_LARGEST_HALF, _LARGEST_HALF)
            pixels = np.ascontiguousarray(level[::-1], np.float32)
            _write(writer, temporary, _level_spec(oiio, spec, pixels), mode, pixels)
        if not writer.close():
            raise OSError(f"cannot write '{temporary}': {openimageio.last_error(writer)}")
        # An OpenEXR file is complete only once its writer is destroyed.
        del writer
        openimageio.check_whole(temporary, 1 + len(levels))
        os.utime(temporary, ns=(time, time))

    try:
        return staging.stage_with(texture.path, write, extension)
    finally:
        reader.close()


def _maker() -> Any:
    """Returns the function behind `blender --command maketx`, or None; it runs on any thread."""
    try:
        import _cycles
    except ImportError:
        return None
    return getattr(_cycles, "maketx", None)


def _open(path: Path) -> tuple[Any, Any]:
    oiio = openimageio.module()
    reader = oiio.ImageInput.open(str(path))
    if reader is None:
        raise OSError(f"cannot read '{path}': {openimageio.last_error(oiio)}")
    spec = reader.spec()
    software = spec.getattribute("Software") or ""
    if not software.startswith(_MAKER.decode()):
        reader.close()
        raise OSError(
            f"'{path}' was not made by Blender's texture cache: its Software is '{software}'"
        )
    return reader, spec


def _source_space(path: Path, spec: Any) -> str:
    match = _SOURCE_SPACE.search(spec.getattribute("DocumentName") or "")
    if match is None:
        raise OSError(
            f"'{path}' does not name its color space, as files of Blender 5.2's texture cache do"
        )
    return match[1]


def _first_spec(spec: Any, is_float: bool, made_of: str) -> Any:
    """Returns a spec that writes the metadata that was read, except `oiio:SHA-1`.

    OpenImageIO does not report this hash when reading. It covers level 0 alone, and readers that
    rely on it would take the file for Blender's.
    """
    if is_float:
        spec.erase_attribute(KEY)
        if made_of:
            spec.attribute(KEY, made_of)
        return spec
    described = ((name, spec.getattribute(name)) for name in _DESCRIBED)
    words = [f"{name}={value}" for name, value in described if value is not None]
    if not words:
        words = [IN_DESCRIPTION.sub("", spec.getattribute("ImageDescription") or "")]
    text = " ".join(filter(None, [*words, f"{KEY}={made_of}" if made_of else ""]))
    spec.erase_attribute("ImageDescription")
    if text:
        spec.attribute("ImageDescription", text)
    return spec


def _made_of(spec: Any) -> str:
    """Returns the fingerprint that `stage` stored in a file; empty for none."""
    match = IN_DESCRIPTION.search(spec.getattribute("ImageDescription") or "")
    return match[1] if match else str(spec.getattribute(KEY) or "")


def _level_spec(oiio: Any, first: Any, pixels: FloatArray) -> Any:
    height, width, channels = pixels.shape
    spec = oiio.ImageSpec(width, height, channels, first.format)
    spec.tile_width, spec.tile_height = first.tile_width, first.tile_height
    # Without DateTime a TIFF level gets the present time, so that equal bakes would differ.
    for name in ("compression", "planarconfig", "DateTime"):
        value = first.getattribute(name)
        if value is not None:
            spec.attribute(name, value)
    return spec


def _write(writer: Any, path: Path, spec: Any, mode: str, pixels: Any) -> None:
    if not writer.open(str(path), spec, mode) or not writer.write_image(pixels):
        raise OSError(f"cannot write '{path}': {openimageio.last_error(writer)}")
