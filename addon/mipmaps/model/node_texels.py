# SPDX-License-Identifier: GPL-3.0-or-later

"""Pictures for files as shaders get them: with what nodes make of their texels."""

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


def with_nodes(item: Item, image: bpy.types.Image, picture: Picture) -> tuple[Picture, list[str]]:
    """Returns the picture with what nodes make of it, and what is to be known of that.

    Nodes count that are functions of the texel, and if all inputs that read the same channels get
    the same. The alpha channel, and what is tested, stay as they are.
    """
    inputs, told = _known(item, image)
    if not any(one.names for one in inputs):
        return picture, told
    linear = scene_linear(picture)
    made = linear.copy()
    by_channel: dict[str, list[_Input]] = {}
    for one in inputs:
        by_channel.setdefault(one.channel, []).append(one)
    is_mixed = "all" in by_channel and len(by_channel) > 1
    for channel, found in by_channel.items():
        names = dict.fromkeys(name for one in found for name in one.names)
        if not names:
            continue
        first, *others = [TexelFunction(lambda _: linear).values(*one.place) for one in found]
        if is_mixed or any(not np.array_equal(first, other) for other in others):
            labels = dict.fromkeys(one.label for one in inputs)
            told.append(
                f"is baked without what nodes do ({listed(names)}): inputs get different values "
                f"of it, {listed(labels)}"
            )
            continue
        made[..., _CHANNELS[channel]] = first if first.ndim == 3 else first[..., None]
        told.append(f"is baked with what nodes do: {listed(names)}")
    return _stored(picture, made), told


def told_of_tiles(item: Item, image: bpy.types.Image) -> list[str]:
    """Returns what is to be known of an image with tiles, to which nodes are not applied."""
    inputs, told = _known(item, image)
    names = dict.fromkeys(name for one in inputs for name in one.names)
    if names:
        told.append(f"is baked without what nodes do ({listed(names)}), as it has tiles")
    return told


@dataclass(frozen=True)
class _Input:
    """An input that gets a function of an image.

    Attributes:
        label: What it is called.
        channel: What it takes of the image.
        place: The input, and the groups around it.
        names: Those of the nodes that change values on the way.
    """

    label: str
    channel: str
    place: tuple[bpy.types.NodeSocket, Groups]
    names: list[str]


def _known(item: Item, image: bpy.types.Image) -> tuple[list[_Input], list[str]]:
    """Returns the inputs that get a function of an image, and what is said of others."""
    texel = np.zeros((1, 1, 4), np.float32)
    inputs: list[_Input] = []
    told: list[str] = []
    for label, channel, socket, groups in _inputs(item, image):
        function, place = TexelFunction(lambda _: texel), before_factor(socket, groups)
        try:
            function.values(*place)
        except OtherNodeError as error:
            told.append(f"is baked without node '{error.node.name}' before {label}")
            continue
        names = [node.name for node in function.changing] if function.image == image else []
        inputs.append(_Input(label, channel, place, names))
    return inputs, list(dict.fromkeys(told))


def _inputs(
    item: Item, image: bpy.types.Image
) -> Iterator[tuple[str, str, bpy.types.NodeSocket, Groups]]:
    """Yields the inputs that an item is for: the label, the channel, and the input itself.

    An input of a color has all channels, and so has one of a number that several are read for.
    """
    channels: dict[tuple[str, bpy.types.NodeSocket, Groups], set[str]] = {}
    for name in sorted(item.materials):
        for role, socket, groups in image_roles.inputs_of(bpy.data.materials[name], image):
            is_wanted = any(use.startswith(role.label) for use in item.uses)
            if is_wanted and role.use != "coverage" and role.channel in _CHANNELS:
                channels.setdefault((role.label, socket, groups), set()).add(role.channel)
    for (label, socket, groups), known in channels.items():
        is_one = socket.type == "VALUE" and len(known) == 1
        yield label, known.pop() if is_one else "all", socket, groups


def _stored(picture: Picture, linear: Floats) -> Picture:
    """Returns the picture with other values, in the way that it has them."""
    values = encoded(picture, linear)
    if picture.texels.dtype != np.uint8:
        return replace(picture, texels=values)
    return replace(picture, texels=(np.clip(values, 0, 1) * 255 + 0.5).astype(np.uint8))
