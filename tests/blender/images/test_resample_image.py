# SPDX-License-Identifier: GPL-3.0-or-later

"""The operator `prefilter.resample_image`."""

import math

import bpy
import numpy as np
import prefilter
import pytest
import scenes
from prefilter.workflows.images import placement as placing
from prefilter.workflows.images import resampling as resamplings

CORNERS = {
    "lower_left": (0.1, 0.0),
    "lower_right": (0.9, 0.2),
    "upper_right": (1.0, 1.0),
    "upper_left": (0.0, 0.7),
}


def resample(**options):
    return bpy.ops.prefilter.resample_image(**options)


def transform(addon, size, /, **options):
    """Returns where pixels of the result come from, with numbers as Blender keeps them."""
    single = {
        name: np.float32(value).astype(float).tolist()
        if isinstance(value, float | tuple)
        else value
        for name, value in options.items()
    }
    settings = addon("images.choices").ResampleSettings(**single)
    return placing.placement(settings, *size).transform


@pytest.mark.parametrize("method", ["exact", "8", "6", "4", "trilinear"])
def test_every_method_is_that_of_the_package(addon, method):
    pixels = 2 * scenes.noise(24, 40)
    pixels[..., 3] = 1
    scenes.image("Sky", pixels, is_float=True)
    options = {"warp": "corners", "size": "pixels", "width": 30, "height": 20, **CORNERS}
    done = resample(image="Sky", method=method, filter="mitchell", wrap="repeat", **options)
    assert done == {"FINISHED"}
    table = {"exact": None, "trilinear": "trilinear"}.get(method)
    if method.isdigit():
        table = prefilter.SamplingTable.standard("mitchell", int(method))
    expected = prefilter.resample(
        pixels[..., :3],
        transform(addon, (40, 24), **options),
        30,
        20,
        table=table,
        filter="mitchell",
        exact=method == "exact",
        wrap="repeat",
    )
    np.testing.assert_allclose(scenes.pixels("Sky.pinned")[..., :3], expected, atol=1e-6)


@pytest.mark.parametrize("filter", ["gaussian", "tent"])
@pytest.mark.parametrize("method", ["exact", "4"])
def test_probes_are_for_gaussian(addon, filter, method):
    pixels = scenes.noise(24, 40)
    scenes.image("Sky", pixels, is_float=True)
    options = {"scale_x": 0.2, "rotation": 0.5}
    resample(image="Sky", method=method, filter=filter, max_probes=9, **options)
    expected = prefilter.resample(
        pixels,
        transform(addon, (40, 24), **options),
        *bpy.data.images["Sky.transformed"].size,
        table=None if method == "exact" else prefilter.SamplingTable.standard(filter, 4),
        filter=filter,
        exact=method == "exact",
        max_probes=9 if filter == "gaussian" else 1,
        wrap="border",
        premultiplied=True,
    )
    np.testing.assert_allclose(
        scenes.pixels("Sky.transformed")[..., :3], expected[..., :3], atol=1e-6
    )


@pytest.mark.parametrize("method", ["exact", "8", "trilinear"])
def test_half_a_turn_keeps_bytes(method):
    pixels = scenes.noise(8, 12, alpha=True)
    scenes.image("Paint", pixels)
    resample(image="Paint", rotation=math.pi, method=method)
    found = scenes.pixels("Paint.transformed")
    before = scenes.pixels("Paint")
    visible = before[..., 3] > 0
    # 8 texels of 16 that Lanczos 2 has.
    tolerance = 0.02 if method == "8" else 1e-5
    np.testing.assert_allclose(found[..., 3], before[::-1, ::-1, 3], atol=tolerance)
    if method != "8":
        np.testing.assert_allclose(
            found[visible[::-1, ::-1]], before[::-1, ::-1][visible[::-1, ::-1]], atol=1.01 / 255
        )


def test_uncovered_pixels_are_transparent():
    """An opaque image gets an alpha, and its colors do not darken toward the edges."""
    pixels = np.ones((16, 16, 4), np.float32) * (0.6, 0.4, 0.2, 1)
    scenes.image("Card", pixels)
    resample(image="Card", rotation=math.radians(30), filter="tent")
    made = bpy.data.images["Card.transformed"]
    extent = math.ceil(16 * (math.cos(math.pi / 6) + math.sin(math.pi / 6)))
    assert tuple(made.size) == (extent, extent)
    found = scenes.pixels("Card.transformed")
    assert (found[0, 0, 3], found[extent // 2, extent // 2, 3]) == (0, 1)
    assert 0.2 < np.mean(found[..., 3]) * extent**2 / 16**2 < 1.05
    covered = found[..., 3] > 0
    expected = np.broadcast_to(scenes.pixels("Card")[0, 0, :3], found[covered][:, :3].shape)
    np.testing.assert_allclose(found[covered][:, :3], expected, atol=1.01 / 255)


@pytest.mark.parametrize(
    ("colorspace", "alpha_mode"), [("Non-Color", "STRAIGHT"), ("sRGB", "CHANNEL_PACKED")]
)
def test_data_gets_no_alpha(colorspace, alpha_mode):
    scenes.image("Mask", scenes.noise(8, 8), colorspace=colorspace, alpha_mode=alpha_mode)
    resample(image="Mask", rotation=math.radians(45))
    found = scenes.pixels("Mask.transformed")
    assert np.all(found[..., 3] == 1)
    assert np.all(found[0, 0, :3] == 0)
    made = bpy.data.images["Mask.transformed"]
    assert (made.colorspace_settings.name, made.alpha_mode) == (colorspace, alpha_mode)


def test_rectifying_undoes_pinning():
    """A smooth picture goes to a quadrilateral and back."""
    v, u = np.mgrid[:64, :64] / 63
    pixels = np.ones((64, 64, 4), np.float32)
    pixels[..., :3] = np.stack([0.2 + 0.6 * u, 0.8 - 0.6 * v, 0.5 + 0.3 * np.sin(6 * u * v)], -1)
    scenes.image("Smooth", pixels, is_float=True)
    resample(
        image="Smooth",
        warp="corners",
        size="pixels",
        width=256,
        height=256,
        wrap="clamp",
        **CORNERS,
    )
    resample(image="Smooth.pinned", warp="rectify", size="pixels", width=64, height=64, **CORNERS)
    found = scenes.pixels("Smooth.pinned.rectified")
    np.testing.assert_allclose(found[4:-4, 4:-4], pixels[4:-4, 4:-4], atol=0.01)


def test_another_press_straightens_the_source_anew():
    with scenes.image_editor(scenes.image("Facade", scenes.noise(24, 40))) as editor:
        resample(warp="rectify", filter="tent", **CORNERS)
        assert editor.image.name == "Facade.rectified"
        first = scenes.pixels("Facade.rectified")
        resample(warp="rectify", filter="tent", **CORNERS)
        assert editor.image.name == "Facade.rectified"
        np.testing.assert_array_equal(scenes.pixels("Facade.rectified"), first)
        resample(warp="rectify", filter="box", **CORNERS)
        assert np.any(scenes.pixels("Facade.rectified") != first)
        assert [image.name for image in bpy.data.images] == ["Facade", "Facade.rectified"]
        # Another warp starts from the result, and so does a named image.
        resample(warp="affine", rotation=0.5)
        assert editor.image.name == "Facade.rectified.transformed"
        resample(warp="rectify", image="Facade.rectified", **CORNERS)
        assert "Facade.rectified.rectified" in bpy.data.images


def test_a_result_without_its_source_is_an_image():
    with scenes.image_editor(scenes.image("Facade", scenes.noise(24, 40))) as editor:
        resample(warp="rectify", **CORNERS)
        bpy.data.images.remove(bpy.data.images["Facade"])
        resample(warp="rectify", **CORNERS)
        assert editor.image.name == "Facade.rectified.rectified"


def test_own_table(addon, tmp_path):
    table = prefilter.SamplingTable.build("tent", texels=3, subdomains=(2, 2, 1))
    table.save(tmp_path / "own.json")
    pixels = scenes.noise(16, 16)
    scenes.image("Sky", pixels, is_float=True)
    resample(image="Sky", scale_x=0.6, method="table", table=str(tmp_path / "own.json"))
    made = bpy.data.images["Sky.transformed"]
    expected = prefilter.resample(
        pixels,
        transform(addon, (16, 16), scale_x=0.6),
        *made.size,
        table=table,
        wrap="border",
        premultiplied=True,
    )
    np.testing.assert_allclose(scenes.pixels(made.name), expected, atol=1e-6)


def test_in_place_and_undo():
    scenes.textured_quad(scenes.image("Paint", scenes.noise(8, 8)))
    bpy.ops.ed.undo_push(message="before")
    resample(image="Paint", scale_x=2.0, use_in_place=True)
    node = next(node for node in bpy.data.materials[0].node_tree.nodes if node.type == "TEX_IMAGE")
    assert node.image.name == "Paint.transformed"
    bpy.ops.ed.undo_push(message="after")
    bpy.ops.ed.undo()
    assert "Paint.transformed" not in bpy.data.images


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"image": "Pain"}, "no image named 'Pain'"),
        ({"image": ""}, "image: no name is given"),
        ({"warp": "corners", "lower_left": (2.0, 2.0)}, "Corners: found .*convex quadrilateral"),
        ({"scale_x": 1000.0, "scale_y": 1000.0}, "."),
        ({"method": "table"}, "Table: no file is named"),
        ({"method": "table", "table": "/none.json"}, "none.json"),
    ],
)
def test_failures_are_reports(options, message):
    scenes.image("Paint", scenes.noise(2000, 4))
    with pytest.raises(RuntimeError, match=message) as caught:
        resample(**{"image": "Paint", **options})
    assert "Traceback" not in str(caught.value)
    assert [image.name for image in bpy.data.images] == ["Paint"]


def test_poll():
    with pytest.raises(RuntimeError, match="no image in this file"):
        resample()


def test_udim_is_refused():
    image = bpy.data.images.new("Tiles", 8, 8, tiled=True)
    with pytest.raises(RuntimeError, match="UDIM"):
        resample(image=image.name)


def test_cancelled_leaves_nothing(addon):
    picture = addon("images.new_picture").read(scenes.image("Paint", scenes.noise(64, 64)))
    settings = addon("images.choices").ResampleSettings(scale_x=4.0)
    work = resamplings.Resampling(picture, settings)
    with pytest.raises(prefilter.Cancelled):
        work.compute(lambda fraction: fraction < 0.3)
    work.discard()
    assert [image.name for image in bpy.data.images] == ["Paint"]


def test_filters_are_those_that_have_tables(addon):
    assert set(addon("images.choices").TABLE_FILTERS) == set(prefilter.SAMPLING_FILTERS)
