# SPDX-License-Identifier: GPL-3.0-or-later

"""Contents of glTF files, without their buffers."""

import json
import struct
from pathlib import Path
from typing import Any


def read_tree(path: Path) -> dict[str, Any]:
    """Returns the JSON of a .glb or .gltf file."""
    data = path.read_bytes()
    if path.suffix == ".glb":
        (length,) = struct.unpack_from("<I", data, 12)
        data = data[20 : 20 + length]
    return json.loads(data)
