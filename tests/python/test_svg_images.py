# SPDX-License-Identifier: GPL-3.0-or-later

"""Images and drawings within drawings."""

import base64
import io

import numpy as np
import prefilter
import pytest
from drawings import GREEN, RED, SIZE, box, composited_boxes, same, svg, whole
from prefilter.shapes._svg.read.image_files import image_size
from prefilter.workflows.files import png


def data_url(texels, kind="png"):
    return f"data:image/{kind};base64,{base64.b64encode(png.encoded(texels[::-1])).decode()}"


def test_images_at_their_own_size_are_unchanged():
    random = np.random.default_rng(1)
    texels = random.integers(0, 256, (SIZE, SIZE, 4), np.uint8)
    expected = texels / np.float32(255)
    expected[..., :3] *= expected[..., 3:]
    element = f'<image width="100" height="100" href="{data_url(texels)}"/>'
    np.testing.assert_allclose(whole(element), expected, atol=2e-3)
    linear = prefilter.to_linear(texels[..., :3] / np.float32(255)) * expected[..., 3:]
    np.testing.assert_allclose(whole(element, light="linear")[..., :3], linear, atol=2e-3)


@pytest.mark.parametrize(
    ("kind", "options"),
    [
        ("gif", {}),
        ("webp", {"lossless": True}),
        ("webp", {"quality": 90}),
        ("webp", {"exif": b"x"}),
    ],
)
def test_image_formats(kind, options):
    pillow = pytest.importorskip("PIL.Image")
    rows = np.zeros((30, 50, 3), np.uint8)
    rows[:, 20:] = (0, 128, 0)
    file = io.BytesIO()
    try:
        pillow.fromarray(rows).save(file, kind, **options)
    except (KeyError, OSError):
        pytest.skip(f"Pillow writes no {kind}")
    assert image_size(file.getvalue()) == (50, 30)
    address = f"data:image/{kind};base64,{base64.b64encode(file.getvalue()).decode()}"
    actual = whole(f'<image width="50" height="30" href="{address}"/>')
    for x, color in ((10, (0, 0, 0, 1)), (40, (0, 128 / 255, 0, 1)), (60, (0, 0, 0, 0))):
        np.testing.assert_allclose(actual[10, x], color, atol=0.02)


def shown(file, kind="png"):
    """Draws an image file over the whole drawing."""
    address = f"data:image/{kind};base64,{base64.b64encode(file).decode()}"
    rest = 'preserveAspectRatio="none" width="100" height="100"'
    return whole(f'<image {rest} href="{address}"/>')


@pytest.mark.parametrize("orientation", range(1, 9))
def test_exif_orientation(orientation):
    pillow = pytest.importorskip("PIL.Image")
    ops = pytest.importorskip("PIL.ImageOps")
    image = pillow.fromarray(np.random.default_rng(1).integers(0, 256, (4, 2, 3), np.uint8))
    block = pillow.Exif()
    block[0x112] = orientation
    file = io.BytesIO()
    image.save(file, "png", exif=block)
    upright = np.asarray(ops.exif_transpose(pillow.open(file)))
    expected = png.encoded(np.ascontiguousarray(upright[::-1]))
    np.testing.assert_array_equal(shown(file.getvalue()), shown(expected))


def test_image_colors_are_converted():
    texels = np.full((4, 4, 3), (150, 120, 90), np.uint8)
    actual = shown(png.encoded(texels, chunks=[(b"cICP", bytes([12, 13, 0, 1]))]))
    light = prefilter.to_linear(texels[:1, :1] / np.float32(255))[0, 0]
    # Published by SMPTE.
    matrix = [[1.22494, -0.22494, 0.0], [-0.04206, 1.04206, 0.0], [-0.01964, -0.07864, 1.09828]]
    expected = prefilter.to_srgb((np.array(matrix) @ light).astype(np.float32)[None, None])[0, 0]
    middle = tuple(side // 2 for side in actual.shape[:2])
    np.testing.assert_allclose(actual[middle][:3], expected, atol=0.6 / 255)


def test_cmyk_images_are_left_out():
    pillow = pytest.importorskip("PIL.Image")
    file = io.BytesIO()
    pillow.new("CMYK", (4, 4), (10, 20, 30, 40)).save(file, "jpeg")
    address = f"data:image/jpeg;base64,{base64.b64encode(file.getvalue()).decode()}"
    drawing = svg(f'<image width="50" height="30" href="{address}"/>')
    actual, (warning,) = prefilter.rasterize_svg(drawing, SIZE, SIZE)
    assert not actual.any()
    assert "left out, as its colors are CMYK" in warning.effect


def test_image_addresses():
    flat = np.full((2, 4, 4), 255, np.uint8)
    href = data_url(flat)
    for rest, expected in (
        ('x="10" y="20.5" width="40" height="20"', (10, 20.5, 50, 40.5)),
        ('width="40" height="40"', (0, 10, 40, 30)),
        ('width="40" height="40" preserveAspectRatio="xMinYMax"', (0, 20, 40, 40)),
        ('width="40" height="40" preserveAspectRatio="none"', (0, 0, 40, 40)),
        ('width="40" height="40" preserveAspectRatio="xMidYMid slice"', (0, 0, 40, 40)),
        ('width="40"', (0, 0, 40, 20)),
        ("", (0, 0, 4, 2)),
    ):
        actual = whole(f'<image {rest} href="{href}"/>')
        np.testing.assert_allclose(actual, composited_boxes((*expected, (1, 1, 1))), atol=1e-5)
    blocks = np.zeros((1, 2, 4), np.uint8)
    blocks[...] = [[(255, 0, 0, 255), (0, 128, 0, 255)]]
    rest = 'width="40" height="20" image-rendering="pixelated"'
    actual = whole(f'<image {rest} href="{data_url(blocks)}"/>')
    same(actual, composited_boxes((0, 0, 20, 20, RED), (20, 0, 40, 20, GREEN)))


@pytest.mark.parametrize("channels", [1, 3, 4])
def test_both_libraries_decode_the_same(monkeypatch, channels):
    pytest.importorskip("PIL")
    pytest.importorskip("OpenImageIO")
    from prefilter.shapes._svg.read import image_files

    random = np.random.default_rng(2)
    for kind in (np.uint8, np.uint16):
        values = random.integers(0, np.iinfo(kind).max, (5, 7, channels), kind)
        data = png.encoded(values)
        first = image_files.decode_image(data)
        with monkeypatch.context() as patched:
            patched.setattr(image_files, "import_module", missing)
            second = image_files.decode_image(data)
        # Pillow truncates 16 bits; OpenImageIO's values are rounded.
        assert np.abs(first.astype(int) - second).max() <= (kind is np.uint16)
        expected = np.rint(values / (1 if kind is np.uint8 else 257)).astype(np.uint8)[::-1]
        np.testing.assert_array_equal(second[..., 0], expected[..., 0])
        alpha = expected[..., 3] if channels == 4 else 255
        np.testing.assert_array_equal(second[..., 3], np.broadcast_to(alpha, (5, 7)))


def missing(name):
    raise ImportError(name)


@pytest.mark.parametrize("aspect", ["xMinYMin", "xMaxYMax slice", "none"])
def test_nested_drawings_without_a_size(aspect):
    inner = svg(box(0, 0, 20, 20, 'fill="green"'), 'viewBox="0 0 20 20"')
    data = base64.b64encode(inner.encode()).decode()
    body = (
        f'<image x="10" y="30" width="80" height="40" preserveAspectRatio="{aspect}" '
        f'href="data:image/svg+xml;base64,{data}"/>'
    )
    expected = (10, 30, 90, 70) if aspect == "none" else (30, 30, 70, 70)
    same(whole(body), composited_boxes((*expected, GREEN)))


def test_images_are_read_once_and_counted(monkeypatch):
    from prefilter.shapes._svg.model import limits
    from prefilter.shapes._svg.paint import images

    href = data_url(np.full((4, 4, 4), 255, np.uint8))
    body = f'<defs><image id="i" width="9" height="9" href="{href}"/></defs>'
    body += '<use href="#i"/>' * 5
    count = 0

    def counted(data):
        nonlocal count
        count += 1
        return images_read(data)

    images_read = images.decode_image
    monkeypatch.setattr(images, "decode_image", counted)
    same(whole(body), composited_boxes((0, 0, 9, 9, (1, 1, 1))))
    assert count == 1
    monkeypatch.setattr(limits, "MAX_TEXELS", 15)
    with pytest.raises(ValueError, match="source: images of more than 15 pixels"):
        whole(body)


def test_nested_drawings():
    inner = svg(box(-9, -9, 50, 99, 'fill="red"'), 'width="20" height="10" viewBox="0 0 100 50"')
    href = "data:image/svg+xml;base64," + base64.b64encode(inner.encode()).decode()
    actual = whole(f'<image x="10" y="10" width="40" height="40" href="{href}"/>')
    same(actual, composited_boxes((10, 20, 30, 40, RED)))
    plain = "data:image/svg+xml," + "".join(f"%{byte:02x}" for byte in inner.encode())
    same(whole(f'<image x="10" y="10" width="40" height="40" href="{plain}"/>'), actual)


def test_images_outside_the_folder_are_not_read(tmp_path):
    folder = tmp_path / "folder"
    (folder / "deeper").mkdir(parents=True)
    picture = png.encoded(np.full((2, 2, 4), 255, np.uint8))
    for path in (folder / "a b.png", folder / "deeper/c.png", tmp_path / "d.png"):
        path.write_bytes(picture)
    (folder / "link.png").symlink_to(tmp_path / "d.png")
    path = folder / "drawing.svg"
    for href, is_shown in (
        ("a%20b.png", True),
        ("deeper/c.png", True),
        ("../d.png", False),
        (str(tmp_path / "d.png"), False),
        ((tmp_path / "d.png").as_uri(), False),
        ("link.png", False),
        ("none.png", False),
        ("http://localhost/a.png", False),
        ("//localhost/a.png", False),
    ):
        path.write_text(svg(f'<image width="100" height="100" href="{href}"/>'))
        actual, warnings = prefilter.rasterize_svg(path, 4, 4)
        assert (actual[..., 3] == 1).all() == is_shown, href
        assert [warning.name for warning in warnings] == ([] if is_shown else ["<image>"])
    # A nested drawing cannot refer to files either.
    (folder / "inner.svg").write_text(path.read_text().replace("//localhost/a", "a%20b"))
    path.write_text(svg('<image width="100" height="100" href="inner.svg"/>'))
    actual, warnings = prefilter.rasterize_svg(path, 4, 4)
    assert len(warnings) == 1
    assert not actual.any()
