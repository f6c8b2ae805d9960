"""Bad input gets a message that names the argument, what was found and what is allowed."""

import numpy as np
import prefilter
import pytest
from scenes import random_image, random_soup, soup, square

IMAGE = random_image(0, 16, 16, 3)
MESH = square()


def changed(array, index, value):
    copy = np.array(array)
    copy[index] = value
    return copy


@pytest.mark.parametrize(
    ("positions", "triangles", "uvs", "message"),
    [
        (np.zeros((0, 3)), np.zeros((0, 3), int), np.zeros((0, 3, 2)), "triangles: .*no faces"),
        (MESH.positions[:, :2], MESH.triangles, MESH.uvs, r"positions: shape \(6, 2\)"),
        (MESH.positions, MESH.triangles[:, :2], MESH.uvs, r"triangles: shape \(2, 2\)"),
        (MESH.positions, MESH.triangles, MESH.uvs[:1], r"uvs: shape \(1, 3, 2\); \(2, 3, 2\)"),
        (MESH.positions, MESH.triangles, None, "uvs: dtype object"),
        (MESH.positions, MESH.triangles.astype(float), MESH.uvs, "triangles: dtype float64"),
        (MESH.positions, MESH.triangles + 1, MESH.uvs, "vertex 6, but there are 6"),
        (MESH.positions, MESH.triangles - 1, MESH.uvs, "triangles: triangle 0 names vertex -1"),
        (changed(MESH.positions, (4, 1), np.nan), MESH.triangles, MESH.uvs, "positions: vertex 4"),
        (changed(MESH.positions, (2, 0), np.inf), MESH.triangles, MESH.uvs, "positions: vertex 2"),
        (MESH.positions, MESH.triangles, changed(MESH.uvs, (1, 2, 0), np.nan), "uvs: triangle 1"),
        (MESH.positions * 1e200, MESH.triangles, MESH.uvs, "positions: the area of triangle 0"),
    ],
)
def test_surface(positions, triangles, uvs, message):
    with pytest.raises(ValueError, match=message):
        prefilter.Surface(positions, triangles, uvs)


@pytest.mark.parametrize(
    ("image", "message"),
    [
        (np.zeros((16, 16, 5), np.float32), "image: 5 channels; 1 to 4"),
        (np.zeros((16, 16), np.float32), r"image: shape \(16, 16\); \(height, width, channels\)"),
        (np.zeros((0, 16, 3), np.float32), "image: .* no pixels"),
        (np.zeros((16, 16, 0), np.float32), "image: .* no pixels"),
        ([[1.0], [1.0, 2.0]], "image: found no array"),
        (np.full((16, 16, 3), 1e300), "image: the texel in row 0, column 0 holds inf"),
        (np.zeros((16, 16, 3), np.int16), "image: dtype int16; float32 or float64"),
        (None, "image: dtype object"),
        (changed(IMAGE, (3, 5, 1), np.nan), "image: the texel in row 3, column 5 holds nan in ch"),
        (changed(IMAGE, (0, 0, 2), np.inf), "image: the texel in row 0, column 0 holds inf"),
    ],
)
@pytest.mark.parametrize(
    "filter", ["box", "lanczos3-covered", "pam-box", "pam-bilinear", "pam-trilinear"]
)
def test_image(image, message, filter):
    with pytest.raises(ValueError, match=message):
        prefilter.mipmaps(image, MESH.surface, filter=filter)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"filter": "pam"}, "filter: 'pam' is not one of box, tent, .*pam-bilinear"),
        ({"wrap": "mirror"}, "wrap: 'mirror' is not one of clamp, repeat, border"),
        ({"wrap": ("clamp", "clamp", "clamp")}, "wrap: .*pair"),
        ({"wrap": ("clamp", 3)}, "wrap: .*pair"),
        ({"bounds": (1.0, 0.0)}, "bounds: the low bound is 1 .* high bound is 0;"),
        ({"bounds": (np.nan, None)}, "bounds: the low bound is nan"),
        ({"bounds": (np.inf, np.inf)}, "bounds: the low bound is inf"),
        ({"bounds": (1e39, None)}, "bounds: the low bound is inf"),
        ({"bounds": (None, -np.inf)}, "bounds: the low bound is open and the high bound is -inf"),
        (
            {"surface": square((2, 2), (3, 3)).surface, "wrap": "border"},
            "surface: none of it lies inside of the image",
        ),
        ({"surface": square((2, 2), (1e12, 3)).surface}, "uvs: triangle 0 spans .* up to 2.30"),
        ({"image": np.full((16, 16, 3), 1e35, np.float32)}, "image: .* holds 1e.35 .* 1e30"),
        ({"bounds": (0.0,)}, "bounds: .*pair"),
        ({"levels": 0}, "levels: 0; a whole number of at least 1"),
        ({"levels": -2}, "levels: -2"),
        ({"levels": 2.5}, "levels: 2.5"),
        ({"levels": 6}, "levels: 6 asked for, .*16 x 16 texels has 1 to 5"),
        ({"levels": 10**30}, "levels: "),
        ({"threads": -1}, "threads: -1"),
        ({"threads": 1.5}, "threads: 1.5"),
        ({"filter": 3}, "filter: 3; a name"),
        ({"filter": "\ud800"}, r"filter: '\?' is not one of"),
        ({"wrap": None}, "wrap: None; one name, or a pair"),
        ({"wrap": 5}, "wrap: 5"),
        ({"bounds": 5}, "bounds: 5; a pair"),
        ({"bounds": ("a", "b")}, r"bounds: .*pair \(low, high\) of numbers"),
        ({"bounds": (1j, None)}, "bounds: "),
        ({"progress": 5}, "progress: 5; a callable"),
        ({"surface": 5}, "surface: a int; a Surface or a list"),
        ({"surface": None}, "surface: none was given"),
        ({"surface": []}, "surface: none was given"),
        ({"surface": [3]}, "surface: holds a int"),
        (
            {"surface": soup([[(0, 0), (1, 0), (0, 1)]], np.zeros(1)).surface},
            "surface: .*area of 0",
        ),
    ],
)
def test_mipmaps(arguments, message):
    arguments = {"image": IMAGE, "surface": MESH.surface, **arguments}
    with pytest.raises(ValueError, match=message):
        prefilter.mipmaps(**arguments)


def test_repeated_tiles_are_limited():
    far = soup([[(0, 0), (1e9, 0), (0, 1e9)], [(0, 0), (3000, 0), (0, 3000)]])
    with pytest.raises(ValueError, match=r"surface 0, uvs: triangle 0 spans u from 0 to 1e"):
        prefilter.mipmaps(IMAGE, far.surface, wrap="repeat")
    for wrap in ("clamp", "border"):
        assert len(prefilter.mipmaps(IMAGE, far.surface, wrap=wrap)) == 5


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"levels": None}, "levels: a NoneType; a list"),
        ({"mip_values": "a"}, "mip_values: numbers"),
        ({"mip_values": [1j]}, "mip_values: numbers"),
        ({"levels": []}, "levels: 0 were given, .* has 1 to 5"),
        ({"levels": [IMAGE] * 6}, "levels: 6 were given"),
        ({"levels": [IMAGE, IMAGE]}, "levels: level 1 has 16 x 16 texels of 3 channels; 8 x 8"),
        ({"levels": [IMAGE[..., :1]]}, "levels: level 0 has 16 x 16 texels of 1 channels"),
        ({"levels": [np.full_like(IMAGE, np.nan)]}, "levels: level 0: the texel in row 0"),
        ({"image": np.full_like(IMAGE, np.nan)}, "image: the texel in row 0, column 0 holds nan"),
        ({"mip_values": [0.5, np.nan]}, "mip_values: holds nan"),
        ({"surface": None}, "surface: none was given"),
        ({"wrap": "tile"}, "wrap: 'tile'"),
    ],
)
def test_mipmap_error(arguments, message):
    arguments = {
        "levels": [IMAGE],
        "image": IMAGE,
        "surface": MESH.surface,
        "mip_values": [0.0],
        **arguments,
    }
    with pytest.raises(ValueError, match=message):
        prefilter.mipmap_error(**arguments)


def test_float32_and_strided_arrays_are_accepted():
    strided = np.repeat(IMAGE, 2, axis=1)[:, ::2]
    mesh = random_soup(1, 4)
    surface = prefilter.Surface(
        mesh.positions.astype(np.float32), mesh.triangles.astype(np.uint32), mesh.uvs
    )
    found = prefilter.mipmaps(strided, surface)
    expected = prefilter.mipmaps(IMAGE, surface)
    assert all(np.array_equal(a, b) for a, b in zip(found, expected, strict=True))


def test_more_threads_than_there_are_is_no_error():
    for threads in (50, 2**31, 2**70):
        assert len(prefilter.mipmaps(IMAGE, MESH.surface, threads=threads)) == 5


def test_inputs_are_left_alone():
    image = random_image(3, 16, 16, 4)
    copy = image.copy()
    levels = prefilter.mipmaps(image, MESH.surface)
    levels[0][:] = 7
    assert np.array_equal(image, copy)
