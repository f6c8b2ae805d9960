"""OpenImageIO's own Python module, as far as the add-on needs it; imported when it is needed.

Official Blender builds carry it. A second copy of the library inside Blender's process is a known
source of crashes, so the add-on brings none.
"""

import tempfile
from collections.abc import Sequence
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float32]

TILE_SIZE = 64


def module() -> ModuleType:
    """Returns the module.

    Raises:
        OSError: It is not installed.
    """
    try:
        import OpenImageIO
    except ImportError as error:
        raise OSError(
            "OpenImageIO's Python module is missing from this Blender; on Debian and Ubuntu "
            "install the package python3-openimageio"
        ) from error
    return OpenImageIO


def color_convert(colors: FloatArray, source: str, target: str, config: str) -> FloatArray:
    """Converts (h, w, 3) colours between two spaces of an OpenColorIO configuration.

    Raises:
        ValueError: A space is unknown to the configuration, or it cannot be read.
    """
    oiio = module()
    result = oiio.ImageBufAlgo.colorconvert(
        oiio.ImageBuf(colors), source, target, unpremult=False, colorconfig=config
    )
    if result.has_error:
        raise ValueError(f"{result.geterror()} (configuration '{config}')")
    return result.get_pixels("float")


def write_texture(
    path: str,
    levels: Sequence[FloatArray],
    *,
    file_format: str,
    pixel_type: str,
    color_space: str,
    wrap_modes: str,
    has_alpha: bool,
) -> None:
    """Writes levels, rows from the top, as a tiled mip-mapped texture.

    The levels go through OpenImageIO's own texture maker, which takes the images of all levels. Its
    plain writer never finishes a mip-mapped OpenEXR file from Python: such a file is completed when
    the writer is destroyed, and the Python object does not own it.

    Args:
        path: The file; replaced where it exists.
        levels: (h, w, c) arrays from the full size down to 1 x 1.
        file_format: "openexr" or "tiff".
        pixel_type: "uint8", "half" or "float".
        color_space: What to say in `oiio:ColorSpace`.
        wrap_modes: What to say in `wrapmodes`, such as "periodic,clamp".
        has_alpha: Whether a fourth channel is alpha, or one more independent channel.

    Raises:
        OSError: The file cannot be written.
    """
    oiio = module()
    with tempfile.TemporaryDirectory(prefix="prefilter-") as folder:
        level_files = []
        for number, level in enumerate(levels[1:], start=1):
            level_file = str(Path(folder) / f"{number}.tif")
            buffer = _buffer(level, has_alpha)
            if not buffer.write(level_file):
                raise OSError(f"cannot write level {number} to '{level_file}': {buffer.geterror()}")
            level_files.append(level_file)

        config = oiio.ImageSpec()
        config.set_format(pixel_type)
        config.tile_width = config.tile_height = TILE_SIZE
        config.attribute("Software", "Prefilter")
        config.attribute("compression", "zip")
        config.attribute("oiio:ColorSpace", color_space)
        config.attribute("wrapmodes", wrap_modes)
        config.attribute("maketx:fileformatname", file_format)
        config.attribute("maketx:mipimages", ";".join(level_files))

        full = _buffer(levels[0], has_alpha)
        if not oiio.ImageBufAlgo.make_texture(oiio.MakeTxTexture, full, path, config):
            raise OSError(f"cannot write '{path}': {oiio.geterror()}")


def _buffer(pixels: FloatArray, has_alpha: bool) -> Any:
    """Returns an ImageBuf; what it says is alpha gets clipped to [0, 1] on the way into halves."""
    buffer = module().ImageBuf(pixels)
    if not has_alpha:
        buffer.specmod().alpha_channel = -1
    return buffer
