# SPDX-License-Identifier: GPL-3.0-or-later

"""Points in lines of numbers, and in PCD files."""

import gzip
import re
from pathlib import Path

import numpy as np
import prefilter
import prefilter.points.scan_files
import pytest
from scan_writers import garbled_are_refused, pcd, ply, write

SHARED = Path(__file__).resolve().parents[3] / "shared" / "data" / "points"
POINTS = np.array([(0.0, 0.5, 1.0), (1.0, 0.25, -2.0), (3.0, 4.0, 5.5)])
NORMALS = np.array([(0.0, 0.6, -0.8), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)])
COLORS = np.array([(0, 10, 255), (1, 1, 1), (200, 0, 3)])
INTENSITY = np.array([-2048.0, 0.5, 2047.0])


def lines(*columns, separator=" "):
    return "".join(
        separator.join(map(str, row)) + "\n" for row in np.column_stack(columns).tolist()
    )


def read(folder, text, name="cloud.xyz"):
    return prefilter.read_points(write(folder, name, text.encode()))


def whole(text):
    return text.replace(".0 ", " ").replace(".0\n", "\n")


@pytest.mark.parametrize(
    "order", ["", "n", "c", "i", "nc", "cn", "ic", "ci", "in", "ni", "inc", "icn"]
)
@pytest.mark.parametrize("form", [str, whole])
def test_columns_are_told_apart(tmp_path, order, form):
    columns = {"n": NORMALS, "c": COLORS, "i": INTENSITY}
    points = read(tmp_path, form(lines(POINTS, *(columns[each] for each in order))))
    np.testing.assert_array_equal(points.positions, POINTS)
    named = dict(points.attributes)
    if "n" in order:
        np.testing.assert_array_equal(points.normals, NORMALS.astype(np.float32))
    else:
        assert points.normals is None
    if "c" in order:
        np.testing.assert_array_equal(points.colors, COLORS)
        assert points.colors.dtype == np.uint8
        for name in ("red", "green", "blue"):
            del named[name]
    if "i" in order:
        np.testing.assert_array_equal(named.pop("intensity"), INTENSITY.astype(np.float32))
        assert not named


def test_other_columns_are_attributes(tmp_path):
    points = read(tmp_path, lines(POINTS, NORMALS, NORMALS, [7.5, 8, 9], [1, 2, 3]))
    names = ["value7", "value8", "value9", "value10", "value11"]
    assert list(points.attributes) == names
    np.testing.assert_array_equal(points.attributes["value10"], [7.5, 8, 9])
    deep = read(tmp_path, lines(POINTS, COLORS * 257))
    assert deep.colors.dtype == np.uint8
    np.testing.assert_array_equal(deep.colors, COLORS)
    deeper = read(tmp_path, lines(POINTS, COLORS * 65536))
    assert deeper.colors.dtype == np.float32
    np.testing.assert_array_equal(deeper.colors, COLORS * 65536)


@pytest.mark.parametrize("separator", [" ", "\t", ",", ", ", ";", "  "])
@pytest.mark.parametrize("name", ["a.xyz", "a.XYZ", "a.xyzn", "a.pts", "a.txt", "a.asc", "a.csv"])
def test_separators_and_comments(tmp_path, separator, name):
    text = "# x y z\n\n" + lines(POINTS, separator=separator)
    text = text.replace("5.5\n", f"5.5{separator}# the last\n// the end")
    np.testing.assert_array_equal(read(tmp_path, text, name).positions, POINTS)
    windows = text.replace("\n", "\r\n")
    np.testing.assert_array_equal(read(tmp_path, windows, name).positions, POINTS)


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("mark", [b"", b"\xef\xbb\xbf"])
@pytest.mark.parametrize("name", ["a.txt", "a.csv"])
def test_line_ends_and_byte_order_marks(tmp_path, end, mark, name):
    text = "3\n# z y x\n" + lines(POINTS, COLORS)
    path = write(tmp_path, name, mark + text.replace("\n", end).encode())
    points = prefilter.read_points(path)
    np.testing.assert_array_equal(points.positions, POINTS)
    np.testing.assert_array_equal(points.colors, COLORS)
    damaged = mark + (text + "1 2\n").replace("\n", end).encode()
    with pytest.raises(ValueError, match="line 6: more points"):
        prefilter.read_points(write(tmp_path, name, damaged))


def test_utf_16_is_named(tmp_path):
    for encoding in ("utf-16-le", "utf-16-be"):
        path = write(tmp_path, "a.txt", ("\ufeff" + lines(POINTS)).encode(encoding))
        with pytest.raises(ValueError, match=r"a.txt': text in UTF-16; save it as UTF-8"):
            prefilter.read_points(path)


@pytest.mark.parametrize(
    "header",
    [
        "classification,Y,X,Z,B,G,R",
        '"Classification";"Y";"X";"Z";"b";"g";"r"',
        "classification\tNorthing (m)\tEasting (m)\tElevation (m)\tBlue\tGreen\tRed",
        "// Classification Y X Z blue green red",
        "#classification y x z b g r",
    ],
)
def test_names_of_columns(tmp_path, header):
    values = np.arange(3.0)[:, None] + 2
    x, y, z = POINTS[:, :1], POINTS[:, 1:2], POINTS[:, 2:]
    text = f"{header}\n" + lines(values, y, x, z, COLORS[:, ::-1])
    points = read(tmp_path, text, "a.csv")
    np.testing.assert_array_equal(points.positions, POINTS)
    np.testing.assert_array_equal(points.colors, COLORS)
    assert points.colors.dtype == np.uint8
    np.testing.assert_array_equal(points.attributes["classification"], values[:, 0])


def test_names_that_do_not_fit(tmp_path):
    # Of columns that have no name, or one of others, there are numbers.
    points = read(tmp_path, "x,y,z,,x,a\n" + lines(POINTS, POINTS, separator=","), "a.csv")
    assert list(points.attributes) == ["value4", "value5", "a"]
    # More names than numbers: those of values.
    points = read(tmp_path, "x,y,z,nx,ny,nz,more\n" + lines(POINTS, COLORS), "a.csv")
    np.testing.assert_array_equal(points.colors, COLORS)
    assert len(read(tmp_path, "x y z\n").positions) == 0


@pytest.mark.parametrize("separator", [";", "\t", " ", "; "])
def test_decimal_commas(tmp_path, separator):
    rows = POINTS + 0.25
    text = "x;y;z\n3\n" + lines(rows, [1, 2, 3], separator=separator).replace(".", ",")
    np.testing.assert_array_equal(read(tmp_path, text, "a.csv").positions, rows)
    # Not where they separate, or some have a point.
    for text in ("1,2,3\n4,5,6\n", "1, 2, 3\n4, 5, 6\n", "1 , 2 , 3\n4,5,6\n"):
        np.testing.assert_array_equal(read(tmp_path, text).positions, [[1, 2, 3], [4, 5, 6]])
    with pytest.raises(ValueError, match="line 2: found 6 numbers; 3 are needed"):
        read(tmp_path, "1.5 2 3\n1,5 2,5 3,5\n")


def test_counts_are_checked(tmp_path):
    several = "3\n" + lines(POINTS) + "0\n2\n" + lines(POINTS[:2])
    points = read(tmp_path, several, "cloud.pts")
    np.testing.assert_array_equal(points.positions, np.concatenate([POINTS, POINTS[:2]]))
    assert len(read(tmp_path, "0\n", "cloud.pts").positions) == 0
    assert len(read(tmp_path, "", "cloud.pts").positions) == 0


def test_large_coordinates_are_doubles(tmp_path):
    # Whether a mesh of these points has to be written in double precision.
    for text, expected in [
        ("1.5 2.123456 -0.3\n", False),
        ("456789.123 5123456.789 100.25\n", True),
    ]:
        path = write(tmp_path, "cloud.xyz", text.encode())
        assert prefilter.points.scan_files.open_points(path).is_double == expected


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("1 2 3\n4 5\n", "line 2: found 2 numbers; 3 are needed, as before"),
        ("1 2 3\n4 5 6 7\n", "line 2: found 4 numbers; 3 are needed, as before"),
        ("1 2 3\n4\n", "line 2: found 1 number; 3 are needed, as before"),
        ("1 2\n", "line 1: found 2 numbers; x, y and z are needed"),
        ("x y\n", "line 1: found 'x'; a number is needed"),
        ("x y z\n1 2 3\nx y z\n", "line 3: found 'x'; a number is needed"),
        ("a b c\n1 2 3\n", "line 1: found 'a'; a number is needed"),
        ("1 2 3\n1 2 3e\n", "line 2: found '3e'; a number is needed"),
        ("\0\1\2\3", r"line 1: found '\?\?\?\?'; a number is needed"),
        ("3\n1 2 3\n", "line 2: ends after 1 of the 3 points that were announced"),
        ("2\n1 2 3\n3\n", "line 3: ends after 1 of the 2 points that were announced"),
        ("1\n1 2 3\n4 5 6\n", "line 3: more points than the 1 that were announced"),
        ("-1\n1 2 3\n", "line 1: found a single number that is not a count; a point needs x, y"),
        ("1.5\n1 2 3\n", "line 1: found a single number that is not a count"),
        ("nan\n1 2 3\n", "line 1: found a single number that is not a count"),
        ("1 2 3\n" * 5000 + "1 2\n", "line 5001: found 2 numbers; 3 are needed, as before"),
    ],
    ids=lambda each: each[:20],
)
def test_damaged_lines(tmp_path, text, message):
    path = write(tmp_path, "cloud.pts", text.encode())
    with pytest.raises(ValueError, match=f"^'{re.escape(str(path))}': {message}"):
        prefilter.read_points(path)


def ptx(scans, end="\n"):
    """Scans of (columns, matrix, rows of numbers)."""
    rows = []
    for columns, matrix, values in scans:
        rows += [[columns], [len(values) // columns], matrix[3][:3], *np.eye(3).tolist()]
        rows += [*matrix, *values]
    return "".join(" ".join(map(repr, row)) + end for row in rows)


def placed_points():
    """Two scans, their points that saw something where they are, and their scanners."""
    turned = [[0.0, 1.0, 0.0, 0], [-1.0, 0.0, 0.0, 0], [0.0, 0.0, 1.0, 0], [4e5, 5e6, 7.5, 1]]
    moved = [[1.0, 0.0, 0.0, 0], [0.0, 1.0, 0.0, 0], [0.0, 0.0, 2.0, 0], [1.0, 2.0, 3.0, 1]]
    nothing = [0, 0, 0, 0.5, 0, 0, 0]
    first = [[1.5, 2.0, 3.0, 0.25, 255, 0, 7], nothing, [4.0, 5.0, 6.0, 1.0, 1, 2, 3], nothing]
    second = [nothing, [0.5, 0.0, 0.0, 0.75, 9, 8, 7]]
    positions = [[4e5 - 2, 5e6 + 1.5, 10.5], [4e5 - 5, 5e6 + 4, 13.5], [1.5, 2.0, 3.0]]
    viewpoints = [turned[3][:3]] * 2 + [moved[3][:3]]
    return [(2, turned, first), (1, moved, second)], positions, viewpoints


@pytest.mark.parametrize("end", ["\n", "\r\n", "\n\n"])
def test_ptx_files(tmp_path, end):
    scans, positions, viewpoints = placed_points()
    text = ptx(scans, end.replace("\n\n", "\n")) + end
    points = read(tmp_path, text, "a.PTX")
    np.testing.assert_array_equal(points.positions, positions)
    np.testing.assert_array_equal(points.viewpoint, viewpoints)
    assert points.normals is None
    np.testing.assert_array_equal(points.colors, [(255, 0, 7), (1, 2, 3), (9, 8, 7)])
    np.testing.assert_array_equal(points.attributes["intensity"], np.float32([0.25, 1, 0.75]))
    plain = [(columns, matrix, [row[:4] for row in rows]) for columns, matrix, rows in scans]
    points = read(tmp_path, ptx(plain), "a.ptx")
    np.testing.assert_array_equal(points.positions, positions)
    assert list(points.attributes) == ["intensity"]
    assert len(read(tmp_path, "", "a.ptx").positions) == 0
    assert len(read(tmp_path, ptx([(1, scans[0][1], [])]), "a.ptx").positions) == 0


def test_normals_of_ptx_files_face_their_scanners(tmp_path):
    random = np.random.default_rng(3)
    directions = random.normal(size=(4000, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    inside = np.eye(4).tolist()
    rows = np.column_stack([2 * directions, np.full(4000, 0.5)]).tolist()
    path = write(tmp_path, "room.ptx", ptx([(1, inside, rows)]).encode())
    positions, triangles = prefilter.reconstruct(path, depth=5)
    corners = positions[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    middles = corners.mean(axis=1)
    # The room is in a solid, which ends behind its walls.
    walls = np.linalg.norm(middles, axis=1) < 2.001
    assert np.count_nonzero(walls) > 2000
    assert (np.einsum("tk,tk->t", normals, middles)[walls] < 0).all()


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("2\n2\n", "2\n2 2\n", "line 2: found 2 numbers; the number of rows of a scan is needed"),
        ("2\n2\n", "-2\n2\n", "line 1: no whole number from 0 to 1e9; the number of columns"),
        ("2\n2\n", "2.5\n2\n", "line 1: no whole number"),
        ("2\n2\n", "x\n2\n", "line 1: found 'x'; a number is needed"),
        ("7.5\n1.0", "7.5 1\n1.0", "line 3: found 4 numbers; the scanner's place and its axes"),
        ("7.5 1\n", "7.5\n", "line 10: found 3 numbers; a row of the scan's matrix is needed"),
        (" 0.25 255 0 7\n", " 0.25 255\n", "line 11: found 5 numbers; x, y, z, an intensity"),
        (" 1 2 3\n", "\n", "line 13: found 4 numbers; 7 are needed, as before"),
        (" 0.75 9 8 7\n", " 0.75 9 8 q\n", "line 26: found 'q'; a number is needed"),
    ],
)
def test_damaged_ptx_files(tmp_path, old, new, message):
    text = ptx(placed_points()[0])
    assert old in text
    path = write(tmp_path, "a.ptx", text.replace(old, new, 1).encode())
    with pytest.raises(ValueError, match=f"^'{re.escape(str(path))}': {re.escape(message)}"):
        prefilter.read_points(path)
    for length in range(1, len(text) - 10, 7):
        path.write_text(text[:length])
        with pytest.raises(ValueError, match=r"a\.ptx': line \d+"):
            prefilter.read_points(path)


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
        (cloud(WIDTH=2, POINTS=2), ": holds more than the 2 points in its header"),
        (cloud("binary", WIDTH=4, POINTS=4), ": too short for the 4 points in its header: 36 byt"),
        (cloud("binary", WIDTH=2, POINTS=2), ": holds more than the 2 points in its header"),
        (cloud(WIDTH=10**18, POINTS=10**18), ": too short for the 1000000000000000000 points"),
        (cloud(VIEWPOINT="0 0 0"), ": line 9: VIEWPOINT needs seven numbers"),
        (cloud(DATA="text"), ": line 11: DATA 'text'; ascii, binary or binary_compressed is n"),
        (cloud(VERSION="0.7\nSIZES 4"), ": line 3: 'SIZES' is not part of a PCD header"),
        (cloud() + b"1 2 3\n", ": holds more than the 3 points in its header"),
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


def shared(name):
    path = SHARED / name
    if not path.exists():
        pytest.skip(f"{path} is missing")
    return path


def test_files_of_others():
    points = prefilter.read_points(shared("bunnyData.pts"))
    np.testing.assert_array_equal(points.positions, np.loadtxt(shared("bunnyData.pts"), skiprows=1))
    points = prefilter.read_points(shared("kitten.xyz"))
    table = np.loadtxt(shared("kitten.xyz"))
    np.testing.assert_array_equal(points.positions, table[:, :3])
    np.testing.assert_array_equal(points.normals, table[:, 3:].astype(np.float32))
    np.testing.assert_allclose(np.linalg.norm(points.normals, axis=1), 1, atol=1e-5)


def test_an_image_of_depths():
    points = prefilter.read_points(shared("pcl_capture0001.pcd"))
    assert points.positions.shape == (640 * 480, 3)
    np.testing.assert_array_equal(points.viewpoint, [0, 0, 0])
    x, y, z = points.positions.reshape(480, 640, 3).transpose(2, 0, 1)
    seen = np.isfinite(z)
    assert 0.5 < seen.mean() < 1
    # A pinhole camera: what is seen at a pixel lies on the ray through it.
    columns, rows = np.meshgrid(np.arange(640), np.arange(480))
    for along, pixels in [(x, columns), (y, rows)]:
        slope, middle = np.polyfit(pixels[seen], (along / z)[seen], 1)
        np.testing.assert_allclose((along / z)[seen], slope * pixels[seen] + middle, atol=1e-4)


OTHER_NAMES = {
    "x": "X",
    "y": "Y",
    "z": "Z",
    "nx": "Normal_X",
    "ny": "NormalY",
    "nz": "NORMAL_Z",
    "red": "diffuse_red",
    "green": "Green",
    "blue": "BLUE",
    "intensity": "scalar_Intensity",
    "return_number": "ReturnNumber",
    "number_of_returns": "scalar_Number_Of_Returns",
    "classification": "scalar_Classification",
    "confidence": "Confidence",
}


def test_names_of_other_programs(tmp_path):
    rows = np.concatenate([POINTS, NORMALS, COLORS, np.arange(15.0).reshape(3, 5)], axis=1)
    fields = [(name, "f4", 1) for name in OTHER_NAMES.values()]
    properties = [("float", name) for name in OTHER_NAMES.values()]
    commas = ",".join(OTHER_NAMES.values())
    for path in (
        write(tmp_path, "a.pcd", pcd("binary", fields, rows.tolist())),
        write(tmp_path, "a.ply", ply("ascii", [("vertex", properties, rows.tolist())])),
        write(tmp_path, "a.csv", f"{commas}\n{lines(rows, separator=',')}".encode()),
    ):
        points = prefilter.read_points(path)
        np.testing.assert_array_equal(points.positions, POINTS)
        np.testing.assert_array_equal(points.normals, NORMALS.astype(np.float32))
        np.testing.assert_array_equal(points.colors, COLORS)
        np.testing.assert_array_equal(points.weights, rows[:, 13])
        names = ("intensity", "return_number", "number_of_returns", "classification")
        for column, name in enumerate(names, 9):
            np.testing.assert_array_equal(points.attributes[name], rows[:, column])


def test_a_name_itself_comes_before_another_spelling(tmp_path):
    kinds = [("float", name) for name in ("X", "x", "y", "z", "Red", "red")]
    contents = ply("ascii", [("vertex", kinds, [(9.0, 1.0, 2.0, 3.0, 4.0, 5.0)])])
    points = prefilter.read_points(write(tmp_path, "a.ply", contents))
    np.testing.assert_array_equal(points.positions, [(1, 2, 3)])
    assert {name: values[0] for name, values in points.attributes.items()} == {
        "X": 9,
        "Red": 4,
        "red": 5,
    }


def test_names_of_two_words(tmp_path):
    text = "X [m];Y [m];Z [m];Return Number;Number of Returns;Class\n1;2;3;1;2;6\n"
    points = read(tmp_path, text, "a.csv")
    np.testing.assert_array_equal(points.positions, [(1, 2, 3)])
    found = {name: values[0] for name, values in points.attributes.items()}
    assert found == {"return_number": 1, "number_of_returns": 2, "classification": 6}


@pytest.mark.parametrize("scale", [1, 257])
@pytest.mark.parametrize("form", ["ply", "text", "pcd"])
def test_colors_of_16_bits_become_bytes(tmp_path, scale, form):
    """Some programs fill only the lower 8 of them: the first million of points tells."""
    count = 100_000  # More than are read at once; only the last have a color.
    colors = np.zeros((count, 3), int)
    colors[-3:] = COLORS
    rows = np.concatenate([np.tile(POINTS, (count, 1))[:count], scale * colors], axis=1)
    names = ("red", "green", "blue")
    kinds = [("float", axis) for axis in "xyz"] + [("ushort", name) for name in names]
    if form == "pcd":
        fields = [(axis, "f4", 1) for axis in "xyz"] + [(name, "u2", 1) for name in names]
        path = write(tmp_path, "a.pcd", pcd("binary", fields, rows[-1000:].tolist()))
    else:
        values = [(*row[:3], *(int(value) for value in row[3:])) for row in rows.tolist()]
        layout = "ascii" if form == "text" else "binary_big_endian"
        path = write(tmp_path, "a.ply", ply(layout, [("vertex", kinds, values)]))
    found = prefilter.read_points(path).colors
    assert found.dtype == np.uint8
    np.testing.assert_array_equal(found[-3:], COLORS)
    assert not found[:-3].any()


def test_ply_with_a_blank_behind_its_name(tmp_path):
    contents = ply("ascii", [("vertex", [("float", axis) for axis in "xyz"], POINTS.tolist())])
    path = write(tmp_path, "a.ply", contents.replace(b"ply\n", b"ply \n", 1))
    np.testing.assert_array_equal(prefilter.read_points(path).positions, POINTS)


def obj(vertices, normals=(), *, end="\n"):
    text = ["# made by hand", "mtllib a.mtl", "o thing"]
    text += ["v " + " ".join(map(str, row)) for row in vertices]
    text += ["vt 0 0"] + ["vn\t" + " ".join(map(str, row)) for row in normals]
    return end.join([*text, "f 1 2 3", "l 1 2", ""]).encode()


@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_vertices_of_obj_files(tmp_path, end):
    points = prefilter.read_points(write(tmp_path, "a.obj", obj(POINTS, end=end)))
    np.testing.assert_array_equal(points.positions, POINTS)
    assert points.normals is points.colors is points.weights is None
    points = prefilter.read_points(write(tmp_path, "a.OBJ", obj(POINTS, NORMALS, end=end)))
    np.testing.assert_array_equal(points.normals, NORMALS.astype(np.float32))
    for normals in (NORMALS[:2], [*NORMALS, (0, 0, 1)]):
        path = write(tmp_path, "a.obj", obj(POINTS, normals, end=end))
        assert prefilter.read_points(path).normals is None


def test_many_vertices_with_normals_and_colors(tmp_path):
    random = np.random.default_rng(2)
    rows = random.normal(size=(70_000, 6))
    rows[:, 3:] = random.integers(0, 256, (70_000, 3))
    normals = random.normal(size=(70_000, 3))
    for scale in (1.0, 255.0):
        scaled = rows / ([1.0] * 3 + [scale] * 3)
        text = "".join(
            "v {} {} {} {} {} {}\nvn {} {} {}\n".format(*row)
            for row in np.concatenate([scaled, normals], axis=1).tolist()
        )
        points = prefilter.read_points(write(tmp_path, "a.obj", text.encode()))
        np.testing.assert_array_equal(points.positions, rows[:, :3])
        np.testing.assert_array_equal(points.normals, normals.astype(np.float32))
        np.testing.assert_array_equal(points.colors, rows[:, 3:])
        assert points.colors.dtype == np.uint8


def test_weights_of_vertices_are_passed_over(tmp_path):
    rows = np.concatenate([POINTS, [[1.0]] * 3], axis=1)
    points = prefilter.read_points(write(tmp_path, "a.obj", obj(rows)))
    np.testing.assert_array_equal(points.positions, POINTS)
    assert points.attributes == {}


def test_obj_files_that_are_none(tmp_path):
    for text, message in [
        (b"", "has no vertex, which is a line 'v x y z'"),
        (b"f 1 2 3\n", "has no vertex"),
        (b"\x64\x86\0\0v\0" * 100, "has no vertex"),
        (b"v 1 2\n", "line 1: found 2 numbers; x, y and z, and none, one or a color"),
        (b"v 1 2 3 4 5\n", "line 1: found 5 numbers"),
        (b"v 1 2 3\n\nv 1 2 3 4\n", "line 3: found 4 numbers; 3 are needed"),
        (b"v 1 2 three\n", "line 1: found 'three'; a number is needed"),
        (b"v 1 2 3\nvn 1 2\n", "line 2: found 2 numbers; 3 are needed"),
        (b"v 0 0 0\n" * 5000 + b"v 1\n", "line 5001: found 1 numbers; 3 are needed"),
    ]:
        with pytest.raises(ValueError, match=rf"a.obj'.*{message}"):
            prefilter.read_points(write(tmp_path, "a.obj", text))
    garbled_are_refused(tmp_path, "a.obj", obj(np.random.default_rng(1).normal(size=(30, 6))))


SPLAT = [
    *(("float", name) for name in ("x", "y", "z", "nx", "ny", "nz", "f_dc_0", "f_dc_1", "f_dc_2")),
    *(("float", f"f_rest_{k}") for k in range(9)),
    *(("float", name) for name in ("opacity", "scale_0", "scale_1", "scale_2")),
    *(("float", f"rot_{k}") for k in range(4)),
]


def rotation(w, x, y, z):
    """The matrix of a quaternion, by turning the axes: q (0, v) q*."""

    def product(a, b):
        along = a[0] * b[1:] + b[0] * a[1:] + np.cross(a[1:], b[1:])
        return np.array([a[0] * b[0] - np.dot(a[1:], b[1:]), *along])

    q = np.array([w, x, y, z]) / np.linalg.norm([w, x, y, z])
    back = q * (1, -1, -1, -1)
    return np.stack(
        [product(product(q, np.array([0.0, *axis])), back)[1:] for axis in np.eye(3)], axis=1
    )


def splats(count=3000, seed=3):
    """Flat splats of a ball, their normals, opacities and colors."""
    random = np.random.default_rng(seed)
    quaternions = random.normal(size=(count, 4)) * random.uniform(0.1, 5, (count, 1))
    axes = random.integers(0, 3, count)
    normals = np.stack([rotation(*q)[:, axis] for q, axis in zip(quaternions, axes, strict=True)])
    scales = random.uniform(-4, -3, (count, 3))
    scales[np.arange(count), axes] -= 3
    logits, colors = random.normal(size=count) * 3, random.normal(size=(count, 3))
    zeros = np.zeros((count, 3))
    parts = [normals, zeros, colors, np.ones((count, 9)), logits[:, None], scales, quaternions]
    return np.concatenate(parts, axis=1), normals, 1 / (1 + np.exp(-logits)), colors


@pytest.mark.parametrize("form", ["ascii", "binary_little_endian"])
def test_gaussian_splats(tmp_path, form):
    rows, normals, opacities, colors = splats()
    path = write(tmp_path, "a.ply", ply(form, [("vertex", SPLAT, rows.tolist())]))
    points = prefilter.read_points(path)
    np.testing.assert_allclose(points.positions, normals, atol=1e-6)
    # Outward, on a ball; the file says nothing of the direction.
    assert (np.sum(points.normals * normals, axis=1) > 0.9999).all()
    np.testing.assert_allclose(points.weights, opacities, rtol=1e-5)
    assert list(points.attributes) == ["red", "green", "blue"]
    wanted = np.clip(0.5 + colors / np.sqrt(4 * np.pi), 0, 1)
    np.testing.assert_allclose(points.colors, 255 * wanted, atol=0.51)
    found, _ = prefilter.reconstruct([path], depth=5)
    assert np.abs(np.linalg.norm(found, axis=1) - 1).max() < 0.1


def test_splats_without_a_third_axis_and_odd_ones(tmp_path):
    rows, _, _, _ = splats(50)
    flat = np.delete(rows, SPLAT.index(("float", "scale_2")), axis=1)
    kinds = [one for one in SPLAT if one[1] != "scale_2"]
    path = write(tmp_path, "a.ply", ply("binary_little_endian", [("vertex", kinds, flat.tolist())]))
    expected = np.stack([rotation(*row[-4:])[:, 2] for row in flat])
    found = prefilter.read_points(path).normals
    np.testing.assert_allclose(np.abs(np.sum(found * expected, axis=1)), 1, atol=1e-5)
    rows[0, -4:] = 0
    rows[1, -4:] = np.nan
    rows[2, -8] = np.nan
    rows[3, -8] = np.inf
    rows[4, -8] = -np.inf
    rows[5, 6:9] = np.nan
    path = write(tmp_path, "a.ply", ply("binary_little_endian", [("vertex", SPLAT, rows.tolist())]))
    points = prefilter.read_points(path)
    assert not points.normals[:2].any()
    np.testing.assert_array_equal(points.weights[2:5], [0, 1, 0])
    np.testing.assert_array_equal(points.colors[5], [0, 0, 0])
    few = ply("binary_little_endian", [("vertex", SPLAT, [])])
    assert len(prefilter.read_points(write(tmp_path, "a.ply", few)).positions) == 0


def test_packed_ply_files(tmp_path):
    count = 300_000  # Unpacked in several pieces.
    kinds = [("double", axis) for axis in "xyz"]
    rows = np.random.default_rng(1).normal(size=(count, 3)).tolist()
    plain = ply("binary_little_endian", [("vertex", kinds, rows)])
    path = write(tmp_path, "a.PLY.gz", gzip.compress(plain, 1))
    told = []
    points = prefilter.read_points(path, progress=told.append)
    np.testing.assert_array_equal(points.positions, rows)
    assert told == sorted(told)
    assert told[-1] == 1.0
    with pytest.raises(prefilter.Cancelled):
        prefilter.read_points(path, progress=lambda done: False)
    # As cat and pigz make them: several, one after the other.
    halves = gzip.compress(plain[:1000]) + gzip.compress(plain[1000:])
    np.testing.assert_array_equal(
        prefilter.read_points(write(tmp_path, "b.ply.gz", halves)).positions, rows
    )


def test_faces_of_packed_ply_files(tmp_path):
    corners = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)]
    elements = [
        ("vertex", [("float", axis) for axis in "xyz"], corners),
        ("face", [("uchar", "int", "vertex_indices")], [([0, 1, 2],)]),
    ]
    path = write(tmp_path, "a.ply.gz", gzip.compress(ply("ascii", elements)))
    np.testing.assert_array_equal(prefilter.points.scan_files.read_faces(path), [(0, 1, 2)])
    assert prefilter.points.scan_files.read_range_grid(path) is None
    points = prefilter.read_points(path)
    normals, _ = prefilter.file_normals(path, points)
    np.testing.assert_allclose(normals, [(0, 0, 1)] * 3)


def test_packed_files_that_are_damaged(tmp_path):
    kinds = [("float", axis) for axis in "xyz"]
    packed = gzip.compress(ply("ascii", [("vertex", kinds, POINTS.tolist())]))
    for contents, message in [
        (b"", "is not a PLY file: it begins with ''"),
        (b"ply\n", "cannot be unpacked by gzip"),
        (packed[:-9], "cannot be unpacked by gzip"),
        (packed[:30], "cannot be unpacked by gzip"),
        (packed[:-8] + b"\0" * 8, "cannot be unpacked by gzip: CRC check failed"),
        (packed[:12] + b"\xff" * 8 + packed[20:], "cannot be unpacked by gzip"),
        (gzip.compress(b"nonsense"), "is not a PLY file: it begins with 'nons'"),
    ]:
        with pytest.raises(ValueError, match=rf"a.ply.gz'.*{message}"):
            prefilter.read_points(write(tmp_path, "a.ply.gz", contents))
    with pytest.raises(FileNotFoundError):
        prefilter.read_points(tmp_path / "none.ply.gz")
    with pytest.raises(ValueError, match=r"unsupported extension '.xyz.gz'"):
        prefilter.read_points(write(tmp_path, "a.xyz.gz", packed))
