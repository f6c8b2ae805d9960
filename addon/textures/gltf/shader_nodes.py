# SPDX-License-Identifier: GPL-3.0-or-later

"""Applies shader nodes to images, which the glTF exporter writes without them."""

import re
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import bpy
import numpy as np
import prefilter
from numpy.typing import NDArray

from ...bridge.nodes import Groups
from ...bridge.texel_functions import OtherNodeError, TexelFunction, before_factor, partial_factor
from ...core.wording import listed

Floats = NDArray[np.float32]
ColorOf = Callable[[bpy.types.Image], Floats]

_CHANNELS = {"Roughness": 1, "Metallic": 2}
"""The channel of the picture for each scalar input."""
_ALPHA = "Alpha"
_INLINED = re.compile(r"^\d+_")
"""The prefix of node names in trees in which the exporter of Blender 5 has inlined groups."""


def changed_texels(
    texels: Floats, sockets: Sequence[Any], color_of: ColorOf
) -> tuple[Floats | None, list[str]]:
    """Applies the nodes between an image and the shader.

    Args:
        texels: (height, width, 3 or 4), the picture made by the exporter.
        sockets: The shader inputs of the picture, as the exporter's objects.
        color_of: Returns the values of an image as shaders read them.

    Returns:
        The changed texels, or None without changes; and warnings about ignored nodes.
    """
    changed: Floats | None = None
    warnings: list[str] = []
    for entry in sockets:
        socket = entry.socket
        groups = tuple(node for node in entry.group_path if getattr(node, "type", "") == "GROUP")
        if socket.name == _ALPHA:
            continue
        partial = partial_factor(socket, groups)
        if partial is not None:
            warnings.append(_ignored(socket, [partial], "is exported as if its factor were 1"))
        function = TexelFunction(color_of)
        try:
            values = _stored(function, *before_factor(socket, groups))
        except OtherNodeError as error:
            warnings.append(_ignored(socket, [error.node], "makes colors of its own"))
            continue
        if not function.changing or function.image is None:
            continue
        channels = _channels_of(socket)
        if channels is None:
            warnings.append(_ignored(socket, function.changing, "cannot be applied to this input"))
            continue
        if values.shape[:2] not in (texels.shape[:2], (1, 1)):
            warnings.append(_ignored(socket, function.changing, "meets images of several sizes"))
            continue
        changed = texels.copy() if changed is None else changed
        changed[..., channels] = values if values.ndim == 3 else values[..., None]
    return changed, warnings


def _ignored(socket: bpy.types.NodeSocket, nodes: Iterable[bpy.types.Node], why: str) -> str:
    is_inlined = bpy.app.version >= (5, 0, 0)
    names = [_INLINED.sub("", node.name) if is_inlined else node.name for node in nodes]
    return f"node {listed(names)} before '{socket.name}' is not applied as it is: it {why}"


def _channels_of(socket: bpy.types.NodeSocket) -> slice | None:
    if socket.type == "VALUE":
        channel = _CHANNELS.get(socket.name)
        return None if channel is None else slice(channel, channel + 1)
    return slice(0, 3)


def _stored(function: TexelFunction, socket: bpy.types.NodeSocket, groups: Groups) -> Floats:
    """Returns the values of an input, as pictures store them."""
    values = function.values(socket, groups)
    if socket.type != "RGBA" or _is_normal(socket):
        return np.clip(values, 0, 1)
    return np.clip(prefilter.to_srgb(np.ascontiguousarray(values)), 0, 1)


def _is_normal(socket: bpy.types.NodeSocket) -> bool:
    return socket.node.type == "NORMAL_MAP"
