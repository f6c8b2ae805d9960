# SPDX-License-Identifier: GPL-3.0-or-later

"""What nodes make of an image that the glTF exporter writes as it is."""

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
"""Inputs of one number, by the channel of the picture that has it."""
_ALPHA = "Alpha"
_INLINED = re.compile(r"^\d+_")
"""What the exporter of Blender 5 puts before names, in trees that it makes without groups."""


def changed_texels(
    texels: Floats, sockets: Sequence[Any], color_of: ColorOf
) -> tuple[Floats | None, list[str]]:
    """Applies what nodes do to an image on its way to the shader.

    Args:
        texels: (height, width, 3 or 4) of the picture that the exporter made.
        sockets: The exporter's; the inputs that the picture is for.
        color_of: Returns the values of an image as shaders get them.

    Returns:
        The texels with the changes, None where there are none; and warnings of nodes that are
        ignored.
    """
    made: Floats | None = None
    warnings: list[str] = []
    for one in sockets:
        socket = one.socket
        groups = tuple(node for node in one.group_path if getattr(node, "type", "") == "GROUP")
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
        made = texels.copy() if made is None else made
        made[..., channels] = values if values.ndim == 3 else values[..., None]
    return made, warnings


def _ignored(socket: bpy.types.NodeSocket, found: Iterable[bpy.types.Node], why: str) -> str:
    is_inlined = bpy.app.version >= (5, 0, 0)
    names = [_INLINED.sub("", node.name) if is_inlined else node.name for node in found]
    return f"node {listed(names)} before '{socket.name}' is not applied as it is: it {why}"


def _channels_of(socket: bpy.types.NodeSocket) -> slice | None:
    if socket.type == "VALUE":
        channel = _CHANNELS.get(socket.name)
        return None if channel is None else slice(channel, channel + 1)
    return slice(0, 3)


def _stored(function: TexelFunction, socket: bpy.types.NodeSocket, groups: Groups) -> Floats:
    """Returns what an input gets, as pictures store it."""
    values = function.values(socket, groups)
    if socket.type != "RGBA" or _is_normal(socket):
        return np.clip(values, 0, 1)
    return np.clip(prefilter.to_srgb(np.ascontiguousarray(values)), 0, 1)


def _is_normal(socket: bpy.types.NodeSocket) -> bool:
    return socket.node.type == "NORMAL_MAP"
