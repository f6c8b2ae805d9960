# SPDX-License-Identifier: GPL-3.0-or-later

"""The preview plane: the editors' drawing, against samples taken without a graphics card."""

from pathlib import Path

import bpy
import numpy as np
import prefilter
import pytest
import scenes

SESSION = Path(__file__).with_name("plane_session.py")
WIDTH, HEIGHT = 64, 48
VIEWS = ((0.0, 0.1, 0.37), (1.2, 0.3, 2.0), (1.45, 2.0, 6.0))
BACKDROP = 0.03


@pytest.fixture(scope="module")
def found(in_window, tmp_path_factory):
    """Runs the session once, and returns its results."""
    result = tmp_path_factory.mktemp("plane") / "result.npz"
    in_window(SESSION, result)
    return dict(np.load(result))


def seen(tilt, rotation, tiles, image_aspect):
    """Returns UVs and their derivatives along x and y of the pixels of a picture, by rays: those
    of pixels above the horizon are NaN."""
    y, x = np.mgrid[:HEIGHT, :WIDTH] + 0.5

    def hit(x, y):
        ray = np.stack([(x - WIDTH / 2) / HEIGHT, y / HEIGHT - 0.5, -np.ones_like(x)], axis=-1)
        cosine, sine = np.cos(tilt), np.sin(tilt)
        to_world = np.array([[1, 0, 0], [0, cosine, -sine], [0, sine, cosine]])
        eye, ray = to_world @ (0.0, 0.0, tiles), ray @ to_world.T
        with np.errstate(all="ignore"):
            far = np.where(ray[..., 2] < 0, -eye[2] / ray[..., 2], np.nan)
        plane = eye[:2] + far[..., None] * ray[..., :2]
        back = np.array(
            [[np.cos(rotation), np.sin(rotation)], [-np.sin(rotation), np.cos(rotation)]]
        )
        return plane @ back.T / (image_aspect, 1.0) + 0.5

    step = 1e-4
    along_x = (hit(x + step, y) - hit(x - step, y)) / (2 * step)
    along_y = (hit(x, y + step) - hit(x, y - step)) / (2 * step)
    return hit(x, y), np.stack([along_x, along_y], axis=-1)


@pytest.mark.parametrize("texels", [4, 8])
@pytest.mark.parametrize("view", range(len(VIEWS)))
@pytest.mark.parametrize(
    ("name", "filter", "pixels"),
    [
        ("wide", "lanczos2", scenes.noise(24, 43)),
        ("high", "tent", scenes.noise(33, 7, alpha=True, seed=2)),
    ],
)
def test_samples_are_those_of_the_package(found, name, filter, pixels, view, texels):
    light = pixels.astype(float)
    light[..., :3] = scenes.to_linear(light[..., :3]) * light[..., 3:]
    height, width = light.shape[:2]
    levels = prefilter.sampling_levels(
        light.astype(np.float32), filter, wrap="repeat", premultiplied=True
    )
    uv, slopes = seen(*VIEWS[view], width / height)
    below = ~np.isnan(uv[..., 0])
    slopes = slopes[below] * np.array([width, height])[:, None]
    scales = np.linalg.norm(slopes, ord=2, axis=(-2, -1))
    assert scales.min() < 1 < scales.max() or view != 1
    expected = np.full((HEIGHT, WIDTH, 3), BACKDROP)
    halves = np.broadcast_to(np.arange(WIDTH) < WIDTH // 2, below.shape)[below]
    samples = np.where(
        halves[:, None],
        *(
            prefilter.sample(levels, table, uv[below], scales, wrap="repeat")
            for table in ("trilinear", prefilter.SamplingTable.standard(filter, texels))
        ),
    )
    alpha = np.clip(samples[:, 3:], 0, 1)
    expected[below] = np.clip(samples[:, :3] + (1 - alpha) * BACKDROP, 0, 1)
    shown = found[f"{name} {view} {texels}"]
    assert np.all(shown[..., 3] == 1)
    difference = np.abs(shown[..., :3] - scenes.to_srgb(expected)).max(axis=-1)
    # Next to the horizon single precision is far off, and a place may lie in the next subdomain.
    assert np.quantile(difference[below], 0.95) < 2e-3
    assert np.quantile(difference[below], 0.99) < 1e-2
    assert np.median(difference) < 3e-4
    assert difference[~below].max(initial=0) < 1e-5


def test_half_is_trilinear_and_half_is_not(found):
    """The halves of the two tables differ on the right only."""
    few, many = found["wide 1 4"], found["wide 1 8"]
    np.testing.assert_array_equal(few[:, : WIDTH // 2], many[:, : WIDTH // 2])
    assert np.abs(few - many)[:, WIDTH // 2 :].max() > 0.01


def test_window(found):
    assert not found["end polls"]
    assert list(found["started"]) == ["RUNNING_MODAL"]
    on, off = (found[f"{name} screen"].astype(int) for name in ("on", "off"))
    assert np.mean(np.abs(on - off).max(axis=-1) > 8) > 0.5
    assert not found["stale before painting"]
    assert found["stale after painting"]
    assert found["ended"]
    assert found["kept in next file"] == 0


def test_packed_levels_do_not_overlap(addon):
    packed = addon("images.view.atlas").packed
    for size in ((1, 1), (2, 1), (1, 9), (17, 17), (64, 5), (5, 63), (100, 33)):
        levels, (height, width) = [], size
        while True:
            levels.append(np.full((height, width, 1), len(levels) + 1.0, np.float32))
            if height == width == 1:
                break
            height, width = -(-height // 2), -(-width // 2)
        counts = np.bincount(packed(levels).astype(int).ravel(), minlength=len(levels) + 1)
        assert list(counts[1:]) == [level.size for level in levels]


def test_works_without_a_window(addon):
    scenes.image("Paint", scenes.noise(8, 4))
    assert bpy.ops.prefilter.preview_plane(image="Paint", filter="box") == {"FINISHED"}
    plane = addon("images.view.plane").find(bpy.data.images["Paint"])
    assert (plane.filter, plane.size, plane.level_count) == ("box", (4, 8), 4)
    light = scenes.to_linear(scenes.pixels("Paint")[..., :3])
    np.testing.assert_allclose(plane.atlas[:8, :4], light, atol=1e-6)
    np.testing.assert_allclose(plane.atlas[:4, 4:6], scenes.halved(light), atol=1e-6)
    assert [image.name for image in bpy.data.images] == ["Paint"]


def test_large_images_are_made_smaller(addon, monkeypatch):
    planes = addon("images.view.plane")
    monkeypatch.setattr(planes, "LONGEST_SIDE", 10)
    pixels = np.ones((25, 8, 4), np.float32) * (0.1, 0.2, 0.3, 1)
    scenes.image("Paint", pixels, is_float=True)
    bpy.ops.prefilter.preview_plane(image="Paint", filter="box")
    plane = planes.find(bpy.data.images["Paint"])
    assert (plane.size, plane.aspect, plane.level_count) == ((3, 10), 8 / 25, 5)
    expected = np.full((10, 3, 3), (0.1, 0.2, 0.3))
    np.testing.assert_allclose(plane.atlas[:10, :3], expected, rtol=1e-5)


@pytest.mark.parametrize(
    ("name", "message"), [("", "image: no name is given"), ("Pain", "no image named 'Pain'")]
)
def test_failures_are_reports(name, message):
    scenes.image("Paint", scenes.noise(4, 4))
    with pytest.raises(RuntimeError, match=message) as caught:
        bpy.ops.prefilter.preview_plane(image=name)
    assert "Traceback" not in str(caught.value)


def test_poll():
    with pytest.raises(RuntimeError, match="no image in this file"):
        bpy.ops.prefilter.preview_plane()
    assert not bpy.ops.prefilter.end_plane.poll()
