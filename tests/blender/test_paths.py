# SPDX-License-Identifier: GPL-3.0-or-later

"""The paths of docs/paths.md are walked in as many clicks as the page says."""

import json
import os
import subprocess
import sys
from pathlib import Path

import bpy
import pytest

HERE = Path(__file__).resolve().parents[2] / "docs" / "paths"
sys.path.append(str(HERE))

import page  # noqa: E402

VERSION = ".".join(map(str, bpy.app.version[:2]))
ALWAYS = {"printer"}


@pytest.mark.parametrize("name", page.WHO)
def test_a_path(name, display, tmp_path):
    if not bpy.app.binary_path:
        pytest.skip("a module of Python has no window")
    if name not in ALWAYS and not os.environ.get("PREFILTER_TEST_ALL"):
        pytest.skip("walked with PREFILTER_TEST_ALL only")
    if name in page.WITHOUT_EXTENSION:
        pytest.skip("the path begins with a zip: docs/paths/drive walks it")
    known = page.read()[name].get(VERSION)
    if known is None:
        pytest.skip("this Blender was not measured")
    done = subprocess.run(
        [
            *(bpy.app.binary_path, "--factory-startup", "--enable-event-simulate"),
            *("--window-geometry", "0", "0", "1280", "800", "--python", HERE / "walks.py"),
            *("--", name, tmp_path),
        ],
        env={**os.environ, **display},
        capture_output=True,
        text=True,
        timeout=1500,
        check=False,
    )
    lines = [line for line in done.stdout.splitlines() if line.startswith(page.TOLD)]
    assert lines, done.stdout + done.stderr
    told = json.loads(lines[0].removeprefix(page.TOLD))
    for key in ("clicks", "keys", "drags", "steps"):
        assert told[key] == known[key], key
