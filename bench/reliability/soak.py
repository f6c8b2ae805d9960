# SPDX-License-Identifier: GPL-3.0-or-later

"""Tests whether a Blender that is used for a long time keeps growing.

Every operator's test in tests/blender/test_smoke.py runs again and again in one Blender: then a
scene is changed and taken back, and bakes are canceled at random moments. Memory, open files,
threads and data-blocks are measured after half of the runs, when everything that loads once is
loaded, and at the end. They must not grow, except memory by 64 KiB a run, which pytest keeps.
Memory is the sum of the allocator's blocks in use and of Python's objects; the process's resident
pages, which are returned at its own pace, are reported beside it.

usage: blender --background --python soak.py -- [PATTERN] [--count N] [--json FILE]
  scripts/run blender --background --factory-startup --python-exit-code 1 \\
    --python bench/reliability/soak.py
"""

import argparse
import contextlib
import ctypes
import gc
import os
import random
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]
TESTS = ROOT / "tests" / "blender"
sys.path[:0] = [str(ROOT), str(TESTS)]

from bench import report  # noqa: E402

MOST_KIB_PER_RUN = 64.0
_PAGE_KIB = os.sysconf("SC_PAGE_SIZE") / 1024
_PACKAGE = "bl_ext.user_default.prefilter"
_BYTES_OF_PYTHONS_BLOCK = 64


class _Mallinfo2(ctypes.Structure):
    """`struct mallinfo2` of glibc's malloc.h."""

    _names = "arena ordblks smblks hblks hblkhd usmblks fsmblks uordblks fordblks keepcost"
    _fields_ = [(name, ctypes.c_size_t) for name in _names.split()]


def _allocated() -> int:
    """Returns how many bytes jemalloc, or else glibc, has given out and not got back."""
    library = ctypes.CDLL(None)
    if hasattr(library, "mallctl"):
        found, epoch, size = ctypes.c_size_t(), ctypes.c_uint64(1), ctypes.c_size_t(8)
        library.mallctl(b"epoch", None, None, ctypes.byref(epoch), size)
        none = ctypes.c_size_t(0)
        library.mallctl(b"stats.allocated", ctypes.byref(found), ctypes.byref(size), None, none)
        return found.value
    library.mallinfo2.restype = _Mallinfo2
    info = library.mallinfo2()
    return info.uordblks + info.hblkhd


@dataclass(frozen=True)
class State:
    """The resources that a process holds."""

    kib: float
    resident_kib: float
    files: int
    threads: int
    blocks: int

    @classmethod
    def now(cls) -> "State":
        """Returns the state of this process."""
        gc.collect()
        taken = _allocated() + _BYTES_OF_PYTHONS_BLOCK * sys.getallocatedblocks()
        resident = int(Path("/proc/self/statm").read_text().split()[1]) * _PAGE_KIB
        blocks = sum(
            len(kind)
            for kind in (getattr(bpy.data, name) for name in dir(bpy.data))
            if isinstance(kind, bpy.types.bpy_prop_collection)
        )
        folder = Path("/proc/self")
        files, threads = (len(os.listdir(folder / name)) for name in ("fd", "task"))
        return cls(taken / 1024, resident, files, threads, blocks)


@dataclass(eq=False)  # pytest keeps plugins by their hashes.
class Soak:
    """Repeated runs of each name: the process's resources early, and at the end."""

    count: int
    early: dict[str, State] = field(default_factory=dict)
    last: dict[str, State] = field(default_factory=dict)
    failed: list[str] = field(default_factory=list)

    def look(self, name: str, run: int) -> None:
        """Looks at the process after a run, from 0 on."""
        if run == max(self.count // 2, 1) - 1:
            self.early[name] = State.now()
        if run == self.count - 1:
            self.last[name] = State.now()

    def pytest_generate_tests(self, metafunc: pytest.Metafunc) -> None:
        """Has each test run so many times, one after another."""
        metafunc.fixturenames.append("run_number")
        metafunc.parametrize("run_number", range(self.count))

    def pytest_runtest_teardown(self, item: pytest.Item) -> None:
        """Looks at the process before the next test begins with an empty file."""
        run = getattr(item, "callspec", None)
        if run is not None:
            self.look(getattr(item, "originalname", item.name), run.params["run_number"])

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Keeps the names of the failed tests."""
        if report.failed:
            self.failed.append(report.nodeid.rpartition("::")[2])

    def rows(self) -> list[list[str]]:
        """Returns how each changed between then and the end."""
        rows = []
        for name, last in self.last.items():
            early, runs = self.early[name], max(self.count - max(self.count // 2, 1), 1)
            rows.append(
                [
                    name.removeprefix("test_"),
                    str(self.count),
                    f"{(last.kib - early.kib) / runs:.1f}",
                    f"{(last.resident_kib - early.resident_kib) / runs:.1f}",
                    str(last.files - early.files),
                    str(last.threads - early.threads),
                    str(last.blocks - early.blocks),
                ]
            )
        return rows


def _paint() -> Any:
    import scenes

    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    made = scenes.image("Paint", scenes.noise(64, 64))
    scenes.textured_quad(made)
    return made


def undo(soak: Soak) -> None:
    """Bakes once, and takes it back and does it again, many times."""
    _paint()
    bpy.ops.ed.undo_push(message="before")
    bpy.ops.prefilter.bake_mipmaps(image="Paint")
    bpy.ops.ed.undo_push(message="after")
    if not bpy.ops.ed.undo.poll():
        return
    for run in range(soak.count):
        bpy.ops.ed.undo()
        bpy.ops.ed.redo()
        soak.look("undo and redo", run)


def cancel(soak: Soak) -> None:
    """Cancels work at random moments, half as often as others run."""
    import prefilter

    chance = random.Random(1)
    image = np.random.default_rng(1).random((128, 128, 3), np.float32)
    corners = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    triangles = [[0, 1, 2], [0, 2, 3]]
    surface = prefilter.Surface(corners, triangles, corners[:, :2])
    cloud = np.random.default_rng(2).normal(size=(4000, 3))
    cloud /= np.linalg.norm(cloud, axis=1, keepdims=True)
    work: list[Callable[[Any], object]] = [
        lambda told: prefilter.mipmaps(image, surface, progress=told),
        lambda told: prefilter.voxelize(corners, triangles, depth=7, thickness=0.1, progress=told),
        lambda told: prefilter.reconstruct(cloud, cloud, depth=6, progress=told),
        lambda told: prefilter.resize(image, 40, 40, progress=told),
    ]
    for run in range(soak.count):
        moment = chance.random()
        with contextlib.suppress(prefilter.Cancelled):
            work[run % len(work)](lambda share, moment=moment: share < moment)
        soak.look("canceled", run)


def main() -> None:
    """Runs all."""
    arguments = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []
    parser = argparse.ArgumentParser()
    parser.add_argument("pattern", nargs="?", default="")
    parser.add_argument("--count", type=int, default=200, help="runs (default: %(default)s)")
    report.add_json_option(parser)
    options = parser.parse_args(arguments)
    soak = Soak(options.count)
    chosen = ["-k", options.pattern] if options.pattern else ["--deselect", "test_every_operator"]
    quiet = ["-q", "--no-header", "-p", "no:cacheprovider", "--disable-warnings", "--tb=short"]
    keep = ["-o", "tmp_path_retention_policy=none"]
    # Other runs of pytest delete its default folders.
    with tempfile.TemporaryDirectory() as folder:
        where = ["--basetemp", str(Path(folder) / "runs"), str(TESTS / "test_smoke.py")]
        pytest.main([*quiet, *keep, *chosen, *where], plugins=[soak])
    undo(soak)
    cancel(soak)
    told, rows = report.Report(), soak.rows()
    head = ["Operator", "Runs", "KiB a run", "Of pages", "Files", "Threads", "Data-blocks"]
    told.table("Growth", head, rows, "soak")
    told.verdict(not soak.failed, f"no run fails ({', '.join(sorted(set(soak.failed))[:5])})")
    for index, what in ((4, "files"), (5, "threads"), (6, "data-blocks")):
        grown = [row[0] for row in rows if int(row[index]) > 0]
        told.verdict(not grown, f"as many {what} as before {' '.join(grown)}")
    grown = [row[0] for row in rows if float(row[2]) > MOST_KIB_PER_RUN]
    told.verdict(not grown, f"at most {MOST_KIB_PER_RUN:g} KiB a run more {' '.join(grown)}")
    told.finish(options.json)


if __name__ == "__main__":
    try:
        main()
        status = 0
    except SystemExit as ended:
        status = int(ended.code or 0)
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(status)
