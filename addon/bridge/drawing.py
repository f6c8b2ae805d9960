# SPDX-License-Identifier: GPL-3.0-or-later

"""Drawing in editors with the GPU: textures, lines, labels and wipes."""

from collections.abc import Sequence

import blf
import bpy
import gpu
import numpy as np
from gpu_extras.batch import batch_for_shader

from .images import FloatArray
from .wipe import is_active

Color = tuple[float, float, float, float]
Points = Sequence[tuple[float, float]]

COLOR_FUNCTIONS = """
float encoded(float light)
{
  return light <= 0.0031308 ? light * 12.92 : 1.055 * pow(light, 1.0 / 2.4) - 0.055;
}

float decoded(float value)
{
  return value <= 0.04045 ? value / 12.92 : pow((value + 0.055) / 1.055, 2.4);
}

vec3 encoded(vec3 light)
{
  return vec3(encoded(light.r), encoded(light.g), encoded(light.b));
}

vec3 decoded(vec3 value)
{
  return vec3(decoded(value.r), decoded(value.g), decoded(value.b));
}
"""
"""GLSL functions that convert between linear and sRGB-encoded values."""

_LINE_WIDTH = 2  # Pixels.
_LABEL_SIZE, _LABEL_GAP = 13, 10
_LINE, _ACTIVE = (1.0, 1.0, 1.0, 1.0), (1.0, 0.63, 0.16, 1.0)
_RIM = (0.0, 0.0, 0.0, 0.6)
_PLATE, _PLATE_MARGIN = (0.0, 0.0, 0.0, 0.85), 4


def upload(pixels: FloatArray) -> gpu.types.GPUTexture:
    """Uploads pixels to a texture of 16-bit floats; alpha is 1 for three channels."""
    height, width = pixels.shape[:2]
    rgba = np.ones((height, width, 4), np.float32)
    rgba[..., : pixels.shape[2]] = pixels
    values = gpu.types.Buffer("FLOAT", rgba.size, rgba.ravel())
    return gpu.types.GPUTexture((width, height), format="RGBA16F", data=values)


def draw_wipe(share: float, left: str, right: str) -> None:
    """Draws a line from the bottom to the top of the region, and labels beside it.

    Args:
        share: Position of the line, as a share of the region's width.
        left: Label of the left side; empty for no line.
        right: Label of the right side.
    """
    scale = bpy.context.preferences.system.ui_scale
    x = share * bpy.context.region.width
    # Labels are at the bottom, as the header may cover the region's upper edge.
    y = _LABEL_GAP * scale
    if left:
        _draw_wipe_line(x)
        draw_label(left, x - label_size(left)[0] - _LABEL_GAP * scale, y)
    draw_label(right, x + _LABEL_GAP * scale, y)


def _draw_wipe_line(x: float) -> None:
    """Draws a line from the bottom to the top of the region, with arrows at half its height."""
    region = bpy.context.region
    color = _ACTIVE if is_active(region) else _LINE
    half = _LINE_WIDTH * bpy.context.preferences.system.ui_scale / 2
    top, y = region.height, region.height / 2
    _draw_polygon([(x - half, 0.0), (x + half, 0.0), (x + half, top), (x - half, top)], color)
    for paint, rim in ((_PLATE, 1.5 * half), (color, 0.0)):
        tall = 7 * half + 1.6 * rim
        for side in (-1, 1):
            tip, base = x + side * (12 * half + 2 * rim), x + side * (4 * half - rim)
            _draw_polygon([(tip, y), (base, y + tall), (base, y - tall)], paint)


def label_size(text: str) -> tuple[float, float]:
    """Width and height of the text of a label, in pixels of the region."""
    blf.size(0, _LABEL_SIZE * bpy.context.preferences.system.ui_scale)
    width, height = blf.dimensions(0, text)
    return width, height


def draw_label(text: str, x: float, y: float) -> None:
    """Draws white text on a dark plate, so that it is readable over any image.

    Args:
        text: One line.
        x: Start of the text, in pixels of the region.
        y: Its baseline.
    """
    width, height = label_size(text)
    margin = _PLATE_MARGIN * bpy.context.preferences.system.ui_scale
    gpu.state.blend_set("ALPHA")
    left, right, low, high = x - margin, x + width + margin, y - margin, y + height + margin
    _draw_polygon([(left, low), (right, low), (right, high), (left, high)], _PLATE)
    gpu.state.blend_set("NONE")
    blf.color(0, 1.0, 1.0, 1.0, 1.0)
    blf.position(0, x, y, 0)
    blf.draw(0, text)


def draw_lines(
    points: Sequence[tuple[float, float]], color: Color, *, closed: bool = False
) -> None:
    """Draws a polyline in the region, with a dark rim, so that it is visible on any image.

    Args:
        points: Points in pixels.
        color: sRGB values and alpha.
        closed: Whether to connect the last point to the first.
    """
    shader = gpu.shader.from_builtin("POLYLINE_UNIFORM_COLOR")
    along = [*points, points[0]] if closed else list(points)
    line = batch_for_shader(shader, "LINE_STRIP", {"pos": [(x, y, 0.0) for x, y in along]})
    scale = bpy.context.preferences.system.ui_scale
    gpu.state.blend_set("ALPHA")
    shader.bind()
    shader.uniform_float("viewportSize", gpu.state.viewport_get()[2:])
    for width, shade in ((_LINE_WIDTH + 2, _RIM), (_LINE_WIDTH, color)):
        shader.uniform_float("lineWidth", width * scale)
        shader.uniform_float("color", shade)
        line.draw(shader)
    gpu.state.blend_set("NONE")


def _draw_polygon(points: Points, color: Color) -> None:
    """Draws a convex polygon."""
    shader = gpu.shader.from_builtin("UNIFORM_COLOR")
    polygon = batch_for_shader(shader, "TRI_FAN", {"pos": list(points)})
    shader.bind()
    shader.uniform_float("color", color)
    polygon.draw(shader)
