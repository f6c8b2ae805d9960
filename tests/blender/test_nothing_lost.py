# SPDX-License-Identifier: GPL-3.0-or-later

"""Whatever command writes files, where it cannot: a little of bench/reliability/disk_full.py."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from bench.reliability import disk_full, writers

WRITERS = writers.of_kind("blender")


@pytest.fixture(scope="module")
def sources(tmp_path_factory):
    folder = tmp_path_factory.mktemp("sources")
    writers.make_sources(folder)
    return folder


@pytest.mark.parametrize("writer", WRITERS, ids=lambda one: one.name)
def test_files_that_cannot_be_written(writer, sources, tmp_path):
    writers.make_scene(sources)
    if missing := writer.missing(sources):
        pytest.skip(f"there is no {missing}")
    trial = disk_full.Trial(writer, sources, tmp_path)
    found, are_disks = disk_full.on_full_disks(trial, tmp_path, 3)
    if not are_disks:
        pytest.skip("no file system can be mounted here")
    assert set(found) <= {"old", "new"}
    assert found[0] == "old"
    assert found[-1] == "new"
    assert disk_full.read_only(trial, tmp_path) == "old"
    assert disk_full.vanishing(trial, tmp_path) in ("old", "new")
