# SPDX-License-Identifier: GPL-3.0-or-later

"""glTF files made from their parts, with pictures beside them."""

import base64
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio
import scenes
from numpy.typing import NDArray

_FLOAT, _UINT16 = 5126, 5123


def write_png(path: Path, pixels: NDArray[np.float32]) -> None:
    """Writes values from 0 to 1, row 0 at the bottom, as 8-bit PNG."""
    height, width, channels = pixels.shape
    writer = oiio.ImageOutput.create(str(path))
    assert writer.open(str(path), oiio.ImageSpec(width, height, channels, "uint8"))
    assert writer.write_image(np.rint(pixels[::-1] * 255).astype(np.uint8))
    writer.close()


def write(path: Path, materials: Sequence[Mapping[str, Any]], images: Sequence[str]) -> None:
    """Writes squares side by side, one a material, each with the whole unit square as UVs.

    Args:
        path: The file.
        materials: As in the file; texture i is image i.
        images: The names of picture files in the folder of the file.
    """
    corners = np.array([(x, y, 0.0) for x, y in scenes.UNIT_SQUARE], np.float32)
    uvs = np.array([(x, 1 - y) for x, y in scenes.UNIT_SQUARE], np.float32)
    triangles = np.array([0, 1, 2, 0, 2, 3], np.uint16)
    parts = [corners.tobytes(), uvs.tobytes(), triangles.tobytes()]
    starts = np.cumsum([0, *map(len, parts)]).tolist()
    data = b"".join(parts)
    file = {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": list(range(len(materials)))}],
        "nodes": [
            {"mesh": i, "name": f"Square {i}", "translation": [2 * i, 0, 0]}
            for i in range(len(materials))
        ],
        "meshes": [
            {
                "primitives": [
                    {"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2, "material": i}
                ]
            }
            for i in range(len(materials))
        ],
        "materials": list(materials),
        "textures": [{"source": i} for i in range(len(images))],
        "images": [{"uri": name} for name in images],
        "accessors": [
            {
                "bufferView": 0,
                "componentType": _FLOAT,
                "count": 4,
                "type": "VEC3",
                "min": [0, 0, 0],
                "max": [1, 1, 0],
            },
            {"bufferView": 1, "componentType": _FLOAT, "count": 4, "type": "VEC2"},
            {"bufferView": 2, "componentType": _UINT16, "count": 6, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": start, "byteLength": len(part)}
            for start, part in zip(starts, parts, strict=False)
        ],
        "buffers": [
            {
                "byteLength": len(data),
                "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode(),
            }
        ],
    }
    path.write_text(json.dumps(file))
