# SPDX-License-Identifier: GPL-3.0-or-later

"""Makes a mip-mapped TIFF of a picture file with prefilter, as a tool around the package would.

usage: bake_file.py PICTURE MESH TARGET FILTER THREADS, MESH as scene.py writes it.
"""

import sys

import numpy as np
import OpenImageIO as oiio
import prefilter

TILE = 64  # Texels along a side, as maketx has it.


def main(picture: str, mesh: str, target: str, filter: str, threads: int) -> None:
    """Reads, filters and writes."""
    file = oiio.ImageInput.open(picture)
    pixels = np.ascontiguousarray(file.read_image("uint8")[::-1])
    file.close()
    surface = prefilter.Surface(**np.load(mesh))
    levels = prefilter.mipmaps(
        pixels, surface, filter=filter, encoding="srgb", wrap="repeat", threads=threads
    )
    output = oiio.ImageOutput.create(target)
    for count, level in enumerate(levels):
        height, width, channels = level.shape
        spec = oiio.ImageSpec(width, height, channels, "uint8")
        spec.tile_width = spec.tile_height = TILE
        spec.attribute("compression", "zip")
        spec.attribute("oiio:ColorSpace", "sRGB")
        mode = "Create" if count == 0 else "AppendSubimage"
        if not (output.open(target, spec, mode) and output.write_image(level[::-1])):
            raise OSError(output.geterror())
    output.close()


if __name__ == "__main__":
    main(*sys.argv[1:5], int(sys.argv[5]))
