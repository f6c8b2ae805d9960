# SPDX-License-Identifier: GPL-3.0-or-later

"""The command `rasterize`: images of SVG files and UV maps."""

import numpy as np
import prefilter
import pytest
from box_fonts import make_font
from command_files import fails, run, write_quad

oiio = pytest.importorskip("OpenImageIO", reason="scripts/decoders.txt is not installed")

SVG = """<svg xmlns="http://www.w3.org/2000/svg" width="8" height="4">
<circle cx="4" cy="2" r="1.7" fill="#ff8000"/></svg>"""


@pytest.fixture
def logo(tmp_path):
    path = tmp_path / "logo.svg"
    path.write_text(SVG)
    return path


def pixels(path, kind):
    config = oiio.ImageSpec()
    config.attribute("oiio:UnassociatedAlpha", 1)
    reader = oiio.ImageInput.open(str(path), config)
    spec = reader.spec()
    values = np.asarray(reader.read_image(kind)).reshape(spec.height, spec.width, -1)
    reader.close()
    return np.flipud(values)


def test_svg_to_floats_equals_rasterize_svg(logo, tmp_path, capsys):
    out = tmp_path / "out.exr"
    flags = ("--width", "64", "--height", "32", "--margin", "0", "--pixel-type", "float")
    assert run("rasterize", logo, "-o", out, *flags, "--filter", "tent") == 0
    assert "Rasterized 'logo' to" in capsys.readouterr().out
    encoded, _ = prefilter.rasterize_svg(logo, 64, 32, filter="tent")
    alpha = encoded[..., 3:]
    straight = np.divide(encoded, alpha, out=np.zeros_like(encoded), where=alpha > 0)[..., :3]
    expected = np.concatenate([prefilter.to_linear(straight) * alpha, alpha], 2)
    np.testing.assert_allclose(pixels(out, "float"), expected, atol=1e-6)
    assert run("rasterize", logo, "-o", out, *flags, "--filter", "tent", "--light", "linear") == 0
    expected, _ = prefilter.rasterize_svg(logo, 64, 32, filter="tent", light="linear")
    np.testing.assert_allclose(pixels(out, "float"), np.clip(expected, 0, None), atol=1e-6)


def test_svg_blends_with_a_background_and_is_clipped_at_its_page(tmp_path):
    path, out = tmp_path / "half.svg", tmp_path / "out.png"
    path.write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="8" height="4">'
        '<rect x="-9" y="-9" width="99" height="99" opacity="0.5"/></svg>'
    )
    flags = ("--density", "2", "--margin", "3", "--background", "#ffffff")
    for more, gray in (((), 127), (("--light", "linear"), 188)):
        assert run("rasterize", path, "-o", out, *flags, *more) == 0
        expected = np.full((14, 22, 3), 255)
        expected[3:11, 3:19] = gray
        np.testing.assert_array_equal(pixels(out, "uint8"), expected)


def test_svg_to_bytes(logo, tmp_path):
    out = tmp_path / "out.png"
    assert run("rasterize", logo, "-o", out, "--side", "80", "--margin", "0") == 0
    actual = pixels(out, "uint8")
    assert actual.shape == (40, 80, 4)
    assert actual[20, 40].tolist() == [255, 128, 0, 255]
    assert actual[0, 0].tolist() == [255, 128, 0, 0]
    more = ("--background", "#ffffff", "--density", "2", "--margin", "1")
    assert run("rasterize", logo, "-o", out, *more) == 0
    actual = pixels(out, "uint8")
    assert actual.shape == (10, 18, 3)
    assert actual[0, 0].tolist() == [255, 255, 255]


def test_fonts_of_a_folder(tmp_path):
    make_font(tmp_path / "boxes.ttf")
    drawing = tmp_path / "text.svg"
    drawing.write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="40" height="20">'
        '<text x="5" y="15" font-family="Boxes" font-size="20">A</text></svg>'
    )
    out = tmp_path / "out.png"
    more = ("--fonts", tmp_path, "--density", "1", "--margin", "0")
    assert run("rasterize", drawing, "-o", out, *more) == 0
    covered = np.zeros((20, 40))
    covered[5:15, 5:17] = 255
    np.testing.assert_array_equal(pixels(out, "uint8")[..., 3], covered)


def test_mask_of_a_uv_map(tmp_path):
    pytest.importorskip("trimesh", reason="scripts/decoders.txt is not installed")
    path = write_quad(tmp_path / "quad.obj")
    path.write_text(path.read_text().replace("vt 1 0\nvt 1 1", "vt 0.5 0\nvt 0.5 1"))
    out = tmp_path / "mask.png"
    assert run("rasterize", path, "-o", out, "--uv", "--side", "8") == 0
    actual = pixels(out, "uint8")
    assert actual.shape == (8, 8, 1)
    assert (actual[:, :4] == 255).all()
    assert (actual[:, 4:] == 0).all()


def test_invalid_arguments_are_refused(logo, tmp_path, capsys):
    out = tmp_path / "out.png"
    for words, arguments in {
        "INPUT: found 'a.blend'": ("a.blend", out),
        "OUTPUT: found 'a.jpg'": (logo, "a.jpg"),
        "an SVG file has neither objects nor a UV map": (logo, out, "--uv"),
        "--uv: needed for meshes": ("a.obj", out),
        "only one of these": (logo, out, "--side", "8", "--density", "2"),
        "--filter: found 'soft'": (logo, out, "--filter", "soft"),
    }.items():
        assert words in fails(capsys, 2, "rasterize", *arguments)
    none = tmp_path / "none.svg"
    assert "INPUT: there is no file" in fails(capsys, 1, "rasterize", none, "-o", out)
    told = fails(capsys, 1, "rasterize", logo, "-o", out, "--side", "8", "--margin", "9")
    assert "leaves no room" in told
    bare = write_quad(tmp_path / "bare.obj", has_uvs=False)
    assert "has no UV map" in fails(capsys, 1, "rasterize", bare, "-o", out, "--uv")
    assert not out.exists()
