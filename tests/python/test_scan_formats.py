# SPDX-License-Identifier: GPL-3.0-or-later

"""Points in lines of numbers, and names of their columns."""

import re
from pathlib import Path

import numpy as np
import prefilter
import prefilter.points.scan_files
import pytest
from prefilter import _native
from scan_writers import COLORS, INTENSITY, NORMALS, POINTS, lines, pcd, ply, whole, write

SHARED = Path(__file__).resolve().parents[3] / "shared" / "data" / "points"


PAGE = Path(__file__).resolve().parents[2] / "docs" / "scans.md"


def read(folder, text, name="cloud.xyz"):
    return prefilter.read_points(write(folder, name, text.encode()))


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


def test_mismatched_column_names(tmp_path):
    # Columns without a name, or with a name already taken, are numbered.
    points = read(tmp_path, "x,y,z,,x,a\n" + lines(POINTS, POINTS, separator=","), "a.csv")
    assert list(points.attributes) == ["value4", "value5", "a"]
    # More names than numbers: names are ignored, and the values decide.
    points = read(tmp_path, "x,y,z,nx,ny,nz,more\n" + lines(POINTS, COLORS), "a.csv")
    np.testing.assert_array_equal(points.colors, COLORS)
    assert len(read(tmp_path, "x y z\n").positions) == 0


@pytest.mark.parametrize("separator", [";", "\t", " ", "; "])
def test_decimal_commas(tmp_path, separator):
    rows = POINTS + 0.25
    text = "x;y;z\n3\n" + lines(rows, [1, 2, 3], separator=separator).replace(".", ",")
    np.testing.assert_array_equal(read(tmp_path, text, "a.csv").positions, rows)
    # No decimal commas where commas separate columns, or where some numbers have a point.
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
    # The mesh is a solid around the room, which ends behind its walls.
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


def test_extensions_include_the_library_s():
    assert prefilter.POINT_EXTENSIONS[: len(_native.POINT_EXTENSIONS)] == _native.POINT_EXTENSIONS
    own = {".ply.gz", *prefilter.points.scan_files._READERS}
    assert {*prefilter.POINT_EXTENSIONS} == {*_native.POINT_EXTENSIONS} | own


def test_the_page_lists_all_extensions():
    text = PAGE.read_text(encoding="utf-8")
    rows = text.partition("| Files | Needs |")[2].partition("\n\n")[0].splitlines()[2:]
    listed = [name for row in rows for name in re.findall(r"`(.+?)`", row.split(" | ")[0])]
    assert sorted(listed) == sorted([*prefilter.POINT_EXTENSIONS, ".blend"])
