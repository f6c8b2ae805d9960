# SPDX-License-Identifier: GPL-3.0-or-later

"""Resizing bytes and 16-bit words, against rounded dense sums in float64."""

from itertools import product

import numpy as np
import prefilter
import pytest
from kernels import FILTERS, weights_of_texels

WRAPS = ("clamp", "repeat", "border")
SIZES = [(12, 9, 5, 4), (7, 4, 17, 9), (5, 16, 9, 3), (300, 40, 37, 23), (40, 260, 90, 17)]
NEARLY = 0.5 + 2e-3  # Of a byte: half of one by rounding, and what floats lose.


def bytes_of(width, height, channels, seed=0):
    return np.random.default_rng(seed).integers(0, 256, (height, width, channels), np.uint8)


def decoded(values):
    """The curve of IEC 61966-2-1."""
    return np.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4)


def encoded(values):
    return np.where(
        values <= 0.0031308, values * 12.92, 1.055 * np.maximum(values, 0) ** (1 / 2.4) - 0.055
    )


def expected(image, width, height, filter, wrap, *, srgb, has_alpha):
    """The result in units of bytes, before rounding."""
    light = image / 255
    colors = min(image.shape[2], 3)
    if srgb:
        light[..., :colors] = decoded(light[..., :colors])
    if has_alpha:
        light[..., :-1] *= light[..., -1:]

    def along(size, new_size, mode):
        return np.eye(size) if size == new_size else weights_of_texels(filter, size, new_size, mode)

    made = np.einsum(
        "jy,ix,yxc->jic",
        along(image.shape[0], height, wrap[1]),
        along(image.shape[1], width, wrap[0]),
        light,
        optimize=True,
    )
    if has_alpha:
        made[..., :-1] /= made[..., -1:]
    made = made.clip(0, 1)
    if srgb:
        made[..., :colors] = encoded(made[..., :colors])
    return 255 * made


@pytest.mark.parametrize("filter", FILTERS)
@pytest.mark.parametrize("encoding", ["linear", "srgb"])
@pytest.mark.parametrize("channels", [1, 2, 3, 4])
def test_bytes_are_rounded_sums(filter, encoding, channels):
    for (width, height, new_width, new_height), wrap in product(SIZES, WRAPS):
        image = bytes_of(width, height, channels)
        modes = (wrap, WRAPS[(WRAPS.index(wrap) + 1) % 3])
        exact = expected(
            image, new_width, new_height, filter, modes, srgb=encoding == "srgb", has_alpha=False
        )
        found = prefilter.resize(
            image,
            new_width,
            new_height,
            filter=filter,
            wrap=modes,
            encoding=encoding,
            premultiplied=True,
        )
        assert found.dtype == np.uint8
        # Encoded near 0 a byte is 13 times as much as elsewhere, and so are errors.
        np.testing.assert_allclose(found, exact, rtol=0, atol=NEARLY)


@pytest.mark.parametrize("encoding", ["linear", "srgb"])
@pytest.mark.parametrize("channels", [2, 4])
def test_bytes_count_by_their_alpha(encoding, channels):
    for width, height, new_width, new_height in SIZES:
        image = bytes_of(width, height, channels)
        image[..., -1] |= 64
        image[0, 0, :-1], image[0, 1, :-1] = 0, 255  # No color is out of the range of those seen.
        exact = expected(
            image,
            new_width,
            new_height,
            "lanczos3",
            ("clamp", "clamp"),
            srgb=encoding == "srgb",
            has_alpha=True,
        )
        found = prefilter.resize(image, new_width, new_height, encoding=encoding)
        np.testing.assert_allclose(found[..., -1], exact[..., -1], rtol=0, atol=NEARLY)
        shown = exact[..., -1] > 2.55  # Of others colors are mostly rounding.
        np.testing.assert_allclose(found[shown], exact[shown], rtol=0, atol=NEARLY)


@pytest.mark.parametrize("channels", [2, 4])
def test_transparent_bytes_do_not_bleed_and_get_the_colors_around(channels):
    image = np.full((64, 64, channels), 255, np.uint8)
    image[..., -1] = 0
    image[20:40, 20:40, :-1] = 100
    image[20:40, 20:40, -1] = 255
    for filter in prefilter.RESIZE_FILTERS:
        found = prefilter.resize(image, 17, 23, filter=filter, encoding="srgb")
        assert np.all(found[..., :-1] == 100), filter
        assert found[0, 0, -1] == 0
        nothing = image.copy()
        nothing[..., -1] = 0
        assert not prefilter.resize(nothing, 9, 9, filter=filter, encoding="srgb").any()


@pytest.mark.parametrize("filter", prefilter.RESIZE_FILTERS)
@pytest.mark.parametrize("encoding", ["linear", "srgb"])
def test_every_byte_stays_where_an_image_is_constant(filter, encoding):
    for byte in range(256):
        image = np.full((6, 5, 3), byte, np.uint8)
        found = prefilter.resize(image, 2, 9, filter=filter, encoding=encoding)
        assert np.all(found == byte)
    image = bytes_of(16, 16, 4)
    np.testing.assert_array_equal(prefilter.resize(image, 16, 16, encoding=encoding), image)


def test_bytes_are_decoded_to_the_bits_of_floats():
    every = np.arange(256, dtype=np.uint8)
    for channels in (1, 2, 3, 4):
        image = np.stack([np.roll(every, c) for c in range(channels)], axis=1)[None]
        floats = image.astype(np.float32) / np.float32(255)
        np.testing.assert_array_equal(prefilter.to_linear(image), prefilter.to_linear(floats))
    exact = decoded(np.arange(256) / 255)
    found = prefilter.to_linear(every[None])[0]
    np.testing.assert_allclose(found, exact, rtol=5e-7)


def test_words_are_rounded_sums():
    image = np.random.default_rng(1).integers(0, 65536, (40, 30, 3), np.uint16)
    for encoding in ("linear", "srgb"):
        light = image / 65535
        light = decoded(light) if encoding == "srgb" else light
        weights = [weights_of_texels("tent", size, 11, "clamp") for size in (40, 30)]
        made = np.einsum("jy,ix,yxc->jic", *weights, light, optimize=True)
        exact = 65535 * (encoded(made) if encoding == "srgb" else made)
        found = prefilter.resize(image, 11, 11, filter="tent", encoding=encoding)
        assert found.dtype == np.uint16
        np.testing.assert_allclose(found, exact, rtol=0, atol=0.55)


def test_an_encoding_of_floats_is_linear():
    image = bytes_of(8, 8, 3) / np.float32(255)
    found = prefilter.resize(image, 3, 3, encoding="linear")
    np.testing.assert_array_equal(found, prefilter.resize(image, 3, 3))
    with pytest.raises(ValueError, match="encoding: 'srgb' requires"):
        prefilter.resize(image, 3, 3, encoding="srgb")
    with pytest.raises(ValueError, match="encoding: 'gamma' is not one of linear, srgb"):
        prefilter.resize(image, 3, 3, encoding="gamma")


def test_an_image_of_two_axes_stays_one():
    image = bytes_of(9, 8, 1)[..., 0]
    assert prefilter.resize(image, 4, 3, encoding="linear").shape == (3, 4)


@pytest.mark.parametrize("filter", prefilter.RESIZE_FILTERS)
def test_bytes_do_not_depend_on_threads(filter):
    image = bytes_of(150, 231, 4)
    for width, height in ((71, 67), (190, 33)):
        made = [
            prefilter.resize(image, width, height, filter=filter, encoding="srgb", threads=threads)
            for threads in (1, 2, 7)
        ]
        np.testing.assert_array_equal(made[0], made[1])
        np.testing.assert_array_equal(made[0], made[2])


@pytest.mark.parametrize("wrap", WRAPS)
def test_lines_and_dots_of_bytes(wrap):
    for shape, size in (((1, 1), (33, 20)), ((1, 30000), (1, 1)), ((30000, 1), (2, 3))):
        image = np.full((*shape, 3), 77, np.uint8)
        found = prefilter.resize(image, *size, wrap=wrap, encoding="linear")
        assert found.shape == (size[1], size[0], 3)
        if wrap != "border":
            assert np.all(found == 77)


def test_a_byte_row_that_reads_too_much_at_once_is_made_of_floats():
    image = np.zeros((3000, 1500, 3), np.uint8)
    image[::2] = 200
    found = prefilter.resize(image, 2, 1, wrap="repeat", encoding="linear")
    np.testing.assert_allclose(found, 100, atol=1)


def test_progress_of_bytes_rises_to_one():
    seen = []
    prefilter.resize(bytes_of(300, 200, 4), 170, 130, encoding="srgb", progress=seen.append)
    assert seen == sorted(seen)
    assert seen[-1] == 1.0
    with pytest.raises(prefilter.Cancelled):
        prefilter.resize(bytes_of(9, 9, 3), 4, 4, encoding="srgb", progress=lambda fraction: False)
