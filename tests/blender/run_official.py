# SPDX-License-Identifier: GPL-3.0-or-later

"""Installs the extension in an official build of Blender, as a module of Python; runs pytest in it.

BLENDER_USER_RESOURCES=FOLDER python3 tests/blender/run_official.py ZIP ARGUMENTS

FOLDER gets the extension, as in any Blender; it should be empty.
"""

import importlib
import os
import sys
from importlib.metadata import distribution
from pathlib import Path

import bpy
import pytest
from packaging.tags import sys_tags

PACKAGE = "bl_ext.user_default.prefilter"
FOLDER = Path(os.environ["BLENDER_USER_RESOURCES"]).resolve()


def install(extension: Path) -> None:
    """Installs and enables the extension from a file, as a user would."""
    assert bpy.app.binary_path == "", "this Blender is a program"
    done = bpy.ops.extensions.package_install_files(
        filepath=str(extension), repo="user_default", enable_on_install=True
    )
    assert done == {"FINISHED"}, done
    assert hasattr(bpy.types, "PREFILTER_OT_voxelize"), "the add-on is not enabled"


def check_wheel() -> None:
    """Asserts that Blender has picked the wheel for its Python and system, and that it loads."""
    module = importlib.import_module("prefilter._native")
    assert Path(module.__file__).resolve().is_relative_to(FOLDER), module.__file__
    wheel = distribution("prefilter").read_text("WHEEL") or ""
    found = [line.split()[1] for line in wheel.splitlines() if line.startswith("Tag:")]
    assert found, "the wheel has no tag"
    assert set(found) <= {str(tag) for tag in sys_tags()}, f"not for this machine: {found}"
    print(f"Blender {bpy.app.version_string}, Python {sys.version.split()[0]}: {', '.join(found)}")


def load_own_modules() -> None:
    """Lets tests and Cycles import modules that Blender bundles in other places since 4.4.

    Raises:
        AssertionError: There is no OpenImageIO of Blender's own.
    """
    own_modules = importlib.import_module(f"{PACKAGE}.bridge.own_modules")
    for name in ("OpenImageIO", "oslquery"):
        try:
            module = own_modules.load(name)
        except ImportError:
            assert bpy.app.version < (4, 4, 0), f"the add-on does not find Blender's own {name}"
            continue
        own = bpy.utils.resource_path("LOCAL")
        if bpy.app.version >= (4, 4, 0):
            assert Path(module.__file__).is_relative_to(own), module.__file__


def main() -> int:
    """Runs the command line; returns the exit status."""
    install(Path(sys.argv[1]).resolve())
    check_wheel()
    load_own_modules()
    sys.stdout.flush()
    return int(pytest.main(sys.argv[2:]))


if __name__ == "__main__":
    status = main()
    sys.stdout.flush()
    sys.stderr.flush()
    # Blender's own work at the end of Python's process may fail; it is not ours.
    os._exit(status)
