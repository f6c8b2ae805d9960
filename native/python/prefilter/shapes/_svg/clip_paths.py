# SPDX-License-Identifier: GPL-3.0-or-later

"""Clip paths: boxes are kept as such, others are told of."""

from collections.abc import Mapping
from dataclasses import replace

from .basic_shapes import BASIC_SHAPES, read_shape
from .context import Context, Sources
from .document import SvgElement
from .groups import Box, Groups, carried
from .tags import NOT_DRAWN
from .values import Matrix, as_paint, as_transform, multiplied


def clipped(
    element: SvgElement,
    declared: Mapping[str, str],
    context: Context,
    sources: Sources,
    groups: Groups,
) -> Context:
    """The context within a clip path, if the element has one."""
    text = declared.get("clip-path", "none")
    if text.lower() == "none":
        return context
    paint = as_paint(text)
    path = sources.document.ids.get(paint.server[1:]) if paint and paint.server else None
    region = None
    if path is None and paint and paint.server.startswith("#"):
        sources.warnings.broken("clip-path", "ignored", element.line)
        return context
    if path is not None and path.tag == "clipPath":
        region = _region(path, context, sources)
    number = groups.add_clipped(element, "clip-path", region)
    return replace(context, groups=(*context.groups, number))


def _region(path: SvgElement, context: Context, sources: Sources) -> Box | None:
    """The box that a clip path is; None where it is something else."""
    shapes = [child for child in path if child.tag not in NOT_DRAWN]
    target = shapes[0] if len(shapes) == 1 else None
    matrix: Matrix | None = context.matrix
    for each in (path, target):
        if isinstance(each, SvgElement) and matrix is not None:
            declared = sources.sheets.declared(each)
            own = as_transform(declared.get("transform", ""))
            matrix = multiplied(matrix, own) if own else None
    if isinstance(target, SvgElement) and target.tag == "use":
        if "x" in target.attrib or "y" in target.attrib:
            return None
        target = sources.document.ids.get(target.href)
        if target is not None and "transform" in sources.sheets.declared(target):
            return None
    if not isinstance(target, SvgElement) or target.tag not in BASIC_SHAPES or matrix is None:
        return None
    if path.get("clipPathUnits", "userSpaceOnUse") != "userSpaceOnUse":
        return None
    declared = sources.sheets.declared(target)
    is_upright = matrix[1] == matrix[2] == 0.0 or matrix[0] == matrix[3] == 0.0
    outline = read_shape(target, declared, context.units, sources.warnings)
    if outline is None or not is_upright or not outline.is_box() or "clip-path" in declared:
        return None
    box = outline.bounds()
    return carried(box, matrix) if box else None
