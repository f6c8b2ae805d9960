# SPDX-License-Identifier: GPL-3.0-or-later

"""Draws textured models by OpenGL into floats, without a screen.

Mesa's software renderer is told to compute mip values and weights as the specification says,
instead of faster: see its GALLIVM_PERF.
"""

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Self

import numpy as np
import scipy.sparse
from numpy.typing import NDArray

os.environ.setdefault("GALLIVM_PERF", "no_brilinear,no_rho_approx")
import moderngl

Floats = NDArray[np.float64]
Texels = NDArray[np.float32]

ELEVATION = np.radians(20)
HALF_FIELD_OF_VIEW = np.radians(15)
UNTEXTURED = -1
SAME = 1e-6  # Vertices nearer than that, of the model's size and the texture's, are one.
STEEPEST = 1.5  # Steps of depth beyond that share of the slopes beside them are edges.

VERTEX_SHADER = """#version 400 core
uniform mat4 to_clip;
in vec3 position;
in vec2 uv_of_corner;
in float chart_of_corner;
out vec2 uv;
flat out float chart;
void main() {
  gl_Position = to_clip * vec4(position, 1.0);
  uv = uv_of_corner;
  chart = chart_of_corner;
}
"""
FRAGMENT_SHADER = """#version 400 core
uniform sampler2D levels;
in vec2 uv;
flat in float chart;
out vec4 result;
void main() { result = %s; }
"""
LOOKUP = "vec4(texture(levels, uv).rgb, 1.0)"
NOTHING = "vec4(0.0)"
# Depth is linear over a triangle on the screen.
PLACE = "vec4(gl_FragCoord.z, dFdx(gl_FragCoord.z), dFdy(gl_FragCoord.z), chart + 1.0)"
# The mip value as the driver finds it, without clamping, and the squared axes of the ellipse that
# a circular pixel covers, in texels of level 0; 1 where the model is.
FOOTPRINT = """vec4(0.0);
  vec2 size = vec2(textureSize(levels, 0));
  vec2 a = dFdx(uv) * size, b = dFdy(uv) * size;
  float p = 0.5 * (dot(a, a) + dot(b, b));
  float q = length(vec2(0.5 * (dot(a, a) - dot(b, b)), dot(a, b)));
  result = vec4(textureQueryLod(levels, uv).y, p + q, max(p - q, 0.0), 1.0)"""
# Follows EXT_texture_filter_anisotropic, with trilinear lookups.
PROBES = """vec4(0.0);
  vec2 size = vec2(textureSize(levels, 0));
  vec2 dx = dFdx(uv), dy = dFdy(uv);
  float px = length(dx * size), py = length(dy * size);
  float longer = max(px, py), shorter = min(px, py);
  float count = clamp(ceil(longer / max(shorter, 1e-20)), 1.0, 16.0);
  float mip = log2(max(longer / count, 1e-20));
  vec2 along = px > py ? dx : dy;
  vec3 sum = vec3(0.0);
  for (float i = 1.0; i <= count; i += 1.0) {
    sum += textureLod(levels, uv + along * (i / (count + 1.0) - 0.5), mip).rgb;
  }
  result = vec4(sum / count, 1.0)"""


def exact(side: int) -> str:
    """Returns GLSL of the mean over a pixel's footprint, by side x side lookups of level 0.

    It bounds the quality of any levels, except for texels beyond a chart.
    """
    return f"""vec4(0.0);
  vec2 dx = dFdx(uv), dy = dFdy(uv);
  vec3 sum = vec3(0.0);
  for (int j = 0; j < {side}; ++j) {{
    for (int i = 0; i < {side}; ++i) {{
      vec2 at = (vec2(i, j) + 0.5) / {side}.0 - 0.5;
      sum += textureLod(levels, uv + at.x * dx + at.y * dy, 0.0).rgb;
    }}
  }}
  result = vec4(sum / {side * side}.0, 1.0)"""


FULL = (moderngl.LINEAR, moderngl.LINEAR)
TRILINEAR = (moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR)
NEAREST_LEVEL = (moderngl.LINEAR_MIPMAP_NEAREST, moderngl.LINEAR)


@dataclass(frozen=True)
class Model:
    """Images and the triangles that wear them; see bench/textures/opengl_models.py.

    Attributes:
        name: Of the model.
        names: Of its images.
        images: (height, width, 3) scene-linear.
        wraps: "repeat" or "clamp" for each.
        corners: (m, 3, 3) positions.
        uvs: (m, 3, 2).
        used: (m,) numbers of the images, or UNTEXTURED.
    """

    name: str
    names: list[str]
    images: list[Texels]
    wraps: list[str]
    corners: Floats
    uvs: Floats
    used: NDArray[np.int64]

    @classmethod
    def read(cls, path: Path) -> Self:
        """Reads a file of opengl_models.py."""
        with np.load(path) as file:
            names = [str(name) for name in file["names"]]
            images = [file[f"image_{i}"] for i in range(len(names))]
            wraps = [str(wrap) for wrap in file["wraps"]]
            return cls(path.stem, names, images, wraps, file["corners"], file["uvs"], file["used"])

    def charts(self) -> NDArray[np.int64]:
        """Returns the chart (m,) that each triangle belongs to: charts share no vertex."""
        corners = self.corners.reshape(-1, 3)
        scale = SAME * np.ptp(corners, axis=0).max()
        keys = np.concatenate(
            [
                np.round(corners / scale),
                np.round(self.uvs.reshape(-1, 2) / SAME),
                self.used.repeat(3)[:, None],
            ],
            axis=1,
        )
        _, vertices = np.unique(keys, axis=0, return_inverse=True)
        vertices = vertices.reshape(-1, 3)
        ends = np.concatenate([vertices[:, :2], vertices[:, 1:]])
        count = vertices.max() + 1
        graph = scipy.sparse.coo_array((np.ones(len(ends)), tuple(ends.T)), (count, count))
        _, labels = scipy.sparse.csgraph.connected_components(graph, directed=False)
        return labels[vertices[:, 0]]


class Renderer:
    """Draws a model, with its textured part centered, in perspective from a little above."""

    def __init__(self, model: Model) -> None:
        """Sends the triangles to OpenGL."""
        self.context = moderngl.create_context(standalone=True, backend="egl", require=400)
        self.context.enable(moderngl.DEPTH_TEST)
        self._model = model
        self._buffers = {}
        self._programs: dict[str, moderngl.Program] = {}
        textured = model.corners[model.used != UNTEXTURED]
        center = (textured.min(axis=(0, 1)) + textured.max(axis=(0, 1))) / 2
        self._radius = np.linalg.norm(textured - center, axis=2).max()
        self._reach = np.linalg.norm(model.corners - center, axis=2).max()
        charts = np.broadcast_to(model.charts()[:, None, None], (len(model.used), 3, 1))
        for image in np.unique(model.used):
            of_image = model.used == image
            rows = [model.corners[of_image] - center, model.uvs[of_image], charts[of_image]]
            vertices = np.concatenate(rows, axis=2).astype(np.float32)
            self._buffers[int(image)] = self.context.buffer(vertices.tobytes())

    def texture(self, levels: list[Texels], wrap: str) -> moderngl.Texture:
        """Returns a texture with these levels, of floats."""
        height, width, channels = levels[0].shape
        texture = self.context.texture((width, height), channels, dtype="f4")
        if len(levels) > 1:
            texture.build_mipmaps(0, len(levels) - 1)
        for number, level in enumerate(levels):
            height, width, _ = level.shape
            if (width, height) != tuple(max(1, side >> number) for side in texture.size):
                raise ValueError(f"level {number}: {width} x {height} is not OpenGL's size")
            texels = np.ascontiguousarray(level, np.float32).tobytes()
            texture.write(texels, viewport=(0, 0, width, height), level=number)
        texture.repeat_x = texture.repeat_y = wrap == "repeat"
        return texture

    def textures(self, levels: list[list[Texels]]) -> list[moderngl.Texture]:
        """Returns the textures of all images."""
        return [self.texture(*pair) for pair in zip(levels, self._model.wraps, strict=True)]

    def draw(
        self,
        textures: list[moderngl.Texture],
        angle: float,
        size: int,
        *,
        filters: tuple[int, int] = TRILINEAR,
        anisotropy: float = 1.0,
        result: str = LOOKUP,
    ) -> Texels:
        """Returns (size, size, 4) colors and coverage, row 0 at the bottom.

        Args:
            textures: Of `textures`.
            angle: By which the model is turned about its vertical axis, radians.
            size: Pixels, with one sample each.
            filters: For making smaller and larger.
            anisotropy: The most.
            result: GLSL of what to draw.
        """
        color = self.context.texture((size, size), 4, dtype="f4")
        depth = self.context.depth_renderbuffer((size, size))
        target = self.context.framebuffer([color], depth)
        target.use()
        target.clear()
        made = [target, color, depth]
        matrix = self._to_clip(angle).T.astype(np.float32).tobytes()
        for image, buffer in self._buffers.items():
            fragment = FRAGMENT_SHADER % (NOTHING if image == UNTEXTURED else result)
            program = self._program(fragment)
            program["to_clip"].write(matrix)
            if image != UNTEXTURED:
                textures[image].filter = filters
                textures[image].anisotropy = anisotropy
                textures[image].use(0)
            # The program does not list attributes that its shader does not use.
            attributes = {"position": 3, "uv_of_corner": 2, "chart_of_corner": 1}
            names = [name for name in attributes if name in program]
            layout = " ".join(
                f"{count}f" if name in names else f"{count}x4" for name, count in attributes.items()
            )
            triangles = self.context.vertex_array(program, [(buffer, layout, *names)])
            triangles.render(moderngl.TRIANGLES)
            made.append(triangles)
        pixels = np.frombuffer(target.read(components=4, dtype="f4"), np.float32)
        for thing in made:
            thing.release()
        return pixels.reshape(size, size, 4)

    def _program(self, fragment: str) -> moderngl.Program:
        # Compiling takes longer than drawing.
        if fragment not in self._programs:
            self._programs[fragment] = self.context.program(
                vertex_shader=VERTEX_SHADER, fragment_shader=fragment
            )
        return self._programs[fragment]

    def _to_clip(self, angle: float) -> Floats:
        turn = np.eye(4)
        turn[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
        # Blender's z is up; OpenGL's camera looks along -z.
        view = np.eye(4)
        c, s = np.cos(ELEVATION), np.sin(ELEVATION)
        view[:3, :3] = [[1, 0, 0], [0, s, c], [0, -c, s]]
        distance = self._radius / np.sin(HALF_FIELD_OF_VIEW)
        view[2, 3] = -distance
        near, far = max(distance - self._reach, 0.1 * self._radius), distance + self._reach
        f = 1 / np.tan(HALF_FIELD_OF_VIEW)
        depth = [(near + far) / (near - far), 2 * near * far / (near - far)]
        project = np.array([[f, 0, 0, 0], [0, f, 0, 0], [0, 0, *depth], [0, 0, -1, 0]])
        return project @ view @ turn


def in_one_piece(places: Texels, factor: int) -> NDArray[np.bool_]:
    """Returns below which squares of samples, of what PLACE draws, one chart lies without edges."""
    size = len(places) // factor
    squares = places.reshape(size, factor, size, factor, 4)
    charts = squares[..., 3]
    alone = (charts == charts[:, :1, :, :1]).all(axis=(1, 3)) & (charts[:, 0, :, 0] > 0)
    for axis, slope in ((3, 1), (1, 2)):
        steps = np.abs(np.diff(squares[..., 0], axis=axis))
        slopes = np.abs(squares[..., slope])
        before = np.take(slopes, range(factor - 1), axis)
        after = np.take(slopes, range(1, factor), axis)
        steep = steps > STEEPEST * np.maximum(before, after) + 1e-5
        alone &= ~steep.any(axis=(1, 3))
    return alone


def averaged(pixels: Texels, factor: int) -> Texels:
    """Returns the means of squares of pixels."""
    size = len(pixels) // factor
    rows = pixels.reshape(size, factor, -1).sum(axis=1)
    return rows.reshape(size, size, factor, -1).sum(axis=2) / np.float32(factor**2)
