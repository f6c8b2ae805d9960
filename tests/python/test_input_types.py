# SPDX-License-Identifier: GPL-3.0-or-later

"""Images and meshes of all accepted types: bit for bit the results of their canonical types.

Canonical are float32 images with an axis of channels, float64 positions, int64 indices, and UVs of
corners. Each test converts its input to these itself.
"""

from dataclasses import dataclass

import numpy as np
import prefilter
import pytest
from scenes import random_image, random_soup, square
from solids import box

SURFACE = random_soup(3, 20).surface
TENT = prefilter.SamplingTable.standard("tent", 4)
PLACES = np.random.default_rng(5).random((7, 2))
JACOBIANS = np.random.default_rng(6).normal(size=(7, 2, 2))
NUMBERS = np.random.default_rng(7).random(7)


@dataclass(frozen=True)
class AsHad:
    """An image, and the same as float32, (height, width, channels)."""

    name: str
    image: object
    meant: np.ndarray


def images(*channels: int) -> list[AsHad]:
    """Every type, of 19 x 12 texels; without `channels` of two axes."""
    random = np.random.default_rng(len(channels) + sum(channels))
    shape = (12, 19, *channels)
    floats = random_image(sum(channels), 12, 19, sum(channels) or 1).reshape(shape)
    doubles = random.random(shape)
    halves = floats.astype(np.float16)
    bytes_ = random.integers(0, 256, shape, np.uint8)
    words = random.integers(0, 65536, shape, np.uint16)
    mask = random.random(shape) < 0.5
    rows = [
        ("float32", floats, floats),
        ("float64", doubles, doubles.astype(np.float32)),
        ("float16", halves, halves.astype(np.float32)),
        ("big-endian float", floats.astype(">f4"), floats),
        ("uint8", bytes_, np.float32(bytes_) / np.float32(255)),
        ("uint16", words, np.float32(words) / np.float32(65535)),
        ("big-endian uint16", words.astype(">u2"), np.float32(words) / np.float32(65535)),
        ("bool", mask, np.float32(mask)),
        ("list of floats", floats.tolist(), floats),
        ("list of 0 and 1", mask.astype(int).tolist(), np.float32(mask)),
        ("list of arrays of bytes", list(bytes_), np.float32(bytes_) / np.float32(255)),
        ("turned", np.rot90(words, 2), np.rot90(np.float32(words) / np.float32(65535), 2)),
        ("every other", bytes_[::2, ::2], np.float32(bytes_[::2, ::2]) / np.float32(255)),
    ]
    return [
        AsHad(f"{name} {shape}", image, np.reshape(meant, (*meant.shape[:2], -1)))
        for name, image, meant in rows
    ]


IMAGES = [*images(), *images(3), *images(4)]
GRAY = [*images(), *images(1)]
ALPHA = images(4)
named = {"ids": lambda had: had.name}


def check(had: AsHad, found, expected):
    """Asserts the expected result, without the axis of channels if the image has none."""
    flat = np.ndim(had.image) == 2
    assert found.dtype == expected.dtype
    assert np.array_equal(found, expected[..., 0] if flat else expected)
    assert found.flags.c_contiguous
    assert isinstance(had.image, list) or not np.shares_memory(found, had.image)


def check_levels(had: AsHad, found, expected):
    for level, of_meant in zip(found, expected, strict=True):
        check(had, level, of_meant)


@pytest.mark.parametrize("had", IMAGES, **named)
@pytest.mark.parametrize("filter", ["box", "pam-bilinear"])
def test_mipmaps(had, filter):
    found = prefilter.mipmaps(had.image, SURFACE, filter=filter)
    expected = prefilter.mipmaps(had.meant, SURFACE, filter=filter)
    assert found.filter == filter
    stored = np.asarray(had.image).dtype
    if stored.kind != "u":
        check_levels(had, found, expected)
        return
    assert np.array_equal(found[0], had.image)
    for level, of_meant in zip(found, expected, strict=True):
        assert level.dtype == stored.newbyteorder("=")
        # A value in the middle between two may go either way.
        off = level - float(np.iinfo(stored).max) * of_meant.reshape(level.shape)
        assert np.abs(off).max() <= 0.51


@pytest.mark.parametrize("channels", [(), (1,), (2,), (3,), (4,)])
@pytest.mark.parametrize("encoding", ["linear", "srgb"])
def test_levels_of_words_are_the_nearest(channels, encoding):
    words = np.random.default_rng(1).integers(0, 65536, (20, 9, *channels), np.uint16)
    floats = np.float32(words) / np.float32(65535)
    linear = prefilter.to_linear(floats) if encoding == "srgb" else floats
    options = {"filter": "pam-bilinear", "bounds": None}
    found = prefilter.mipmaps(words, SURFACE, encoding=encoding, **options)
    assert np.array_equal(found[0], words)
    for level, of_floats in zip(found, prefilter.mipmaps(linear, SURFACE, **options), strict=True):
        values = prefilter.to_srgb(of_floats) if encoding == "srgb" else of_floats
        assert level.dtype == np.uint16
        assert level.shape == of_floats.shape
        assert np.abs(level - 65535 * np.clip(values, 0, 1)).max() <= 0.5 + 1e-2


def test_words_of_bytes_have_levels_as_the_bytes_have():
    image = np.random.default_rng(2).integers(0, 256, (16, 16, 4), np.uint8)
    for encoding in ("linear", "srgb"):
        of_bytes = prefilter.mipmaps(image, SURFACE, encoding=encoding)
        of_words = prefilter.mipmaps(image.astype(np.uint16) * 257, SURFACE, encoding=encoding)
        for a, b in zip(of_bytes, of_words, strict=True):
            assert np.abs(a - b / 257).max() <= 0.51


@pytest.mark.parametrize("had", IMAGES, **named)
def test_images_of_images(had):
    """Functions that turn an image into an image or into levels."""
    check(had, prefilter.resize(had.image, 7, 5), prefilter.resize(had.meant, 7, 5))
    check(had, prefilter.to_linear(had.image), prefilter.to_linear(had.meant))
    check(had, prefilter.to_srgb(had.image), prefilter.to_srgb(had.meant))
    map_ = [[0.9, 0.3, 1.0], [-0.2, 0.8, 2.0]]
    for exact in (False, True):
        options = {"filter": "tent", "exact": exact}
        found = prefilter.resample(had.image, map_, 8, 6, **options)
        check(had, found, prefilter.resample(had.meant, map_, 8, 6, **options))
    check(
        had,
        prefilter.fill_unused(had.image, SURFACE),
        prefilter.fill_unused(had.meant, SURFACE),
    )
    check_levels(
        had,
        prefilter.sampling_levels(had.image, "tent"),
        prefilter.sampling_levels(had.meant, "tent"),
    )


@pytest.mark.parametrize("had", ALPHA, **named)
def test_alpha(had):
    check(had, prefilter.fill_transparent(had.image), prefilter.fill_transparent(had.meant))


@pytest.mark.parametrize("had", [*GRAY, *ALPHA], **named)
def test_cut_outs(had):
    coarser = prefilter.mipmaps(had.meant, filter="tent")[1:2]
    flat = [level[..., 0] for level in coarser] if np.ndim(had.image) == 2 else coarser
    found = prefilter.keep_coverage([had.image, *flat])
    check_levels(had, found, prefilter.keep_coverage([had.meant, *coarser]))


@pytest.mark.parametrize("had", images(3), **named)
def test_normals(had):
    found = prefilter.normal_mipmaps(had.image, SURFACE)
    check_levels(had, found, prefilter.normal_mipmaps(had.meant, SURFACE))


@pytest.mark.parametrize("had", GRAY, **named)
def test_roughness(had):
    normals = random_image(8, *had.meant.shape[:2], 3)
    found = prefilter.normal_mipmaps(normals, SURFACE, roughness=had.image)
    expected = prefilter.normal_mipmaps(normals, SURFACE, roughness=had.meant)
    check_levels(had, found[1], expected[1])
    for a, b in zip(found[0], expected[0], strict=True):
        assert np.array_equal(a, b)


@pytest.mark.parametrize("had", IMAGES, **named)
def test_measures(had):
    coarser = prefilter.mipmaps(had.meant, SURFACE)[1:]
    values = [0.0, 0.5, 1.5]
    assert np.array_equal(
        prefilter.mipmap_error([had.image, *coarser], had.image, SURFACE, values),
        prefilter.mipmap_error([had.meant, *coarser], had.meant, SURFACE, values),
    )
    assert np.array_equal(
        prefilter.seam_contrast([had.image, *coarser], SURFACE),
        prefilter.seam_contrast([had.meant, *coarser], SURFACE),
    )


@pytest.mark.parametrize("had", IMAGES, **named)
def test_samples(had):
    flat = np.ndim(had.image) == 2

    def same(found, expected):
        # Samples of bytes round differently from samples of the equivalent floats.
        assert found.dtype == expected.dtype
        assert found.shape == (expected.shape[:1] if flat else expected.shape)
        np.testing.assert_allclose(found.reshape(expected.shape), expected, rtol=0, atol=1e-6)

    scales = [1.0] * 7
    coarse = [prefilter.sampling_levels(had.meant, "tent")[1]]
    levels, meant = [had.image], [had.meant]
    if np.asarray(had.image).dtype != np.uint8:
        levels, meant = levels + coarse, meant + coarse
    same(
        prefilter.sample_exact(had.image, PLACES.tolist(), scales, filter="tent"),
        prefilter.sample_exact(had.meant, PLACES, 1.0, filter="tent"),
    )
    same(
        prefilter.sample_ewa(had.image, PLACES, JACOBIANS.tolist()),
        prefilter.sample_ewa(had.meant, PLACES, JACOBIANS),
    )
    same(
        prefilter.sample(levels, TENT, PLACES, scales),
        prefilter.sample(meant, TENT, PLACES, 1.0),
    )
    same(
        prefilter.sample_anisotropic(levels, TENT, PLACES, JACOBIANS),
        prefilter.sample_anisotropic(meant, TENT, PLACES, JACOBIANS),
    )
    same(
        prefilter.sample_stochastic(levels, TENT, PLACES, 1.0, NUMBERS.tolist()),
        prefilter.sample_stochastic(meant, TENT, PLACES, 1.0, NUMBERS),
    )
    picked = prefilter.pick_texels(levels, TENT, PLACES, 1.0, NUMBERS)
    expected = prefilter.pick_texels(meant, TENT, PLACES, 1.0, NUMBERS)
    assert all(np.array_equal(a, b) for a, b in zip(picked, expected, strict=True))


def file_of(write, tmp_path, levels, **options) -> bytes:
    path = tmp_path / "levels"
    write(path, levels, **options)
    return path.read_bytes()


@pytest.mark.parametrize("had", IMAGES, **named)
@pytest.mark.parametrize("write", [prefilter.write_dds, prefilter.write_ktx2])
def test_texture_files(had, write, tmp_path):
    for options in ({"format": "rgba32f"}, {"format": "rgba8"}, {"format": "bc1"}):
        found = file_of(write, tmp_path, [had.image], **options)
        assert found == file_of(write, tmp_path, [had.meant], **options), options


@pytest.mark.parametrize("write", [prefilter.write_dds, prefilter.write_ktx2])
def test_encoded_words_in_texture_files(write, tmp_path):
    """sRGB-encoded 16-bit words are written as decoded floats."""
    words = np.random.default_rng(3).integers(0, 65536, (8, 8, 4), np.uint16)
    floats = prefilter.to_linear(np.float32(words) / np.float32(65535))
    for format in ("rgba8", "rgba16f", "rgba32f"):
        options = {"format": format, "encoding": "srgb"}
        found = file_of(write, tmp_path, [words], **options)
        assert found == file_of(write, tmp_path, [floats], **options)


MESH = random_soup(9, 30)
SHARED = box()  # Vertices of several triangles.
SHARED_UVS = np.random.default_rng(4).random((len(SHARED.positions), 2))


def surfaces_are_same(a: prefilter.Surface, b: prefilter.Surface) -> bool:
    return all(
        np.array_equal(getattr(a, name), getattr(b, name))
        for name in ("positions", "triangles", "uvs", "areas")
    )


@pytest.mark.parametrize(
    "form",
    [
        np.ndarray.tolist,
        tuple,
        lambda array: array.astype(np.float32 if array.dtype.kind == "f" else np.uint32),
        lambda array: array.astype(">f8" if array.dtype.kind == "f" else ">i8"),
        lambda array: array.astype(np.float16 if array.dtype.kind == "f" else np.uint8),
        np.asfortranarray,
    ],
    ids=["lists", "tuples", "float32, uint32", "big-endian", "float16, uint8", "Fortran"],
)
def test_surfaces(form):
    positions = np.float64(np.float16(MESH.positions))
    uvs = np.float64(np.float16(MESH.uvs))
    weights = np.float64(np.float16(np.random.default_rng(5).random(len(positions))))
    found = prefilter.Surface(
        form(positions), form(MESH.triangles), form(uvs), weights=form(weights)
    )
    expected = prefilter.Surface(positions, MESH.triangles.astype(np.int64), uvs, weights=weights)
    assert surfaces_are_same(found, expected)


def test_whole_numbers_are_coordinates():
    positions = [[0, 0, 0], [2, 0, 0], [2, 3, 0], [0, 3, 0]]
    triangles = [[0, 1, 2], [0, 2, 3]]
    uvs = [[0, 0], [1, 0], [1, 1], [0, 1]]
    surface = prefilter.Surface(positions, triangles, uvs, weights=[1, 2])
    assert surface.area == 9
    octree = prefilter.voxelize((SHARED.positions * 8).round().astype(int), SHARED.triangles)
    assert octree.volume > 0


def test_uvs_of_vertices():
    corners = SHARED_UVS[SHARED.triangles]
    expected = prefilter.Surface(SHARED.positions, SHARED.triangles, corners)
    for uvs in (SHARED_UVS, SHARED_UVS.tolist(), SHARED_UVS.astype(">f8")):
        found = prefilter.Surface(SHARED.positions, SHARED.triangles, uvs)
        assert surfaces_are_same(found, expected)
    image = random_image(1, 16, 16, 3)
    found = prefilter.mipmaps(image, prefilter.Surface(*_mesh(), SHARED_UVS))
    for a, b in zip(found, prefilter.mipmaps(image, expected), strict=True):
        assert np.array_equal(a, b)
    charts = prefilter.uv_charts(*_mesh(), [SHARED_UVS, corners])
    assert np.array_equal(charts, prefilter.uv_charts(*_mesh(), [corners, corners]))


def _mesh():
    return SHARED.positions, SHARED.triangles


def test_as_many_triangles_as_vertices():
    """UVs of four vertices, and of the corners of four triangles: the axes tell them apart."""
    positions = [(0.0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
    triangles = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
    of_vertices = np.array([(0.1, 0.2), (0.9, 0.2), (0.5, 0.9), (0.4, 0.4)])
    of_corners = of_vertices[np.array(triangles)]
    assert surfaces_are_same(
        prefilter.Surface(positions, triangles, of_vertices),
        prefilter.Surface(positions, triangles, of_corners),
    )


def test_uvs_of_vertices_that_no_triangle_has_do_not_count():
    mesh = square()
    positions = np.vstack([mesh.positions, [[5.0, 5.0, 5.0]]])
    of_vertices = np.zeros((len(positions), 2))
    of_vertices[mesh.triangles] = mesh.uvs
    of_vertices[-1] = np.nan
    found = prefilter.Surface(positions, mesh.triangles, of_vertices)
    assert np.array_equal(found.uvs, mesh.surface.uvs)


def test_arrays_that_know_how_to_become_some():
    """Tensors and pictures of other libraries support this protocol."""

    class Picture:
        def __init__(self, array):
            self.array = array

        def __array__(self, dtype=None, copy=None):
            return self.array if dtype is None else self.array.astype(dtype)

    for had in (*images(), *images(3)):
        if isinstance(had.image, np.ndarray):
            found = prefilter.resize(Picture(had.image), 5, 5)
            assert np.array_equal(found, prefilter.resize(had.image, 5, 5))


def test_an_image_is_left_as_it_is():
    for had in IMAGES:
        if isinstance(had.image, np.ndarray):
            before = had.image.tobytes()
            for level in prefilter.mipmaps(had.image, filter="tent"):
                level[:] = 0
            assert had.image.tobytes() == before
