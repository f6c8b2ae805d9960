# SPDX-License-Identifier: GPL-3.0-or-later

"""Applies shader nodes to the texels of pictures that are written to files."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import bpy
import numpy as np
from numpy.typing import NDArray
from prefilter.workflows.picture import Picture, encoded, scene_linear

from ...bridge import image_roles
from ...bridge.nodes import Groups
from ...bridge.texel_functions import OtherNodeError, TexelFunction, before_factor
from ...core.wording import listed
from .plan import Item

_CHANNELS = {"all": slice(0, 3), "red": slice(0, 1), "green": slice(1, 2), "blue": slice(2, 3)}
Floats = NDArray[np.float32]


def apply_nodes(item: Item, image: bpy.types.Image, picture: Picture) -> tuple[Picture, list[str]]:
    """Returns the picture after the nodes before its inputs, and notes for the user.

    A node is applied if it is a function of the texel, and if all inputs that read the same
    channels get the same values. The alpha channel and channels of alpha tests are unchanged.
    """
    inputs, notes = _analyze_inputs(item, image)
    if not any(entry.names for entry in inputs):
        return picture, notes
    linear = scene_linear(picture)
    changed = linear.copy()
    by_channel: dict[str, list[_Input]] = {}
    for entry in inputs:
        by_channel.setdefault(entry.channel, []).append(entry)
    is_mixed = "all" in by_channel and len(by_channel) > 1
    for channel, entries in by_channel.items():
        names = dict.fromkeys(name for entry in entries for name in entry.names)
        if not names:
            continue
        values = [TexelFunction(lambda _: linear).values(*entry.socket) for entry in entries]
        first, *others = values
        if is_mixed or any(not np.array_equal(first, other) for other in others):
            labels = dict.fromkeys(entry.label for entry in inputs)
            notes.append(
                f"is baked without what nodes do ({listed(names)}): inputs get different values "
                f"of it, {listed(labels)}"
            )
            continue
        changed[..., _CHANNELS[channel]] = first if first.ndim == 3 else first[..., None]
        notes.append(f"is baked with what nodes do: {listed(names)}")
    return _with_values(picture, changed), notes


def tile_notes(item: Item, image: bpy.types.Image) -> list[str]:
    """Returns notes for an image with tiles, to which nodes are not applied."""
    inputs, notes = _analyze_inputs(item, image)
    names = dict.fromkeys(name for entry in inputs for name in entry.names)
    if names:
        notes.append(f"is baked without what nodes do ({listed(names)}), as it has tiles")
    return notes


@dataclass(frozen=True)
class _Input:
    """A shader input whose value is a function of an image.

    Attributes:
        label: Its label.
        channel: The channel of the image that it reads.
        socket: The input, and the node groups around it.
        names: The names of the nodes that change values on the way.
    """

    label: str
    channel: str
    socket: tuple[bpy.types.NodeSocket, Groups]
    names: list[str]


def _analyze_inputs(item: Item, image: bpy.types.Image) -> tuple[list[_Input], list[str]]:
    """Returns the inputs that are functions of an image, and notes about the others."""
    texel = np.zeros((1, 1, 4), np.float32)
    inputs: list[_Input] = []
    notes: list[str] = []
    for label, channel, socket, groups in _inputs(item, image):
        function, source = TexelFunction(lambda _: texel), before_factor(socket, groups)
        try:
            function.values(*source)
        except OtherNodeError as error:
            notes.append(f"is baked without node '{error.node.name}' before {label}")
            continue
        names = [node.name for node in function.changing] if function.image == image else []
        inputs.append(_Input(label, channel, source, names))
    return inputs, list(dict.fromkeys(notes))


def _inputs(
    item: Item, image: bpy.types.Image
) -> Iterator[tuple[str, str, bpy.types.NodeSocket, Groups]]:
    """Yields the label, the channel and the socket of each input that the item is used for.

    The channel is "all" for a color, and for a value that is read from several channels.
    """
    channels: dict[tuple[str, bpy.types.NodeSocket, Groups], set[str]] = {}
    for name in sorted(item.materials):
        for role, socket, groups in image_roles.inputs_of(bpy.data.materials[name], image):
            is_used = any(use.startswith(role.label) for use in item.uses)
            if is_used and role.use != "coverage" and role.channel in _CHANNELS:
                channels.setdefault((role.label, socket, groups), set()).add(role.channel)
    for (label, socket, groups), names in channels.items():
        is_single = socket.type == "VALUE" and len(names) == 1
        yield label, names.pop() if is_single else "all", socket, groups


def _with_values(picture: Picture, linear: Floats) -> Picture:
    """Returns the picture with new values, encoded and stored like the old ones."""
    values = encoded(picture, linear)
    if picture.texels.dtype != np.uint8:
        return replace(picture, texels=values)
    return replace(picture, texels=(np.clip(values, 0, 1) * 255 + 0.5).astype(np.uint8))
