# SPDX-License-Identifier: GPL-3.0-or-later

"""Draws levels over the objects that show their image, in the 3D views.

The scene does not change: the levels are drawn over the objects, without lighting. Lookups are as
in `overlay`. The level of each pixel may be chosen as on a GPU, by the number of texels in the
pixel.
"""

from typing import TYPE_CHECKING

import bpy
import gpu
import numpy as np
from bpy.app.handlers import persistent
from gpu_extras.batch import batch_for_shader

from ..choices import FILTERS
from . import preview
from .overlay import LOOKUP

if TYPE_CHECKING:
    from ...bridge.images import FloatArray
    from .preview import Preview

_VERTEX = """
void main()
{
  uv = texture_place;
  vec4 place = matrix * vec4(position, 1.0);
  // In front of the object's own surface.
  place.z -= NEARER * place.w;
  gl_Position = place;
  across = place.xw;
}
"""
_FRAGMENT = """
vec4 texel(sampler2D coarse, int level, ivec2 index)
{
  ivec4 box = ivec4(texelFetch(boxes, ivec2(level, 0), 0));
  ivec2 size = box.zw;
  bool outside = (wrap.x == 2 && (index.x < 0 || index.x >= size.x)) ||
                 (wrap.y == 2 && (index.y < 0 || index.y >= size.y));
  if (outside) {
    return vec4(0.0);
  }
  ivec2 place = ivec2(wrapped(index.x, size.x, wrap.x), wrapped(index.y, size.y, wrap.y));
  vec4 light = level == 0 ? texelFetch(level_0, place, 0) : texelFetch(coarse, box.xy + place, 0);
  return decodesAfter ? vec4(encoded(light.rgb), light.a) : light;
}

vec4 bilinear(sampler2D coarse, int level)
{
  vec2 size = texelFetch(boxes, ivec2(level, 0), 0).zw;
  vec2 place = uv * size - 0.5;
  ivec2 low = ivec2(floor(place));
  vec2 f = place - floor(place);
  vec4 found = mix(
    mix(texel(coarse, level, low), texel(coarse, level, low + ivec2(1, 0)), f.x),
    mix(texel(coarse, level, low + ivec2(0, 1)), texel(coarse, level, low + ivec2(1, 1)), f.x),
    f.y);
  return decodesAfter ? vec4(decoded(found.rgb), found.a) : found;
}

void main()
{
  vec2 size = texelFetch(boxes, ivec2(0, 0), 0).zw;
  vec2 dx = dFdx(uv) * size, dy = dFdy(uv) * size;
  float covered = 0.5 * log2(max(max(dot(dx, dx), dot(dy, dy)), 1e-12));
  float mip = clamp(byDistance ? covered + value : value, 0.0, float(last_level));
  int fine = min(int(floor(mip)), max(last_level - 1, 0));
  int coarse = min(fine + 1, last_level);
  float fraction = mip - float(fine);
  vec4 light = across.x / across.y * 0.5 + 0.5 < wipe
    ? mix(bilinear(left, fine), bilinear(left, coarse), fraction)
    : mix(bilinear(right, fine), bilinear(right, coarse), fraction);
  float alpha = blends ? clamp(light.a, 0.0, 1.0) : 1.0;
  vec3 shown = clamp(blends && alpha > 0.0 ? light.rgb / alpha : light.rgb, 0.0, 1.0);
  color = vec4(srgbTarget ? shown : encoded(shown), alpha);
}
"""
_NEARER = "1e-6"
_WITHOUT_DEPTH = frozenset({"MATERIAL", "RENDERED"})
"""The shading modes in which a view without overlays has no depth buffer."""

_handles: list[object] = []
_shader: gpu.types.GPUShader | None = None


class _ModelPreview:
    """The preview of an image, with its batches and textures on the GPU."""

    def __init__(self, image: bpy.types.Image, shown: "Preview") -> None:
        self.image_uid = image.session_uid
        self.preview = shown
        self.batches: dict[str, gpu.types.GPUBatch | None] = {}
        self.textures: dict[str, gpu.types.GPUTexture] = {}

    def image(self) -> bpy.types.Image | None:
        """Returns the image; None if it was deleted."""
        images = (image for image in bpy.data.images if image.session_uid == self.image_uid)
        return next(images, None)

    def batch(
        self, obj: bpy.types.Object, image: bpy.types.Image, depsgraph: bpy.types.Depsgraph
    ) -> gpu.types.GPUBatch | None:
        """Returns the triangles of an object that show the image."""
        from ...bridge.drawn_meshes import triangles_with

        if obj.name not in self.batches:
            triangles = triangles_with(obj, image, depsgraph)
            self.batches[obj.name] = None
            if triangles is not None:
                values = {"position": triangles.positions, "texture_place": triangles.uvs}
                self.batches[obj.name] = batch_for_shader(_compiled(), "TRIS", values)
        return self.batches[obj.name]

    def texture(self, name: str) -> gpu.types.GPUTexture:
        """Returns all levels of a filter but the first, below each other; "" for the first."""
        from ...bridge.drawing import upload

        if name not in self.textures:
            levels = self.preview.levels[name or next(iter(self.preview.levels))]
            self.textures[name] = upload(_stacked(levels[1:] or levels) if name else levels[0])
        return self.textures[name]

    def boxes(self) -> gpu.types.GPUTexture:
        """Returns a texture with x, y, width and height of each level in its texture."""
        if "boxes" not in self.textures:
            boxes, y = [], 0
            for index, level in enumerate(next(iter(self.preview.levels.values()))):
                height, width = level.shape[:2]
                boxes.append((0, y if index else 0, width, height))
                y += height if index else 0
            values = np.array(boxes, np.float32)
            data = gpu.types.Buffer("FLOAT", values.size, values.ravel())
            self.textures["boxes"] = gpu.types.GPUTexture(
                (len(boxes), 1), format="RGBA32F", data=data
            )
        return self.textures["boxes"]


_shown: _ModelPreview | None = None


def begin(image: bpy.types.Image) -> None:
    """Starts drawing the preview of an image in the 3D views."""
    global _shown
    levels = preview.find(image)
    _shown = _ModelPreview(image, levels) if levels is not None else None


def end() -> None:
    """Stops drawing levels in the 3D views."""
    global _shown
    _shown = None


def shown_image() -> bpy.types.Image | None:
    """Returns the image whose levels the 3D views draw; None for none."""
    image = _shown.image() if _shown is not None else None
    return image if preview.find(image) is not None else None


def current() -> "Preview | None":
    """Returns the preview that the 3D views draw; None for none."""
    return preview.find(shown_image())


def _stacked(levels: "list[FloatArray]") -> "FloatArray":
    """Returns levels stacked vertically, the first one at row 0."""
    width = max(level.shape[1] for level in levels)
    rows = [np.pad(level, ((0, 0), (0, width - level.shape[1]), (0, 0))) for level in levels]
    return np.concatenate(rows)


def _compiled() -> gpu.types.GPUShader:
    from ...bridge.drawing import COLOR_FUNCTIONS

    global _shader
    if _shader is None:
        info = gpu.types.GPUShaderCreateInfo()
        for kind, name in (
            ("MAT4", "matrix"),
            ("IVEC2", "wrap"),
            ("FLOAT", "value"),
            ("FLOAT", "wipe"),
            ("INT", "last_level"),
            ("BOOL", "byDistance"),
            ("BOOL", "blends"),
            ("BOOL", "decodesAfter"),
            # Set by Blender: whether the framebuffer encodes written values as sRGB.
            ("BOOL", "srgbTarget"),
        ):
            info.push_constant(kind, name)
        for slot, name in enumerate(("level_0", "left", "right", "boxes")):
            info.sampler(slot, "FLOAT_2D", name)
        interface = gpu.types.GPUStageInterfaceInfo("prefilter_on_model")
        interface.smooth("VEC2", "uv")
        interface.smooth("VEC2", "across")
        info.vertex_in(0, "VEC3", "position")
        info.vertex_in(1, "VEC2", "texture_place")
        info.vertex_out(interface)
        info.fragment_out(0, "VEC4", "color")
        info.define("NEARER", _NEARER)
        info.vertex_source(_VERTEX)
        info.fragment_source(COLOR_FUNCTIONS + LOOKUP + _FRAGMENT)
        _shader = gpu.shader.create_from_info(info)
    return _shader


def _filters(levels: "Preview") -> tuple[str, str, float]:
    """Returns the filters left and right of the wipe, and the position of the wipe."""
    settings = bpy.context.window_manager.prefilter_view
    main, other = next(iter(levels.levels)), settings.compare
    wipes = settings.use_wipe and other in levels.levels
    return (other if wipes else main), main, (settings.wipe if wipes else 0.0)


def _draw_view() -> None:
    settings = bpy.context.window_manager.prefilter_view
    image = shown_image() if settings.use_model else None
    found = preview.find(image)
    if image is None or found is None or _shown is None:
        return
    if _shown.preview is not found:
        begin(image)
    depsgraph = bpy.context.evaluated_depsgraph_get()
    space = bpy.context.space_data
    if not space.overlay.show_overlays and space.shading.type in _WITHOUT_DEPTH:
        gpu.state.active_framebuffer_get().clear(depth=1.0)
    gpu.state.depth_test_set("LESS_EQUAL")
    gpu.state.depth_mask_set(True)
    gpu.state.blend_set("ALPHA" if found.blends else "NONE")
    view = gpu.matrix.get_projection_matrix() @ gpu.matrix.get_model_view_matrix()
    for obj in bpy.context.view_layer.objects:
        if obj.name in found.objects and obj.visible_in_viewport_get(space):
            batch = _shown.batch(obj, image, depsgraph)
            if batch is not None:
                _draw_batch(batch, found, view @ obj.matrix_world)
    gpu.state.blend_set("NONE")
    gpu.state.depth_mask_set(False)
    gpu.state.depth_test_set("NONE")


def _draw_batch(batch: gpu.types.GPUBatch, found: "Preview", matrix: object) -> None:
    settings = bpy.context.window_manager.prefilter_view
    left, right, wipe = _filters(found)
    by_distance = settings.choice == "distance"
    shader = _compiled()
    shader.bind()
    assert _shown is not None
    shader.uniform_sampler("level_0", _shown.texture(""))
    shader.uniform_sampler("left", _shown.texture(left))
    shader.uniform_sampler("right", _shown.texture(right))
    shader.uniform_sampler("boxes", _shown.boxes())
    shader.uniform_float("matrix", matrix)
    shader.uniform_int("wrap", found.wrap_numbers)
    value = float(np.log2(settings.distance)) if by_distance else settings.mip_value
    shader.uniform_float("value", value)
    shader.uniform_float("wipe", wipe)
    shader.uniform_int("last_level", found.last_level)
    shader.uniform_bool("byDistance", by_distance)
    shader.uniform_bool("blends", found.blends)
    shader.uniform_bool("decodesAfter", found.decodes_after)
    batch.draw(shader)


def _draw_labels() -> None:
    from ...bridge.drawing import draw_wipe
    from ...core.translations import tr

    settings = bpy.context.window_manager.prefilter_view
    found = current() if settings.use_model else None
    if found is None:
        return
    left, right, wipe = _filters(found)
    if settings.choice == "distance" and settings.distance == 1.0:
        text = tr("{filter}, as seen from here").format(filter=tr(FILTERS[right].label))
    elif settings.choice == "distance":
        text = tr("{filter}, {factor} times as far").format(
            filter=tr(FILTERS[right].label), factor=f"{settings.distance:g}"
        )
    else:
        value = f"{min(settings.mip_value, found.last_level):g}"
        text = tr("{filter}, mip value {value}").format(
            filter=tr(FILTERS[right].label), value=value
        )
    draw_wipe(wipe, tr(FILTERS[left].label) if left != right else "", text)


@persistent
def _drop_changed_batches(_: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    """Deletes the batches of objects that have changed."""
    if _shown is None:
        return
    for update in depsgraph.updates:
        changed = update.id.original
        if isinstance(changed, bpy.types.Material):
            _shown.batches.clear()
        elif isinstance(changed, bpy.types.Object) and update.is_updated_geometry:
            _shown.batches.pop(changed.name, None)


@persistent
def _drop_all_batches(*_: object) -> None:
    if _shown is not None:
        _shown.batches.clear()


_HANDLERS = (
    ("depsgraph_update_post", _drop_changed_batches),
    ("undo_post", _drop_all_batches),
    ("redo_post", _drop_all_batches),
)


def register() -> None:
    """Adds the draw handlers."""
    for draw, when in ((_draw_view, "POST_VIEW"), (_draw_labels, "POST_PIXEL")):
        _handles.append(bpy.types.SpaceView3D.draw_handler_add(draw, (), "WINDOW", when))
    for name, handler in _HANDLERS:
        getattr(bpy.app.handlers, name).append(handler)


def unregister() -> None:
    """Removes the draw handlers."""
    global _shader
    for name, handler in _HANDLERS:
        getattr(bpy.app.handlers, name).remove(handler)
    while _handles:
        bpy.types.SpaceView3D.draw_handler_remove(_handles.pop(), "WINDOW")
    end()
    _shader = None
