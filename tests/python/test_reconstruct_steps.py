# SPDX-License-Identifier: GPL-3.0-or-later

"""`reconstruct` in steps: several processes give the same bits as one."""

import gzip
import json
import subprocess
import sys

import numpy as np
import prefilter
import pytest
from command_files import fails, run
from prefilter.points import sources
from prefilter.points import steps as point_steps
from scan_writers import pcd

DEPTH = ("--depth", "6")
STEPS = ("measure", "count", "merge", "part", "join")


def write_ball(path, count, seed, height=0.0):
    """Writes points of a third of a bent ball, with normals and colors."""
    random = np.random.default_rng(seed)
    normals = random.normal(size=(count, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    normals[:, 2] = np.abs(normals[:, 2]) * (1 if seed % 2 else -1)
    points = normals + random.normal(scale=0.003, size=normals.shape)
    points[:, 2] += height
    rows = np.hstack([points, normals, random.integers(0, 256, (count, 3))]).astype("<f4")
    names = ("x", "y", "z", "nx", "ny", "nz", "quality", "time", "angle")
    properties = "".join(f"property float {name}\n" for name in names)
    head = f"ply\nformat binary_little_endian 1.0\nelement vertex {count}\n{properties}end_header\n"
    path.write_bytes(head.encode() + rows.tobytes())
    return path


@pytest.fixture(scope="module")
def scans(tmp_path_factory):
    folder = tmp_path_factory.mktemp("scans")
    # Some are read in several batches, whose sums must not mix with sums of other files.
    counts = (9_000, 290_000, 15_000, 140_000)
    return [
        write_ball(folder / f"{k}.ply", count, k, 0.1 * (k // 2)) for k, count in enumerate(counts)
    ]


@pytest.fixture(scope="module")
def expected(scans):
    """Returns a function from flags to the file that one process writes."""
    made: dict[tuple[str, ...], bytes] = {}

    def of(*flags):
        if flags not in made:
            target = scans[0].with_name("whole.ply")
            assert run("reconstruct", *scans, "-o", target, *DEPTH, *flags) == 0
            made[flags] = target.read_bytes()
        return made[flags]

    return of


def steps(scans, folder, *flags, parts=5):
    """Does all steps in this process; returns the surface."""
    target = folder / "surface.ply"
    words = ("reconstruct", *scans, "-o", target, *DEPTH, *flags, "--work", folder / "work")
    for step in STEPS:
        assert run(*words, "--parts", str(parts), "--step", step) == 0
    return target.read_bytes()


@pytest.mark.parametrize("parts", [1, 3, 40])
def test_steps_give_the_same_file_as_one_process(scans, expected, tmp_path, parts):
    assert steps(scans, tmp_path, parts=parts) == expected()


@pytest.mark.parametrize(
    "flags",
    [
        ("--watertight",),
        ("--trim", "2"),
        ("--adaptivity", "0.1"),
        ("--no-fit",),
        ("--no-smooth", "--isovalue", "mean"),
        ("--direction", "outward"),
        ("--box", "-0.8", "-2", "-2", "0.8", "2", "2"),
    ],
)
def test_other_settings(scans, expected, tmp_path, flags):
    assert steps(scans, tmp_path, *flags, parts=2) == expected(*flags)


def test_a_folder_of_sources(scans, expected, tmp_path, capsys):
    (tmp_path / "scans").mkdir()
    for path in scans:
        (tmp_path / "scans" / path.name).write_bytes(path.read_bytes())
    (tmp_path / "scans" / "notes.md").write_text("none")
    assert steps([tmp_path / "scans"], tmp_path) == expected()
    (tmp_path / "empty").mkdir()
    words = ("reconstruct", tmp_path / "empty", "-o", tmp_path / "s.ply")
    assert "empty" in fails(capsys, 2, *words)


def test_a_single_source_and_limits_of_memory(scans, tmp_path):
    one = tmp_path / "one.ply"
    assert run("reconstruct", scans[1], "-o", one, *DEPTH) == 0
    limit = ("--memory-limit", "40", "--threads", "1")
    assert steps(scans[1:2], tmp_path, *limit) == one.read_bytes()


SHARE = 60_000
"""Points that are counted by themselves here, so that the scans have 1, 5, 1 and 3 such shares."""


def test_files_are_counted_in_shares(scans, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(sources, "POINTS_A_SHARE", SHARE)
    whole = tmp_path / "whole.ply"
    assert run("reconstruct", *scans, "-o", whole, *DEPTH) == 0
    capsys.readouterr()
    assert steps(scans, tmp_path, parts=3) == whole.read_bytes()
    told = capsys.readouterr().out
    assert told.count("Step measure") == told.count("Step count") == 1 + 5 + 1 + 3
    words = (
        "reconstruct",
        *scans,
        "-o",
        whole,
        *DEPTH,
        "--work",
        tmp_path / "w",
        "--step",
        "count",
    )
    assert run(*words, "--list") == 0
    assert len(capsys.readouterr().out.splitlines()) == 1 + 5 + 1 + 3


def write_las(path, points):
    laspy = pytest.importorskip("laspy", reason="laspy cannot be imported")
    header = laspy.LasHeader(point_format=2, version="1.2")
    header.scales = np.full(3, 1e-4)
    for name in ("nx", "ny", "nz"):
        header.add_extra_dim(laspy.ExtraBytesParams(name=name, type=np.float32))
    las = laspy.LasData(header)
    las.x, las.y, las.z = points.positions.T
    for name, values in zip(("nx", "ny", "nz"), points.normals.T, strict=True):
        las[name] = values
    las.classification = np.arange(len(points.positions)) % 3
    las.write(path)


def write_other(path, points):
    """Writes points in the format that the name asks for."""
    rows = np.hstack([points.positions, points.normals])
    if path.suffix in (".las", ".laz"):
        write_las(path, points)
    elif path.suffix == ".gz":
        path.write_bytes(gzip.compress(path.with_name("1.ply").read_bytes(), 1))
    elif path.suffix == ".xyzn":
        np.savetxt(path, rows, "%.6g")
    else:
        fields = [(name, "<f4", 1) for name in ("x", "y", "z", "normal_x", "normal_y", "normal_z")]
        path.write_bytes(pcd(path.stem, fields, rows))


@pytest.mark.parametrize(
    ("name", "flags", "shares"),
    [
        ("binary.pcd", (), 5),
        ("binary_compressed.pcd", (), 5),
        ("ascii.pcd", (), 1),
        ("scan.las", (), 5),
        ("scan.laz", ("--classes", "0,2"), 5),
        ("scan.xyzn", (), 1),
        ("1.ply.gz", (), 5),
        ("1.ply", ("--box", "-0.8", "-2", "-2", "0.8", "2", "2"), 5),
    ],
)
def test_shares_of_other_files(tmp_path, monkeypatch, capsys, name, flags, shares):
    monkeypatch.setattr(sources, "POINTS_A_SHARE", 5_000)
    source = tmp_path / name
    scan = write_ball(tmp_path / "1.ply", 24_000, 1)
    if source != scan:
        write_other(source, prefilter.read_points(scan))
    whole = tmp_path / "whole.ply"
    assert run("reconstruct", source, "-o", whole, *DEPTH, *flags) == 0
    capsys.readouterr()
    assert steps([source], tmp_path, *flags, parts=1) == whole.read_bytes()
    assert capsys.readouterr().out.count("Step count") == shares
    # No point is lost, and none is counted twice.
    monkeypatch.setattr(sources, "POINTS_A_SHARE", 1 << 30)
    at_once = prefilter.read_points(whole)
    assert run("reconstruct", source, "-o", whole, *DEPTH, *flags) == 0
    again = prefilter.read_points(whole)
    assert len(again.positions) == len(at_once.positions)
    np.testing.assert_allclose(again.positions, at_once.positions, atol=1e-4)


def test_four_processes_at_once(scans, expected, tmp_path):
    target = tmp_path / "surface.ply"
    words = ["-m", "prefilter", "reconstruct", *map(str, scans), "-o", str(target), *DEPTH]
    words += ["--work", str(tmp_path / "work"), "--parts", "8"]
    for step in STEPS:
        count = 1 if step in ("merge", "join") else 4
        runs = [
            subprocess.Popen(
                [sys.executable, *words, "--step", step, "--task", f"{number}/{count}"],
                stderr=subprocess.PIPE,
                text=True,
            )
            for number in range(1, count + 1)
        ]
        for one in runs:
            told = one.communicate(timeout=600)[1]
            assert one.returncode == 0, told
    assert target.read_bytes() == expected()


def test_finished_steps_are_not_repeated(scans, expected, tmp_path, capsys):
    first = steps(scans, tmp_path)
    times = {path: path.stat().st_mtime_ns for path in (tmp_path / "work").iterdir()}
    lost = tmp_path / "work" / "part.2-of-5.prefilter"
    lost.unlink()
    capsys.readouterr()
    assert steps(scans, tmp_path) == first == expected()
    told = capsys.readouterr().out
    assert told.count("Up to date") == 4 + 4 + 1 + 4
    after = {path: path.stat().st_mtime_ns for path in (tmp_path / "work").iterdir()}
    assert {path for path in after if after[path] != times[path]} == {lost}
    # Other settings invalidate all steps.
    assert steps(scans, tmp_path, "--no-fit") == expected("--no-fit")
    assert "Up to date" not in capsys.readouterr().out


def test_a_part_can_be_cancelled_while_it_prepares_the_surface(scans, tmp_path, monkeypatch):
    words = ("reconstruct", *scans, "-o", tmp_path / "surface.ply", *DEPTH, "--work", tmp_path)
    for step in STEPS[:3]:
        assert run(*words, "--parts", "2", "--step", step) == 0
    fractions = []

    def stop(fraction):
        fractions.append(fraction)
        return False

    monkeypatch.setattr(point_steps, "as_progress", lambda _: stop)
    assert run(*words, "--parts", "2", "--step", "part") != 0
    assert fractions[0] < 0.5
    assert len(fractions) == 1


def test_a_list_of_the_runs(scans, tmp_path, capsys):
    words = ("reconstruct", *scans, "-o", tmp_path / "s.ply", *DEPTH, "--work", tmp_path / "w")
    for step, count in (("measure", 4), ("count", 4), ("merge", 1), ("part", 16), ("join", 1)):
        assert run(*words, "--step", step, "--list", "--json") == 0
        tasks = json.loads(capsys.readouterr().out)["tasks"]
        assert len({task["files"][0] for task in tasks}) == count


def test_files_that_are_missing_or_damaged(scans, tmp_path, capsys):
    words = ("reconstruct", *scans, "-o", tmp_path / "s.ply", *DEPTH, "--work", tmp_path / "w")
    words = (*words, "--parts", "2")
    assert "measure.1-of-4" in fails(capsys, 1, *words, "--step", "count")
    assert run(*words, "--step", "measure") == 0
    assert "count.1-of-4" in fails(capsys, 1, *words, "--step", "merge")
    for step in ("count", "merge", "part"):
        assert run(*words, "--step", step) == 0
    for name, step in (
        ("measure.2-of-4", "join"),
        ("count.3-of-4", "merge"),
        ("merge.1-of-1", "part"),
        ("part.2-of-2", "join"),
    ):
        path = tmp_path / "w" / f"{name}.prefilter"
        data = path.read_bytes()
        middle = len(data) * 2 // 3
        others = (
            b"",
            data[:20],
            data[:-1],
            data + b"\0",
            data[:middle] + bytes([data[middle] ^ 1]) + data[middle + 1 :],
            (tmp_path / "w" / "part.1-of-2.prefilter").read_bytes(),
        )
        for other in others:
            path.write_bytes(other)
            for made in (tmp_path / "w").glob(f"{step}.*"):
                made.unlink()
            last = fails(capsys, 1, *words, "--step", step)
            assert name in last, (name, len(other))
        path.write_bytes(data)
        for again in ("measure", "count", "merge", "part"):
            assert run(*words, "--step", again) == 0


def test_options_not_available_in_steps(scans, tmp_path, capsys):
    words = ("reconstruct", *scans, "-o", tmp_path / "s.ply", "--work", tmp_path / "w")
    assert "Depth" in fails(capsys, 1, *words, "--step", "measure").title()
    assert "haar" in fails(capsys, 1, *words, *DEPTH, "--wavelet", "d4", "--step", "measure")
    assert "align" in fails(capsys, 1, *words, *DEPTH, "--align", "--step", "measure")
    bare = tmp_path / "bare.xyz"
    bare.write_text("0 0 0\n1 0 0\n0 1 0\n")
    alone = ("reconstruct", bare, "-o", tmp_path / "s.ply", *DEPTH, "--work", tmp_path / "w")
    assert "no normals" in fails(capsys, 1, *alone, "--step", "measure")
    for flags, word in (
        (("--step", "measure", "--parts", "0"), "--parts"),
        (("--step", "all"), "--step"),
    ):
        assert word in fails(capsys, 2, *words, *DEPTH, *flags)
    last = fails(capsys, 2, "reconstruct", *scans, "-o", tmp_path / "s.ply", "--step", "measure")
    assert "--work" in last
    assert "--step" in fails(capsys, 2, *words)


def test_points_far_from_all_others(scans, tmp_path, capsys):
    far = write_ball(tmp_path / "far.ply", 2, 1, height=1e4)
    sources = (*scans, far)
    words = ("reconstruct", *sources, "-o", tmp_path / "s.ply", *DEPTH, "--work", tmp_path / "w")
    assert run(*words, "--step", "measure") == 0
    assert "box" in fails(capsys, 1, *words, "--step", "count").lower()


def test_points_at_one_place(scans, tmp_path, capsys):
    contents = scans[0].read_bytes().replace(b"element vertex 9000", b"element vertex 9050")
    source = tmp_path / "phantom.ply"
    source.write_bytes(contents + 50 * np.array([5, *8 * [1]], "<f4").tobytes())
    words = ("reconstruct", source, tmp_path / "s.ply", *DEPTH, "--work", tmp_path / "w")
    text = fails(capsys, 1, *words, "--step", "measure")
    assert "50 points are at one place, (5, 1, 1)" in text
