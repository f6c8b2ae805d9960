# SPDX-License-Identifier: GPL-3.0-or-later

"""Points of LAS, LAZ and E57 files, as the Python modules write these that can be imported."""

import os
import subprocess
import sys

import numpy as np
import prefilter
import pytest
from e57_files import checksum

COUNT = 150_000  # More than are read at once.


def random_points(seed=0, count=COUNT):
    return np.random.default_rng(seed).normal(size=(count, 3)) * 100 + (500_000, 5_000_000, 100)


@pytest.fixture
def laspy():
    return pytest.importorskip("laspy", reason="laspy cannot be imported")


@pytest.fixture
def pye57():
    return pytest.importorskip("pye57", reason="pye57 cannot be imported")


def las_file(laspy, path, *, version=2, color=None, normals=None, positions=None):
    positions = random_points() if positions is None else positions
    header = laspy.LasHeader(point_format=version, version="1.4" if version > 5 else "1.2")
    header.offsets, header.scales = np.array([500_000, 5_000_000, 0]), np.full(3, 0.001)
    for name in ("NormalX", "NormalY", "NormalZ", "amplitude") if normals is not None else ():
        header.add_extra_dim(laspy.ExtraBytesParams(name=name, type=np.float32))
    las = laspy.LasData(header)
    las.x, las.y, las.z = positions.T
    las.intensity = np.arange(len(positions)) % 65536
    las.classification = np.arange(len(positions)) % 19
    las.number_of_returns = np.arange(len(positions)) % 7 + 1
    las.return_number = np.arange(len(positions)) % np.array(las.number_of_returns) + 1
    if color is not None:
        las.red, las.green, las.blue = color.T
    if normals is not None:
        las.NormalX, las.NormalY, las.NormalZ = normals.T
        las.amplitude = normals[:, 0] * 7
    las.write(path)
    return positions


@pytest.mark.parametrize("ending", [".las", ".laz"])
def test_las_files(laspy, tmp_path, ending):
    if ending == ".laz":
        pytest.importorskip("lazrs", reason="lazrs cannot be imported")
    path = tmp_path / f"cloud{ending}"
    normals = np.random.default_rng(3).normal(size=(COUNT, 3)).astype(np.float32)
    color = np.random.default_rng(4).integers(0, 65536, (COUNT, 3))
    expected = las_file(laspy, path, version=7, color=color, normals=normals)
    points = prefilter.read_points(path)
    np.testing.assert_allclose(points.positions, expected, atol=0.00051, rtol=0)
    np.testing.assert_array_equal(points.normals, normals)
    np.testing.assert_array_equal(points.colors, np.round(color / 257))
    assert points.colors.dtype == np.uint8
    assert list(points.attributes) == [
        *("intensity", "amplitude", "classification", "return_number", "number_of_returns"),
        *("red", "green", "blue"),
    ]
    np.testing.assert_array_equal(points.attributes["intensity"], np.arange(COUNT) % 65536)
    np.testing.assert_array_equal(points.attributes["classification"], np.arange(COUNT) % 19)
    of = np.arange(COUNT) % 7 + 1
    np.testing.assert_array_equal(points.attributes["number_of_returns"], of)
    np.testing.assert_array_equal(points.attributes["return_number"], np.arange(COUNT) % of + 1)
    last = prefilter.read_points(path, returns="last", classes=[2, 3]).positions
    chosen = (np.arange(COUNT) % of + 1 == of) & np.isin(np.arange(COUNT) % 19, [2, 3])
    np.testing.assert_array_equal(last, points.positions[chosen])
    np.testing.assert_array_equal(points.attributes["amplitude"], normals[:, 0] * np.float32(7))
    assert points.viewpoint is None
    assert points.is_from_above


def test_las_files_without_more(laspy, tmp_path):
    path = tmp_path / "cloud.las"
    expected = las_file(laspy, path, version=0, positions=random_points(count=10))
    points = prefilter.read_points(path)
    np.testing.assert_allclose(points.positions, expected, atol=0.00051, rtol=0)
    assert points.normals is points.colors is None
    las_file(laspy, path, positions=np.zeros((0, 3)), color=np.zeros((0, 3), np.uint16))
    assert len(prefilter.read_points(path).positions) == 0


def test_las_colors_of_eight_bits(laspy, tmp_path):
    path = tmp_path / "cloud.las"
    color = np.random.default_rng(4).integers(0, 256, (COUNT, 3))
    las_file(laspy, path, color=color)
    np.testing.assert_array_equal(prefilter.read_points(path).colors, color)


@pytest.mark.filterwarnings("error")
def test_overflowing_scales_give_no_numpy_warnings(laspy, tmp_path):
    path = tmp_path / "cloud.las"
    las_file(laspy, path, positions=random_points(count=50))
    contents = path.read_bytes()
    path.write_bytes(contents[:131] + np.float64(1e308).tobytes() + contents[139:])
    assert not np.isfinite(prefilter.read_points(path).positions[:, 0]).all()


def with_long_record(laspy, path):
    """Returns a file with an extended record of almost 2^63 bytes."""
    las_file(laspy, path, version=7, positions=random_points(count=50))
    contents = path.read_bytes()
    record = bytes(20) + (2**63 - 1).to_bytes(8, "little") + bytes(32)
    place = len(contents).to_bytes(8, "little") + (1).to_bytes(4, "little")
    return contents[:235] + place + contents[247:] + record


def test_damaged_las_files(laspy, tmp_path):
    path = tmp_path / "cloud.las"
    las_file(laspy, path, positions=random_points(count=50))
    contents = path.read_bytes()
    assert len(prefilter.read_points(path).positions) == 50
    records = contents[:100] + b"\xff\xff\xff\xff" + contents[104:]
    # Where points begin: laspy would take so much memory before it reads.
    far = contents[:96] + b"\xff\xff\xff\xff" + contents[100:]
    for damaged, message in [
        (b"", "is not a LAS file: it begins with b''"),
        (b"garbage" * 1000, "is not a LAS file: it begins with b'garb'"),
        (contents[:200], "is not a LAS file"),
        (contents[:-100], r"too short for the 50 points in its header: \d+ bytes follow it"),
        (records, "too short for the records that its header announces"),
        (far, "too short for the records that its header announces"),
        (contents[:104] + b"\x7f" + contents[105:], "cannot be read as a LAS file"),
        (with_long_record(laspy, path), "too short for the records that its header announces"),
    ]:
        path.write_bytes(damaged)
        with pytest.raises(ValueError, match=f"cloud.las'.*{message}"):
            prefilter.read_points(path)


# On damaged files lazrs may end the process, so another process reads them.
_READ_DAMAGED = """
import resource, sys
import prefilter

resource.setrlimit(resource.RLIMIT_AS, (4 << 30, 4 << 30))
for path in sys.argv[1:]:
    try:
        prefilter.read_points(path)
    except ValueError as error:
        assert path in str(error), error
print("read", len(sys.argv) - 1)
"""


def damaged(contents: bytes, random: np.random.Generator) -> bytes:
    """Returns a file with a bit flipped, a byte replaced, or a number that is far too large."""
    found = bytearray(contents)
    for _ in range(random.integers(1, 4)):
        place = int(random.integers(0, len(found) - 8))
        kind = random.integers(0, 4)
        if kind == 0:
            found[place] ^= 1 << int(random.integers(0, 8))
        elif kind == 1:
            found[place] = random.integers(0, 256)
        elif kind == 2:
            found[place : place + 4] = int(random.choice([0, 1 << 30, (1 << 32) - 1])).to_bytes(
                4, "little"
            )
        else:
            found[place : place + 8] = int(random.choice([1 << 40, (1 << 63) - 1])).to_bytes(
                8, "little"
            )
    return bytes(found)


@pytest.mark.skipif(sys.platform == "win32", reason="has no limit of memory for a process")
@pytest.mark.parametrize("point_format", [3, 6])
def test_damaged_laz_files_end_no_process(laspy, tmp_path, point_format):
    pytest.importorskip("lazrs", reason="lazrs cannot be imported")
    random = np.random.default_rng(point_format)
    whole = tmp_path / "whole.laz"
    las = laspy.create(point_format=point_format)
    las.x, las.y, las.z = random.normal(size=(3, 25))
    las.write(whole)
    contents = whole.read_bytes()
    paths = [tmp_path / f"{number}.laz" for number in range(250)]
    for path in paths:
        path.write_bytes(damaged(contents, random))
    read = subprocess.run(
        [sys.executable, "-c", _READ_DAMAGED, whole, *paths],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )
    assert read.stdout == f"read {len(paths) + 1}\n", read.stderr[-2000:]


def test_laz_files_whose_chunks_do_not_agree(laspy, tmp_path):
    pytest.importorskip("lazrs", reason="lazrs cannot be imported")
    path = tmp_path / "cloud.laz"
    las_file(laspy, path, positions=random_points(count=COUNT))
    contents = path.read_bytes()
    assert len(prefilter.read_points(path).positions) == COUNT
    begin = int.from_bytes(contents[96:100], "little")
    table = int.from_bytes(contents[begin : begin + 8], "little")
    record = contents.index(b"laszip encoded") - 2 + 54

    def with_number(place: int, number: int, size: int) -> bytes:
        return contents[:place] + number.to_bytes(size, "little") + contents[place + size :]

    for broken, message in [
        (with_number(table + 4, 0xFFFFFFFF, 4), "too short for the 4294967295 chunks of its table"),
        (with_number(begin, len(contents), 8), f"their table at {len(contents)}, and it has"),
        (with_number(record + 12, 1 << 30, 4), "a chunk of 1073741824 points; at most 4194304"),
        (with_number(record + 12, COUNT // 2, 4), f"points for the {COUNT} in its header"),
        (with_number(table + 4, 100_000, 4), "too short for the 100000 chunks of its table"),
        (with_number(record, 1, 2), "compressor 1 is not one of 2, 3"),
        (with_number(record + 32, 0, 2), "its compressed points have 0 bytes"),
    ]:
        path.write_bytes(broken)
        with pytest.raises(ValueError, match=f"cloud.laz'.*{message}"):
            prefilter.read_points(path)


def test_laz_files_whose_layers_leave_no_room_for_their_sizes(laspy, tmp_path):
    pytest.importorskip("lazrs", reason="lazrs cannot be imported")
    path = tmp_path / "cloud.laz"
    las = laspy.create(point_format=6)
    las.x, las.y, las.z = random_points(count=100).T
    las.write(path)
    contents = path.read_bytes()
    begin = int.from_bytes(contents[96:100], "little") + 8
    size = int.from_bytes(contents[begin - 8 : begin], "little") - begin
    sizes = begin + 30 + 4
    layers = [int.from_bytes(contents[at : at + 4], "little") for at in range(sizes, sizes + 36, 4)]
    assert 30 + 4 + 36 + sum(layers) == size
    last = size - sum(layers[:-1])
    path.write_bytes(contents[: sizes + 32] + last.to_bytes(4, "little") + contents[sizes + 36 :])
    with pytest.raises(ValueError, match=f"chunk 0 has {size} bytes, and its layers {size}"):
        prefilter.read_points(path)


def e57_scan(seed, *, with_color=True, **more):
    random = np.random.default_rng(seed)
    data = {f"cartesian{axis}": random.normal(size=COUNT).astype(np.float32) for axis in "XYZ"}
    data["intensity"] = random.random(COUNT).astype(np.float32)
    if with_color:
        for name in ("Red", "Green", "Blue"):
            data[f"color{name}"] = random.integers(0, 256, COUNT).astype(np.uint8)
    return {name: np.asarray(values) for name, values in {**data, **more}.items()}


def test_e57_files(pye57, tmp_path):
    path = tmp_path / "scan.e57"
    # A quarter turn around z.
    turn = np.array([0.5**0.5, 0.0, 0.0, 0.5**0.5])
    invalid = (np.arange(COUNT) % 3 == 0).astype(np.int8)
    first, second = e57_scan(1, cartesianInvalidState=invalid), e57_scan(2)
    with pye57.E57(str(path), mode="w") as file:
        file.write_scan_raw(first, rotation=turn, translation=np.array([1000.0, 2000.0, 30.0]))
        file.write_scan_raw(second, rotation=[1, 0, 0, 0], translation=np.array([0.0, 0.0, 5.0]))
    points = prefilter.read_points(path)
    kept = invalid == 0
    x, y, z = (first[f"cartesian{axis}"][kept].astype(float) for axis in "XYZ")
    expected = np.concatenate(
        [
            np.stack([1000 - y, 2000 + x, 30 + z], axis=1),
            np.stack([second[f"cartesian{axis}"] for axis in "XYZ"], axis=1)
            + np.array([0, 0, 5.0]),
        ]
    )
    np.testing.assert_allclose(points.positions, expected, atol=1e-9, rtol=1e-12)
    for name in ("Red", "Green", "Blue"):
        values = np.concatenate([first[f"color{name}"][kept], second[f"color{name}"]])
        np.testing.assert_array_equal(points.attributes[name.lower()], values)
        assert points.attributes[name.lower()].dtype == np.uint8
    intensity = np.concatenate([first["intensity"][kept], second["intensity"]])
    np.testing.assert_array_equal(points.attributes["intensity"], intensity)
    assert points.viewpoint.shape == points.positions.shape
    np.testing.assert_array_equal(points.viewpoint[: kept.sum()], [[1000, 2000, 30]] * kept.sum())
    np.testing.assert_array_equal(points.viewpoint[kept.sum() :], [[0, 0, 5]] * COUNT)


def test_one_scan_has_one_viewpoint(pye57, tmp_path):
    path = tmp_path / "scan.e57"
    with pye57.E57(str(path), mode="w") as file:
        file.write_scan_raw(e57_scan(1), translation=np.array([1.0, 2.0, 3.0]))
    np.testing.assert_array_equal(prefilter.read_points(path).viewpoint, [1, 2, 3])
    with pye57.E57(str(path), mode="w") as file:
        file.write_scan_raw(e57_scan(1))
    assert prefilter.read_points(path).viewpoint is None
    with pye57.E57(str(path), mode="w") as file:
        file.write_scan_raw(e57_scan(1))
        file.write_scan_raw(e57_scan(2, with_color=False))
    points = prefilter.read_points(path)
    assert points.colors is None
    assert list(points.attributes) == ["intensity"]
    np.testing.assert_array_equal(points.viewpoint, [0, 0, 0])


def with_text(contents, replaced):
    """An E57 file with other text in its description, which stays as long: blanks give way."""
    pages = b"".join(contents[k : k + 1020] for k in range(0, len(contents), 1024))
    begin = pages.index(b"<?xml")
    length = int.from_bytes(pages[32:40], "little")
    text = pages[begin : begin + length]
    for old, new in replaced.items():
        assert old in text
        text = text.replace(old, new)
    for _ in range(len(text) - length):
        text = text.replace(b"\n ", b"\n", 1)
    pages = pages[:begin] + text + pages[begin + length :]
    starts = range(0, len(pages), 1020)
    return b"".join(pages[k : k + 1020] + checksum(pages[k : k + 1020]) for k in starts)


def test_returns_in_e57_files_count_from_one(pye57, tmp_path):
    path = tmp_path / "scan.e57"
    count = 300
    returns = np.arange(count) % 3
    scan = {name: values[:count] for name, values in e57_scan(1).items()}
    scan |= {"rowIndex": returns, "columnIndex": np.full(count, 3)}
    with pye57.E57(str(path), mode="w") as file:
        file.write_scan_raw(scan)
    # pye57 writes no returns, but numbers as these are.
    names = {b"rowIndex": b"returnIndex", b"columnIndex": b"returnCount"}
    path.write_bytes(with_text(path.read_bytes(), names))
    points = prefilter.read_points(path)
    np.testing.assert_array_equal(points.attributes["return_number"], returns + 1)
    np.testing.assert_array_equal(points.attributes["number_of_returns"], 3)
    first = prefilter.read_points(path, returns="first").positions
    np.testing.assert_array_equal(first, points.positions[returns == 0])


@pytest.mark.parametrize(
    ("count", "message"),
    [
        (b"99", "a scan ends after 50 of the 99 points in its header"),
        (b"999999999999", "too short for the 999999999999 points of a scan in its header"),
    ],
)
def test_e57_files_of_fewer_points_than_they_say(pye57, tmp_path, count, message):
    path = tmp_path / "scan.e57"
    with pye57.E57(str(path), mode="w") as file:
        file.write_scan_raw({name: values[:50] for name, values in e57_scan(1).items()})
    announced = {b'recordCount="50"': b'recordCount="' + count + b'"'}
    path.write_bytes(with_text(path.read_bytes(), announced))
    with pytest.raises(ValueError, match=rf"scan.e57'.*{message}"):
        prefilter.read_points(path)


def test_damaged_e57_files(pye57, tmp_path):
    path = tmp_path / "scan.e57"
    with pye57.E57(str(path), mode="w") as file:
        file.write_scan_raw({name: values[:50] for name, values in e57_scan(1).items()})
    contents = path.read_bytes()
    for damaged in (b"", b"garbage" * 1000, contents[:-1000], contents[:3000]):
        path.write_bytes(damaged)
        with pytest.raises(ValueError, match=r"scan.e57' cannot be read as an E57 file"):
            prefilter.read_points(path)
        assert path.read_bytes() == damaged
