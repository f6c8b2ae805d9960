# SPDX-License-Identifier: GPL-3.0-or-later

"""OpenGL's lookups follow its formulas, as bench/textures/opengl.py assumes."""

import sys
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("moderngl", reason="there is no moderngl to draw with")
pytest.importorskip("scipy", reason="scipy finds charts")

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from bench.textures import opengl_renderer
from bench.textures.opengl_renderer import Model, Renderer, averaged, in_one_piece

SIDE, SIZE = 64, 24
# Mesa's lookups, not its queries, take 2^k (1 + m) to have the logarithm k + m, and half of that.
LOG2_ERROR = 0.0431


@pytest.fixture(scope="module")
def levels():
    random = np.random.default_rng(3)
    return [random.random((SIDE >> k, SIDE >> k, 3)).astype(np.float32) for k in range(7)]


def quads(*centers):
    """A model of 2 x 2 squares facing +y, at positions (x, y), each with the whole texture."""
    ends = np.array([[-1, 0, -1], [1, 0, -1], [1, 0, 1], [-1, 0, 1]], float)
    corners = [ends + np.array([x, y, 0]) for x, y in centers]
    uvs = (ends[:, [0, 2]] + 1) / 2
    threes = ([0, 1, 2], [0, 2, 3])
    return Model(
        "quads",
        ["image"],
        [np.zeros((SIDE, SIDE, 3), np.float32)],
        ["repeat"],
        np.array([quad[three] for quad in corners for three in threes]),
        np.array([uvs[three] for _ in corners for three in threes]),
        np.zeros(2 * len(corners), int),
    )


@pytest.fixture(scope="module")
def renderer():
    return Renderer(quads((0, 0)))


def bilinear(level, uvs):
    side = len(level)
    x = uvs * side - 0.5
    first = np.floor(x).astype(int)
    s, t = (x - first).T[..., None]
    (i, j), (i1, j1) = first.T % side, (first.T + 1) % side
    return (1 - t) * ((1 - s) * level[j, i] + s * level[j, i1]) + t * (
        (1 - s) * level[j1, i] + s * level[j1, i1]
    )


def trilinear(levels, uvs, mip_values):
    result = np.zeros((len(uvs), 3))
    for number, level in enumerate(levels):
        share = np.maximum(1 - np.abs(np.clip(mip_values, 0, len(levels) - 1) - number), 0)
        result += share[:, None] * bilinear(level, uvs)
    return result


def drawn_places(renderer, texture, angle):
    """Which pixels the quad covers, and their uv and mip values, from differences in numpy."""
    drawn = renderer.draw([texture], angle, SIZE, result="vec4(uv, 0.0, 1.0)")
    covered = drawn[..., 3] == 1
    uvs = drawn[..., :2].astype(float)
    # OpenGL takes differences in squares of 2 x 2 pixels; the first row and column stand for all.
    squares = uvs.reshape(SIZE // 2, 2, SIZE // 2, 2, 2)
    dx = np.linalg.norm(squares[:, 0, :, 1] - squares[:, 0, :, 0], axis=-1) * SIDE
    dy = np.linalg.norm(squares[:, 1, :, 0] - squares[:, 0, :, 0], axis=-1) * SIDE
    whole = covered.reshape(SIZE // 2, 2, SIZE // 2, 2).all(axis=(1, 3)).repeat(2, 0).repeat(2, 1)
    mip_values = np.log2(np.maximum(np.maximum(dx, dy), 1e-9)).repeat(2, 0).repeat(2, 1)
    return whole, uvs[whole], mip_values[whole]


@pytest.mark.parametrize("angle", [0.2, 0.9, 3.5])
def test_trilinear_lookups_are_those_of_numpy(renderer, levels, angle):
    texture = renderer.texture(levels, "repeat")
    whole, uvs, mip_values = drawn_places(renderer, texture, angle)
    assert whole.sum() > 40
    assert mip_values.min() > 0.5
    queried = renderer.draw([texture], angle, SIZE, result=opengl_renderer.FOOTPRINT)[whole]
    assert np.abs(queried[:, 0] - mip_values).max() < 1e-4
    found = renderer.draw([texture], angle, SIZE)[whole][:, :3]
    apart = [
        np.abs(found - trilinear(levels, uvs, mip_values - less)).max(axis=1)
        for less in np.linspace(0, LOG2_ERROR, 24)
    ]
    assert np.min(apart, axis=0).max() < 2e-3


def test_the_full_image_is_looked_up_bilinearly(renderer, levels):
    texture = renderer.texture(levels[:1], "repeat")
    whole, uvs, _ = drawn_places(renderer, texture, 0.4)
    found = renderer.draw([texture], 0.4, SIZE, filters=opengl_renderer.FULL)
    assert np.abs(found[whole][:, :3] - bilinear(levels[0], uvs)).max() < 1e-4


def test_probes_of_a_round_footprint_are_one_lookup(renderer, levels):
    texture = renderer.texture(levels, "repeat")
    flat = [np.full_like(level, 0.25) for level in levels]
    constant = renderer.texture(flat, "repeat")
    for result in (opengl_renderer.PROBES, opengl_renderer.exact(4)):
        shown = renderer.draw([constant], 0.7, SIZE, result=result)
        assert shown[..., 3].max() == 1
        assert np.allclose(shown[shown[..., 3] == 1][:, :3], 0.25, atol=1e-6)
    place = renderer.draw([texture], 0.0, SIZE, result=opengl_renderer.FOOTPRINT)
    ratios = np.sqrt(place[..., 2] / np.maximum(place[..., 1], 1e-9))[place[..., 3] == 1]
    assert 0.8 < np.median(ratios) <= 1


def test_the_exact_footprint_is_the_mean_of_samples(renderer, levels):
    smooth = np.sin(np.arange(SIDE) * 2 * np.pi / SIDE).astype(np.float32)
    image = np.broadcast_to((smooth[:, None] * smooth)[..., None], (SIDE, SIDE, 3))
    texture = renderer.texture([image], "repeat")
    full = opengl_renderer.FULL
    samples = averaged(renderer.draw([texture], 0.4, 16 * SIZE, filters=full), 16)
    shown = renderer.draw([texture], 0.4, SIZE, filters=full, result=opengl_renderer.exact(16))
    inside = samples[..., 3] == 1
    assert inside.sum() > 40
    assert np.abs(shown - samples)[inside].max() < 0.005


def test_pixels_with_an_edge_of_depth_are_not_in_one_piece():
    renderer = Renderer(quads((0, 0), (0.9, 1.0)))
    texture = renderer.texture([np.zeros((4, 4, 3), np.float32)], "repeat")
    samples = averaged(renderer.draw([texture], 0.3, 8 * SIZE), 8)
    alone = in_one_piece(renderer.draw([texture], 0.3, 8 * SIZE, result=opengl_renderer.PLACE), 8)
    covered = samples[..., 3] == 1
    assert covered.sum() > alone.sum() > 0.5 * covered.sum()
    assert not (alone & ~covered).any()


def test_averages_are_of_squares():
    pixels = np.arange(4 * 4 * 2, dtype=np.float32).reshape(4, 4, 2)
    expected = [[pixels[i : i + 2, j : j + 2].mean(axis=(0, 1)) for j in (0, 2)] for i in (0, 2)]
    assert np.allclose(averaged(pixels, 2), expected)
