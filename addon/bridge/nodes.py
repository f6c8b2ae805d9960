# SPDX-License-Identifier: GPL-3.0-or-later

"""Walking over the nodes of shaders, into groups and out of them again, and against the links."""

from collections.abc import Iterator
from typing import TypeAlias

import bpy

Groups: TypeAlias = tuple[bpy.types.Node, ...]
"""The group nodes that a node lies in, the outermost first."""

Owner: TypeAlias = bpy.types.Material | bpy.types.World | bpy.types.Light
"""What may have shader nodes."""


def tree_of(owner: Owner) -> bpy.types.NodeTree | None:
    """Returns the shader nodes that something uses; None if there are none."""
    switch = owner.bl_rna.properties.get("use_nodes")
    # Where Blender is about to do without the switch, it is always on, and reading it warns.
    is_gone = switch is None or getattr(switch, "is_deprecated", False)
    return owner.node_tree if is_gone or owner.use_nodes else None


def walk(
    tree: bpy.types.NodeTree | None, groups: Groups = ()
) -> Iterator[tuple[bpy.types.Node, Groups]]:
    """Yields the nodes that are not muted, those in groups too, each with the groups around it."""
    for node in tree.nodes if tree is not None else ():
        if node.mute:
            continue
        if node.type == "GROUP" and node.node_tree is not None:
            yield from walk(node.node_tree, (*groups, node))
        else:
            yield node, groups


def link_into(socket: bpy.types.NodeSocket) -> bpy.types.NodeLink | None:
    """Returns the link that an input socket gets its value by; None if there is none."""
    return next((link for link in socket.links if not link.is_muted), None)


def bypassed(node: bpy.types.Node, output: bpy.types.NodeSocket) -> bpy.types.NodeSocket | None:
    """Returns the input that a muted node hands on to an output; None if there is none."""
    found = (link.from_socket for link in node.internal_links if link.to_socket == output)
    return next(found, None)


def origin(
    socket: bpy.types.NodeSocket, groups: Groups
) -> tuple[bpy.types.NodeSocket, bpy.types.Node | None, Groups]:
    """Returns where an input socket gets its value from, however far that is led.

    Returns:
        The output of a node, this node, and the groups around it; or an input that has a value of
        its own, and None.
    """
    while True:
        link = link_into(socket)
        if link is None:
            return socket, None, groups
        node, source = link.from_node, link.from_socket
        following: bpy.types.NodeSocket | None
        if node.mute:
            # A texture that is muted shows nothing.
            following = bypassed(node, source) if node.type != "TEX_IMAGE" else None
        elif node.type == "REROUTE":
            following = node.inputs[0]
        elif node.type == "GROUP" and node.node_tree is not None:
            following, groups = group_output(node, source.identifier), (*groups, node)
        elif node.type == "GROUP_INPUT" and groups:
            following = group_input(groups[-1], source.identifier)
            groups = groups[:-1]
        else:
            return source, node, groups
        if following is None:
            return socket, None, groups
        socket = following


def group_output(group: bpy.types.Node, identifier: str) -> bpy.types.NodeSocket | None:
    """Returns the socket inside a group that an output of it gets its value from."""
    for node in group.node_tree.nodes:
        if node.type == "GROUP_OUTPUT" and node.is_active_output:
            return _socket(node.inputs, identifier)
    return None


def group_input(group: bpy.types.Node, identifier: str) -> bpy.types.NodeSocket:
    """Returns the socket outside of a group that an input of it gets its value from."""
    return _socket(group.inputs, identifier)


def _socket(sockets: bpy.types.bpy_prop_collection, identifier: str) -> bpy.types.NodeSocket:
    return next(socket for socket in sockets if socket.identifier == identifier)
