# SPDX-License-Identifier: GPL-3.0-or-later

"""The command `rasterize`."""

import bpy
import numpy as np
import OpenImageIO as oiio
import outlines
import pytest
import scenes
from command_line import assert_fails, run

SVG = """\
<svg xmlns="http://www.w3.org/2000/svg" width="8" height="4">
<rect x="0" y="0" width="2" height="4" fill="#ff0000"/>
<rect x="4" y="0" width="4" height="2" fill="#00ff00" fill-opacity="0.5"/>
</svg>
"""


@pytest.fixture
def blend(tmp_path):
    """Saves a .blend file with two squares, a hidden one, and a mesh with a UV map."""
    outlines.square("First")
    second = outlines.square("Second", 1, (1, 1))
    outlines.colored(second, (1, 0, 0))
    outlines.square("Hidden", 50).hide_set(True)
    scenes.quads("Quad", [[(0, 0), (0.5, 0), (0.5, 1), (0, 1)]])
    path = tmp_path / "scene.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return path


@pytest.fixture
def svg(tmp_path):
    """Writes an SVG file."""
    path = tmp_path / "drawing.svg"
    path.write_text(SVG)
    return path


def picture(path):
    """Returns the type and the values of a file, rows from the top, as they are stored."""
    hints = oiio.ImageSpec()
    hints.attribute("oiio:UnassociatedAlpha", 1)
    file = oiio.ImageInput.open(str(path), hints)
    kind = file.spec().format
    values = file.read_image("float")
    file.close()
    return str(kind), values


def test_help():
    result = run("rasterize", "--help")
    assert result.returncode == 0
    for word in ("--width", "--density", "--filter", "mitchell", "--background", "--uv", "#RRGGBB"):
        assert word in result.stdout
    assert "rasterize" in run("--help").stdout


def test_curves_to_png_and_exr(blend, tmp_path):
    options = ("--width", 32, "--height", 32, "--margin", 0)
    result = run("rasterize", blend, "-o", tmp_path / "out.png", *options)
    assert result.returncode == 0, result.stderr
    assert f"Rasterized 'First' to '{tmp_path / 'out.png'}': 32 x 32 pixels" in result.stdout
    assert "100 %" in result.stderr
    kind, values = picture(tmp_path / "out.png")
    assert kind == "uint8"
    expected = np.zeros((32, 32, 4))
    expected[:16, 16:] = (1, 0, 0, 1)
    expected[16:, :16] = 1
    np.testing.assert_array_equal(values[..., 3], expected[..., 3])
    np.testing.assert_array_equal(values * values[..., 3:], expected)
    for pixel_type, wanted in (("half", "half"), ("float", "float"), ("byte", "half")):
        run("rasterize", blend, "-o", tmp_path / "out.exr", *options, "--pixel-type", pixel_type)
        kind, values = picture(tmp_path / "out.exr")
        assert kind == wanted
        np.testing.assert_array_equal(values, expected)
    run(
        "rasterize",
        blend,
        "-o",
        tmp_path / "out.png",
        *options,
        "--pixel-type",
        "half",
        "--color",
        "mask",
    )
    kind, values = picture(tmp_path / "out.png")
    assert kind == "uint16"
    np.testing.assert_array_equal(values[..., 0], expected[..., 3])
    assert {path.name for path in tmp_path.iterdir()} == {"scene.blend", "out.png", "out.exr"}


def test_pixels_per_unit_and_background(blend, tmp_path):
    target = tmp_path / "out.png"
    options = ("--object", "Second", "--density", 20, "--margin", 2, "--background", "#00ff00")
    result = run("rasterize", blend, "-o", target, *options)
    assert result.returncode == 0, result.stderr
    _, values = picture(target)
    assert values.shape == (24, 24, 3)
    np.testing.assert_array_equal(values[12, 12], (1, 0, 0))
    np.testing.assert_array_equal(values[0, 0], (0, 1, 0))


def test_uv_mask(blend, tmp_path):
    target = tmp_path / "mask.png"
    result = run("rasterize", blend, "-o", target, "--uv", "--width", 16, "--height", 8)
    assert result.returncode == 0, result.stderr
    _, values = picture(target)
    assert values.shape == (8, 16, 1)
    np.testing.assert_array_equal(values[..., 0], np.repeat([[1, 0]], 8, axis=1).repeat(8, axis=0))


def change_scene(blend, change):
    bpy.ops.wm.open_mainfile(filepath=str(blend))
    change()
    bpy.ops.wm.save_as_mainfile(filepath=str(blend))


def move_second():
    bpy.data.objects["Second"].location.x += 0.25


def paint_second():
    second = bpy.data.objects["Second"]
    second.data.materials.clear()
    outlines.colored(second, (0, 1, 0))


def move_uvs():
    bpy.data.meshes["Quad"].uv_layers[0].data[1].uv.x = 0.75


def move_hidden():
    bpy.data.objects["Hidden"].location.x += 0.25


@pytest.mark.parametrize(
    ("change", "flags", "decides"),
    [
        (move_second, (), True),
        (paint_second, (), True),
        (move_hidden, (), False),
        (move_hidden, ("--filter", "tent"), True),
        (move_hidden, ("--threads", 1), False),
        (move_uvs, ("--uv",), True),
        (move_second, ("--uv",), False),
    ],
)
def test_up_to_date_files_are_left_alone(blend, tmp_path, change, flags, decides):
    target = tmp_path / "out.png"
    uv = ("--uv",) if "--uv" in flags else ()
    words = ("rasterize", blend, "-o", target, "--side", 40, *uv, "--skip-up-to-date")
    assert run(*words).returncode == 0
    first = target.read_bytes()
    again = run(*words)
    assert "Up to date" in again.stdout, again.stdout + again.stderr
    change_scene(blend, change)
    result = run(*words, *flags)
    assert result.returncode == 0, result.stderr
    assert ("Up to date" not in result.stdout) is decides
    assert (target.read_bytes() != first) is decides
    run(*words[:-1], *flags)
    made = picture(target)[1]
    target.write_bytes(first)
    run(*words, *flags)
    np.testing.assert_array_equal(picture(target)[1], made)


def test_drawings_that_stand_alone_are_left_alone(svg, tmp_path):
    words = ("rasterize", svg, "-o", tmp_path / "out.exr", "--side", 40, "--skip-up-to-date")
    for expected in (False, True):
        assert ("Up to date" in run(*words).stdout) is expected
    svg.write_text(SVG.replace("#ff0000", "#0000ff"))
    for expected in (False, True):
        assert ("Up to date" in run(*words).stdout) is expected
    svg.write_text(SVG.replace("</svg>", "<text>a</text></svg>"))
    for _ in range(2):
        assert "Up to date" not in run(*words).stdout


def test_svg(svg, tmp_path):
    result = run("rasterize", svg, "-o", "out.png", "--density", 2, "--margin", 0, cwd=tmp_path)
    assert result.returncode == 0, result.stderr
    _, values = picture(tmp_path / "out.png")
    assert values.shape == (8, 16, 4)
    np.testing.assert_array_equal(values[4, 2], (1, 0, 0, 1))
    np.testing.assert_allclose(values[1, 12], (0, 1, 0, 0.5), atol=1 / 255)
    assert values[6, 12, 3] == 0


def test_svg_mixes_as_browsers_do_or_as_light_does(tmp_path):
    path = tmp_path / "half.svg"
    path.write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="8" height="4"><rect width="8" height="4" '
        'fill="white"/><rect x="-9" y="-9" width="99" height="99" opacity="0.5"/></svg>'
    )
    for more, gray in (({}, 127), ({"light": "linear"}, 188)):
        before = set(bpy.data.images)
        bpy.ops.prefilter.rasterize_svg(filepath=str(path), width=22, height=14, margin=3, **more)
        (made,) = set(bpy.data.images) - before
        values = np.rint(scenes.pixels(made.name) * 255)
        # Parts outside the page do not show in the margin.
        expected = np.zeros((14, 22))
        expected[3:11, 3:19] = 255
        np.testing.assert_array_equal(values[..., 3], expected)
        np.testing.assert_array_equal(values[3:11, 3:19, :3], np.full((8, 16, 3), gray))


def test_failures_leave_nothing(blend, svg, tmp_path):
    before = {file.name: file.read_bytes() for file in tmp_path.iterdir()}
    target = tmp_path / "out.png"
    rows = [
        (("rasterize", tmp_path / "gone.svg", "-o", target), ["there is no file"], 1),
        (("rasterize", blend, "-o", tmp_path / "gone" / "out.png"), ["there is no folder"], 1),
        (("rasterize", blend, "-o", tmp_path / "out.jpg"), ["OUTPUT: found", ".png, .exr"], 2),
        (("rasterize", "image.png", "-o", target), ["INPUT: found 'image.png'"], 2),
        (("rasterize", blend, "-o", target, "--width", 0), ["--width: found '0'", "1 to 65536"], 2),
        (
            ("rasterize", blend, "-o", target, "--density", 2, "--width", 8),
            ["--density, and --width"],
            2,
        ),
        (("rasterize", svg, "-o", target, "--uv"), ["--object, --uv"], 2),
        (
            ("rasterize", blend, "-o", target, "--object", "Hidden"),
            ["no visible curve or text named 'Hidden'", "'First', 'Second'"],
            1,
        ),
        (
            ("rasterize", blend, "-o", target, "--uv", "--object", "First"),
            ["no visible mesh with a UV map named 'First'", "'Quad'"],
            1,
        ),
        (("rasterize", blend, "-o", target, "--density", 1e6), ["Pixels per Unit", "65536"], 1),
    ]
    for arguments, words, status in rows:
        assert_fails(run(*arguments), *words, status=status)
    assert {file.name: file.read_bytes() for file in tmp_path.iterdir()} == before


def test_damaged_svg(tmp_path):
    path = tmp_path / "bad.svg"
    path.write_text("<svg")
    assert_fails(run("rasterize", path, "-o", tmp_path / "out.png"), "bad.svg")
    assert not (tmp_path / "out.png").exists()
