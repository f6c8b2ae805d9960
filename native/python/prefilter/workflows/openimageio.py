# SPDX-License-Identifier: GPL-3.0-or-later

"""Reading and writing pictures with OpenImageIO's Python module, which is imported on demand."""

import itertools
import re
import shutil
import tempfile
from collections.abc import Callable, Iterator, Sequence
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..files.claims import temporary_folder
from ..files.undecodable_names import reads_any_name, writes_any_name
from .damage import damaged
from .files.tiff import NO_DATE, remove_dates
from .memory import free_memory
from .wording import listed

FloatArray = NDArray[np.float32]

TILE_SIZE = 64

Check = Callable[[], None]
"""Called between stages of long work; raises to cancel it."""

_MOST_CHANNELS = 4
_MOST_NAMES = 6
"""Largest number of channels that a warning lists."""
_PIXELS_A_BAND = 1 << 20
_PATH_SEPARATOR = ";"
_PLACEHOLDER = "%"
_CUT_OFF = "Premature end of JPEG"
"""Error of a truncated JPEG file, whose missing rest is read as gray."""
_PNG = b"\x89PNG\r\n\x1a\n"
_MOST_ORIENTATIONS = 8
_RGB_MODELS = frozenset({"", "RGB", "YCbCr", "Grayscale", "gray", "palette"})
_DESCRIBED_SPACE = re.compile(r"\bcolorInteropID=(\w+)")
"""The color space in the description of TIFF files of levels."""
_EXIF_ADOBE_RGB, _ADOBE_RGB_RULE = 2, "R03"


class Metadata(NamedTuple):
    """Metadata of a picture file about its colors and orientation.

    Attributes:
        format: Name of the file format.
        orientation: Orientation by EXIF, 1 to 8; 1 is upright.
        model: Color model if neither RGB nor gray, such as "CMYK"; else empty.
        interop_id: The Color Interop Forum's name of the color space; empty if absent.
        color_space: OpenImageIO's name of the color space; empty if it has none.
        gamma: The exponent, if `color_space` leaves that open.
        icc: The ICC profile; empty if absent.
        chromaticities: x and y of red, green, blue and white; None if absent.
        is_adobe_rgb: Whether EXIF names Adobe RGB.
    """

    format: str
    orientation: int = 1
    model: str = ""
    interop_id: str = ""
    color_space: str = ""
    gamma: float = 1.0
    icc: bytes = b""
    chromaticities: tuple[float, ...] | None = None
    is_adobe_rgb: bool = False


class Pixels(NamedTuple):
    """Pixels and metadata of a picture file.

    Attributes:
        values: (h, w, c) array of uint8, uint16 or float32, rows from the top.
        is_straight: Whether colors are not multiplied by alpha.
        metadata: Metadata about the colors.
        left_out: Unread contents, such as "the channels 'Z', 'mask'"; empty for none.
    """

    values: NDArray[Any]
    is_straight: bool
    metadata: Metadata
    left_out: str = ""


def module() -> ModuleType:
    """Returns the module.

    Raises:
        OSError: It is not installed.
    """
    return _finder()


def last_error(source: Any) -> str:
    """Returns the last error message of the module, or of an object of it, in one line."""
    return " ".join(source.geterror().split())


def set_finder(finder: Callable[[], ModuleType]) -> None:
    """Sets the function that finds the module in this process; it raises OSError on failure."""
    global _finder
    _finder = finder


def _installed() -> ModuleType:
    try:
        return import_module("OpenImageIO")
    except ImportError as error:
        raise OSError(
            "pictures need OpenImageIO, which is missing: pip install 'prefilter[command]'"
        ) from error


_finder = _installed


def color_convert(
    colors: FloatArray, source: str, target: str, config: str, check: Check
) -> FloatArray:
    """Converts (h, w, 3) colors between two spaces of an OpenColorIO configuration.

    Args:
        colors: The colors.
        source: The name of the colors' space.
        target: The space to convert them to.
        config: Path of the configuration.
        check: Called between bands of rows.

    Raises:
        ValueError: A space is unknown, or the configuration cannot be read.
    """
    oiio = module()
    converted = np.empty_like(colors)
    rows = max(1, _PIXELS_A_BAND // colors.shape[1])
    for start in range(0, len(colors), rows):
        check()
        band = slice(start, start + rows)
        result = oiio.ImageBufAlgo.colorconvert(
            oiio.ImageBuf(colors[band]), source, target, unpremult=False, colorconfig=config
        )
        if result.has_error:
            raise ValueError(f"{last_error(result)} (configuration '{config}')")
        converted[band] = result.get_pixels("float")
    return converted


class ValueKind(NamedTuple):
    """Kind of values in a picture file.

    Attributes:
        is_integer: Whether they are integers; False if unknown.
        is_gray: Whether one channel stands for all colors; False if unknown.
    """

    is_integer: bool
    is_gray: bool


def value_kind(path: str) -> ValueKind:
    """Returns the kind of values in a picture file, as far as that can be determined."""
    try:
        oiio = module()
    except OSError:
        return ValueKind(is_integer=_is_png(path), is_gray=False)
    reader = oiio.ImageInput.open(path)
    if reader is None:
        oiio.geterror()
        return ValueKind(is_integer=False, is_gray=False)
    spec = reader.spec()
    reader.close()
    kind, channels = spec.format.basetype, _channels(list(spec.channelnames))
    return ValueKind(
        is_integer=kind not in {oiio.HALF, oiio.FLOAT, oiio.DOUBLE},
        is_gray=len(channels) in {1, 2},
    )


def _is_png(path: str) -> bool:
    try:
        with open(path, "rb") as file:
            return file.read(len(_PNG)) == _PNG
    except OSError:
        return False


@reads_any_name
def read_pixels(path: Path) -> Pixels:
    """Reads a picture file without converting alpha or colors.

    Raises:
        ValueError: The channels are neither gray nor RGB, with or without alpha.
        MemoryError: By the size in its header, it is larger than the free memory.
        OSError: OpenImageIO cannot read it, or it is damaged.
    """
    oiio = module()
    reader = _opened(path)
    try:
        spec = reader.spec()
        channels = _channels(list(spec.channelnames))
        if not channels:
            names = ", ".join(spec.channelnames)
            raise ValueError(f"'{path}': found the channels {names}; R, G, B and A are needed")
        kind = spec.format.basetype
        is_float = kind in {oiio.HALF, oiio.FLOAT, oiio.DOUBLE}
        read_as = {oiio.UINT8: "uint8"}.get(kind, "float" if is_float else "uint16")
        _check_memory(spec, read_as)
        metadata = _metadata(reader.format_name(), spec)
        values = reader.read_image(read_as)
        failure = last_error(reader)
        # Readers of JPEG files also report harmless problems.
        if values is None or (_CUT_OFF in failure if metadata.format == "jpeg" else failure):
            raise OSError(_unreadable(path, failure))
        is_straight = bool(spec.get_int_attribute("oiio:UnassociatedAlpha", 0))
        left_out = _left_out(reader, spec, channels)
    finally:
        reader.close()
    values = np.asarray(values).reshape(spec.height, spec.width, spec.nchannels)[..., channels]
    return Pixels(_on_canvas(values, spec), is_straight, metadata, left_out)


def _left_out(reader: Any, spec: Any, channels: Sequence[int]) -> str:
    """Returns a text about unread channels and images of a file; empty if there are none."""
    contents = []
    names = [name for k, name in enumerate(spec.channelnames) if k not in channels]
    if names:
        shown = names if len(names) <= _MOST_NAMES else [*names[:_MOST_NAMES], "others"]
        contents.append(f"the channel{'s' if len(names) > 1 else ''} {listed(shown)}")
    if reader.seek_subimage(1, 0):
        contents.append("further images")
    return " and ".join(contents)


@reads_any_name
def read_metadata(path: Path) -> tuple[Metadata, int, bool]:
    """Reads the metadata of a picture file, but no pixels.

    Returns:
        The metadata, the number of channels that count, and whether they are floats.

    Raises:
        MemoryError: As for `read_pixels`.
        OSError: As for `read_pixels`.
    """
    oiio, reader = module(), _opened(path)
    try:
        spec = reader.spec()
        _check_memory(spec, "float")
        is_float = spec.format.basetype in {oiio.HALF, oiio.FLOAT, oiio.DOUBLE}
        channels = len(_channels(list(spec.channelnames)))
        return _metadata(reader.format_name(), spec), channels, is_float
    finally:
        reader.close()


def _opened(path: Path) -> Any:
    oiio = module()
    config = oiio.ImageSpec()
    config.attribute("oiio:UnassociatedAlpha", 1)
    reader = oiio.ImageInput.open(str(path), config)
    if reader is None:
        raise OSError(_unreadable(path, last_error(oiio)))
    return reader


def _check_memory(spec: Any, read_as: str) -> None:
    """Raises MemoryError if a picture would not fit into memory, before any of it is decoded."""
    size = np.dtype(read_as.replace("float", "float32")).itemsize
    read = spec.width * spec.height * spec.nchannels * size
    # A copy in our row order; integers of more than 8 bits become floats.
    canvas_values = spec.full_width * spec.full_height * min(max(spec.nchannels, 3), _MOST_CHANNELS)
    needed = read + canvas_values * (1 if size == 1 else 8)
    free, why = free_memory()
    if needed > free:
        raise MemoryError(
            f"a picture of {spec.full_width} x {spec.full_height} pixels needs about "
            f"{needed / 1e9:.3g} GB of memory; {why}"
        )


def _metadata(format: str, spec: Any) -> Metadata:
    model = str(spec.getattribute(f"{format}:ColorSpace") or "")
    interop = str(spec.getattribute("Exif:InteroperabilityIndex") or "")
    points = spec.getattribute("chromaticities")
    profile = spec.getattribute("ICCProfile")
    orientation = spec.get_int_attribute("Orientation", 1)
    described = _DESCRIBED_SPACE.search(str(spec.getattribute("ImageDescription") or ""))
    return Metadata(
        format=format,
        orientation=orientation if 1 <= orientation <= _MOST_ORIENTATIONS else 1,
        model="" if model in _RGB_MODELS else model,
        interop_id=str(spec.getattribute("colorInteropID") or (described[1] if described else "")),
        color_space=str(spec.getattribute("oiio:ColorSpace") or ""),
        gamma=float(spec.get_float_attribute("oiio:Gamma", 1.0)),
        icc=b"" if profile is None else np.asarray(profile).astype(np.uint8).tobytes(),
        chromaticities=None if points is None else tuple(float(number) for number in points),
        is_adobe_rgb=spec.get_int_attribute("Exif:ColorSpace", 0) == _EXIF_ADOBE_RGB
        or interop.startswith(_ADOBE_RGB_RULE),
    )


def _unreadable(path: Path, reason: str) -> str:
    return f"'{path}' cannot be read as a picture: {damaged(path, reason)}"


def _channels(names: list[str]) -> list[int]:
    """Returns the indices of the channels: gray, or red, green and blue, then alpha if present."""
    by_name = {name.upper(): index for index, name in enumerate(names)}
    if "RY" in by_name or "BY" in by_name:
        return []  # Luminance with subsampled chroma.
    for colors in (("R", "G", "B"), ("Y",)):
        if all(name in by_name for name in colors):
            return [by_name[name] for name in (*colors, "A") if name in by_name]
    return list(range(len(names))) if len(names) <= _MOST_CHANNELS else []


def _on_canvas(values: NDArray[Any], spec: Any) -> NDArray[Any]:
    """Returns the full display window, where the file's data window differs; 0 elsewhere."""
    left, top = spec.x - spec.full_x, spec.y - spec.full_y
    height, width = spec.full_height, spec.full_width
    if (left, top, height, width) == (0, 0, *values.shape[:2]):
        return values
    canvas = np.zeros((height, width, values.shape[2]), values.dtype)
    low_x, low_y = max(left, 0), max(top, 0)
    high_x, high_y = min(left + values.shape[1], width), min(top + values.shape[0], height)
    if low_x < high_x and low_y < high_y:
        part = values[low_y - top : high_y - top, low_x - left : high_x - left]
        canvas[low_y:high_y, low_x:high_x] = part
    return canvas


@reads_any_name
def text_attribute(path: Path, name: str) -> str:
    """Returns a text attribute of a picture file; empty if absent.

    Raises:
        OSError: The file cannot be read.
    """
    reader = module().ImageInput.open(str(path))
    if reader is None:
        raise OSError(_unreadable(path, last_error(module())))
    try:
        return str(reader.spec().getattribute(name) or "")
    finally:
        reader.close()


@reads_any_name
def check_whole(path: Path, levels: int = 1) -> None:
    """Reads a written file back, band by band: writers do not report failures at the end.

    Args:
        path: The file.
        levels: Its least number of levels: a truncated TIFF file may lack the last ones without an
            error.

    Raises:
        OSError: It cannot be read completely.
    """
    reader = module().ImageInput.open(str(path))
    if reader is None:
        reason = last_error(module())
        raise OSError(f"'{path.name}' was not written as a whole; is the disk full? {reason}")
    try:
        if _levels_read(reader) < levels:
            raise OSError(
                f"'{path.name}' was not written as a whole; is the disk full? {last_error(reader)}"
            )
    finally:
        reader.close()


def _levels_read(reader: Any) -> int:
    """Returns the number of levels of a file; 0 if it cannot be read completely."""
    levels = set()
    for image, level, first, end in _bands(reader):
        if not _is_read(reader, image, level, first, end):
            return 0
        levels.add((image, level))
    return len(levels)


def _bands(reader: Any) -> Iterator[tuple[int, int, int, int]]:
    """Yields bands of all images of a file: numbers of image and level, first and end row.

    Some formats store levels as parts of an image, others as images.
    """
    for image in itertools.count():
        for level in itertools.count():
            if not reader.seek_subimage(image, level):
                if not level:
                    return
                break
            spec = reader.spec()
            rows = max(1, _PIXELS_A_BAND // (TILE_SIZE * spec.width)) * TILE_SIZE
            for first in range(spec.y, spec.y + spec.height, rows):
                yield image, level, first, min(first + rows, spec.y + spec.height)


def _is_read(reader: Any, image: int, level: int, first: int, end: int) -> bool:
    spec = reader.spec()
    if spec.tile_width:
        x = spec.x, spec.x + spec.width
        pixels = reader.read_tiles(
            image, level, *x, first, end, 0, 1, 0, spec.nchannels, spec.format
        )
    else:
        pixels = reader.read_scanlines(image, level, first, end, 0, 0, spec.nchannels, spec.format)
    return pixels is not None


@writes_any_name
def write_texture(
    path: Path,
    levels: Sequence[NDArray[Any]],
    *,
    pixel_type: str,
    color_space: str,
    wrap_modes: str,
    has_alpha: bool,
    check: Check,
    description: str = "",
) -> None:
    """Writes levels, rows from the top, as a tiled mip-mapped TIFF file.

    OpenImageIO's own texture maker writes the file, from images of all levels, so that renderers
    accept it.
    Args:
        path: The file; replaced if it exists. A failure may leave an incomplete file.
        levels: (h, w, c) arrays of floats, or bytes, from the full size down to 1 x 1.
        pixel_type: "uint8" or "float".
        color_space: Value of `oiio:ColorSpace`.
        wrap_modes: Value of `wrapmodes`, such as "periodic,clamp".
        has_alpha: Whether a fourth channel is alpha, or one more independent channel.
        check: Called before each level.
        description: Value of `ImageDescription`.

    Raises:
        OSError: The file cannot be written.
    """
    oiio = module()
    with temporary_folder(_work_folder(path)) as folder:
        level_files = []
        for number, level in enumerate(levels[1:], start=1):
            check()
            level_file = str(folder / f"{number}.tif")
            _write_level(level_file, _buffer(level, has_alpha), number)
            level_files.append(level_file)
        check()

        config = oiio.ImageSpec()
        config.set_format(pixel_type)
        config.tile_width = config.tile_height = TILE_SIZE
        config.attribute("Software", "Prefilter")
        config.attribute("DateTime", NO_DATE)
        config.attribute("compression", "zip")
        if description:
            config.attribute("ImageDescription", description)
        config.attribute("oiio:ColorSpace", color_space)
        config.attribute("wrapmodes", wrap_modes)
        config.attribute("maketx:fileformatname", "tiff")
        config.attribute("maketx:mipimages", _PATH_SEPARATOR.join(level_files))

        full = _buffer(levels[0], has_alpha)
        temporary = str(folder / f"texture{path.suffix}")
        if not oiio.ImageBufAlgo.make_texture(oiio.MakeTxTexture, full, temporary, config):
            raise OSError(f"cannot write '{temporary}': {last_error(oiio)}")
        remove_dates(Path(temporary))
        shutil.move(temporary, path)
    check_whole(path, len(levels))


def _work_folder(path: Path) -> str:
    """Returns a temporary folder whose path the texture maker does not misread.

    The texture maker gets the paths of all levels in one string, and replaces '%' by digits.
    """
    folders = (tempfile.gettempdir(), str(path.parent))
    for folder in folders:
        if _PATH_SEPARATOR not in folder and _PLACEHOLDER not in folder:
            return folder
    candidates = " and ".join(f"'{folder}'" for folder in folders)
    raise OSError(
        f"no folder for temporary files: found {candidates}, and one without ';' and '%' is needed"
    )


def _write_level(path: str, buffer: Any, number: int) -> None:
    """Writes a level and reads it back: the texture maker aborts the process if it cannot."""
    if not buffer.write(path):
        raise OSError(f"cannot write level {number} to '{path}': {last_error(buffer)}")
    reader = module().ImageInput.open(path)
    if reader is None:
        raise OSError(f"cannot read level {number} back from '{path}': {last_error(module())}")
    reader.close()


def _buffer(pixels: NDArray[Any], has_alpha: bool) -> Any:
    """Returns an ImageBuf whose alpha channel is marked."""
    buffer = module().ImageBuf(pixels)
    spec = buffer.specmod()
    if pixels.shape[2] < 3:
        spec.channelnames = ("Y", "A")[: pixels.shape[2]]
    spec.alpha_channel = pixels.shape[2] - 1 if has_alpha and pixels.shape[2] in {2, 4} else -1
    return buffer
