# SPDX-License-Identifier: GPL-3.0-or-later

"""Modules that an import loads: Blender imports the package at every start."""

import subprocess
import sys

import prefilter
import pytest

# Each of the slow modules loads further slow ones.
ALWAYS = {"prefilter", "prefilter._native"}
SLOW = {"argparse", "concurrent.futures", "json", "logging", "tempfile", "zipfile", "tinycss2"}


def loaded_by(code: str) -> set[str]:
    """Returns the modules that code loads in a Python of its own, which has numpy already."""
    program = f"import sys, numpy, numpy.typing; known = set(sys.modules)\n{code}\n"
    program += "print(*(set(sys.modules) - known))"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return set(done.stdout.split())


def test_importing_the_package_loads_hardly_more_than_the_native_module():
    found = loaded_by("import prefilter")
    assert {name for name in found if name.startswith("prefilter")} == ALWAYS
    assert not found & SLOW


@pytest.mark.parametrize("name", ["MIPMAP_FILTERS", "POINT_EXTENSIONS", "Octree"])
def test_what_options_are_made_of_loads_nothing_slow(name):
    assert not loaded_by(f"import prefilter\nprefilter.{name}") & SLOW


def test_every_public_name_is_there():
    everything = {name: getattr(prefilter, name) for name in prefilter.__all__}
    assert everything.keys() <= set(dir(prefilter))
    scope: dict[str, object] = {}
    exec("from prefilter import *", scope)
    assert {name: scope[name] for name in everything} == everything


def test_other_names_are_not():
    with pytest.raises(AttributeError, match=r"prefilter.*'voxelise'"):
        _ = prefilter.voxelise
    with pytest.raises(ImportError, match="voxelise"):
        from prefilter import voxelise  # noqa: F401
