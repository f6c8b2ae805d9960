# SPDX-License-Identifier: GPL-3.0-or-later

"""Points that are vertices of PLY and OBJ files, and splats."""

import gzip

import numpy as np
import prefilter
import prefilter.points.scan_files
import pytest
from scan_writers import (
    COLORS,
    NORMALS,
    POINTS,
    garbled_are_refused,
    pcd,
    ply,
    write,
)


@pytest.mark.parametrize("scale", [1, 257])
@pytest.mark.parametrize("form", ["ply", "text", "pcd"])
def test_colors_of_16_bits_become_bytes(tmp_path, scale, form):
    """Some programs use only the lower 8 of 16 bits; the first million points decide."""
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
    # Several gzip members in sequence, as cat and pigz write them.
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
