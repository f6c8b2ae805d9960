# SPDX-License-Identifier: GPL-3.0-or-later

"""Small glTF files with the nodes that real ones have: parents, cameras, skins, shared images."""

import base64
import io
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

_FLOAT, _SHORT, _BYTE = 5126, 5123, 5121


class _Buffer:
    """The binary part of a document, with its views and accessors."""

    def __init__(self, document: dict[str, Any]) -> None:
        """Starts empty."""
        self._document, self._data = document, b""
        document |= {"accessors": [], "bufferViews": []}

    def add(self, values: Any, kind: str, component: int) -> int:
        """Adds an accessor, and returns its number."""
        array = np.asarray(values, {_FLOAT: "<f4", _SHORT: "<u2", _BYTE: "u1"}[component])
        self._data += bytes(-len(self._data) % 4)
        view = {"buffer": 0, "byteOffset": len(self._data), "byteLength": array.nbytes}
        self._document["bufferViews"].append(view)
        self._data += array.tobytes()
        accessor: dict[str, Any] = {
            "bufferView": len(self._document["bufferViews"]) - 1,
            **{"componentType": component, "count": len(array), "type": kind},
        }
        if kind == "VEC3":
            accessor |= {"min": array.min(axis=0).tolist(), "max": array.max(axis=0).tolist()}
        self._document["accessors"].append(accessor)
        return len(self._document["accessors"]) - 1

    def finish(self) -> None:
        """Embeds the data."""
        encoded = base64.b64encode(self._data).decode()
        uri = f"data:application/octet-stream;base64,{encoded}"
        self._document["buffers"] = [{"byteLength": len(self._data), "uri": uri}]


def write(stem: Path, random: np.random.Generator) -> Mapping[str, Any]:
    """Writes a quad with a texture in a scene of some kind."""
    document: dict[str, Any] = {"asset": {"version": "2.0"}, "scene": 0}
    buffer = _Buffer(document)
    attributes = {
        "POSITION": buffer.add([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], "VEC3", _FLOAT),
        "TEXCOORD_0": buffer.add([(0, 1), (1, 1), (1, 0), (0, 0)], "VEC2", _FLOAT),
    }
    primitive = {
        "attributes": attributes,
        "indices": buffer.add([0, 1, 2, 0, 2, 3], "SCALAR", _SHORT),
        "material": 0,
    }
    nodes: list[dict[str, Any]] = [{"name": "Quad", "mesh": 0}]
    roots = [0]
    made = str(random.choice(["plain", "parent", "camera", "skin", "deep", "two"]))
    if made in ("parent", "deep"):
        for name in ("Parent", "Grandparent")[: 1 + (made == "deep")]:
            nodes.append({"name": name, "children": roots, "rotation": [0, 0, 0.6, 0.8]})
            roots = [len(nodes) - 1]
    elif made == "camera":
        document["cameras"] = [{"type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.1}}]
        nodes.append({"name": "Camera", "camera": 0, "translation": [0, 0, 5]})
        roots.append(1)
    elif made == "skin":
        attributes["JOINTS_0"] = buffer.add(np.zeros((4, 4)), "VEC4", _BYTE)
        attributes["WEIGHTS_0"] = buffer.add([(1, 0, 0, 0)] * 4, "VEC4", _FLOAT)
        inverse = buffer.add([np.eye(4).ravel()], "MAT4", _FLOAT)
        document["skins"] = [{"joints": [1], "inverseBindMatrices": inverse}]
        nodes[0]["skin"] = 0
        nodes.append({"name": "Bone"})
        roots.append(1)
    elif made == "two":
        nodes.append({"name": "Again", "mesh": 0, "scale": [-1, 2, 0.5]})
        roots.append(1)
    is_shared = bool(random.random() < 0.3)
    material: dict[str, Any] = {"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}
    if is_shared:
        material["normalTexture"] = {"index": 0}
    document |= {
        "scenes": [{"nodes": roots}],
        "nodes": nodes,
        "meshes": [{"primitives": [primitive]}],
        "materials": [material],
        "textures": [{"source": 0}],
        "images": [{"uri": _texture(random), "name": "Paint"}],
    }
    buffer.finish()
    stem.with_suffix(".gltf").write_text(json.dumps(document), encoding="utf-8")
    return {"must_work": True, "made": made, "images": 2 if is_shared else 1}


def _texture(random: np.random.Generator) -> str:
    side = int(random.choice([8, 32, 48]))
    pixels = np.uint8(random.integers(0, 256, (side, side, 3)))
    data = io.BytesIO()
    Image.fromarray(pixels).save(data, "PNG")
    return "data:image/png;base64," + base64.b64encode(data.getvalue()).decode()
