# SPDX-License-Identifier: GPL-3.0-or-later

"""Files of points in formats whose readers the extension brings along."""

import io

import bpy
import clouds
import numpy as np
import pytest
from e57_files import Floating, e57
from las_files import OFFSETS, SCALES, las

COUNT = 3000


@pytest.fixture
def steps():
    """Points of a torus, in steps of a millimeter and more."""
    positions, _ = clouds.torus(COUNT)
    return np.round(positions / (SCALES[0], SCALES[1], 0.01)).astype(int)


def packed(contents: bytes, count: int) -> bytes:
    """A LAZ file of a LAS file's points of format 6, which the extension's lazrs packs."""
    import lazrs

    record = lazrs.LazVlr.new_for_compression(6, 0)
    data = record.record_data()
    data = data.tobytes() if hasattr(data, "tobytes") else bytes(data)
    head = bytearray(contents[:375])
    head[104] |= 0x80
    listed = bytes(2) + b"laszip encoded".ljust(16, b"\0")
    listed += (22204).to_bytes(2, "little") + len(data).to_bytes(2, "little") + bytes(32) + data
    head[96:100] = (375 + len(listed)).to_bytes(4, "little")
    head[100:104] = (1).to_bytes(4, "little")
    target = io.BytesIO(bytes(head) + listed)
    target.seek(0, io.SEEK_END)
    compressor = lazrs.LasZipCompressor(target, record)
    compressor.compress_many(np.frombuffer(contents[375:], np.uint8))
    compressor.done()
    return target.getvalue()


@pytest.mark.parametrize("ending", [".las", ".laz"])
def test_airborne_scans_open_as_installed(tmp_path, steps, ending, capfd):
    path = tmp_path / f"tile{ending}"
    contents = las([{"xyz": row} for row in steps.tolist()], 6)
    path.write_bytes(contents if ending == ".las" else packed(contents, COUNT))
    assert bpy.ops.prefilter.import_points(filepath=str(path)) == {"FINISHED"}
    made = bpy.context.object
    found = clouds.points(made) + np.array(made["scan_offset"])
    np.testing.assert_allclose(found, steps * SCALES + OFFSETS, atol=1e-3)
    assert f"Imported {COUNT} points from 'tile{ending}'" in capfd.readouterr().out


def test_scanners_files_open_as_installed(tmp_path):
    positions, _ = clouds.torus(COUNT)
    names = ("cartesianX", "cartesianY", "cartesianZ")
    fields = {n: Floating(v.tolist()) for n, v in zip(names, positions.T, strict=True)}
    path = tmp_path / "scan.e57"
    path.write_bytes(e57([(fields, "")]))
    assert bpy.ops.prefilter.import_points(filepath=str(path)) == {"FINISHED"}
    np.testing.assert_allclose(clouds.points(bpy.context.object), positions, atol=1e-6)


def test_a_surface_says_what_was_left_out(tmp_path, capfd):
    positions, _ = clouds.torus(COUNT)
    points = np.concatenate([positions + np.array([5.0, 0.0, 0.0]), np.zeros((500, 3))])
    path = clouds.file(tmp_path / "torus.xyz", points)
    bpy.ops.prefilter.import_points(filepath=str(path))
    bpy.context.object.location = (1.0, 2.0, 3.0)
    bpy.context.view_layer.update()
    assert bpy.ops.prefilter.reconstruct() == {"FINISHED"}
    printed = capfd.readouterr().out
    assert "left out, because they are all at one place, (1, 2, 3), as scanners write" in printed
    assert "saw nothing: 500 points" in printed
