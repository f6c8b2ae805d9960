# SPDX-License-Identifier: GPL-3.0-or-later

"""`memory_limit`: a process's peak stays within it, and limits below the minimum are refused."""

import json
import re
import subprocess
import sys
from pathlib import Path

import clouds
import numpy as np
import prefilter
import pytest
from scan_writers import ply, write

SLACK = 8
"""MiB by which a process's memory varies between runs."""

PROGRAM = """
import json, os, re, sys
import numpy as np, prefilter
source, target, limit, threads, depth, options = sys.argv[1:]
ball = np.random.default_rng(0).normal(size=(500, 3))
prefilter.reconstruct(ball, ball, depth=3)  # one-time loading
def mib(name):
    status = open("/proc/self/status").read()
    return int(re.search(name + r":\\s+(\\d+) kB", status)[1]) / 1024
with open("/proc/self/clear_refs", "w") as file:
    file.write("5")
before = mib("VmRSS")
report = prefilter.reconstruct_file(
    source, target, depth=int(depth), threads=int(threads),
    memory_limit=None if limit == "None" else int(limit), **json.loads(options),
)
print(json.dumps([mib("VmHWM") - before, report.is_spilled]))
"""

needs_linux = pytest.mark.skipif(
    not Path("/proc/self/clear_refs").exists(), reason="the system does not tell a peak"
)


def terrain(count):
    random = np.random.default_rng(3)
    x, y = random.uniform(-5, 5, (2, count))
    slope = 0.4 * np.column_stack([-np.cos(x) * np.cos(y), np.sin(x) * np.sin(y)])
    points = np.column_stack([x, y, 0.4 * np.sin(x) * np.cos(y)])
    return points, np.column_stack([slope, np.ones(count)])


CLOUDS = {
    "ball": (clouds.sphere(400_000).both, 0, 8),
    "sparse ball": (clouds.sphere(100_000).both, 0, 9),
    "terrain with values": (terrain(400_000), 8, 9),
}


@pytest.fixture(scope="module", params=CLOUDS)
def cloud(request, tmp_path_factory):
    """A file of points, and the depth for it."""
    (points, normals), extra, depth = CLOUDS[request.param]
    names = [*"xyz", "nx", "ny", "nz", *(f"value{k}" for k in range(extra))]
    rows = np.column_stack([points, normals, *[points[:, 0]] * extra])
    contents = ply("binary_little_endian", [("vertex", [("float", one) for one in names], rows)])
    return write(tmp_path_factory.mktemp("cloud"), "cloud.ply", contents), depth


def least(cloud, tmp_path, **options):
    """The least memory limit, as the refusal of 1 MiB states it."""
    source, depth = cloud
    with pytest.raises(ValueError, match="memory_limit: 1 MiB; at least") as refused:
        prefilter.reconstruct_file(
            source, tmp_path / "none.ply", depth=depth, memory_limit=1, **options
        )
    assert not list(tmp_path.glob("none*"))
    return int(re.search(r"at least (\d+) MiB are needed for \d+ cells", str(refused.value))[1])


def peak(cloud, target, limit, threads=2, **options):
    source, depth = cloud
    arguments = (source, target, limit, threads, depth, json.dumps(options))
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, *map(str, arguments)],
        capture_output=True,
        text=True,
        check=True,
    )
    return json.loads(done.stdout)


@needs_linux
@pytest.mark.parametrize(
    "options",
    [
        {},
        {"wavelet": "d4"},
        {"adaptivity": 0.1},
        {"adaptivity": 0.1, "watertight": True},
    ],
)
def test_the_least_is_enough_and_what_is_taken(cloud, tmp_path, options):
    enough = least(cloud, tmp_path, **options)
    target = tmp_path / "least.ply"
    found, _ = peak(cloud, target, enough, **options)
    assert found < 1.1 * enough + SLACK
    # The stated minimum is not much more than the memory used.
    assert enough < 1.5 * found + SLACK
    if "wavelet" not in options:
        free = tmp_path / "free.ply"
        peak(cloud, free, None, **options)
        assert free.read_bytes() == target.read_bytes()


@needs_linux
@pytest.mark.parametrize("share", [1.3, 2.0])
def test_limits_hold(cloud, tmp_path, share):
    limit = int(share * least(cloud, tmp_path))
    found, _ = peak(cloud, tmp_path / "mesh.ply", limit)
    assert found < 1.1 * limit + SLACK


def test_one_less_is_refused(tmp_path):
    scan = prefilter.ScanPoints(*clouds.sphere(60_000).both)
    enough = least((scan, 7), tmp_path)
    assert 4 < enough < 40
    with pytest.raises(ValueError, match=f"{enough - 1} MiB; at least {enough} MiB"):
        prefilter.reconstruct(scan, depth=7, memory_limit=enough - 1)
    mesh = prefilter.reconstruct(scan, depth=7, memory_limit=enough)
    for limit in (0, None):
        other = prefilter.reconstruct(scan, depth=7, memory_limit=limit)
        np.testing.assert_array_equal(other[0], mesh[0])
        np.testing.assert_array_equal(other[1], mesh[1])
