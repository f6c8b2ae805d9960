# SPDX-License-Identifier: GPL-3.0-or-later

"""Points of LAS files, read without Python modules."""

import sys

import numpy as np
import prefilter
import pytest
from las_files import OFFSETS, SCALES, las
from scan_writers import write

RANDOM = np.random.default_rng(1)


def random_points(count, **more):
    return [
        {
            "xyz": RANDOM.integers(-(2**31), 2**31, 3).tolist(),
            "intensity": int(RANDOM.integers(0, 65536)),
            "number": k % 3 + 1,
            "of": 3,
            "class": k % 32,
            "color": RANDOM.integers(0, 65536, 3).tolist(),
            **{name: values[k] for name, values in more.items()},
        }
        for k in range(count)
    ]


@pytest.mark.parametrize("point_format", range(11))
@pytest.mark.parametrize("padding", [0, 3])
def test_all_formats_of_points(tmp_path, point_format, padding):
    points = random_points(100)
    contents = las(points, point_format, padding=padding, records=[(b"of someone", 7, b"abc")])
    found = prefilter.read_points(write(tmp_path, "cloud.las", contents))
    expected = np.array([p["xyz"] for p in points]) * SCALES + OFFSETS
    np.testing.assert_array_equal(found.positions, expected)
    for name, key in (
        ("intensity", "intensity"),
        ("classification", "class"),
        ("return_number", "number"),
        ("number_of_returns", "of"),
    ):
        np.testing.assert_array_equal(found.attributes[name], [p[key] for p in points], name)
    if point_format in (2, 3, 5, 7, 8, 10):
        colors = np.round(np.array([p["color"] for p in points]) / 257)
        np.testing.assert_array_equal(found.colors, colors)
    else:
        assert found.colors is None
    assert found.is_from_above


def test_extra_dimensions(tmp_path):
    """Extra dimensions: scaled, of several numbers, bytes without a meaning, and a normal."""
    count = 10
    more = {
        "height": RANDOM.integers(-1000, 1000, count).tolist(),
        "pair": [0] * count,
        "unknown": [0] * count,
        **{f"normal {axis}": RANDOM.normal(size=count).tolist() for axis in "xyz"},
    }
    extra = [
        ("height", 4, "h", 0.5, 3.0),
        ("pair", 15, "q", 1.0, 0.0),  # two numbers of four bytes
        *((f"normal {axis}", 9, "f", 1.0, 0.0) for axis in "xyz"),
    ]
    points = random_points(count, **more)
    found = prefilter.read_points(write(tmp_path, "cloud.las", las(points, 6, extra=extra)))
    np.testing.assert_array_equal(found.attributes["height"], np.array(more["height"]) * 0.5 + 3)
    expected = np.array([[p[f"normal {axis}"] for axis in "xyz"] for p in points], np.float32)
    np.testing.assert_array_equal(found.normals, expected)
    assert "pair" not in found.attributes


def test_points_are_read_from_any_one_on(tmp_path):
    """More points than are read at once, and a part of them, as for shares of a file."""
    steps = np.arange(3 * 70_000).reshape(-1, 3)
    points = [{"xyz": row} for row in steps.tolist()]
    path = write(tmp_path, "cloud.las", las(points, 0))
    found = prefilter.read_points(path).positions
    np.testing.assert_allclose(found, steps * SCALES + OFFSETS, rtol=1e-12)
    few = prefilter.read_points(path, most=1000)
    np.testing.assert_array_equal(few.positions, found[:: few.stride])


def test_a_surface_of_a_file(tmp_path):
    x, y = (axis.ravel() for axis in np.mgrid[:60, :60])
    rows = np.stack([x * 1000, y * 100, 2 + (x // 20)], axis=1)
    path = write(tmp_path, "terrain.las", las([{"xyz": row} for row in rows.tolist()], 1))
    report = prefilter.reconstruct_file(path, tmp_path / "terrain.ply", depth=5)
    assert report.points == 3600
    assert report.directions == ("up",)


@pytest.mark.parametrize(
    ("contents", "message"),
    [
        (b"", "is not a LAS file: it begins with b''"),
        (las(random_points(5), 0)[:-1], "too short for the 5 points in its header: 99 bytes"),
        (las(random_points(5), 3, mark=0x40), "points of format 67 with 34 bytes; 0 to 10"),
        (las(random_points(5), 0)[:104] + b"\x0b" + bytes(200), "points of format 11 with"),
    ],
    ids=["empty", "cut", "mark", "format"],
)
def test_damaged_files(tmp_path, contents, message):
    with pytest.raises(ValueError, match=f"cloud.las'.*{message}"):
        prefilter.read_points(write(tmp_path, "cloud.las", contents))


def test_the_missing_package_for_laz_files_is_named(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "lazrs", None)
    path = write(tmp_path, "cloud.laz", las(random_points(5), 0, mark=0x80))
    with pytest.raises(
        ValueError, match=r"cloud.laz': LAZ files need the Python module lazrs"
    ) as e:
        prefilter.read_points(path)
    assert "pip install lazrs, or convert the file to LAS" in str(e.value)
    assert sys.executable not in str(e.value)
