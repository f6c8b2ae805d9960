# SPDX-License-Identifier: GPL-3.0-or-later

"""The amount of memory available, against the system's own reports."""

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
    # Other processes change it between the two readings.
    assert math.isclose(prefilter.available_memory(), told, rel_tol=0.2)


@pytest.mark.skipif(sys.platform != "win32", reason="Windows tells it in GlobalMemoryStatusEx")
def test_it_is_what_windows_says():
    # MEMORYSTATUSEX: its length and the memory load share one field; seven byte counts follow.
    status = (ctypes.c_uint64 * 8)(64)
    assert ctypes.CDLL("kernel32").GlobalMemoryStatusEx(status)
    _, _, free, _, free_with_page_files, *_ = status
    told = min(free, free_with_page_files)
    # Other processes change it between the two readings.
    assert math.isclose(prefilter.available_memory(), told, rel_tol=0.2)
