# SPDX-License-Identifier: GPL-3.0-or-later

"""The corners that are being dragged, drawn over their image, and what comes out of them."""

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
_ROUND = 24
_PART = 0.34
"""How much of the region's width and height the straightened image takes at most."""
_GAP = 12.0
_LINE, _GRID = (1.0, 1.0, 1.0, 1.0), (1.0, 1.0, 1.0, 0.45)
_ACTIVE, _WRONG = (1.0, 0.63, 0.16, 1.0), (1.0, 0.3, 0.25, 1.0)

_handles: list[object] = []


@dataclass
class Session:
    """What is dragged.

    Attributes:
        image_uid: The session_uid of the image.
        active: The number of the corner that keys move.
        is_over: Whether the operator is to end.
    """

    image_uid: int
    active: int = 0
    is_over: bool = False


session: Session | None = None


def begin(image: bpy.types.Image) -> Session:
    """Has the editors draw the corners of an image."""
    global session
    session = Session(image.session_uid)
    return session


def end() -> None:
    """Has them draw none."""
    global session
    session = None


def is_on(image: bpy.types.Image | None) -> bool:
    """Tells whether the corners of an image are dragged."""
    return session is not None and image is not None and image.session_uid == session.image_uid


def canvas_of(region: bpy.types.Region, size: tuple[int, int]) -> "Canvas":
    """Returns where a region of an Image editor shows an image of a size."""
    from ..pins import Canvas

    # Of the view, 1 is the width and the height of the image.
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
    from prefilter.workflows.resampling.placement import corners

    image = bpy.context.space_data.image
    if session is None or not is_on(image):
        return
    settings = bpy.context.scene.prefilter_resample.to_settings()
    if settings.warp == "affine" or not all(image.size):
        return
    size = tuple(image.size)
    canvas = canvas_of(bpy.context.region, size)
    places = corners(settings, *size)
    is_convex = _draw_result(image, settings, canvas, places)
    _draw_pins(places, canvas, session.active, is_convex=is_convex)


def _draw_result(
    image: bpy.types.Image,
    settings: ResampleSettings,
    canvas: "Canvas",
    places: "NDArray[np.float64]",
) -> bool:
    """Draws what comes out, and the grid; returns whether there is something."""
    from ...bridge.drawing import draw_lines
    from ..pins import grid

    try:
        if settings.warp == "corners":
            _draw_pinned(image, settings, canvas, places)
        lines = grid(places)
    except ValueError:
        return False
    for line in lines:
        draw_lines(canvas.to_region(line).tolist(), _GRID)
    if settings.warp == "rectify":
        _draw_rectified(image, settings, canvas, places)
    return True


def _draw_pinned(
    image: bpy.types.Image,
    settings: ResampleSettings,
    canvas: "Canvas",
    places: "NDArray[np.float64]",
) -> None:
    """Draws the image between its corners, over all of the frame that they are places of."""
    from prefilter.workflows.resampling.placement import frame, homography, rectangle

    from ..pins import uv_of_box

    size = tuple(image.size)
    low, high = np.zeros(2), np.array(frame(settings, *size), np.float64)
    if settings.size == "fit":
        low, high = places.min(axis=0), places.max(axis=0)
    matrix = uv_of_box(homography(places, rectangle(*size)), low, high - low, size)
    on_screen = canvas.to_region([low, high])
    warped.draw(image, matrix, tuple(on_screen[0]), tuple(on_screen[1] - on_screen[0]))


def _draw_rectified(
    image: bpy.types.Image,
    settings: ResampleSettings,
    canvas: "Canvas",
    places: "NDArray[np.float64]",
) -> None:
    """Draws the straightened image in a corner of the region, away from the active pin."""
    from prefilter.workflows.resampling.placement import placement

    from ...bridge.drawing import draw_label, draw_lines
    from ..pins import uv_of_box

    assert session is not None
    size = tuple(image.size)
    placed = placement(settings, *size)
    low, extent = _inset(placed.width / placed.height, canvas.to_region(places[session.active]))
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
    left, right = _free_of_sidebars()
    gap = _GAP * bpy.context.preferences.system.ui_scale
    width, height = _PART * (right - left), _PART * bpy.context.region.height
    width, height = min(width, height * aspect), min(height, width / aspect)
    is_left = active[0] > (left + right) / 2 or active[1] > bpy.context.region.height / 2
    return (left + gap if is_left else right - gap - width, gap), (width, height)


def _free_of_sidebars() -> tuple[float, float]:
    """Returns where, along x, the region is not under another of its area."""
    region, area = bpy.context.region, bpy.context.area
    left, right = 0.0, float(region.width)
    for other in area.regions:
        if other.type == "TOOLS" and other.width > 1:
            left = max(left, other.x + other.width - region.x)
        elif other.type == "UI" and other.width > 1:
            right = min(right, other.x - region.x)
    return left, right


def _draw_pins(
    places: "NDArray[np.float64]", canvas: "Canvas", active: int, *, is_convex: bool
) -> None:
    from ...bridge.drawing import draw_label, draw_lines, label_size

    scale = bpy.context.preferences.system.ui_scale
    left, right = _free_of_sidebars()
    on_screen = canvas.to_region(places)
    draw_lines(on_screen.tolist(), _LINE if is_convex else _WRONG, closed=True)
    turn = [2 * math.pi * i / _ROUND for i in range(_ROUND)]
    ring = _RADIUS * scale * np.array([(math.cos(one), math.sin(one)) for one in turn])
    for index, (name, place, at) in enumerate(zip(CORNERS, places, on_screen, strict=True)):
        color = _ACTIVE if index == active else _LINE
        draw_lines((at + ring).tolist(), color, closed=True)
        x, y = (f"{round(float(one), 1):g}" for one in place)
        label = f"{_label(name)}  {x}, {y}"
        # Away from the others, so that no label lies on another; in sight all the same.
        (along, up), (width, height) = at - on_screen.mean(axis=0), label_size(label)
        gap = 1.5 * _RADIUS * scale
        x_low = at[0] + gap if along > 0 else at[0] - gap - width
        y_low = at[1] + gap if up > 0 else at[1] - gap - height
        x_low = min(max(x_low, left + gap), right - gap - width)
        draw_label(label, x_low, min(max(y_low, gap), bpy.context.region.height - gap - height))


def _label(name: str) -> str:
    return tr(option(ResampleSettings, name)[1].label)


def register() -> None:
    """Adds the drawing to the editors."""
    handle = bpy.types.SpaceImageEditor.draw_handler_add(_draw, (), "WINDOW", "POST_PIXEL")
    _handles.append(handle)


def unregister() -> None:
    """Takes the drawing out of the editors."""
    end()
    while _handles:
        bpy.types.SpaceImageEditor.draw_handler_remove(_handles.pop(), "WINDOW")
    warped.forget()
