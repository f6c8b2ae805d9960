# SPDX-License-Identifier: GPL-3.0-or-later

"""Draws the corners that are dragged over their image, with a preview of the result."""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import bpy
import numpy as np

from ...core.options import option
from ...core.translations import tr
from ..choices import CORNERS, ResampleSettings
from . import warped

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ..pins import Canvas

_RADIUS = 9.0
_CIRCLE_SEGMENTS = 24
_INSET_SHARE = 0.34
"""Largest share of the region's width and height for the rectified image."""
_GAP = 12.0
_LINE, _GRID = (1.0, 1.0, 1.0, 1.0), (1.0, 1.0, 1.0, 0.45)
_ACTIVE, _WRONG = (1.0, 0.63, 0.16, 1.0), (1.0, 0.3, 0.25, 1.0)

_handles: list[object] = []


@dataclass
class Session:
    """The state of a drag operation.

    Attributes:
        image_uid: The session_uid of the image.
        active: The index of the corner that keys move.
        is_over: Whether the operator should end.
    """

    image_uid: int
    active: int = 0
    is_over: bool = False


session: Session | None = None


def begin(image: bpy.types.Image) -> Session:
    """Starts drawing the corners of an image."""
    global session
    session = Session(image.session_uid)
    return session


def end() -> None:
    """Stops drawing corners."""
    global session
    session = None


def is_on(image: bpy.types.Image | None) -> bool:
    """Returns whether the corners of an image are being dragged."""
    return session is not None and image is not None and image.session_uid == session.image_uid


def canvas_of(region: bpy.types.Region, size: tuple[int, int]) -> "Canvas":
    """Returns the position of an image with a size in a region of an Image editor."""
    from ..pins import Canvas

    # In view coordinates the image is [0, 1]^2.
    low = region.view2d.region_to_view(0.0, 0.0)
    high = region.view2d.region_to_view(region.width, region.height)
    factor = [
        extent / (end - begin)
        for begin, end, extent in zip(low, high, (region.width, region.height), strict=True)
    ]
    return Canvas(
        (-low[0] * factor[0], -low[1] * factor[1]), (factor[0] / size[0], factor[1] / size[1])
    )


def _draw() -> None:
    from prefilter.workflows.images.placement import corners

    image = bpy.context.space_data.image
    if session is None or not is_on(image):
        return
    settings = bpy.context.scene.prefilter_resample.to_settings()
    if settings.warp == "affine" or not all(image.size):
        return
    size = tuple(image.size)
    canvas = canvas_of(bpy.context.region, size)
    points = corners(settings, *size)
    is_convex = _draw_result(image, settings, canvas, points)
    _draw_pins(points, canvas, session.active, is_convex=is_convex)


def _draw_result(
    image: bpy.types.Image,
    settings: ResampleSettings,
    canvas: "Canvas",
    points: "NDArray[np.float64]",
) -> bool:
    """Draws the result and the grid; returns False if the corners are not convex."""
    from ...bridge.drawing import draw_lines
    from ..pins import grid

    try:
        if settings.warp == "corners":
            _draw_pinned(image, settings, canvas, points)
        lines = grid(points)
    except ValueError:
        return False
    for line in lines:
        draw_lines(canvas.to_region(line).tolist(), _GRID)
    if settings.warp == "rectify":
        _draw_rectified(image, settings, canvas, points)
    return True


def _draw_pinned(
    image: bpy.types.Image,
    settings: ResampleSettings,
    canvas: "Canvas",
    points: "NDArray[np.float64]",
) -> None:
    """Draws the image between its corners, over the whole frame."""
    from prefilter.workflows.images.placement import frame, homography, rectangle

    from ..pins import uv_of_box

    size = tuple(image.size)
    low, high = np.zeros(2), np.array(frame(settings, *size), np.float64)
    if settings.size == "fit":
        low, high = points.min(axis=0), points.max(axis=0)
    matrix = uv_of_box(homography(points, rectangle(*size)), low, high - low, size)
    on_screen = canvas.to_region([low, high])
    warped.draw(image, matrix, tuple(on_screen[0]), tuple(on_screen[1] - on_screen[0]))


def _draw_rectified(
    image: bpy.types.Image,
    settings: ResampleSettings,
    canvas: "Canvas",
    points: "NDArray[np.float64]",
) -> None:
    """Draws the rectified image in a corner of the region, away from the active pin."""
    from prefilter.workflows.images.placement import placement

    from ...bridge.drawing import draw_label, draw_lines
    from ..pins import uv_of_box

    assert session is not None
    size = tuple(image.size)
    placed = placement(settings, *size)
    low, extent = _inset(placed.width / placed.height, canvas.to_region(points[session.active]))
    whole = (placed.width, placed.height)
    warped.draw(image, uv_of_box(placed.transform, (0.0, 0.0), whole, size), low, extent)
    high = (low[0] + extent[0], low[1] + extent[1])
    draw_lines([low, (high[0], low[1]), high, (low[0], high[1])], _LINE, closed=True)
    scale = bpy.context.preferences.system.ui_scale
    draw_label(f"{placed.width} x {placed.height}", low[0] + _GAP * scale, low[1] + _GAP * scale)


def _inset(
    aspect: float, active: "NDArray[np.float64]"
) -> tuple[tuple[float, float], tuple[float, float]]:
    """Returns the lower left corner and the size of a box in a lower corner of the region."""
    left, right = _uncovered_range()
    gap = _GAP * bpy.context.preferences.system.ui_scale
    width, height = _INSET_SHARE * (right - left), _INSET_SHARE * bpy.context.region.height
    width, height = min(width, height * aspect), min(height, width / aspect)
    is_left = active[0] > (left + right) / 2 or active[1] > bpy.context.region.height / 2
    return (left + gap if is_left else right - gap - width, gap), (width, height)


def _uncovered_range() -> tuple[float, float]:
    """Returns the horizontal range of the region that toolbar and sidebar do not cover."""
    region, area = bpy.context.region, bpy.context.area
    left, right = 0.0, float(region.width)
    for other in area.regions:
        if other.type == "TOOLS" and other.width > 1:
            left = max(left, other.x + other.width - region.x)
        elif other.type == "UI" and other.width > 1:
            right = min(right, other.x - region.x)
    return left, right


def _draw_pins(
    points: "NDArray[np.float64]", canvas: "Canvas", active: int, *, is_convex: bool
) -> None:
    from ...bridge.drawing import draw_label, draw_lines, label_size

    scale = bpy.context.preferences.system.ui_scale
    left, right = _uncovered_range()
    on_screen = canvas.to_region(points)
    draw_lines(on_screen.tolist(), _LINE if is_convex else _WRONG, closed=True)
    angles = [2 * math.pi * i / _CIRCLE_SEGMENTS for i in range(_CIRCLE_SEGMENTS)]
    ring = _RADIUS * scale * np.array([(math.cos(angle), math.sin(angle)) for angle in angles])
    for index, (name, point, center) in enumerate(zip(CORNERS, points, on_screen, strict=True)):
        color = _ACTIVE if index == active else _LINE
        draw_lines((center + ring).tolist(), color, closed=True)
        x, y = (f"{round(float(coordinate), 1):g}" for coordinate in point)
        label = f"{_label(name)}  {x}, {y}"
        # On the outer side, so that labels do not overlap, but within the region.
        (right_of, above), (width, height) = center - on_screen.mean(axis=0), label_size(label)
        gap = 1.5 * _RADIUS * scale
        x_low = center[0] + gap if right_of > 0 else center[0] - gap - width
        y_low = center[1] + gap if above > 0 else center[1] - gap - height
        x_low = min(max(x_low, left + gap), right - gap - width)
        draw_label(label, x_low, min(max(y_low, gap), bpy.context.region.height - gap - height))


def _label(name: str) -> str:
    return tr(option(ResampleSettings, name)[1].label)


def register() -> None:
    """Adds the draw handler."""
    handle = bpy.types.SpaceImageEditor.draw_handler_add(_draw, (), "WINDOW", "POST_PIXEL")
    _handles.append(handle)


def unregister() -> None:
    """Removes the draw handler."""
    end()
    while _handles:
        bpy.types.SpaceImageEditor.draw_handler_remove(_handles.pop(), "WINDOW")
    warped.free_shader()
