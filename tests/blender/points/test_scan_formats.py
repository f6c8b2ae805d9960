# SPDX-License-Identifier: GPL-3.0-or-later

"""Files of points in formats whose readers the extension brings along."""

import bpy
import clouds
import numpy as np
import pytest
from e57_files import Floating, e57
from las_files import OFFSETS, SCALES, las
from scan_files import COUNT, packed_las


@pytest.fixture
def steps():
    """Points of a torus, in steps of a millimeter and more."""
    positions, _ = clouds.torus(COUNT)
    return np.round(positions / (SCALES[0], SCALES[1], 0.01)).astype(int)


@pytest.mark.parametrize("ending", [".las", ".laz"])
def test_airborne_scans_open_as_installed(tmp_path, steps, ending, capfd):
    path = tmp_path / f"tile{ending}"
    contents = las([{"xyz": row} for row in steps.tolist()], 6)
    path.write_bytes(contents if ending == ".las" else packed_las(contents, COUNT))
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
