# SPDX-License-Identifier: GPL-3.0-or-later

"""Draws an image in perspective in a box of the region."""

from functools import lru_cache
from typing import TYPE_CHECKING

import bpy
import gpu
from gpu_extras.batch import batch_for_shader

if TYPE_CHECKING:
    from prefilter.workflows.images.placement import Matrix

_VERTEX = """
void main()
{
  place = position;
  gl_Position = vec4(2.0 * (low.xy + position * extent.xy) - 1.0, 0.0, 1.0);
}
"""
_FRAGMENT = """
void main()
{
  vec3 at = vec3(place, 1.0);
  float w = dot(row_w.xyz, at);
  vec2 uv = vec2(dot(row_u.xyz, at), dot(row_v.xyz, at)) / w;
  vec4 light = texture(image, uv);
  bool is_there = w > 0.0 && uv == clamp(uv, 0.0, 1.0);
  vec3 shown = is_there ? clamp(light.rgb + (1.0 - clamp(light.a, 0.0, 1.0)) * backdrop.rgb,
                                0.0, 1.0)
                        : backdrop.rgb;
  if (is_data) {
    color = vec4(srgbTarget ? decoded(shown) : shown, 1.0);
  }
  else {
    color = vec4(srgbTarget ? shown : encoded(shown), 1.0);
  }
}
"""
_BACKDROP = (0.03, 0.03, 0.03, 1.0)  # Linear color outside the image and behind transparent pixels.


def draw(
    image: bpy.types.Image,
    uv_of_box: "Matrix",
    low: tuple[float, float],
    extent: tuple[float, float],
) -> None:
    """Draws an image in a box of the region.

    Args:
        image: The image.
        uv_of_box: The transform from the box, [0, 1]^2, to UVs; the homogeneous coordinate w is
            positive on the image.
        low: The lower left corner of the box, in pixels of the region.
        extent: Its width and height.
    """
    region = bpy.context.region
    width, height = region.width, region.height
    shader = _compiled()
    box = batch_for_shader(shader, "TRI_FAN", {"position": [(0, 0), (1, 0), (1, 1), (0, 1)]})
    shader.bind()
    shader.uniform_sampler("image", gpu.texture.from_image(image))
    for name, row in zip(("row_u", "row_v", "row_w"), uv_of_box, strict=True):
        shader.uniform_float(name, (*row, 0.0))
    shader.uniform_float("backdrop", _BACKDROP)
    shader.uniform_float("low", (low[0] / width, low[1] / height))
    shader.uniform_float("extent", (extent[0] / width, extent[1] / height))
    shader.uniform_bool("is_data", image.colorspace_settings.is_data)
    box.draw(shader)


@lru_cache(maxsize=1)
def _compiled() -> gpu.types.GPUShader:
    from ...bridge.drawing import COLOR_FUNCTIONS

    info = gpu.types.GPUShaderCreateInfo()
    for kind, name in (
        ("VEC4", "row_u"),
        ("VEC4", "row_v"),
        ("VEC4", "row_w"),
        ("VEC4", "backdrop"),
        ("VEC2", "low"),
        ("VEC2", "extent"),
        ("BOOL", "is_data"),
        # Set by Blender: whether the framebuffer encodes written values as sRGB.
        ("BOOL", "srgbTarget"),
    ):
        info.push_constant(kind, name)
    info.sampler(0, "FLOAT_2D", "image")
    interface = gpu.types.GPUStageInterfaceInfo("prefilter_warped")
    interface.smooth("VEC2", "place")
    info.vertex_in(0, "VEC2", "position")
    info.vertex_out(interface)
    info.fragment_out(0, "VEC4", "color")
    info.vertex_source(_VERTEX)
    info.fragment_source(COLOR_FUNCTIONS + _FRAGMENT)
    return gpu.shader.create_from_info(info)


def free_shader() -> None:
    """Frees the shader."""
    _compiled.cache_clear()
