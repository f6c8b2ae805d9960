# SPDX-License-Identifier: GPL-3.0-or-later

"""Draws an image on a plane in the Image editors: trilinear left, by a sampling table right."""

from functools import lru_cache
from typing import TYPE_CHECKING, Any, cast

import bpy
import gpu
import prefilter
from gpu_extras.batch import batch_for_shader

from ...core.translations import tr
from ..choices import METHODS, TABLE_FILTERS
from . import plane
from .atlas import READ_TEXELS
from .camera import uv_of_picture
from .plane import Plane

if TYPE_CHECKING:
    from prefilter.workflows.images.placement import Matrix

_VERTEX = """
void main()
{
  place = position;
  gl_Position = vec4(2.0 * position - 1.0, 0.0, 1.0);
}
"""
_MACROS = """
#define PREFILTER_FETCH(level, texel) texel_of(level, texel)
#define PREFILTER_SIZE(level) size_of(level)
#define PREFILTER_LEVELS level_count
"""
_FRAGMENT = """
int repeated(int i, int size, float extent)
{
  float x = float(i) + 0.5;
  return clamp(i < 0 || i >= size ? int(x - floor(x / extent) * extent) : i, 0, size - 1);
}

vec4 bilinear(int level, vec2 uv)
{
  ivec2 size = size_of(level);
  vec2 extent = vec2(size_0) / float(1 << level);
  vec2 at = fract(uv) * extent - 0.5;
  ivec2 low = ivec2(floor(at));
  vec2 f = at - floor(at);
  ivec2 high = ivec2(repeated(low.x + 1, size.x, extent.x), repeated(low.y + 1, size.y, extent.y));
  low = ivec2(repeated(low.x, size.x, extent.x), repeated(low.y, size.y, extent.y));
  return mix(mix(texel_of(level, low), texel_of(level, ivec2(high.x, low.y)), f.x),
             mix(texel_of(level, ivec2(low.x, high.y)), texel_of(level, high), f.x), f.y);
}

vec4 trilinear(vec2 uv, float mip_value)
{
  float mip = clamp(mip_value, 0.0, float(level_count - 1));
  int fine = min(int(floor(mip)), max(level_count - 2, 0));
  return mix(bilinear(fine, uv), bilinear(min(fine + 1, level_count - 1), uv), mip - float(fine));
}

void main()
{
  vec3 at = vec3(place, 1.0);
  float w = dot(plane_w.xyz, at);
  vec4 light = vec4(0.0);
  if (w > 0.0) {
    vec2 uv = vec2(dot(plane_u.xyz, at), dot(plane_v.xyz, at)) / w;
    vec2 duv_dx = (vec2(plane_u.x, plane_v.x) - uv * plane_w.x) / w * pixel.x;
    vec2 duv_dy = (vec2(plane_u.y, plane_v.y) - uv * plane_w.y) / w * pixel.y;
    float mip_value = prefilter_mip_value(duv_dx, duv_dy);
    light = place.x < wipe
                ? trilinear(uv, mip_value)
                : prefilter_sample(uv, mip_value, ivec2(PREFILTER_REPEAT, PREFILTER_REPEAT));
  }
  vec3 shown = clamp(light.rgb + (1.0 - clamp(light.a, 0.0, 1.0)) * backdrop.rgb, 0.0, 1.0);
  if (is_data) {
    color = vec4(srgbTarget ? decoded(shown) : shown, 1.0);
  }
  else {
    color = vec4(srgbTarget ? shown : encoded(shown), 1.0);
  }
}
"""
_BACKDROP = (0.03, 0.03, 0.03, 1.0)  # Linear color behind transparent pixels and the horizon.

_handles: list[object] = []


def draw_plane(
    shown: Plane,
    uv_of_viewport: "Matrix",
    size: tuple[int, int],
    *,
    texels: int,
    wipe: float,
) -> None:
    """Draws the plane over the whole viewport of the active framebuffer.

    Args:
        shown: The levels.
        uv_of_viewport: The transform from the viewport, [0, 1]^2, to UVs; see
            `camera.uv_of_picture`.
        size: The width and height of the viewport in pixels.
        texels: The number of texels that the table reads: 4, 6 or 8.
        wipe: The position of the wipe, right of which the table is used, as a share of the width.
    """
    shader = _compiled(shown.filter, texels)
    batch = batch_for_shader(shader, "TRI_FAN", {"position": [(0, 0), (1, 0), (1, 1), (0, 1)]})
    shader.bind()
    shader.uniform_sampler("atlas", shown.texture())
    for name, row in zip(("plane_u", "plane_v", "plane_w"), uv_of_viewport, strict=True):
        shader.uniform_float(name, (*row, 0.0))
    shader.uniform_float("backdrop", _BACKDROP)
    shader.uniform_float("pixel", (1.0 / size[0], 1.0 / size[1]))
    shader.uniform_float("wipe", wipe)
    shader.uniform_int("size_0", shown.size)
    shader.uniform_int("level_count", shown.level_count)
    shader.uniform_bool("is_data", shown.is_data)
    batch.draw(shader)


@lru_cache(maxsize=8)
def _compiled(filter: str, texels: int) -> gpu.types.GPUShader:
    from ...bridge.drawing import COLOR_FUNCTIONS

    table = prefilter.SamplingTable.standard(cast("Any", filter), texels)
    info = gpu.types.GPUShaderCreateInfo()
    for kind, name in (
        ("VEC4", "plane_u"),
        ("VEC4", "plane_v"),
        ("VEC4", "plane_w"),
        ("VEC4", "backdrop"),
        ("VEC2", "pixel"),
        ("IVEC2", "size_0"),
        ("INT", "level_count"),
        ("FLOAT", "wipe"),
        ("BOOL", "is_data"),
        # Set by Blender: whether the framebuffer encodes written values as sRGB.
        ("BOOL", "srgbTarget"),
    ):
        info.push_constant(kind, name)
    info.sampler(0, "FLOAT_2D", "atlas")
    interface = gpu.types.GPUStageInterfaceInfo("prefilter_plane")
    interface.smooth("VEC2", "place")
    info.vertex_in(0, "VEC2", "position")
    info.vertex_out(interface)
    info.fragment_out(0, "VEC4", "color")
    info.vertex_source(_VERTEX)
    info.fragment_source(
        "\n".join([COLOR_FUNCTIONS, READ_TEXELS, _MACROS, table.glsl(), _FRAGMENT])
    )
    return gpu.shader.create_from_info(info)


def _draw() -> None:
    from ...bridge.drawing import draw_wipe

    settings = bpy.context.window_manager.prefilter_plane
    shown = plane.find(bpy.context.space_data.image)
    if shown is None or not settings.use_plane:
        return
    region = bpy.context.region
    matrix = uv_of_picture(
        settings.tilt,
        settings.rotation,
        settings.tiles,
        picture_aspect=region.width / region.height,
        image_aspect=shown.aspect,
    )
    gpu.state.blend_set("NONE")
    gpu.state.depth_test_set("NONE")
    size = (region.width, region.height)
    draw_plane(shown, matrix, size, texels=int(settings.texels), wipe=settings.wipe)
    draw_wipe(
        settings.wipe,
        tr(METHODS["trilinear"].label),
        f"{tr(TABLE_FILTERS[shown.filter].label)}, {tr(METHODS[settings.texels].label)}",
    )


def register() -> None:
    """Adds the draw handler."""
    draw = bpy.types.SpaceImageEditor.draw_handler_add(_draw, (), "WINDOW", "POST_PIXEL")
    _handles.append(draw)


def unregister() -> None:
    """Removes the draw handler."""
    while _handles:
        bpy.types.SpaceImageEditor.draw_handler_remove(_handles.pop(), "WINDOW")
    _compiled.cache_clear()
