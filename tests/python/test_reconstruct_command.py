# SPDX-License-Identifier: GPL-3.0-or-later

"""The command `reconstruct`, against the file that the package's function writes."""

import gzip

import clouds
import numpy as np
import prefilter
import pytest
from command_files import fails, run
from scan_writers import ply


@pytest.fixture
def scan(tmp_path):
    positions, normals = clouds.sphere(3000).both
    path = tmp_path / "scan.xyz"
    np.savetxt(path, np.hstack([positions, normals]), fmt="%.9g")
    return path


def test_command_writes_the_same_file_as_the_package(scan, tmp_path, capsys):
    out, expected = tmp_path / "out.ply", tmp_path / "expected.ply"
    assert (
        run("reconstruct", scan, "-o", out, "--depth", "5", "--no-fit", "--isovalue", "half") == 0
    )
    told = capsys.readouterr()
    assert "Reconstructed 'out.ply' from 3000 points at depth 5, in cells of 0." in told.out
    assert "100 %" in told.err
    prefilter.reconstruct_file(scan, expected, depth=5, fit=False, isovalue="half")
    assert out.read_bytes() == expected.read_bytes()


def test_several_sources_and_a_size(scan, tmp_path, capsys):
    other = tmp_path / "other.xyz"
    other.write_bytes(scan.read_bytes())
    out, expected = tmp_path / "out.ply", tmp_path / "expected.ply"
    assert run("reconstruct", scan, other, "-o", out, "--voxel-size", "0.1") == 0
    assert "read 'scan.xyz', 'other.xyz'" in capsys.readouterr().out
    prefilter.reconstruct_file([scan, other], expected, cell_size=0.1)
    assert out.read_bytes() == expected.read_bytes()


def test_an_isovalue_of_ones_own(scan, tmp_path):
    out, expected = tmp_path / "out.ply", tmp_path / "expected.ply"
    assert run("reconstruct", scan, "-o", out, "--depth", "5", "--custom-isovalue", "0.3") == 0
    prefilter.reconstruct_file(scan, expected, depth=5, isovalue=0.3)
    assert out.read_bytes() == expected.read_bytes()


def test_normals_face_a_viewpoint(tmp_path, capsys):
    """Each file has a viewpoint, inside its ball: the balls come out hollow."""
    scans = []
    for k, x in enumerate((0.0, 4.0)):
        scans.append(tmp_path / f"{k}.xyz")
        np.savetxt(scans[k], clouds.sphere(3000, center=(x, 0, 0)).points, fmt="%.9g")
    out, expected = tmp_path / "out.ply", tmp_path / "expected.ply"
    places = [[0.1, 0.0, 0.0], [4.1, 0.0, 0.0]]
    flags = [part for place in places for part in ("--viewpoint", *map(str, place))]
    assert run("reconstruct", *scans, "-o", out, "--depth", "6", *flags) == 0
    assert "normals point to the scanner" in capsys.readouterr().out
    prefilter.reconstruct_file(scans, expected, depth=6, viewpoint=places)
    assert out.read_bytes() == expected.read_bytes()
    assert prefilter.reconstruct_file(scans, expected, depth=6, direction="outward")
    assert out.read_bytes() != expected.read_bytes()
    told = fails(capsys, 1, "reconstruct", *scans, "-o", out, "--direction", "given")
    assert "Normals: 'given', but there are points without normals" in told
    told = fails(capsys, 1, "reconstruct", *scans, "-o", out, *flags, *flags)
    assert "viewpoint: found 4 for 2 sources" in told


def test_points_that_are_chosen(tmp_path, capsys):
    positions, normals = clouds.sphere(6000).both
    of = np.arange(6000) % 3 + 1
    columns = [positions, normals, np.arange(6000) % 4, np.arange(6000) % of + 1, of]
    names = "x,y,z,nx,ny,nz,classification,return_number,number_of_returns"
    scan, out, expected = (tmp_path / name for name in ("a.csv", "out.ply", "expected.ply"))
    np.savetxt(scan, np.column_stack(columns), fmt="%.9g", delimiter=",", header=names, comments="")
    box = ["-1", "-1", "-0.5", "1", "1", "0.9"]
    choice = ("--classes", "1, 3", "--returns", "last", "--box", *box)
    assert run("reconstruct", scan, "-o", out, "--depth", "4", "--trim", "3", *choice) == 0
    corners = [[-1, -1, -0.5], [1, 1, 0.9]]
    report = prefilter.reconstruct_file(
        scan, expected, depth=4, trim=3.0, classes=[1, 3], returns="last", box=corners
    )
    assert out.read_bytes() == expected.read_bytes()
    assert f"from {report.points} points" in capsys.readouterr().out
    for words, arguments in {
        "Classes: found 'ground'; whole numbers from 0 to 255": ("--classes", "ground"),
        "Classes: found '2,256'": ("--classes", "2,256"),
        "box: from": ("--box", *["1", "0", "0", "0", "1", "1"]),
    }.items():
        assert words in fails(capsys, 1, "reconstruct", scan, "-o", out, *arguments)
    assert "--returns: found 'second'" in fails(
        capsys, 2, "reconstruct", scan, "-o", out, "--returns", "second"
    )


def test_files_that_are_aligned(tmp_path, capsys):
    scans = [tmp_path / f"{k}.ply.gz" for k in range(2)]
    for k, path in enumerate(scans):
        positions, normals = clouds.sphere(4000, seed=k + 1).both
        positions = positions * (1, 1.3, 0.8) + (0.05 * k, 0.0, 0.03 * k)
        kinds = [("double", name) for name in ("x", "y", "z", "nx", "ny", "nz")]
        rows = np.hstack([positions, normals / (1, 1.3, 0.8)]).tolist()
        path.write_bytes(gzip.compress(ply("binary_little_endian", [("vertex", kinds, rows)])))
    out, expected = tmp_path / "out.ply", tmp_path / "expected.ply"
    assert run("reconstruct", *scans, "-o", out, "--depth", "5", "--align") == 0
    told = capsys.readouterr().out
    report = prefilter.reconstruct_file(scans, expected, depth=5, align=True)
    assert out.read_bytes() == expected.read_bytes()
    after, before = report.alignment.after, report.alignment.before
    assert after < 0.3 * before
    assert f"aligned the files: typically {after:.4g} apart, before {before:.4g}" in told


def test_refused_arguments(scan, tmp_path, capsys):
    out = tmp_path / "out.ply"
    for words, arguments in {
        "SOURCE: found 'scan.blend'": ("scan.blend", out),
        "TARGET: found 'out.glb'": (scan, "out.glb"),
        "--voxel-size: not allowed with argument --depth": (
            *(scan, out, "--depth", "5", "--voxel-size", "1"),
        ),
        "--depth: found '99'": (scan, out, "--depth", "99"),
    }.items():
        assert words in fails(capsys, 2, "reconstruct", *arguments)
    assert "none.xyz" in fails(capsys, 1, "reconstruct", tmp_path / "none.xyz", "-o", out)
    told = fails(capsys, 1, "reconstruct", scan, "-o", out, "--voxel-size", "1e-5")
    assert "Voxel Size: " in told
    told = fails(capsys, 1, "reconstruct", scan, "-o", out, "--memory-limit", "1")
    assert "Memory Limit: 1 MiB; at least " in told
    assert not out.exists()
