# SPDX-License-Identifier: GPL-3.0-or-later

"""Flattening: a tree as shapes over each other, as far as these can show it."""

from collections.abc import Iterator

from ...affine import IDENTITY, Matrix
from ..model.tree import Group, Painted, Pattern, Picture
from ..model.warnings import Warnings
from .layers import LayerPlanner


class FlatTree:
    """The outlines of a tree.

    Args:
        warnings: Receives effects that need layers.

    Attributes:
        painted: Outlines from bottom to top, each with the product of its groups' opacities.
    """

    def __init__(self, group: Group, warnings: Warnings) -> None:
        self._layers = LayerPlanner()
        self._warnings = warnings
        self.painted = list(self._outlines(group, IDENTITY, 1.0))

    def _outlines(
        self, group: Group, matrix: Matrix, opacity: float
    ) -> Iterator[tuple[Painted, float]]:
        for placed in self._layers.placed(group, matrix, (), opacity):
            item = placed.item
            if isinstance(item, Group):
                self._warn(item)
                yield from self._outlines(item, matrix, placed.opacity * item.opacity)
            elif isinstance(item, Picture):
                self._warnings.unsupported("<image>", "left out", item.line)
            elif isinstance(item.paint, Pattern):
                self._warnings.unsupported("<pattern> as paint", "left out", item.line)
            else:
                yield item, placed.opacity

    def _warn(self, group: Group) -> None:
        if group.filter is not None:
            self._warnings.unsupported("filter", "ignored", group.line)
        if group.masks:
            self._warnings.unsupported("mask", "ignored", group.line)
        if group.blend != "normal":
            self._warnings.unsupported("mix-blend-mode", "ignored", group.line)
        if group.opacity < 1.0 and not group.masks and group.blend == "normal":
            self._warnings.unsupported(
                "opacity of a group", "applied to each of its shapes", group.line
            )
