# SPDX-License-Identifier: GPL-3.0-or-later

"""Fragment shaders run without a screen, by Mesa on the processor where there is no GPU."""

import numpy as np
import pytest

moderngl = pytest.importorskip("moderngl", reason="there is no moderngl to run shaders with")

VERTEX_SHADER = """#version 330 core
in vec2 position;
void main() { gl_Position = vec4(position, 0.0, 1.0); }
"""
FRAGMENT_SHADER = """#version {version} core
{source}
uniform sampler2D levels;
uniform sampler2D queries;
uniform ivec2 wrap;
out vec4 result;
void main() {{
  vec4 query = texelFetch(queries, ivec2(gl_FragCoord.xy), 0);
  {body}
}}
"""
QUERIES_OF_ROW = 64


class SoftwareGpu:
    def __init__(self):
        self._context = moderngl.create_context(standalone=True, backend="egl", require=330)

    def texture(self, levels):
        """A texture of float32 with these levels; sizes are rounded down, as in OpenGL."""
        height, width, channels = levels[0].shape
        texture = self._context.texture((width, height), channels, dtype="f4")
        texture.build_mipmaps(0, len(levels) - 1)
        for level, pixels in enumerate(levels):
            height, width, _ = pixels.shape
            assert (width, height) == tuple(max(1, side >> level) for side in texture.size)
            texels = np.ascontiguousarray(pixels, np.float32).tobytes()
            texture.write(texels, viewport=(0, 0, width, height), level=level)
        texture.filter = (moderngl.NEAREST_MIPMAP_NEAREST, moderngl.NEAREST)
        return texture

    def program(self, source, body, version=330):
        """Compiles code that computes `result` from `query`, both vec4, `levels` and `wrap`."""
        fragment_shader = FRAGMENT_SHADER.format(version=version, source=source, body=body)
        return self._context.program(vertex_shader=VERTEX_SHADER, fragment_shader=fragment_shader)

    def run(self, program, texture, queries, wrap=(0, 0)):
        """The results, float32 (n, 4), of queries of up to four numbers."""
        count = len(queries)
        rows = -(-count // QUERIES_OF_ROW)
        numbers = np.zeros((rows * QUERIES_OF_ROW, 4), np.float32)
        numbers[:count, : np.shape(queries)[1]] = queries
        size = (QUERIES_OF_ROW, rows)
        query_texture = self._context.texture(size, 4, numbers.tobytes(), dtype="f4")
        query_texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
        uniforms = {"levels": 0, "queries": 1, "wrap": wrap}
        for name in uniforms.keys() & set(program):
            program[name] = uniforms[name]
        if texture is not None:
            texture.use(0)
        query_texture.use(1)

        target = self._context.framebuffer([self._context.texture(size, 4, dtype="f4")])
        target.use()
        corners = np.array([-1, -1, 3, -1, -1, 3], np.float32)
        buffer = self._context.buffer(corners.tobytes())
        triangle = self._context.vertex_array(program, [(buffer, "2f", "position")])
        triangle.render(moderngl.TRIANGLES)
        results = np.frombuffer(target.read(components=4, dtype="f4"), np.float32)
        return results.reshape(-1, 4)[:count]
