# SPDX-License-Identifier: GPL-3.0-or-later

"""Point files by other programs are read, and damage is reported."""

import os
import re
import tarfile
from pathlib import Path

import numpy as np
import prefilter
import pytest
from prefilter import _native
from prefilter.points.scan_files import read_faces, read_range_grid
from scan_writers import FORMATS, TYPES, garbled_are_refused, ply, random_rows, write

SHARED = Path(__file__).resolve().parents[3] / "shared" / "data" / "points"
XYZ = [("float", axis) for axis in "xyz"]
CORNERS = [(0.0, 0.5, 1.0), (1.0, 0.25, -2.0), (3.0, 4.0, 5.5)]


def read(folder, contents, name="cloud.ply"):
    return prefilter.read_points(write(folder, name, contents))


@pytest.mark.parametrize("form", FORMATS)
@pytest.mark.parametrize("newline", ["\n", "\r\n"])
def test_all_types_are_read(tmp_path, form, newline):
    properties = [(kind, f"of_{kind}") for kind in TYPES]
    properties[5:5] = [("double", "z"), ("float", "x")]
    properties.append(("int", "y"))
    rows = random_rows([kind for kind, _ in properties], 1000)
    points = read(tmp_path, ply(form, [("vertex", properties, rows)], newline=newline))
    columns = dict(zip([name for _, name in properties], np.array(rows).T, strict=True))
    np.testing.assert_array_equal(
        points.positions, np.stack([columns.pop(axis) for axis in "xyz"], axis=1)
    )
    assert list(points.attributes) == list(columns)
    for name, values in columns.items():
        is_byte = name in ("of_uchar", "of_uint8")
        assert points.attributes[name].dtype == (np.uint8 if is_byte else np.float32)
        np.testing.assert_array_equal(points.attributes[name], values.astype(np.float32))
    assert points.normals is points.weights is points.viewpoint is points.colors is None


@pytest.mark.parametrize("form", FORMATS)
@pytest.mark.parametrize("prefix", ["n", "normal_"])
def test_normals_weights_and_colors(tmp_path, form, prefix):
    properties = [
        *XYZ,
        *(("uchar", color) for color in ("red", "green", "blue", "alpha")),
        ("float", "confidence"),
        *(("float", prefix + axis) for axis in "xyz"),
        ("float", "quality"),
    ]
    rows = random_rows([kind for kind, _ in properties], 300)
    points = read(tmp_path, ply(form, [("vertex", properties, rows)]))
    table = np.array(rows)
    np.testing.assert_array_equal(points.positions, table[:, :3])
    np.testing.assert_array_equal(points.colors, table[:, 3:6])
    np.testing.assert_array_equal(points.weights, table[:, 7])
    np.testing.assert_array_equal(points.normals, table[:, 8:11])
    np.testing.assert_array_equal(points.attributes["quality"], table[:, 11].astype(np.float32))
    assert points.colors.dtype == np.uint8
    assert set(points.attributes) == {"red", "green", "blue", "alpha", "quality"}


@pytest.mark.parametrize("form", FORMATS)
def test_other_elements_and_lists_are_passed_over(tmp_path, form):
    lists = [("uchar", "int", "some"), ("float", "between"), ("int", "double", "more")]
    others = [([1, 2, 3], 0.5, []), ([], 1.5, [0.25]), ([7] * 200, 2.5, [1.0, 2.0])]
    vertices = [(i, *corner, [i] * i) for i, corner in enumerate(CORNERS)]
    contents = ply(
        form,
        [
            ("camera", lists, others),
            ("nothing", [], [(), ()]),
            ("pair", [("float", "x"), ("short", "y")], [(1.0, 2), (3.0, 4)]),
            ("vertex", [("uchar", "id"), *XYZ, ("uchar", "ushort", "links")], vertices),
            ("face", [("uchar", "int", "vertex_indices")], [([0, 1, 2],)]),
        ],
        lines=["comment made by hand", "obj_info number 7", "comment", "bye", ""],
    )
    points = read(tmp_path, contents)
    np.testing.assert_array_equal(points.positions, CORNERS)
    np.testing.assert_array_equal(points.attributes["id"], [0, 1, 2])
    assert list(points.attributes) == ["id"]


@pytest.mark.parametrize("form", FORMATS)
def test_many_points_are_read_in_pieces(tmp_path, form):
    rows = random_rows(["float", "float", "double"], 70_000)
    properties = [("float", "x"), ("float", "y"), ("double", "z")]
    told = []
    path = write(tmp_path, "cloud.ply", ply(form, [("vertex", properties, rows)]))
    points = prefilter.read_points(path, progress=told.append)
    np.testing.assert_array_equal(points.positions, rows)
    assert told[-1] == 1.0
    assert sorted(told) == told
    with pytest.raises(prefilter.Cancelled):
        prefilter.read_points(path, progress=lambda _: False)


def test_numbers_as_programs_write_them(tmp_path):
    header = ply("ascii", [("vertex", XYZ, [])]).replace(b"vertex 0", b"vertex 5")
    text = (
        b"+1 -1. .5\r\n\n  1e3\t1E-3 -0\nnan NaN -inf\n1.#QNAN -1.#IND -1.#INF\n1e999 -1e999 1e-999"
    )
    expected = [
        (1, -1, 0.5),
        (1000, 0.001, 0),
        (np.nan, np.nan, -np.inf),
        (np.nan, np.nan, -np.inf),
        (np.inf, -np.inf, 0),
    ]
    np.testing.assert_array_equal(read(tmp_path, header + text).positions, expected)


@pytest.mark.parametrize("form", FORMATS)
def test_no_points_are_no_error(tmp_path, form):
    points = read(tmp_path, ply(form, [("vertex", [*XYZ, ("uchar", "red")], [])]))
    assert points.positions.shape == (0, 3)
    assert points.attributes["red"].shape == (0,)


def vertices(form="ascii", properties=XYZ, rows=CORNERS):
    return ply(form, [("vertex", properties, rows)])


@pytest.mark.parametrize(
    ("contents", "message"),
    [
        (b"", "is not a PLY file: it begins with ''"),
        (b"plywood", "is not a PLY file: it begins with 'plyw'"),
        (b"\x89PNG\r\n", r"is not a PLY file: it begins with '\?PNG'"),
        (b"ply\n", "ends within the header, after line 1"),
        (vertices()[:38], "ends within the header, after line"),
        (vertices().replace(b"ascii", b"text"), "line 2: format 'text'; ascii, binary_little"),
        (vertices().replace(b"format ascii 1.0\n", b""), "the header has no line 'format'"),
        (vertices().replace(b"vertex 3", b"vertex -3"), "line 3: element 'vertex' with count '-3'"),
        (vertices().replace(b"vertex 3", b"vertex 1e3"), "with count '1e3'; a name and a whole"),
        (vertices().replace(b"vertex 3", b"vertex"), "with count ''"),
        (vertices().replace(b"vertex 3", b"vertex 99999999999999999999"), "2\\^63 - 1 are needed"),
        (vertices().replace(b"vertex 3", b"vertex 9000000000000000000"), "too short for the 90000"),
        (vertices("binary_big_endian").replace(b"vertex 3", b"vertex 4"), "too short for the 4 ro"),
        (vertices("binary_big_endian")[:-1], "too short for the 3 rows of 'vertex' in its header"),
        (vertices().replace(b"vertex 3", b"vertex 4"), "line 10: vertex 4 of 4: the file ends"),
        (
            vertices().replace(b"0.25", b"a\033[31m"),
            r"line 9: found 'a\?\[31m'; a number is needed",
        ),
        (vertices().replace(b"0.25", b""), "line 9: vertex 2 of 3: found 2 values; more are need"),
        (vertices().replace(b"0.25", b"0,25"), "line 9: found '0,25'; a number is needed"),
        (vertices().replace(b"0.25", b"0 25"), "line 9: vertex 2 of 3: found 4 values; 3 are need"),
        (vertices().replace(b"vertex 3", b"face 3"), "there is no element 'vertex' in its header"),
        (vertices().replace(b"float z", b"float w"), "points have no coordinate 'z'; x, y and z"),
        (vertices().replace(b"float z", b"float x"), "line 6: a second property 'x' of 'vertex'"),
        (vertices().replace(b"float z", b"half z"), "line 6: 'half' is not a type of PLY"),
        (vertices().replace(b"float z", b"float"), "line 6: a property without a name"),
        (vertices().replace(b"float z", b"list float int z"), "of a type of whole numbers"),
        (vertices().replace(b"element", b"elements"), "line 4: a property before any element"),
        (vertices().replace(b"element vertex 3\n", b""), "line 3: a property before any element"),
    ],
    ids=str,
)
def test_damaged_ply_files(tmp_path, contents, message):
    path = write(tmp_path, "cloud.ply", contents)
    with pytest.raises(ValueError, match=f"^'{re.escape(str(path))}'.*{message}"):
        prefilter.read_points(path)


@pytest.mark.parametrize(
    ("contents", "count"),
    [
        (vertices("binary_big_endian").replace(b"vertex 3", b"vertex 2"), 2),
        (vertices("binary_little_endian").replace(b"vertex 3", b"vertex 1"), 1),
        (vertices().replace(b"vertex 3", b"vertex 2"), 2),
        (vertices() + b"\n" * 10 + b"x", 3),
    ],
    ids=str,
)
def test_rows_beyond_those_of_the_header_are_not_read(tmp_path, contents, count):
    path = write(tmp_path, "cloud.ply", contents)
    points = prefilter.read_points(path)
    expected = [(0.0, 0.5, 1.0), (1.0, 0.25, -2.0), (3.0, 4.0, 5.5)]
    np.testing.assert_array_equal(points.positions, expected[:count])
    text = f"'{path}': holds more than the {count} rows of 'vertex' in its header; the rest was"
    assert len(points.warnings) == 1
    assert points.warnings[0].startswith(text)


def test_text_lines_that_are_too_long(tmp_path):
    with pytest.raises(ValueError, match=r"line 131.*: the header is longer than 1 MiB"):
        read(tmp_path, b"ply\nformat ascii 1.0\n" + b"comment\n" * 200_000)
    with pytest.raises(ValueError, match="line 10 is longer than 16 MiB; this is not a text file"):
        read(tmp_path, vertices()[:-5] + b" " * 40_000_000)


@pytest.mark.parametrize(
    ("row", "message"),
    [
        (b"-1 5", "line 11: camera 2 of 3: found a list of length -1"),
        (b"1.5 5", "line 11: camera 2 of 3: found a list of length 1.5"),
        (b"2 5", "line 11: camera 2 of 3: a list is longer than its line"),
        (b"1 5 5", "line 11: camera 2 of 3: found 3 values; 2 are needed"),
    ],
)
def test_damaged_lists(tmp_path, row, message):
    cameras = ("camera", [("char", "int", "some")], [([1],), ([5],), ([],)])
    contents = ply("ascii", [cameras, ("vertex", XYZ, CORNERS)])
    assert len(read(tmp_path, contents).positions) == 3
    with pytest.raises(ValueError, match=message):
        read(tmp_path, contents.replace(b"\n1 5\n", b"\n" + row + b"\n"))


def test_damaged_binary_lists(tmp_path):
    cameras = ("camera", [("int", "int", "some")], [([1],), ([5],)])
    contents = ply("binary_little_endian", [cameras, ("vertex", XYZ, CORNERS)])
    start = contents.index(b"end_header\n") + 11
    for length, message in [(-2, "length -2"), (10**9, "length 1e.09 is longer than the file")]:
        damaged = contents[:start] + length.to_bytes(4, "little", signed=True)
        with pytest.raises(ValueError, match=f"camera 1 of 2: .* {message}"):
            read(tmp_path, damaged + contents[start + 4 :])


def test_errors_of_the_system(tmp_path):
    with pytest.raises(OSError, match=r"none.ply': cannot be opened: No such file or directory"):
        prefilter.read_points(tmp_path / "none.ply")
    (tmp_path / "folder.ply").mkdir()
    with pytest.raises(OSError, match=r"folder.ply' is a folder; a regular file is needed"):
        prefilter.read_points(tmp_path / "folder.ply")
    if not hasattr(os, "mkfifo"):
        return
    os.mkfifo(tmp_path / "pipe.ply")
    with pytest.raises(OSError, match=r"pipe.ply' is a device or pipe; a regular file is needed"):
        prefilter.read_points(tmp_path / "pipe.ply")


def test_bad_arguments(tmp_path):
    with pytest.raises(ValueError, match="path: 7; the path of a file is needed"):
        prefilter.read_points(7)
    with pytest.raises(ValueError, match=r"cloud.stl': unsupported extension '.stl'; .*ply"):
        read(tmp_path, b"", "cloud.stl")
    with pytest.raises(ValueError, match="cloud': unsupported extension ''"):
        read(tmp_path, b"", "cloud")


def test_any_name_of_a_file(tmp_path):
    if os.name == "nt":
        pytest.skip("names are Unicode there, whatever they hold")
    name = os.fsdecode(b"b\xe4r ' \xf0.PLY")
    assert len(read(tmp_path, vertices(), name).positions) == 3
    with pytest.raises(ValueError, match=r"b\\xe4r"):
        read(tmp_path, b"", name)


def test_a_name_in_a_file_may_hold_any_bytes(tmp_path):
    contents = vertices(properties=[*XYZ, ("float", "QQ")], rows=[(1.0, 2.0, 3.0, 4.0)])
    points = read(tmp_path, contents.replace(b"QQ", b"\xff\xe4"))
    assert points.attributes == {"\\xff\\xe4": 4.0}


def some_files():
    rows = random_rows(["float", "float", "float", "uchar"], 5)
    for form in FORMATS:
        yield (
            f"{form}.ply",
            ply(
                form,
                [
                    ("camera", [("uchar", "int", "some")], [([1, 2],), ([],)]),
                    ("vertex", [*XYZ, ("uchar", "red")], rows),
                ],
            ),
        )


@pytest.mark.parametrize(("name", "contents"), some_files(), ids=FORMATS)
def test_garbled_files_are_read_or_refused(tmp_path, name, contents):
    garbled_are_refused(tmp_path, name, contents)


def test_a_range_scan(tmp_path):
    path = SHARED / "bunny" / "bun000.ply"
    if not path.exists():
        pytest.skip(f"{path} is missing")
    rows = path.read_text().split("end_header\n")[1].split("\n")[:40256]
    expected = np.array([row.split() for row in rows], np.float64)
    np.testing.assert_array_equal(prefilter.read_points(path).positions, expected)
    grid = read_range_grid(path)
    assert grid.shape == (400, 512)
    np.testing.assert_array_equal(np.sort(grid[grid >= 0]), np.arange(40256))
    # Neighbors in the grid are neighbors in space.
    both = (grid[:, :-1] >= 0) & (grid[:, 1:] >= 0)
    steps = expected[grid[:, 1:][both]] - expected[grid[:, :-1][both]]
    assert np.median(np.linalg.norm(steps, axis=1)) < 0.001


def test_headers_of_the_dragon(tmp_path):
    path = SHARED / "dragon_stand.tar.gz"
    if not path.exists():
        pytest.skip(f"{path} is missing")
    with tarfile.open(path) as archive:
        contents = archive.extractfile("dragon_stand/dragonStandRight_0.ply").read()
    scan = write(tmp_path, "dragon.ply", contents)
    assert len(prefilter.read_points(scan).positions) == 41841
    assert read_range_grid(scan).shape == (262, 483)


def range_scan(form="ascii", sizes=("num_rows 2", "num_cols 3"), last=2):
    grid = [([0],), ([],), ([1],), ([],), ([],), ([last],)]
    return ply(
        form,
        [
            ("vertex", XYZ, CORNERS),
            ("range_grid", [("uchar", "int", "vertex_indices")], grid),
        ],
        lines=["obj_info is_warped 0", *(f"obj_info {size}" for size in sizes)],
    )


@pytest.mark.parametrize("form", FORMATS)
def test_range_grids(tmp_path, form):
    path = write(tmp_path, "scan.ply", range_scan(form))
    np.testing.assert_array_equal(read_range_grid(path), [[0, -1, 1], [-1, -1, 2]])
    assert read_faces(path).shape == (0, 3)
    told = []
    read_range_grid(path, progress=told.append)
    assert sorted(told) == told
    np.testing.assert_array_equal(prefilter.read_points(path).positions, CORNERS)
    assert read_range_grid(write(tmp_path, "cloud.ply", vertices(form))) is None


@pytest.mark.parametrize(
    ("contents", "message"),
    [
        (range_scan(last=3), "range_grid 6 of 6: names point 3; there are 3, numbered from 0"),
        (range_scan(last=-1), "range_grid 6 of 6: names point -1"),
        (range_scan(sizes=["num_rows 2"]), "a range grid, but no line 'obj_info num_cols'"),
        (range_scan(sizes=["num_rows 2", "num_cols 2"]), "6 places; its header says 2 rows of 2"),
        (
            range_scan(sizes=["num_rows 2", "num_cols -3"]),
            "no line 'obj_info num_cols' with a whol",
        ),
        (range_scan(sizes=["num_rows 9223372036854775808", "num_cols 0"]), "num_rows' with a"),
        (
            range_scan(sizes=["num_rows 6148914691236517206", "num_cols 3"]),
            "says 61489146912365172",
        ),
        (range_scan(sizes=["num_rows 2", "num_cols 0"]), "header says 2 rows of 0"),
        (range_scan().replace(b"uchar int", b""), "line 11: 'vertex_indices' is not a type of PLY"),
        (range_scan().replace(b"vertex_ind", b"ind"), "range_grid has no list 'vertex_indices'"),
        (range_scan()[:-4], "range_grid 6 of 6: the file ends before it"),
    ],
    ids=str,
)
def test_damaged_range_grids(tmp_path, contents, message):
    path = write(tmp_path, "scan.ply", contents)
    with pytest.raises(ValueError, match=f"^'{re.escape(str(path))}'.*{message}"):
        read_range_grid(path)


@pytest.mark.parametrize("form", FORMATS)
@pytest.mark.parametrize("name", ["vertex_index", "vertex_indices"])
def test_faces_become_triangles(tmp_path, form, name):
    faces = [(0.5, [0, 1, 2]), (1.0, [3, 4, 2, 0]), (0.0, []), (0.0, [1, 2])]
    properties = [("float", "quality"), ("uchar", "uint", name)]
    elements = [("vertex", XYZ, random_rows(["float"] * 3, 5)), ("face", properties, faces)]
    path = write(tmp_path, "mesh.ply", ply(form, elements))
    np.testing.assert_array_equal(read_faces(path), [(0, 1, 2), (3, 4, 2), (3, 2, 0)])
    elements[1][2].append((0.0, [0, 1, 5]))
    with pytest.raises(ValueError, match=r"face 5 of 5: names point 5; there are 5, numbered"):
        read_faces(write(tmp_path, "mesh.ply", ply(form, elements)))
    elements[1][2].pop()
    with pytest.raises(ValueError, match="holds more than the 4 rows of 'face' in its header"):
        read_faces(write(tmp_path, "mesh.ply", ply(form, elements) + b"1"))


class Reader:
    """Points in chunks, as a reader of a format that the native module does not know."""

    count = None
    has_normals = True
    can_seek = False
    attributes = (("red", True), ("intensity", False))
    viewpoint = (1.0, 2.0, 3.0)

    def __init__(self, *sizes):
        self.sizes = sizes

    def chunks(self):
        random = np.random.default_rng(1)
        for size in self.sizes:
            yield (
                random.normal(size=(size, 3)),
                random.normal(size=(size, 3)).astype(np.float32),
                random.random(size).astype(np.float32),
                random.random((size, 3)),
                np.floor(255 * random.random((size, 2), np.float32)),
            )


def test_points_come_from_python_in_chunks_of_any_size():
    source = _native.PointSource(Reader(1, 0, 100_000, 7))
    assert source.attributes == [("red", True), ("intensity", False)]
    assert source.viewpoint == (1.0, 2.0, 3.0)
    chunks = [np.concatenate(each) for each in zip(*Reader(1, 0, 100_000, 7).chunks(), strict=True)]
    for _ in range(2):
        positions, normals, weights, viewpoints, attributes, _ = _native.read_points(
            source, 2**62, None
        )
        np.testing.assert_array_equal(positions, chunks[0])
        np.testing.assert_array_equal(normals, chunks[1])
        np.testing.assert_array_equal(weights, chunks[2])
        np.testing.assert_array_equal(viewpoints, chunks[3])
        np.testing.assert_array_equal(attributes["red"], chunks[4][:, 0].astype(np.uint8))
        np.testing.assert_array_equal(attributes["intensity"], chunks[4][:, 1])


@pytest.mark.parametrize("most", [1, 7, 70_000, 100_007, 100_008])
def test_a_file_is_thinned_while_it_is_read(most):
    """The stride is the smallest that will do where the number of points is known."""

    class Counted(Reader):
        count = 100_008

    source = _native.PointSource(Counted(1, 0, 100_000, 7))
    everything = _native.read_points(source, 2**62, None)
    *found, stride = _native.read_points(source, most, None)
    assert stride == -(-100_008 // most)
    for kept, of in zip(found[:4], everything[:4], strict=True):
        np.testing.assert_array_equal(kept, of[::stride])
    for name, values in found[4].items():
        np.testing.assert_array_equal(values, everything[4][name][::stride])


def test_text_is_thinned_while_it_is_read(tmp_path):
    """Lines are not counted before, so that the stride is a power of two."""
    path = tmp_path / "line.xyz"
    path.write_text("".join(f"{i} 0 {-i}\n" for i in range(200_000)))
    found = prefilter.read_points(path, most=30_000)
    assert found.stride == 8
    np.testing.assert_array_equal(found.positions[:, 0], np.arange(0, 200_000, 8))
    assert prefilter.read_points(path).stride == 1


@pytest.mark.parametrize("most", [0, -1, 1.5, True])
def test_limits_of_thinning(tmp_path, most):
    with pytest.raises(ValueError, match=r"most: .* a whole number above 0 is needed"):
        prefilter.read_points(tmp_path / "none.xyz", most=most)


def test_python_errors_are_passed_on():
    class Torn(Reader):
        def chunks(self):
            yield from super().chunks()
            raise RuntimeError("torn")

    with pytest.raises(RuntimeError, match="torn"):
        _native.read_points(_native.PointSource(Torn(5)), 2**62, None)

    class Short(Reader):
        def chunks(self):
            for positions, normals, weights, *rest in super().chunks():
                yield positions, normals, weights[1:], *rest

    with pytest.raises(ValueError, match="arrays of a chunk have different lengths"):
        _native.read_points(_native.PointSource(Short(5)), 2**62, None)
