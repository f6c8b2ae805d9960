# SPDX-License-Identifier: GPL-3.0-or-later

"""Makes the picture of docs/shaders.md: a plane in perspective, by GLSL.

usage: python3 shaders.py FOLDER        (with the package prefilter importable, and moderngl)

Leaves FOLDER/shaders.png, and prints how far each shader is from the exact filter.
"""

import sys
from pathlib import Path

import moderngl
import numpy as np
import prefilter
from numpy.typing import NDArray
from resize import drawn
from sheets import encoded, sheet

Array = NDArray[np.float32]

WIDTH, HEIGHT = 360, 270
PART = (slice(130, 184), slice(90, 162))  # Shown enlarged, to WIDTH and HEIGHT.
FILTER = "lanczos2"

PLANE = """#version 330 core
{source}
uniform sampler2D image;
out vec4 color;
// The ground below a camera that looks down a little.
vec2 ground(vec2 pixel) {{
  vec2 ray = (pixel - 0.5 * vec2({width}, {height})) / float({width});
  float distance = 1.0 / (0.55 - ray.y);
  return vec2(ray.x, 0.7) * distance * 1.4 + vec2(0.5, 0.1);
}}
void main() {{
  vec2 uv = ground(gl_FragCoord.xy);
  float mip_value = prefilter_mip_value(image, dFdx(uv), dFdy(uv));
  color = {expression};
}}
"""
CORNERS = """#version 330 core
in vec2 position;
void main() { gl_Position = vec4(position, 0.0, 1.0); }
"""


class Renderer:
    """Draws the plane with a texture, into floats."""

    def __init__(self, levels: list[Array]) -> None:
        self.context = moderngl.create_context(standalone=True, backend="egl", require=330)
        height, width, channels = levels[0].shape
        self.texture = self.context.texture((width, height), channels, dtype="f4")
        self.texture.build_mipmaps()
        for number, level in enumerate(levels):
            size = (0, 0, level.shape[1], level.shape[0])
            self.texture.write(np.ascontiguousarray(level).tobytes(), viewport=size, level=number)
        self.texture.filter = (moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR)

    def draw(self, source: str, expression: str) -> Array:
        """Returns the picture, (HEIGHT, WIDTH, 4), row 0 at the bottom."""
        plane = PLANE.format(source=source, expression=expression, width=WIDTH, height=HEIGHT)
        program = self.context.program(vertex_shader=CORNERS, fragment_shader=plane)
        self.texture.use(0)
        target = self.context.framebuffer([self.context.texture((WIDTH, HEIGHT), 4, dtype="f4")])
        target.use()
        corners = self.context.buffer(np.array([-1, -1, 3, -1, -1, 3], np.float32).tobytes())
        self.context.vertex_array(program, [(corners, "2f", "position")]).render()
        pixels = np.frombuffer(target.read(components=4, dtype="f4"), np.float32)
        return pixels.reshape(HEIGHT, WIDTH, 4)


def main(folder: Path) -> None:
    """Makes the picture."""
    image = drawn(512)
    renderer = Renderer(prefilter.sampling_levels(image, FILTER, wrap="repeat"))
    table = prefilter.SamplingTable.standard(FILTER, 8)
    source = table.glsl()
    wrap = "ivec2(PREFILTER_REPEAT, PREFILTER_REPEAT)"
    trilinear = renderer.draw(source, "textureLod(image, uv, mip_value)")
    sampled = renderer.draw(source, f"prefilter_sample(image, uv, mip_value, {wrap})")
    places = renderer.draw(source, "vec4(uv, exp2(mip_value), 1.0)").reshape(-1, 4)
    exact = prefilter.sample_exact(image, places[:, :2], places[:, 2], filter=FILTER, wrap="repeat")
    exact = exact.reshape(HEIGHT, WIDTH, 3)
    print(f"mip values from {np.log2(places[:, 2].min()):.2f} to {np.log2(places[:, 2].max()):.2f}")

    cells = []
    for pixels, title in ((trilinear, "Trilinear"), (sampled, "8 texels by a table")):
        error = np.sqrt(np.mean((pixels[..., :3] - exact) ** 2))
        print(f"{title}: error {error:.4f}, {-20 * np.log10(error):.1f} dB")
        cells.append((pixels[..., :3], f"{title}: {-20 * np.log10(error):.1f} dB"))
    cells.append((exact, "Every texel under the filter"))
    shown = [(encoded(pixels)[::-1], note) for pixels, note in cells]
    scale = HEIGHT // (PART[0].stop - PART[0].start)
    enlarged = [
        (pixels[PART].repeat(scale, axis=0).repeat(scale, axis=1), f"{scale} times as large")
        for pixels, _ in shown
    ]
    sheet(shown + enlarged, columns=3).save(folder / "shaders.png")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
