"""Texture files, staged beside their target and renamed into place; here those for renderers.

* OpenEXR: scene-linear, associated alpha, 16-bit floats unless 32 are asked for.
* TIFF (.tif, .tiff, .tx): a byte image stays 8-bit and in its colour space, a float image is
  written as scene-linear 32-bit floats; associated alpha, as texture readers expect.

A file always holds every level down to 1 x 1, in tiles of 64 x 64. Those for engines are written
by `engine_files`.
"""

import os
import secrets
import shutil
import stat
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from . import images, openimageio
from .images import FloatArray, Picture

_FORMATS = {".exr": "openexr", ".tif": "tiff", ".tiff": "tiff", ".tx": "tiff"}
# Those that `engine_files` writes; the last one gets a file a level.
_OTHER_EXTENSIONS = (".dds", ".ktx2", ".png")
_MOST_LEVELS = 31
_WRAP_MODES = {"repeat": "periodic", "clamp": "clamp", "border": "black"}
_WRITE_BITS = stat.S_IWUSR | stat.S_IWGRP | stat.S_IWOTH


@dataclass(frozen=True)
class StagedFile:
    """A finished file under a temporary name, in the folder of its target."""

    temporary: Path
    target: Path

    def commit(self) -> None:
        """Renames the file into place; it gets the mode of a file that it replaces."""
        if self.target.exists():
            shutil.copymode(self.target, self.temporary)
        os.replace(self.temporary, self.target)

    def discard(self) -> None:
        """Removes the temporary file, if it is still there."""
        self.temporary.unlink(missing_ok=True)


@dataclass(frozen=True)
class StagedFolder:
    """A finished file with those that go with it, in a temporary folder beside its target."""

    temporary: Path
    target: Path

    def commit(self) -> None:
        """Moves the files into place, the target last, and removes the folder."""
        written = sorted(self.temporary.iterdir(), key=lambda path: path.name == self.target.name)
        for path in written:
            StagedFile(path, self.target.with_name(path.name)).commit()
        self.discard()

    def discard(self) -> None:
        """Removes the temporary folder."""
        shutil.rmtree(self.temporary, ignore_errors=True)


def check_target(path: str) -> Path:
    """Returns the absolute path of a texture file that can be written, symbolic links resolved.

    Raises:
        ValueError: The name does not end in a known extension.
        OSError: The folder is missing, or the file or its folder is read-only.
    """
    target = Path(os.path.realpath(path))
    extension = target.suffix.lower()
    allowed = (*_FORMATS, *_OTHER_EXTENSIONS)
    if extension not in allowed:
        raise ValueError(
            f"file '{path}': found extension '{target.suffix}'; allowed are {', '.join(allowed)}"
        )
    if extension == ".png":
        for number in range(_MOST_LEVELS):
            level_file = numbered(target, number)
            _check_place(str(level_file), level_file)
    else:
        _check_place(path, target)
    return target


def numbered(target: Path, number: int) -> Path:
    """Returns the file of a level where each has its own, symbolic links resolved."""
    return Path(os.path.realpath(target.with_suffix(f".{number}{target.suffix}")))


def shown(target: Path) -> str:
    """Returns how to call a file, or the files of all levels."""
    if target.suffix.lower() != ".png":
        return f"'{target}'"
    return f"'{target.with_suffix(f'.0{target.suffix}')}' and so on"


def check_plain_target(path: str, ending: str) -> Path:
    """Returns the absolute path of a file that can be written, and whose name ends as needed.

    Raises:
        ValueError: The name does not end in `ending`.
        OSError: The folder is missing, or the file or its folder is read-only.
    """
    target = Path(os.path.realpath(path))
    if target.suffix.lower() != ending:
        raise ValueError(f"file '{path}': found extension '{target.suffix}'; {ending} is needed")
    _check_place(path, target)
    return target


def check_output(path: str) -> Path:
    """Returns the absolute path of a file of any kind that can be written.

    Raises:
        OSError: The folder is missing, or the file or its folder is read-only.
    """
    target = Path(os.path.realpath(path))
    _check_place(path, target)
    return target


def stage_folder(target: Path, write: Callable[[Path], object]) -> StagedFolder:
    """Has a function write a file under its own name, and others with it, beside its target.

    Raises:
        OSError: The file cannot be written.
    """
    staged = StagedFolder(target.with_name(f".prefilter-{secrets.token_hex(4)}"), target)
    staged.temporary.mkdir()
    try:
        write(staged.temporary / target.name)
        if not (staged.temporary / target.name).exists():
            raise OSError(f"file '{target}': Blender did not write it")
    except BaseException:
        staged.discard()
        raise
    return staged


def stage_with(target: Path, write: Callable[[Path], object]) -> StagedFile:
    """Has a function write a file beside its target.

    Raises:
        OSError: The file cannot be written.
    """
    staged = _staged(target)
    try:
        write(staged.temporary)
    except BaseException:
        staged.discard()
        raise
    return staged


def check_writable(path: Path) -> None:
    """Raises OSError if a file or its folder is read-only.

    Root may write what has no write bits; a path without them is left alone all the same.
    """
    if path.exists() and not _is_writable(path):
        raise OSError(f"file '{path}' is read-only")
    if not _is_writable(path.parent):
        raise OSError(f"file '{path}': its folder is read-only")


def stage(
    target: Path,
    picture: Picture,
    linear_levels: Sequence[FloatArray],
    stored_levels: Sequence[FloatArray],
    wrap: tuple[str, str],
    check: openimageio.Check,
    *,
    half: bool = True,
) -> StagedFile:
    """Writes a mip-mapped file beside its target.

    Args:
        target: A path from `check_target`.
        picture: Where the levels come from.
        linear_levels: Every level, scene-linear, row 0 at the bottom.
        stored_levels: The same levels in the encoding of the picture.
        wrap: Wrap modes in u and v.
        check: Called before each level.
        half: Whether OpenEXR gets 16-bit floats instead of 32-bit ones.

    Raises:
        OSError: The file cannot be written.
    """
    file_format = _FORMATS[target.suffix.lower()]
    keep_bytes = file_format == "tiff" and not picture.is_float
    levels = stored_levels if keep_bytes else linear_levels
    float_type = "half" if file_format == "openexr" and half else "float"
    staged = _staged(target)
    try:
        openimageio.write_texture(
            staged.temporary,
            [_file_pixels(picture, level) for level in levels],
            file_format=file_format,
            pixel_type="uint8" if keep_bytes else float_type,
            color_space=_color_space(picture, keep_bytes),
            wrap_modes=",".join(_WRAP_MODES[mode] for mode in wrap),
            has_alpha=picture.alpha_is_coverage,
            check=check,
        )
    except BaseException:
        staged.discard()
        raise
    return staged


def _check_place(path: str, target: Path) -> None:
    if not target.parent.is_dir():
        raise OSError(f"file '{path}': there is no folder '{target.parent}'")
    if target.is_dir():
        raise OSError(f"file '{path}' is a folder")
    check_writable(target)


def _staged(target: Path) -> StagedFile:
    name = f".prefilter-{secrets.token_hex(4)}{target.suffix}"
    return StagedFile(target.with_name(name), target)


def _file_pixels(picture: Picture, level: FloatArray) -> FloatArray:
    """Returns a level with associated alpha and rows from the top."""
    if picture.alpha_is_straight:
        level = np.concatenate([level[..., :3] * level[..., 3:], level[..., 3:]], axis=2)
    return np.ascontiguousarray(level[::-1])


def _color_space(picture: Picture, keep_bytes: bool) -> str:
    if picture.is_data:
        return "raw"
    if keep_bytes and picture.encoding is not images.Encoding.NONE:
        return picture.colorspace
    return "scene_linear"


def _is_writable(path: Path) -> bool:
    return os.access(path, os.W_OK) and bool(path.stat().st_mode & _WRITE_BITS)
