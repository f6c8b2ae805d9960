# SPDX-License-Identifier: GPL-3.0-or-later

"""Modules loaded at start with the add-on: drawing and declarations, and no work."""

import os
import re
import subprocess
import sys

import bpy
from conftest import PACKAGE

# Modules of the add-on that register classes, or that declare their settings.
AT_ENABLING = re.compile(
    r"""
    | core(\..*)? | commands | preferences
    | bridge(\.(files|editors|previews|views|wipe|image_operator))?
    | \w+ (\.(choices|properties|menus|(\w+_)?panels?|operators?|scene_cache)(\..*)?)?
    | \w+ (\.(importance|view|model)(\..*)?)?
    | textures\.gltf(\.(choices|properties|panel|hooks))?
    """,
    re.VERBOSE,
)
WORK = re.compile(r"\w+\.(view\.(errors|figure|canvas)|model\.\w+)")
# Modules of the package from which options take their limits and choices.
OF_PACKAGE = re.compile(
    r"prefilter(\.(_native|files(\..*)?|_border(\..*)?|options(\.(?!flags).*)?|workflows(\.\w+)?"
    r"|images(\.(filters|color))?|meshes(\.surface)?"
    r"|points(\.(scan_files|extensions))?|sampling(\.levels)?"
    r"|voxels(\.(octree|contours|thin_places|lost_parts))?))?"
)
SLOW = {"argparse", "concurrent.futures", "logging", "tempfile", "zipfile", "OpenImageIO"}
PROGRAM = f"""
import gc, os, sys
import addon_utils, bpy, numpy, numpy.typing
known = set(sys.modules)
assert addon_utils.enable({PACKAGE!r}, default_set=True) is not None
assert gc.isenabled()
print("LOADED", *(set(sys.modules) - known), flush=True)
os._exit(0)  # Official 4.5, as a module, may not come to its end.
"""


def loaded_at_enabling() -> set[str]:
    """Returns the modules that enabling the add-on loads in a Blender of its own."""
    command = [sys.executable, "-S", "-c", f"import bpy{PROGRAM}"]
    if bpy.app.binary_path:
        command = [bpy.app.binary_path, "--background", "--factory-startup"]
        command += ["--python-exit-code", "1", "--python-expr", PROGRAM]
    done = subprocess.run(
        command, env=dict(os.environ), capture_output=True, text=True, timeout=1500, check=False
    )
    lines = [line for line in done.stdout.splitlines() if line.startswith("LOADED ")]
    assert lines, done.stdout + done.stderr
    return set(lines[0].split()[1:])


def test_only_what_is_needed_is_loaded():
    found = loaded_at_enabling()
    own = {name.removeprefix(PACKAGE).lstrip(".") for name in found if name.startswith(PACKAGE)}
    assert {"core.operator", "textures.choices"} <= own
    wrong = {name for name in own if not AT_ENABLING.fullmatch(name) or WORK.fullmatch(name)}
    assert not wrong, f"import these in the functions that need them: {sorted(wrong)}"
    package = {name for name in found if re.match(r"prefilter\b", name)}
    assert {name for name in package if not OF_PACKAGE.fullmatch(name)} == set()
    assert not found & SLOW
