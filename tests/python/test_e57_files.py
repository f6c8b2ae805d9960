# SPDX-License-Identifier: GPL-3.0-or-later

"""Points of E57 files, read without Python modules."""

import numpy as np
import prefilter
import pytest
from e57_files import Floating, Number, e57, paged, pose_xml
from scan_writers import write

COUNT = 5000
QUARTER = (0.5**0.5, 0.0, 0.0, 0.5**0.5)
RANDOM = np.random.default_rng(1)
STEPS = RANDOM.integers(-100_000, 100_001, (COUNT, 3))
XYZ = ("cartesianX", "cartesianY", "cartesianZ")


def floating(values=None, precision="double"):
    values = RANDOM.normal(size=(COUNT, 3)) if values is None else values
    return {n: Floating(v.tolist(), precision) for n, v in zip(XYZ, values.T, strict=True)}


def read(tmp_path, *scans, **more):
    return prefilter.read_points(write(tmp_path, "scan.e57", e57(scans, **more)))


@pytest.mark.parametrize("per_packet", [16, 701, 60_000 // 8])
def test_values_of_all_kinds(tmp_path, per_packet):
    """Numbers of 18, 1, 3 and 12 bits, scaled or not, and none at all where all are the same."""
    count = COUNT if per_packet > 16 else 300
    steps = STEPS[:count]
    reds = RANDOM.integers(0, 4096, count)
    returns = RANDOM.integers(0, 5, count)
    invalid = (RANDOM.random(count) < 0.2).astype(int)
    fields = {
        n: Number(v.tolist(), -100_000, 100_000, 0.001, 5.0)
        for n, v in zip(XYZ, steps.T, strict=True)
    }
    fields |= {
        "cartesianInvalidState": Number(invalid.tolist(), 0, 2),
        "intensity": Floating(RANDOM.random(count).tolist(), "single"),
        "colorRed": Number(reds.tolist(), 0, 4095),
        "colorGreen": Number([7] * count, 7, 7),
        "colorBlue": Number([0] * count, 0, 0),
        "returnIndex": Number(returns.tolist(), 0, 4),
        "returnCount": Number([5] * count, 0, 5),
        "nor:normalX": Floating([1.0] * count),
        "nor:normalY": Floating([0.0] * count, "single"),
        "nor:normalZ": Number([0] * count, -(2**63), 2**63 - 1),
    }
    limits = "".join(
        f'<color{c}Maximum type="Integer">4095</color{c}Maximum>' for c in ("Red", "Green", "Blue")
    )
    more = f'<colorLimits type="Structure">{limits}</colorLimits>'
    more += pose_xml(QUARTER, (1000.0, 0.0, -3.0))
    points = read(tmp_path, (fields, more), per_packet=per_packet)
    kept = invalid == 0
    x, y, z = (steps[kept] * 0.001 + 5.0).T
    np.testing.assert_allclose(points.positions, np.stack([1000 - y, x, z - 3], axis=1), atol=1e-9)
    np.testing.assert_array_equal(points.attributes["red"], np.round(reds[kept] * (255 / 4095)))
    assert set(points.attributes["green"]) == {0}
    expected = np.array(fields["intensity"].values, np.float32)[kept]
    np.testing.assert_array_equal(points.attributes["intensity"], expected)
    np.testing.assert_array_equal(points.attributes["return_number"], returns[kept] + 1)
    np.testing.assert_allclose(points.normals, [(0, 1, 0)] * kept.sum(), atol=1e-7)
    np.testing.assert_array_equal(points.viewpoint, [1000, 0, -3])


def test_more_points_than_are_read_at_once(tmp_path):
    steps = RANDOM.integers(0, 8, (140_001, 3))
    fields = {n: Number(v.tolist(), 0, 7) for n, v in zip(XYZ, steps.T, strict=True)}
    # The numbers of all pages together would take minutes bit by bit.
    points = read(tmp_path, (fields, ""), per_packet=20_000)
    np.testing.assert_array_equal(points.positions, steps)


def test_spherical_coordinates_face_the_scanner(tmp_path):
    angles = RANDOM.uniform(-1.0, 1.0, (COUNT, 2))
    fields = {
        "sphericalRange": Floating([2.0] * COUNT),
        "sphericalAzimuth": Floating(angles[:, 0].tolist()),
        "sphericalElevation": Floating(angles[:, 1].tolist()),
    }
    points = read(tmp_path, (fields, ""))
    azimuth, elevation = angles.T
    expected = 2.0 * np.stack(
        [
            np.cos(elevation) * np.cos(azimuth),
            np.cos(elevation) * np.sin(azimuth),
            np.sin(elevation),
        ],
        axis=1,
    )
    np.testing.assert_allclose(points.positions, expected, atol=1e-12)
    np.testing.assert_array_equal(points.viewpoint, [0, 0, 0])


GRID = {
    "rowIndex": Number(list(range(COUNT)), 0, COUNT),
    "columnIndex": Number([0] * COUNT, 0, 9),
}


@pytest.mark.parametrize(
    ("more", "text", "viewpoint"),
    [
        ({}, "", None),
        ({}, pose_xml((1, 0, 0, 0), (0, 0, 0)), None),
        ({}, pose_xml((1, 0, 0, 0), (1, 2, 3)), (1, 2, 3)),
        (GRID, "", (0, 0, 0)),
        (GRID, pose_xml((1, 0, 0, 0), (0, 0, 0)), (0, 0, 0)),
    ],
)
def test_viewpoints(tmp_path, more, text, viewpoint):
    points = read(tmp_path, ({**floating(), **more}, text))
    found = points.viewpoint
    assert found is None if viewpoint is None else tuple(found) == viewpoint


def test_several_scans(tmp_path):
    first, second = floating(), floating(precision="single")
    points = read(
        tmp_path,
        ({**first, "intensity": Floating([0.5] * COUNT)}, pose_xml((1, 0, 0, 0), (0, 0, 5))),
        (second, pose_xml((2, 0, 0, 0), (0, 0, 0))),
    )
    assert points.attributes == {}
    expected = np.stack([np.array(first[n].values) for n in XYZ], axis=1)
    expected[:, 2] += 5.0
    np.testing.assert_allclose(points.positions[:COUNT], expected, atol=1e-12)
    rest = np.stack([np.array(second[n].values, np.float32) for n in XYZ], axis=1)
    np.testing.assert_array_equal(points.positions[COUNT:], rest)
    np.testing.assert_array_equal(points.viewpoint[[0, -1]], [(0, 0, 5), (0, 0, 0)])


def test_a_surface_of_a_file(tmp_path):
    ball = RANDOM.normal(size=(4000, 3))
    ball /= np.linalg.norm(ball, axis=1)[:, None]
    path = write(tmp_path, "ball.e57", e57([(floating(ball + 5.0), "")]))
    report = prefilter.reconstruct_file(path, tmp_path / "ball.ply", depth=5)
    assert report.points == 4000
    assert report.directions == ("outward",)


WHOLE = e57([(floating(), "")])


def changed(begin: int, data: bytes) -> bytes:
    return WHOLE[:begin] + data + WHOLE[begin + len(data) :]


@pytest.mark.parametrize(
    ("contents", "message"),
    [
        (b"", "it begins with b''"),
        (b"garbage" * 1000, "it begins with b'garbage"),
        (WHOLE[:-1024], r"it has \d+ of the \d+ bytes in its header"),
        (changed(3000, b"???"), "the checksum of page 2 does not agree"),
        (WHOLE.replace(b"1.0", b"1.1", 1), "the checksum of page 0|the checksum of page"),
        (e57([({"cartesianX": Floating([1.0])}, "")]), "neither Cartesian nor spherical"),
    ],
    ids=["empty", "garbage", "cut", "flipped", "text", "one axis"],
)
def test_damaged_files(tmp_path, contents, message):
    with pytest.raises(ValueError, match=rf"scan.e57'.*({message})"):
        prefilter.read_points(write(tmp_path, "scan.e57", contents))


@pytest.mark.parametrize(
    ("count", "message"),
    [
        (b"9999", "a scan ends after 5000 of the 9999 points in its header"),
        (b"9999999999999999", "too short for the 9999999999999999 points of a scan"),
    ],
)
def test_files_of_fewer_points_than_they_say(tmp_path, count, message):
    pages = b"".join(WHOLE[k : k + 1020] for k in range(0, len(WHOLE), 1024))
    begin = pages.index(b"<?xml")
    text = pages[begin:].rstrip(b"\0").replace(b'"5000"', b'"' + count + b'"')
    head = pages[:32] + len(text).to_bytes(8, "little") + pages[40:begin]
    size = -(-(begin + len(text)) // 1020) * 1024
    head = head[:16] + size.to_bytes(8, "little") + head[24:]
    with pytest.raises(ValueError, match=message):
        prefilter.read_points(write(tmp_path, "scan.e57", paged(head + text)))


def test_garbled_files_are_read_or_refused(tmp_path):
    small = e57([(floating(np.zeros((20, 3))), "")])
    pages = b"".join(small[k : k + 1020] for k in range(0, len(small), 1024))
    random = np.random.default_rng(7)
    refused = []
    for _ in range(150):
        garbled = bytearray(pages)
        for at in random.integers(0, len(pages), 3):
            garbled[at] = random.integers(0, 256)
        # Valid checksums, so that reading goes on past them.
        path = write(tmp_path, "scan.e57", paged(bytes(garbled)))
        try:
            points = prefilter.read_points(path)
        except ValueError as error:
            refused.append(str(error))
        else:
            assert len(points.positions) <= 20
    assert len(refused) > 5
    assert all("scan.e57" in message for message in refused)
