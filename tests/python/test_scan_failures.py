# SPDX-License-Identifier: GPL-3.0-or-later

"""A failed reconstruction to a file leaves the target unchanged, and no other files."""

import os
import signal
import subprocess
import sys
from contextlib import contextmanager

import numpy as np
import prefilter
import pytest
from scan_writers import ply, write

try:
    import resource
except ImportError:  # Windows
    resource = None

BEFORE = b"what was there before"


@pytest.fixture(scope="module")
def sphere():
    """A file of points of a sphere with their normals, and its bytes."""
    points = np.random.default_rng(1).normal(size=(20_000, 3)).astype(np.float32)
    points /= np.linalg.norm(points, axis=1)[:, None]
    properties = [("float", name) for name in ("x", "y", "z", "nx", "ny", "nz")]
    rows = np.concatenate([points, points], axis=1).tolist()
    return ply("binary_little_endian", [("vertex", properties, rows)])


@contextmanager
def only_target_is_left(folder, before=BEFORE):
    target = write(folder, "mesh.ply", before)
    there = sorted(os.listdir(folder))
    yield target
    assert sorted(os.listdir(folder)) == there
    assert target.read_bytes() == before


@contextmanager
def full_disk(size):
    """Limits the size of files within its block, in bytes."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


def test_a_source_that_ends_too_early(tmp_path, sphere):
    text = sphere[: sphere.index(b"end_header")].replace(b"binary_little_endian", b"ascii")
    text += b"end_header\n" + b"0.00 0.00 1.00 0 0 1\n" * 19_999 + b"0 0"
    source = write(tmp_path, "cloud.ply", text)
    with (
        only_target_is_left(tmp_path) as target,
        pytest.raises(ValueError, match=r"cloud.ply': line 20010: vertex 20000 of 20000: found 2"),
    ):
        prefilter.reconstruct_file(source, target, depth=5)


@pytest.mark.skipif(resource is None, reason="files cannot be kept small")
@pytest.mark.parametrize("size", [1000, 100_000, 400_000])
@pytest.mark.parametrize("memory_limit", [None, 0])
def test_a_full_disk(tmp_path, sphere, size, memory_limit):
    source = write(tmp_path, "cloud.ply", sphere)
    with (
        only_target_is_left(tmp_path) as target,
        pytest.raises(OSError, match=rf"{tmp_path}.*': cannot write \d+ bytes at byte \d+: "),
        full_disk(size),
    ):
        prefilter.reconstruct_file(source, target, depth=7, memory_limit=memory_limit)


@pytest.mark.parametrize("memory_limit", [None, 0])
def test_canceling(tmp_path, sphere, memory_limit):
    source = write(tmp_path, "cloud.ply", sphere)
    for after in (0.0, 0.3, 0.6, 0.9):
        with only_target_is_left(tmp_path) as target, pytest.raises(prefilter.Cancelled):
            prefilter.reconstruct_file(
                source,
                target,
                depth=6,
                memory_limit=memory_limit,
                progress=lambda done, after=after: done < after,
            )


def test_a_kill(tmp_path, sphere):
    if os.name != "nt":
        try:
            os.close(os.open(tmp_path, os.O_RDWR | os.O_TMPFILE))
        except (AttributeError, OSError):
            pytest.skip(f"files need names in {tmp_path}")
    kill = signal.SIGTERM if os.name == "nt" else signal.SIGKILL
    source = write(tmp_path, "cloud.ply", sphere)
    program = f"""
import os, prefilter, signal
def stop(done):
    if done > 0.5:
        os.kill(os.getpid(), {int(kill)})
prefilter.reconstruct_file({str(source)!r}, {str(tmp_path / "mesh.ply")!r}, depth=7,
                           memory_limit=0, progress=stop)
"""
    with only_target_is_left(tmp_path):
        ended = subprocess.run([sys.executable, "-c", program], check=False)
        assert abs(ended.returncode) == kill


def test_the_source_as_target(tmp_path, sphere):
    source = write(tmp_path, "cloud.ply", sphere)
    report = prefilter.reconstruct_file(source, source, depth=5)
    assert len(prefilter.read_points(source).positions) == report.vertices


def test_names_in_any_language(tmp_path, sphere):
    folder = tmp_path / "Größe 大小 📐"
    folder.mkdir()
    source, target = write(folder, "Wölfe.ply", sphere), folder / "läuft.ply"
    for _ in range(2):
        report = prefilter.reconstruct_file(source, target, depth=5)
        assert len(prefilter.read_points(target).positions) == report.vertices
    assert sorted(path.name for path in folder.iterdir()) == ["Wölfe.ply", "läuft.ply"]


@pytest.mark.skipif(os.name != "nt", reason="elsewhere files that are open can be replaced")
def test_an_open_target_is_reported(tmp_path, sphere):
    source = write(tmp_path, "cloud.ply", sphere)
    with (
        only_target_is_left(tmp_path) as target,
        target.open("rb"),
        pytest.raises(OSError, match=r"mesh.ply': cannot be replaced: another program has"),
    ):
        prefilter.reconstruct_file(source, target, depth=5)
