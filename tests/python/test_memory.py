# SPDX-License-Identifier: GPL-3.0-or-later

"""How much memory there is, against what the system says in its own words."""

import ctypes
import math
import sys
from pathlib import Path

import prefilter
import pytest


def test_there_is_some_memory():
    assert 1e6 < prefilter.available_memory() < 1e15


@pytest.mark.skipif(sys.platform != "linux", reason="Linux tells it in /proc/meminfo")
def test_it_is_what_linux_says():
    lines = dict(line.split(":") for line in Path("/proc/meminfo").read_text().splitlines())
    told = 1024.0 * int(lines["MemAvailable"].split()[0])
    # Others take and give back meanwhile.
    assert math.isclose(prefilter.available_memory(), told, rel_tol=0.2)


@pytest.mark.skipif(sys.platform != "win32", reason="Windows tells it in GlobalMemoryStatusEx")
def test_it_is_what_windows_says():
    # Its length, which shares a place with the load; then seven numbers of bytes.
    status = (ctypes.c_uint64 * 8)(64)
    assert ctypes.CDLL("kernel32").GlobalMemoryStatusEx(status)
    _, _, free, _, free_with_page_files, *_ = status
    told = min(free, free_with_page_files)
    # Others take and give back meanwhile.
    assert math.isclose(prefilter.available_memory(), told, rel_tol=0.2)
