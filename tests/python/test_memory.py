# SPDX-License-Identifier: GPL-3.0-or-later

"""How much memory there is, against what the system says in its own words."""

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
