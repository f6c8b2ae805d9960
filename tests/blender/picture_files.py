# SPDX-License-Identifier: GPL-3.0-or-later

"""Picture files written and read back without Blender."""

import numpy as np
import OpenImageIO as oiio


def write(path, pixels, kind, *, straight=True):
    """Writes rows from the bottom as a picture file of uint8, uint16, half or float values."""
    spec = oiio.ImageSpec(pixels.shape[1], pixels.shape[0], pixels.shape[2], kind)
    if straight:
        spec.attribute("oiio:UnassociatedAlpha", 1)
    writer = oiio.ImageOutput.create(str(path))
    assert writer.open(str(path), spec)
    assert writer.write_image(np.ascontiguousarray(pixels[::-1], np.float32))
    writer.close()


def content(path):
    """Returns rows from the bottom as they are stored, and the type of the values."""
    config = oiio.ImageSpec()
    config.attribute("oiio:UnassociatedAlpha", 1)
    buffer = oiio.ImageBuf(str(path), 0, 0, config)
    pixels = buffer.get_pixels("float")
    assert not buffer.has_error, buffer.geterror()
    return pixels[::-1], str(buffer.spec().format)
