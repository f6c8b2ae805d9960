# SPDX-License-Identifier: GPL-3.0-or-later

"""Points in PCD files."""

import re
from pathlib import Path

import numpy as np
import prefilter
import prefilter.points.scan_files
import pytest
from scan_writers import COLORS, POINTS, garbled_are_refused, lines, pcd, whole, write

SHARED = Path(__file__).resolve().parents[3] / "shared" / "data" / "points"
FIELDS = [("x", "<f4", 1), ("y", "<f4", 1), ("z", "<f4", 1)]
DATA = ["ascii", "binary", "binary_compressed"]


@pytest.mark.parametrize("data", DATA)
def test_pcd_files_of_all_types(tmp_path, data):
    random = np.random.default_rng(1)
    kinds = ["i1", "<i2", "<i4", "<i8", "u1", "<u2", "<u4", "<u8", "<f4", "<f8"]
    fields = [
        *((f"of_{kind.strip('<')}", kind, 1) for kind in kinds),
        ("_", "u1", 3),
        *(("xyz"[axis], "<f8" if axis == 1 else "<f4", 1) for axis in (2, 0, 1)),
        ("histogram", "<f4", 5),
        *((f"normal_{axis}", "<f4", 1) for axis in "xyz"),
    ]
    rows = [
        tuple(
            random.integers(0, 100, count) if count > 1 else random.integers(0, 100)
            for _, _, count in fields
        )
        for _ in range(3000)
    ]
    points = prefilter.read_points(write(tmp_path, "cloud.pcd", pcd(data, fields, rows)))
    named = {name: [row[k] for row in rows] for k, (name, _, _) in enumerate(fields)}
    np.testing.assert_array_equal(points.positions, np.column_stack([named[a] for a in "xyz"]))
    normals = np.column_stack([named[f"normal_{axis}"] for axis in "xyz"])
    np.testing.assert_array_equal(points.normals, normals)
    assert list(points.attributes) == [f"of_{kind.strip('<')}" for kind in kinds]
    for name, values in points.attributes.items():
        np.testing.assert_array_equal(values, named[name])
    assert points.attributes["of_u1"].dtype == np.uint8
    assert points.viewpoint is None


@pytest.mark.parametrize("data", DATA)
@pytest.mark.parametrize("kind", ["<f4", "<u4", "<i4"])
@pytest.mark.parametrize("name", ["rgb", "rgba"])
def test_packed_colors(tmp_path, data, kind, name):
    # The alpha of a float stays below 0x7f, where it would be no number.
    colors = np.array([(1, 2, 3, 0), (255, 0, 127, 100), (0, 0, 0, 0), (0, 255, 0, 63)])
    packed = (colors @ [1 << 16, 1 << 8, 1, 1 << 24]).astype(np.uint32).view(np.dtype(kind))
    fields = [*FIELDS[:2], (name, kind, 1), FIELDS[2]]
    rows = [(k, k + 1, packed[k], k + 2) for k in range(4)]
    points = prefilter.read_points(write(tmp_path, "cloud.pcd", pcd(data, fields, rows)))
    np.testing.assert_array_equal(points.positions[:, 2], [2, 3, 4, 5])
    np.testing.assert_array_equal(points.colors, colors[:, :3])
    assert ("alpha" in points.attributes) == (name == "rgba")
    if name == "rgba":
        np.testing.assert_array_equal(points.attributes["alpha"], colors[:, 3])


@pytest.mark.parametrize("data", DATA)
def test_points_that_are_not_there_are_passed_on(tmp_path, data):
    rows = [(1, 2, 3), (np.nan, np.nan, np.nan), (np.inf, 0, 0)]
    points = prefilter.read_points(write(tmp_path, "cloud.pcd", pcd(data, FIELDS, rows)))
    np.testing.assert_array_equal(points.positions, rows)


def test_viewpoints(tmp_path):
    def viewpoint(**lines):
        contents = pcd("ascii", FIELDS, [(1, 2, 3)] * 4, lines=lines)
        return prefilter.read_points(write(tmp_path, "cloud.pcd", contents)).viewpoint

    assert viewpoint() is None
    assert viewpoint(VIEWPOINT=None) is None
    assert viewpoint(VIEWPOINT="nan 0 0 1 0 0 0") is None
    np.testing.assert_array_equal(viewpoint(VIEWPOINT="1 -2 0.5 0 1 0 0"), [1, -2, 0.5])
    np.testing.assert_array_equal(viewpoint(WIDTH=2, HEIGHT=2), [0, 0, 0])


@pytest.mark.parametrize("data", DATA)
def test_a_large_pcd_file(tmp_path, data):
    rows = np.random.default_rng(2).integers(-9, 9, (100_000, 3))
    path = write(tmp_path, "cloud.pcd", pcd(data, FIELDS, rows.tolist()))
    np.testing.assert_array_equal(prefilter.read_points(path).positions, rows)


def cloud(data="ascii", **lines):
    return pcd(data, FIELDS, POINTS, lines=lines)


@pytest.mark.parametrize(
    ("contents", "message"),
    [
        (b"", " is not a PCD file: there is no line DATA"),
        (b"\x89PNG\r\n", r": line 1: '\?PNG' without a value"),
        (cloud().split(b"DATA")[0], ": there is no line DATA"),
        (cloud(FIELDS=None, SIZE=None, TYPE=None, COUNT=None), ": there is no line FIELDS"),
        (cloud(WIDTH=None, POINTS=None), ": there is no line WIDTH or POINTS"),
        (cloud(FIELDS="x y w"), ": points have no coordinate 'z'; x, y and z are needed"),
        (cloud(FIELDS="x y z x"), ": line 4: found 3 words for 4 fields"),
        (cloud(TYPE="F F Q"), ": field 'z' of TYPE 'Q' and SIZE 4; I or U of 1, 2"),
        (cloud(SIZE="4 4 3"), ": field 'z' of TYPE 'F' and SIZE 3; I or U of 1, 2"),
        (cloud(COUNT="1 1 2000000000000"), ": points are larger than 1 MiB"),
        (cloud(COUNT="1 1 0"), ": points have no coordinate 'z'"),
        (cloud(WIDTH="-3"), ": line 7: found '-3'; a whole number from 0"),
        (cloud(WIDTH=4), ": POINTS is 3, but WIDTH is 4 and HEIGHT 1"),
        (cloud(WIDTH=2**62, HEIGHT=2**62), ": WIDTH times HEIGHT is above 2\\^62"),
        (cloud(WIDTH=4, POINTS=4), ": line 14: ends after 3 of 4 points"),
        (cloud("binary", WIDTH=4, POINTS=4), ": too short for the 4 points in its header: 36 byt"),
        (cloud(WIDTH=10**18, POINTS=10**18), ": too short for the 1000000000000000000 points"),
        (cloud(VIEWPOINT="0 0 0"), ": line 9: VIEWPOINT needs seven numbers"),
        (cloud(DATA="text"), ": line 11: DATA 'text'; ascii, binary or binary_compressed is n"),
        (cloud(VERSION="0.7\nSIZES 4"), ": line 3: 'SIZES' is not part of a PCD header"),
        (cloud()[:-4] + b"\n", ": line 14: found 2 numbers; 3 are needed"),
        (
            cloud("binary_compressed", WIDTH=4, POINTS=4),
            ": 4 points of 12 bytes in its header, but",
        ),
        (cloud("binary_compressed")[:-1], ": .. bytes of compressed points are announced; .. fol"),
        (cloud("binary_compressed", DATA="binary_compressed\n\0\0\0\0\0\0"), ": 3 points of 12"),
        (b"VERSION 0.7\n" + b"# comment\n" * 200_000, " is not a PCD file: there is no line DATA"),
    ],
    ids=lambda each: each[-50:] if isinstance(each, str) else None,
)
def test_damaged_pcd_files(tmp_path, contents, message):
    path = write(tmp_path, "cloud.pcd", contents)
    with pytest.raises(ValueError, match=f"^'{re.escape(str(path))}'{message}"):
        prefilter.read_points(path)


@pytest.mark.parametrize(
    "contents",
    [cloud(WIDTH=2, POINTS=2), cloud("binary", WIDTH=2, POINTS=2), cloud() + b"1 2 3\n"],
)
def test_the_points_that_a_header_announces_are_read(tmp_path, contents):
    path = write(tmp_path, "cloud.pcd", contents)
    count = 3 if contents.endswith(b"1 2 3\n") else 2
    points = prefilter.read_points(path)
    np.testing.assert_array_equal(points.positions[:2], [(0, 0.5, 1), (1, 0.25, -2)])
    assert len(points.positions) == count
    assert len(points.warnings) == 1
    assert f"holds more than the {count} points in its header" in points.warnings[0]


@pytest.mark.parametrize(
    "packed",
    [
        b"",  # nothing
        b"\x23" + b"a" * 35,  # more copied than was said
        b"\x1f" + b"a" * 32,  # fewer
        b"\x20\x00" * 12,  # what repeats is before the first
        b"\x00a\x20\x01" + b"\x05aaaaaa" * 5,
        b"\x1f" + b"a" * 31,  # ends within a run
        b"\x00a\xe0",
        b"\x00a\xe0\xff",
        b"\x00a\xe0\xff\x00",  # more than was said
    ],
)
def test_damaged_compression(tmp_path, packed):
    start = cloud("binary_compressed")
    start = start[: start.index(b"binary_compressed\n") + 18]
    sizes = len(packed).to_bytes(4, "little") + (36).to_bytes(4, "little")
    path = write(tmp_path, "cloud.pcd", start + sizes + packed)
    with pytest.raises(
        ValueError, match=f"^'{re.escape(str(path))}': the compressed points are damaged at byte"
    ):
        prefilter.read_points(path)


@pytest.mark.parametrize(
    ("name", "contents"),
    [
        ("counted.pts", b"3\n" + whole(lines(POINTS, COLORS)).encode()),
        *((f"{data}.pcd", pcd(data, FIELDS, POINTS)) for data in DATA),
    ],
    ids=lambda each: each if isinstance(each, str) else "",
)
def test_garbled_files_are_read_or_refused(tmp_path, name, contents):
    garbled_are_refused(tmp_path, name, contents)


def test_an_image_of_depths():
    path = SHARED / "pcl_capture0001.pcd"
    if not path.exists():
        pytest.skip(f"{path} is missing")
    points = prefilter.read_points(path)
    assert points.positions.shape == (640 * 480, 3)
    np.testing.assert_array_equal(points.viewpoint, [0, 0, 0])
    x, y, z = points.positions.reshape(480, 640, 3).transpose(2, 0, 1)
    seen = np.isfinite(z)
    assert 0.5 < seen.mean() < 1
    # A pinhole camera: the point seen at a pixel lies on the ray through it.
    columns, rows = np.meshgrid(np.arange(640), np.arange(480))
    for along, pixels in [(x, columns), (y, rows)]:
        slope, middle = np.polyfit(pixels[seen], (along / z)[seen], 1)
        np.testing.assert_allclose((along / z)[seen], slope * pixels[seen] + middle, atol=1e-4)
