# SPDX-License-Identifier: GPL-3.0-or-later

"""The command `resample`."""

import math

import numpy as np
import prefilter
import pytest
import scenes
from command_line import assert_fails, run
from picture_files import content, write
from prefilter.workflows.images import placement as placing

CORNERS = (0.1, 0.0, 0.9, 0.2, 1.0, 1.0, 0.0, 0.7)


@pytest.fixture
def sky(tmp_path):
    """Writes a picture of floats and returns its path and its values."""
    pixels = np.random.default_rng(5).random((12, 20, 3)).astype(np.float32)
    write(tmp_path / "sky.exr", pixels, "float")
    return tmp_path / "sky.exr", pixels


@pytest.fixture
def transform(addon):
    """Returns a function that tells where pixels of the result come from."""
    settings = addon("images.choices").ResampleSettings

    def find(size, /, **options):
        return placing.placement(settings(**options), *size)

    return find


def test_help():
    result = run("resample", "--help")
    assert result.returncode == 0
    for word in ("--rotate", "--scale", "--corners", "--rectify", "--method", "lanczos2", "--wrap"):
        assert word in result.stdout


@pytest.mark.parametrize(
    ("arguments", "options"),
    [
        (("--rotate", -30, "--scale", 0.5), {"rotation": -math.pi / 6, "scale": 0.5}),
        (
            ("--scale-x", 2, "--scale-y", -1, "--size", "image", "--offset-x", -3, "--offset-y", 1),
            {"scale_x": 2.0, "scale_y": -1.0, "size": "image", "offset_x": -3.0, "offset_y": 1.0},
        ),
        (("--scale", 3, "--scale-y", 2), {"scale_x": 3.0, "scale_y": 2.0}),
        (("--corners", *CORNERS), {"warp": "corners"}),
        (
            ("--corners", *CORNERS, "--width", 9, "--height", 7),
            {"warp": "corners", "size": "pixels", "width": 9, "height": 7},
        ),
        (("--rectify", *CORNERS, "--size", "image"), {"warp": "rectify", "size": "image"}),
        (
            ("--rectify", *CORNERS, "--aspect", 2.5),
            {"warp": "rectify", "proportions": "given", "aspect": 2.5},
        ),
    ],
)
def test_where_the_image_goes(sky, tmp_path, transform, arguments, options):
    path, pixels = sky
    result = run("resample", path, "-o", tmp_path / "new.exr", *arguments, "--wrap", "clamp")
    assert result.returncode == 0, result.stderr
    if "warp" in options:
        names = ("lower_left", "lower_right", "upper_right", "upper_left")
        options |= dict(zip(names, zip(CORNERS[::2], CORNERS[1::2], strict=True), strict=True))
    if "scale" in options:
        options["scale_x"] = options["scale_y"] = options.pop("scale")
    placed = transform((20, 12), **options)
    found, kind = content(tmp_path / "new.exr")
    assert kind == "float"
    expected = prefilter.resample(
        pixels, placed.transform, placed.width, placed.height, exact=True, wrap="clamp"
    )
    np.testing.assert_allclose(found, expected, atol=1e-6)


def test_corners_in_pixels(sky, tmp_path):
    path, _ = sky
    share = ("--corners", *CORNERS, "--size", "image")
    pixels = ("--pixels", "--corners", *(np.reshape(CORNERS, (4, 2)) * (20, 12)).ravel())
    run("resample", path, "-o", tmp_path / "shares.exr", *share)
    run("resample", path, "-o", tmp_path / "pixels.exr", *pixels, "--size", "image")
    one, other = (content(tmp_path / f"{name}.exr")[0] for name in ("shares", "pixels"))
    np.testing.assert_allclose(one, other, atol=1e-5)
    assert one.shape == (12, 20, 4)


@pytest.mark.parametrize("method", ["8", "6", "4", "trilinear"])
def test_methods(sky, tmp_path, transform, method):
    path, pixels = sky
    result = run(
        *("resample", path, "-o", tmp_path / "new.exr", "--scale", 0.7, "--wrap", "repeat"),
        *("--method", method, "--filter", "tent"),
    )
    assert result.returncode == 0, result.stderr
    placed = transform((20, 12), scale_x=0.7, scale_y=0.7)
    table = "trilinear"
    if method != "trilinear":
        table = prefilter.SamplingTable.standard("tent", int(method))
    expected = prefilter.resample(
        pixels,
        placed.transform,
        placed.width,
        placed.height,
        table=table,
        filter="tent",
        wrap="repeat",
    )
    np.testing.assert_allclose(content(tmp_path / "new.exr")[0], expected, atol=1e-6)


def test_own_table(sky, tmp_path):
    assert run("sampling-table", tmp_path / "tent.json", "--filter", "tent").returncode == 0
    size = ("--scale", 0.6)
    run(
        *("resample", sky[0], "-o", tmp_path / "own.exr", *size),
        *("--method", "table", "--table", tmp_path / "tent.json"),
    )
    run(
        "resample", sky[0], "-o", tmp_path / "known.exr", *size, "--method", "8", "--filter", "tent"
    )
    one, other = (content(tmp_path / f"{name}.exr")[0] for name in ("own", "known"))
    np.testing.assert_array_equal(one, other)


def test_uncovered_bytes_get_an_alpha_of_0(tmp_path):
    pixels = np.ones((16, 16, 3), np.float32) * (0.6, 0.4, 0.2)
    write(tmp_path / "card.png", pixels, "uint8")
    run("resample", tmp_path / "card.png", "-o", tmp_path / "turned.png", "--rotate", 45)
    found, kind = content(tmp_path / "turned.png")
    assert kind == "uint8"
    assert found.shape == (23, 23, 4)
    assert (found[0, 0, 3], found[11, 11, 3]) == (0, 1)
    covered = found[..., 3] > 0
    expected = np.broadcast_to(pixels[0, 0], found[covered][:, :3].shape)
    np.testing.assert_allclose(found[covered][:, :3], expected, atol=1.01 / 255)


def test_data(tmp_path):
    pixels = scenes.noise(8, 12)[..., :3]
    write(tmp_path / "mask.png", pixels, "uint8")
    run(
        *("resample", tmp_path / "mask.png", "-o", tmp_path / "half.png", "--scale", 0.5, "--data"),
        *("--filter", "box", "--size", "fit"),
    )
    found, _ = content(tmp_path / "half.png")
    np.testing.assert_allclose(found, scenes.halved(pixels), atol=0.5 / 255 + 1e-6)


def test_threads_make_no_difference(sky, tmp_path):
    for threads in (1, 3):
        run(
            *("resample", sky[0], "-o", tmp_path / f"{threads}.png", "--rotate", 20),
            *("--threads", threads, "--method", "8"),
        )
    assert (tmp_path / "1.png").read_bytes() == (tmp_path / "3.png").read_bytes()


def test_wrong_arguments(sky, tmp_path):
    path, target = sky[0], tmp_path / "new.png"
    corners, places = ("--corners", *CORNERS), ("--rectify", *CORNERS)
    for arguments, words in (
        ((*corners, *places), ("--corners: not allowed with --rectify",)),
        ((*corners, "--rotate", 5), ("--corners: not allowed with --rotate",)),
        ((*places, "--scale", 5), ("--rectify: not allowed with --scale",)),
        (("--corners", 1, 2, 3), ("--corners", "8 arguments")),
        (("--corners", *CORNERS[:7], "nan"), ("Upper Left", "found 0 nan")),
        (("--aspect", 2), ("--aspect: not allowed without --rectify",)),
        (
            (*places, "--aspect", 2, "--proportions", "sides"),
            ("--aspect: not allowed with --proportions sides",),
        ),
        ((*places, "--proportions", "given"), ("--proportions given: give --aspect",)),
        (("--pixels",), ("--pixels: give --corners or --rectify",)),
        (("--width", 5), ("both --width and --height",)),
        (("--size", "pixels"), ("both --width and --height",)),
        (("--size", "fit", "--width", 5, "--height", 5), ("--width: not allowed with --size fit",)),
        (("--scale-x", "1e9"), ("--scale-x", "allowed: -1000 to 1000")),
        (("--method", "table"), ("--method table: give --table",)),
        (("--table", "x.json"), ("--table: not allowed without --method table",)),
        (("--max-probes", 4), ("--max-probes: not allowed without --filter gaussian",)),
    ):
        assert_fails(run("resample", path, "-o", target, *arguments), *words, status=2)
    assert_fails(run("resample", path, "-o", tmp_path / "new.jpg"), "OUTPUT", "new.jpg", status=2)
    assert not target.exists()


def test_failures(sky, tmp_path):
    path, target = sky[0], tmp_path / "new.png"
    for arguments, words in (
        ((tmp_path / "none.png", target), ("INPUT", "none.png")),
        ((path, tmp_path / "none" / "new.png"), ("there is no folder",)),
        (
            (path, target, "--corners", 0, 0, 1, 1, 1, 0, 0, 1),
            ("Corners: found", "convex quadrilateral"),
        ),
        ((path, target, "--method", "table", "--table", "no.json"), ("no.json",)),
    ):
        assert_fails(run("resample", *arguments), *words)
    assert not target.exists()
