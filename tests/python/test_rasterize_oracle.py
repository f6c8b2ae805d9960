# SPDX-License-Identifier: GPL-3.0-or-later

"""Images against quadrature of the true shape: lines, curves of any degree, conics."""

import functools

import numpy as np
import prefilter
import pytest
from outlines import (
    KERNELS,
    Rows,
    Segment,
    blob,
    circle,
    image_of_rows,
    mapped,
    polygon,
    radial_values,
    reversed_contours,
    to_shape,
)

WIDTH, HEIGHT = 9, 8
BOX_BAR, BAR = 1e-6, 1e-5
FIELD = (0.7, 0.4), (8.6, 7.7)


def closed_conic(weight):
    """A conic closed by its chord."""
    corners = np.array([(1.3, 0.4), (8.7, 3.1), (2.2, 7.6)])
    return [Segment(corners, weight), Segment(corners[[2, 0]])]


def star(center, radius, count, step):
    """A polygon through every step-th corner of a regular one."""
    angles = 2 * np.pi * step * np.arange(count) / count + 0.3
    return polygon(np.array(center) + radius * np.stack([np.cos(angles), np.sin(angles)], 1))


SCENES = {
    **{f"degree {degree}": [blob(degree, degree, *FIELD)] for degree in range(1, 9)},
    **{
        f"degree {degree}, small": [blob(degree, 30 + degree, (3.2, 2.9), (4.9, 4.3))]
        for degree in range(1, 9)
    },
    "tiny": [blob(3, 60, (3.62, 2.71), (3.70, 2.77))],
    "conics": [blob(2, 20, *FIELD, weights=[0.3, 1.7, 1.0, 4.0, 0.8])],
    "conics, small": [blob(2, 21, (3.2, 2.9), (4.9, 4.3), weights=[0.1, 6.0, 1.0, 20.0, 0.5])],
    **{f"weight {weight:g}": [closed_conic(weight)] for weight in (1e-6, 1e-2, 30.0, 1e3, 1e6)},
    "circle": [circle((4.3, 4.1), 3.3)],
    "circle on grid lines": [circle((4.0, 4.0), 3.0)],
    "circle inside a pixel": [circle((4.4, 4.6), 0.3)],
    "larger than the image": [blob(3, 5, (-6, -5), (14, 15))],
    "grid lines": [polygon([(2, 1), (7, 1), (7, 6), (2, 6)])],
    "on pixel centers": [polygon([(2.5, 1.5), (6.5, 1.5), (6.5, 6.5), (2.5, 6.5)])],
    "a sliver": [polygon([(0.2, 0.3), (8.8, 7.2), (8.8, 7.201)])],
    "with a hole": [circle((4.4, 4.1), 3.4), *reversed_contours([circle((4.7, 4.3), 1.9)])],
    "several": [
        blob(2, 8, (-2, 4), (4, 11)),
        blob(5, 9, (4.5, 0.5), (12, 5)),
        blob(1, 10, (5, 5.2), (8, 7.9)),
    ],
    "a cusp": [
        [
            Segment(np.array([(1.0, 1.0), (8.0, 7.0), (1.0, 7.0), (8.0, 1.0)])),
            Segment(np.array([(8.0, 1.0), (4.5, -0.5), (1.0, 1.0)])),
        ]
    ],
    "doubled control points": [
        [
            Segment(np.array([(1.2, 1.1), (1.2, 1.1), (8.3, 7.4), (8.3, 7.4)])),
            Segment(np.array([(8.3, 7.4), (7.7, 1.3), (7.7, 1.3), (1.2, 1.1)])),
        ]
    ],
}

# Contours that intersect themselves or each other.
OVERLAPS = {
    "pentagram": [star((4.4, 4.2), 3.5, 5, 2)],
    "two circles": [circle((3.2, 4.0), 2.6), circle((5.7, 4.3), 2.4)],
    "a loop": [
        [
            Segment(np.array([(0.8, 1.0), (12.0, 8.5), (-3.0, 8.3), (8.2, 1.2)])),
            Segment(np.array([(8.2, 1.2), (0.8, 1.0)])),
        ]
    ],
    "the same twice": [blob(3, 3, *FIELD)] * 2,
    "there and back": [blob(3, 3, *FIELD), *reversed_contours([blob(3, 3, *FIELD)])],
    "ring of two alike": [circle((4.3, 4.1), 3.3), circle((4.4, 4.2), 1.7)],
    "curves of many kinds": [
        blob(4, 31, (0.5, 0.6), (6.3, 6.0)),
        blob(2, 32, (2.0, 1.8), (8.6, 7.7), weights=[0.5, 2.0, 1.0, 0.8, 1.5]),
        star((4.0, 4.5), 3.3, 7, 3),
    ],
}


@functools.cache
def rows_of(name):
    return Rows(SCENES.get(name) or OVERLAPS[name], WIDTH, HEIGHT)


def rendered(contours, name, **options):
    image = prefilter.rasterize([to_shape(contours, **options)], WIDTH, HEIGHT, filter=name)
    return image[..., 0]


@pytest.mark.parametrize("scene", SCENES)
def test_images_equal_quadrature(scene):
    for name in KERNELS:
        expected = image_of_rows(rows_of(scene), WIDTH, HEIGHT, name)
        off = np.abs(rendered(SCENES[scene], name) - expected).max()
        assert off < (BOX_BAR if name == "box" else BAR), name


@pytest.mark.parametrize("scene", ["degree 1", "degree 3", "degree 8, small", "conics", "circle"])
def test_radial_filters(scene):
    pixels = np.random.default_rng(1).permutation(WIDTH * HEIGHT)[:24]
    for radius in (2, 3):
        places = np.stack([pixels % WIDTH, pixels // WIDTH], 1)
        expected = radial_values(rows_of(scene), places, float(radius))
        actual = rendered(SCENES[scene], f"radial{radius}").ravel()[pixels]
        assert np.abs(actual - expected).max() < BAR, radius


@pytest.mark.parametrize("fill_rule", ["nonzero", "evenodd"])
@pytest.mark.parametrize("scene", OVERLAPS)
def test_fill_rules_where_contours_overlap(scene, fill_rule):
    rows = rows_of(scene)
    for name in ("box", "mitchell"):
        expected = image_of_rows(rows, WIDTH, HEIGHT, name, rows.inside(fill_rule))
        off = np.abs(rendered(OVERLAPS[scene], name, fill_rule=fill_rule) - expected).max()
        assert off < (BOX_BAR if name == "box" else BAR), name


@pytest.mark.parametrize("scene", ["degree 2", "degree 3, small", "conics", "with a hole"])
def test_gradients_are_exact(scene):
    colors = [(0.2, 0.09, 0.0), (0.9, 0.0, -0.1), (-0.1, 0.06, 0.05)]
    shape = to_shape(SCENES[scene])
    shape.gradient(*np.transpose(colors))
    for name in KERNELS:
        image = prefilter.rasterize([shape], WIDTH, HEIGHT, filter=name)
        for channel, color in enumerate(colors):
            expected = image_of_rows(rows_of(scene), WIDTH, HEIGHT, name, color=color)
            off = np.abs(image[..., channel] - expected).max()
            assert off < (BOX_BAR if name == "box" else BAR), (name, channel)


LAYERS = [
    blob(3, 51, (0.5, 0.5), (6.5, 6.5)),
    circle((5.3, 4.4), 2.8),
    blob(1, 52, (1.5, 2.0), (8.5, 7.5)),
]


@pytest.mark.parametrize(
    "colors",
    [
        [(1.0, 0.2), (0.3, 0.9), (0.6, 0.5)],
        [(0.5, 0.2, 0.1, 0.6), (0.2, 0.3, 0.3, 0.3), (0.1, 0.6, 0.7, 0.8)],
    ],
    ids=["opaque", "alpha"],
)
def test_later_shapes_cover_earlier_ones(colors):
    rows = Rows(LAYERS, WIDTH, HEIGHT)
    shapes = [
        to_shape([contour], color=color) for contour, color in zip(LAYERS, colors, strict=True)
    ]
    for name in ("box", "mitchell"):
        image = prefilter.rasterize(shapes, WIDTH, HEIGHT, filter=name, overlap="cover")
        for channel in range(len(colors[0])):
            value = 0.0
            for winding, color in zip(rows.winding, colors, strict=True):
                alpha = color[3] if len(color) == 4 else 1.0
                value = np.where(winding != 0, color[channel] + (1.0 - alpha) * value, value)
            expected = image_of_rows(rows, WIDTH, HEIGHT, name, value)
            off = np.abs(image[..., channel] - expected).max()
            assert off < (BOX_BAR if name == "box" else BAR), (name, channel)


def test_bytes_are_correctly_rounded():
    """They differ by one only where the value is this close to a half."""
    close = 1e-4
    width = height = 24
    for degree in (1, 2, 3):
        contours = mapped([blob(degree, 9, (0, 0), (1, 1), 9)], [(23, 0, 0.3), (0, 22, 1)])
        true = 255.0 * image_of_rows(Rows(contours, width, height), width, height, "box")
        image = prefilter.rasterize([to_shape(contours)], width, height, dtype="uint8")[..., 0]
        off = np.abs(image - np.rint(true))
        tie = np.abs(true - np.floor(true) - 0.5) < close
        assert off[~tie].max() == 0
        assert off.max() <= 1


@pytest.mark.parametrize("method", ["scanline", "wavelet"])
@pytest.mark.parametrize("channels", [1, 2, 3, 4])
def test_bytes_are_the_floats_rounded(method, channels):
    """Negative lobes, rows of every length, with and without a background."""
    colors = np.random.default_rng(channels).uniform(-0.2, 1.2, (3, channels))
    colors[:, 3:] = np.clip(colors[:, 3:], 0.0, 1.0)
    for width, height in ((1, 3), (15, 9), (37, 5)):
        shapes = [
            to_shape([blob(3, 40 + i, (0, 0), (width, height - 1))], color=color)
            for i, color in enumerate(colors)
        ]
        for name in ("box",) if method == "wavelet" else ("box", "lanczos3", "radial3"):
            for background in (None, colors[0]):
                actual = [
                    prefilter.rasterize(
                        shapes, width, height, filter=name, method=method, background=background,
                        dtype=dtype,
                    )
                    for dtype in (np.float32, np.uint8)
                ]  # fmt: skip
                expected = np.rint(np.float32(255.0) * np.clip(actual[0], 0.0, 1.0))
                assert actual[1].dtype == np.uint8
                np.testing.assert_array_equal(actual[1], expected)


def test_bytes_of_colors_out_of_range():
    square = polygon([(1, 1), (3, 1), (3, 3), (1, 3)])
    for color, expected in ((-0.5, 0), (0.0, 0), (1.0, 255), (7.0, 255), (1e30, 255)):
        image = prefilter.rasterize([to_shape([square], color=[color])], 4, 4, dtype="uint8")
        assert image[1:3, 1:3].min() == image[1:3, 1:3].max() == expected


def test_the_oracle_itself():
    """Sums are areas, and more nodes change nothing."""
    ring = [circle((4.3, 4.1), 3.3), *reversed_contours([circle((4.7, 4.3), 1.9)])]
    coarse, fine = Rows(ring, WIDTH, HEIGHT), Rows(ring, WIDTH, HEIGHT, 60)
    for name in KERNELS:
        image = image_of_rows(coarse, WIDTH, HEIGHT, name)
        assert np.abs(image - image_of_rows(fine, WIDTH, HEIGHT, name)).max() < 1e-8
    area = image_of_rows(coarse, WIDTH, HEIGHT, "box").sum()
    assert area == pytest.approx(np.pi * (3.3**2 - 1.9**2), abs=1e-8)
    both = [circle((3.2, 4.0), 2.0), circle((5.2, 4.0), 2.0)]
    lens = 2 * 4.0 * np.arccos(0.5) - np.sqrt(12.0)
    rows = Rows(both, WIDTH, HEIGHT)
    for rule, area in (("nonzero", 8 * np.pi - lens), ("evenodd", 8 * np.pi - 2 * lens)):
        image = image_of_rows(rows, WIDTH, HEIGHT, "box", rows.inside(rule))
        assert image.sum() == pytest.approx(area, abs=1e-7)
