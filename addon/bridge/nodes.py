# SPDX-License-Identifier: GPL-3.0-or-later

"""Traversal of shader nodes, through groups and backward along links."""

from collections.abc import Iterator
from typing import TypeAlias

import bpy

Groups: TypeAlias = tuple[bpy.types.Node, ...]
"""Group nodes that contain a node, outermost first."""

Owner: TypeAlias = bpy.types.Material | bpy.types.World | bpy.types.Light
"""Datablocks that may have shader nodes."""


def tree_of(owner: Owner) -> bpy.types.NodeTree | None:
    """Returns the node tree that a datablock uses; None if it uses none."""
    switch = owner.bl_rna.properties.get("use_nodes")
    # Later Blender versions deprecate the switch: it is always on, and reading it warns.
    is_gone = switch is None or getattr(switch, "is_deprecated", False)
    return owner.node_tree if is_gone or owner.use_nodes else None


def walk(
    tree: bpy.types.NodeTree | None, groups: Groups = ()
) -> Iterator[tuple[bpy.types.Node, Groups]]:
    """Yields all nodes that are not muted, in groups too, each with its groups."""
    for node in tree.nodes if tree is not None else ():
        if node.mute:
            continue
        if node.type == "GROUP" and node.node_tree is not None:
            yield from walk(node.node_tree, (*groups, node))
        else:
            yield node, groups


def link_into(socket: bpy.types.NodeSocket) -> bpy.types.NodeLink | None:
    """Returns the link into an input socket; None if there is none."""
    return next((link for link in socket.links if not link.is_muted), None)


def bypassed(node: bpy.types.Node, output: bpy.types.NodeSocket) -> bpy.types.NodeSocket | None:
    """Returns the input that a muted node passes through to an output; None if there is none."""
    inputs = (link.from_socket for link in node.internal_links if link.to_socket == output)
    return next(inputs, None)


def origin(
    socket: bpy.types.NodeSocket, groups: Groups
) -> tuple[bpy.types.NodeSocket, bpy.types.Node | None, Groups]:
    """Follows an input socket back to its value, through reroutes, groups and muted nodes.

    Returns:
        The output of a node, that node, and its groups; or an unlinked input with a value of its
        own, and None instead of a node.
    """
    while True:
        link = link_into(socket)
        if link is None:
            return socket, None, groups
        node, source = link.from_node, link.from_socket
        following: bpy.types.NodeSocket | None
        if node.mute:
            # Muted textures pass nothing through.
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
    """Returns the socket inside a group that feeds an output of the group."""
    for node in group.node_tree.nodes:
        if node.type == "GROUP_OUTPUT" and node.is_active_output:
            return _socket(node.inputs, identifier)
    return None


def group_input(group: bpy.types.Node, identifier: str) -> bpy.types.NodeSocket:
    """Returns the input of a group node that feeds a socket inside the group."""
    return _socket(group.inputs, identifier)


def _socket(sockets: bpy.types.bpy_prop_collection, identifier: str) -> bpy.types.NodeSocket:
    return next(socket for socket in sockets if socket.identifier == identifier)
