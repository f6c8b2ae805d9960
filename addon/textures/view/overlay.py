# SPDX-License-Identifier: GPL-3.0-or-later

"""Draws levels over their image in the Image and UV editors.

Lookups are those of a renderer, in single precision: bilinear within a level, linear between two
levels, in scene-linear light; for readers that decode after the lookup, bilinear among encoded
texels. The shader encodes the result for an sRGB display, as the editor shows an image without View
as Render.
"""

import math

import bpy
import gpu
from gpu_extras.batch import batch_for_shader
from mathutils import Matrix

from ...core.translations import tr
from ..choices import FILTERS
from . import preview
from .preview import Preview

# Between the editor's image, behind, and its UVs, in front.
_DEPTH = 0.5
_CHANNELS = {"COLOR_ALPHA": 0, "COLOR": 1, "ALPHA": 2, "RED": 3, "GREEN": 4, "BLUE": 5}
# Whether the editor multiplies linear light by alpha: Blender 5.2 does, 4.3 does not.
_MULTIPLIES_LIGHT = bpy.app.version >= (5, 0, 0)

_VERTEX = """
void main()
{
  uv = position;
  gl_Position = vec4(position * view.xy + view.zw, depth, 1.0);
  across = gl_Position.x * 0.5 + 0.5;
}
"""
LOOKUP = """
int wrapped(int index, int size, int mode)
{
  return mode == 1 ? index - size * int(floor(float(index) / float(size)))
                   : clamp(index, 0, size - 1);
}
"""
"""GLSL: the index of a texel after wrapping; modes: 0 clamp, 1 repeat, 2 border (texels outside are
0)."""
_FRAGMENT = """
vec4 texel(sampler2D level, ivec2 index)
{
  ivec2 size = textureSize(level, 0);
  bool outside = (wrap.x == 2 && (index.x < 0 || index.x >= size.x)) ||
                 (wrap.y == 2 && (index.y < 0 || index.y >= size.y));
  if (outside) {
    return vec4(0.0);
  }
  return texelFetch(
    level, ivec2(wrapped(index.x, size.x, wrap.x), wrapped(index.y, size.y, wrap.y)), 0);
}

vec4 read(sampler2D level, ivec2 index)
{
  vec4 light = texel(level, index);
  return decodesAfter ? vec4(encoded(light.rgb), light.a) : light;
}

vec4 bilinear(sampler2D level)
{
  vec2 place = uv * vec2(textureSize(level, 0)) - 0.5;
  ivec2 low = ivec2(floor(place));
  vec2 f = place - floor(place);
  vec4 found = mix(mix(read(level, low), read(level, low + ivec2(1, 0)), f.x),
                   mix(read(level, low + ivec2(0, 1)), read(level, low + ivec2(1, 1)), f.x), f.y);
  return decodesAfter ? vec4(decoded(found.rgb), found.a) : found;
}

void main()
{
  vec4 light = across < wipe ? mix(bilinear(left_fine), bilinear(left_coarse), fraction)
                             : mix(bilinear(right_fine), bilinear(right_coarse), fraction);
  float alpha = clamp(light.a, 0.0, 1.0);
  vec3 shown = clamp(blends && alpha > 0.0 ? light.rgb / alpha : light.rgb, 0.0, 1.0);
  if (blends) {
    // As the editor does; before Blender 5 it multiplied display values.
    shown = MULTIPLIES_LIGHT ? shown * alpha : decoded(encoded(shown) * alpha);
  }
  if (channels == 0 && blends) {
    ivec2 square = ivec2(floor(gl_FragCoord.xy / checker_size));
    vec3 checker = ((square.x + square.y) & 1) == 0 ? checker_first.rgb : checker_second.rgb;
    shown += decoded(checker) * (1.0 - alpha);
  }
  else if (channels == 2) {
    shown = vec3(alpha);
  }
  else if (channels >= 3) {
    shown = vec3(shown[channels - 3]);
  }
  color = vec4(srgbTarget ? shown : encoded(shown), 1.0);
}
"""
_SAMPLERS = ("left_fine", "left_coarse", "right_fine", "right_coarse")

_handles: list[object] = []
_shader: gpu.types.GPUShader | None = None


def draw_levels(
    shown: Preview,
    view: Matrix,
    *,
    filters: tuple[str, str],
    mip_value: float,
    wipe: float,
    channels: str = "COLOR_ALPHA",
) -> None:
    """Draws the unit square of UV space with levels on it, into the active framebuffer.

    Args:
        shown: The levels.
        view: The matrix from UV space to clip space; it scales and translates.
        filters: The filters left and right of the wipe.
        mip_value: The level to draw; 0 is the image.
        wipe: The position of the wipe, as a share of the framebuffer's width; 0 shows the right
            filter only.
        channels: A value of `SpaceImageEditor.display_channels`.
    """
    mip_value = min(max(mip_value, 0.0), float(shown.last_level))
    fine = min(math.floor(mip_value), max(shown.last_level - 1, 0))
    coarse = min(fine + 1, shown.last_level)
    textures = _textures(shown, [(name, level) for name in filters for level in (fine, coarse)])
    shader = _compiled()
    batch = batch_for_shader(shader, "TRI_FAN", {"position": [(0, 0), (1, 0), (1, 1), (0, 1)]})
    shader.bind()
    for name, texture in zip(_SAMPLERS, textures, strict=True):
        shader.uniform_sampler(name, texture)
    shader.uniform_float("view", (view[0][0], view[1][1], view[0][3], view[1][3]))
    shader.uniform_float("depth", _DEPTH)
    shader.uniform_float("fraction", mip_value - fine)
    shader.uniform_float("wipe", wipe)
    shader.uniform_int("wrap", shown.wrap_numbers)
    shader.uniform_int("channels", _CHANNELS.get(channels, 0))
    shader.uniform_bool("blends", shown.blends)
    shader.uniform_bool("decodesAfter", shown.decodes_after)
    theme = bpy.context.preferences.themes[0].user_interface
    shader.uniform_float("checker_first", (*theme.transparent_checker_primary[:3], 1.0))
    shader.uniform_float("checker_second", (*theme.transparent_checker_secondary[:3], 1.0))
    shader.uniform_float("checker_size", float(theme.transparent_checker_size))
    batch.draw(shader)


def _compiled() -> gpu.types.GPUShader:
    from ...bridge.drawing import COLOR_FUNCTIONS

    global _shader
    if _shader is None:
        info = gpu.types.GPUShaderCreateInfo()
        for kind, name in (
            ("VEC4", "view"),
            ("VEC4", "checker_first"),
            ("VEC4", "checker_second"),
            ("IVEC2", "wrap"),
            ("FLOAT", "depth"),
            ("FLOAT", "fraction"),
            ("FLOAT", "wipe"),
            ("FLOAT", "checker_size"),
            ("INT", "channels"),
            ("BOOL", "blends"),
            ("BOOL", "decodesAfter"),
            # Set by Blender: whether the framebuffer encodes written values as sRGB.
            ("BOOL", "srgbTarget"),
        ):
            info.push_constant(kind, name)
        for slot, name in enumerate(_SAMPLERS):
            info.sampler(slot, "FLOAT_2D", name)
        interface = gpu.types.GPUStageInterfaceInfo("prefilter_level")
        interface.smooth("VEC2", "uv")
        interface.smooth("FLOAT", "across")
        info.vertex_in(0, "VEC2", "position")
        info.vertex_out(interface)
        info.fragment_out(0, "VEC4", "color")
        info.vertex_source(_VERTEX)
        info.define("MULTIPLIES_LIGHT", str(_MULTIPLIES_LIGHT).lower())
        info.fragment_source(COLOR_FUNCTIONS + LOOKUP + _FRAGMENT)
        _shader = gpu.shader.create_from_info(info)
    return _shader


def _textures(shown: Preview, wanted: list[tuple[str, int]]) -> list[gpu.types.GPUTexture]:
    """Returns textures of levels; those that no drawing wants any longer are freed."""
    from ...bridge.drawing import upload

    keys = [("", 0) if level == 0 else (name, level) for name, level in wanted]
    kept = {key: shown.textures[key] for key in keys if key in shown.textures}
    for key, (name, level) in zip(keys, wanted, strict=True):
        if key not in kept:
            kept[key] = upload(shown.levels[name][level])
    shown.textures = kept
    return [kept[key] for key in keys]


def _editor_preview() -> tuple[Preview, tuple[str, str], float] | None:
    """Returns the preview of the editor, its filters, and the position of the wipe."""
    settings = bpy.context.window_manager.prefilter_view
    shown = preview.find(bpy.context.space_data.image)
    if shown is None or not settings.use_preview:
        return None
    main = next(iter(shown.levels))
    other = settings.compare
    wipes = settings.use_wipe and other in shown.levels
    return shown, (other if wipes else main, main), settings.wipe if wipes else 0.0


def _draw_view() -> None:
    editor_preview = _editor_preview()
    if editor_preview is None:
        return
    shown, filters, wipe = editor_preview
    gpu.state.blend_set("NONE")
    gpu.state.depth_test_set("LESS_EQUAL")
    draw_levels(
        shown,
        gpu.matrix.get_projection_matrix() @ gpu.matrix.get_model_view_matrix(),
        filters=filters,
        mip_value=bpy.context.window_manager.prefilter_view.mip_value,
        wipe=wipe,
        channels=bpy.context.space_data.display_channels,
    )
    gpu.state.depth_test_set("NONE")


def _draw_labels() -> None:
    from ...bridge.drawing import draw_wipe

    editor_preview = _editor_preview()
    if editor_preview is None:
        return
    shown, (left, right), wipe = editor_preview
    mip_value = min(bpy.context.window_manager.prefilter_view.mip_value, shown.last_level)
    left_label = tr(FILTERS[left].label) if left != right else ""
    text = tr("{filter}, mip value {value}")
    draw_wipe(
        wipe, left_label, text.format(filter=tr(FILTERS[right].label), value=f"{mip_value:g}")
    )


def register() -> None:
    """Adds the draw handlers."""
    for draw, when in ((_draw_view, "POST_VIEW"), (_draw_labels, "POST_PIXEL")):
        handle = bpy.types.SpaceImageEditor.draw_handler_add(draw, (), "WINDOW", when)
        _handles.append(handle)


def unregister() -> None:
    """Removes the draw handlers."""
    global _shader
    while _handles:
        bpy.types.SpaceImageEditor.draw_handler_remove(_handles.pop(), "WINDOW")
    _shader = None
