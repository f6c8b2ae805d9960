# SPDX-License-Identifier: GPL-3.0-or-later

"""The error curves, their figure, and the operator that makes both."""

from itertools import pairwise

import bpy
import numpy as np
import prefilter
import pytest
import scenes


@pytest.fixture
def stretched():
    """Makes an object whose left half has 16 times the area that the UVs give it."""
    image = scenes.image("Paint", scenes.noise(32, 32))
    halves = [
        ((0.0, 0.0), (0.5, 0.0), (0.5, 1.0), (0.0, 1.0)),
        ((0.5, 0.0), (1.0, 0.0), (1.0, 1.0), (0.5, 1.0)),
    ]
    obj = scenes.quads("Cloth", halves, sizes=[4.0, 1.0])
    obj.data.materials.append(scenes.material("Cloth", image))
    return image


def plot(**options):
    return bpy.ops.prefilter.plot_error(image="Paint", **options)


def rows(text):
    """Returns the table's head and its rows as lists."""
    head, *body = [line.split(",") for line in text.as_string().strip().splitlines()]
    return head, body


def sampled_error(levels, image, mip_value, count=40_000):
    """Estimates the error by looking up points that are spread evenly over `stretched`."""
    random = np.random.default_rng(7)
    left = random.random(count) < 16 / 17
    u = random.random(count) / 2 + np.where(left, 0.0, 0.5)
    v = random.random(count)
    low = min(int(mip_value), len(levels) - 2)
    share = mip_value - low
    found = (1 - share) * scenes.bilinear(levels[low], u, v)
    found += share * scenes.bilinear(levels[low + 1], u, v)
    return np.sqrt(np.mean((found - scenes.bilinear(image, u, v)) ** 2))


def test_table_agrees_with_random_lookups(stretched):
    bpy.context.scene.prefilter_bake.wrap = "clamp"
    assert plot(filters={"box", "pam-bilinear"}) == {"FINISHED"}
    head, body = rows(bpy.data.texts["Paint.error.csv"])
    assert head == ["mip value", "pam-bilinear", "box"]
    assert [row[0] for row in body[:2]] == ["0", "0.125"]
    assert body[-2][0] == "5"
    light = scenes.to_linear(scenes.noise(32, 32)[..., :3])
    box = [light]
    while len(box[-1]) > 1:
        box.append(scenes.halved(box[-1]))
    for row in body[4:-1:6]:
        expected = sampled_error(box, light, float(row[0]))
        assert float(row[2]) == pytest.approx(expected, rel=0.02)
    errors = np.array(body[:-1], float)
    assert np.all(errors[8:, 1] < errors[8:, 2])


def test_error_over_all_mip_values_is_the_integral(stretched):
    """Simpson's rule on eighths agrees with a fine sum of the library's errors in between."""
    bpy.context.scene.prefilter_bake.wrap = "clamp"
    plot(filters={"box"})
    _, body = rows(bpy.data.texts["Paint.error.csv"])
    assert body[-1][0] == "all"
    light = scenes.to_linear(scenes.noise(32, 32)[..., :3]).astype(np.float32)
    corners = np.array([(0, 0, 0), (4, 0, 0), (4, 4, 0), (0, 4, 0)], float)
    more = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], float)
    square = np.array(scenes.UNIT_SQUARE)
    triangles = np.array([(0, 1, 2), (0, 2, 3)])
    surfaces = [
        prefilter.Surface(points, triangles, (square * (0.5, 1) + (shift, 0))[triangles])
        for points, shift in ((corners, 0.0), (more, 0.5))
    ]
    levels = prefilter.mipmaps(light, surfaces, filter="box")
    middles = (np.arange(5000) + 0.5) / 1000
    errors = prefilter.mipmap_error(levels, light, surfaces, middles)
    assert float(body[-1][1]) == pytest.approx(np.sqrt(np.mean(errors**2)), rel=1e-6)


def test_the_curve_follows_the_data(stretched, addon):
    plot(filters={"box", "pam-bilinear", "lanczos3"})
    figure = addon("textures.view.figure")
    picture = scenes.pixels("Paint.error")
    assert picture.shape == (figure.HEIGHT, figure.WIDTH, 4)
    head, body = rows(bpy.data.texts["Paint.error.csv"])
    values = np.array(body[:-1], float)
    axes = figure.Axes(5.0, figure.axes_of(curves_of(addon, head, values)).top_error)
    color = np.array(figure.COLORS["lanczos3"])  # The last that is drawn, so nothing covers it.
    assert head[-1] == "lanczos3"
    matches = np.abs(picture[..., :3] - color).max(axis=-1) < 0.02
    for row in values[1:]:
        x, y = axes.position(row[0], row[-1])
        assert matches[int(y), int(x)], row
        assert not matches[int(y) + 12, int(x) - 2], row
    for left, right in pairwise(values):
        x, y = (axes.position(left[0], left[-1]) + axes.position(right[0], right[-1])) / 2
        assert matches[int(y), int(x)]


def curves_of(addon, head, values):
    return addon("textures.view.errors").ErrorCurves(
        "Paint", tuple(head[1:]), values[:, 0], values[:, 1:].T.copy()
    )


def test_dashes_are_at_the_error_over_all(stretched, addon):
    plot(filters={"box"})
    figure = addon("textures.view.figure")
    head, body = rows(bpy.data.texts["Paint.error.csv"])
    curves = curves_of(addon, head, np.array(body[:-1], float))
    axes = figure.axes_of(curves)
    overall = float(body[-1][1])
    (left, y), (right, _) = axes.position([0.0, 5.0], [overall, overall])
    line = scenes.pixels("Paint.error")[int(y) - 1 : int(y) + 2, int(left) : int(right), :3]
    distance = np.abs(line - np.array(figure.COLORS["box"])).max(axis=-1).min(axis=0)
    drawn = distance < 0.35
    assert 0.3 < drawn.mean() < 0.7
    assert 20 < np.count_nonzero(np.diff(drawn.astype(int)) == 1) < 80


@pytest.mark.parametrize(
    ("top", "step", "end"),
    [(1.0, 0.2, 1.0), (0.37, 0.1, 0.4), (0.043, 0.01, 0.05), (12.0, 5.0, 15.0), (0.0, 1.0, 1.0)],
)
def test_axis_of_errors_is_round(addon, top, step, end):
    figure = addon("textures.view.figure")
    values = np.array([0.0, 1.0])
    curves = addon("textures.view.errors").ErrorCurves(
        "x", ("box",), values, np.array([[0.0, top]])
    )
    assert figure._round_step(top) == pytest.approx(step)
    assert figure.axes_of(curves).top_error == pytest.approx(end)


@pytest.mark.parametrize("size", [(1, 1), (1, 8), (2, 2)])
def test_tiny_images_and_no_error(size, addon):
    flat = np.full((*size, 4), 0.5, np.float32)
    flat[..., 3] = 1
    scenes.textured_quad(scenes.image("Paint", flat, is_float=True))
    assert plot(filters={"box"}) == {"FINISHED"}
    _, body = rows(bpy.data.texts["Paint.error.csv"])
    assert np.abs(np.array([row[1] for row in body], float)).max() < 1e-6
    assert np.isfinite(scenes.pixels("Paint.error")).all()


def test_next_plot_takes_the_place_of_the_last(stretched):
    plot(filters={"box"})
    bpy.data.images["Paint.error"]["mark"] = 1
    plot(filters={"tent"})
    assert sorted(image.name for image in bpy.data.images) == ["Paint", "Paint.error"]
    assert "mark" not in bpy.data.images["Paint.error"]
    assert [text.name for text in bpy.data.texts] == ["Paint.error.csv"]
    assert rows(bpy.data.texts["Paint.error.csv"])[0] == ["mip value", "tent"]
    assert bpy.data.images["Paint.error"].packed_file is not None


def test_image_of_the_users_keeps_its_pixels(stretched):
    scenes.image("Paint.error", scenes.noise(2, 2, seed=5))
    mine = bpy.data.texts.new("Paint.error.csv")
    mine.write("mine")
    plot(filters={"box"})
    assert scenes.pixels("Paint.error").shape == (2, 2, 4)
    assert bpy.data.texts["Paint.error.csv"].as_string().strip() == "mine"
    assert "Paint.error.001" in bpy.data.images
    assert "Paint.error.csv.001" in bpy.data.texts


def test_no_filter_is_refused(stretched):
    with pytest.raises(RuntimeError, match="Filters: choose at least one"):
        plot(filters=set())
    assert [image.name for image in bpy.data.images] == ["Paint"]


def test_report_has_the_values(stretched, capfd):
    plot(filters={"box"})
    _, body = rows(bpy.data.texts["Paint.error.csv"])
    said = f"Error of 'Paint' over all mip values: Box {float(body[-1][1]):.4g}"
    assert said in capfd.readouterr().out


def test_canceling_stops(stretched, addon):
    settings = addon("textures.choices").Settings()
    bake_inputs = addon("textures.bake_inputs")
    request = bake_inputs.Request(stretched, list(bpy.data.objects), settings, scenes.depsgraph())
    source = bake_inputs.read(request).source
    seen = []

    def progress(fraction):
        seen.append(fraction)
        return fraction < 0.5

    with pytest.raises(prefilter.Cancelled):
        addon("textures.view.errors").measure(source, ["box", "tent", "pam-box"], progress)
    assert seen == sorted(seen)
    assert max(seen) < 0.9
