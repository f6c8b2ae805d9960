#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later

"""Lay out the source distribution: what building the Python package needs, and what tests it.

usage: sdist.py FOLDER PYBIND11 LINKED...

Makes FOLDER/tree. PYBIND11 is the .dist-info folder of pybind11, whose headers are compiled in: it
gives its license. LINKED are the source folders of libraries that are linked in.
"""

import shutil
import sys
from collections.abc import Sequence
from pathlib import Path

from packager.project import SOURCE, description

# Files taken from this checkout, besides README.md and pyproject.toml, which are adapted.
FILES = (
    "CHANGELOG.md",
    "CMakeLists.txt",
    "LICENSE",
    "blender_manifest.toml",
    "scripts/platforms.toml",
    "scripts/sources.toml",
)
FOLDERS = ("native", "bench/voxels", "tests/python")


def lay_out(folder: Path, pybind11: Path, linked: Sequence[Path], source: Path = SOURCE) -> Path:
    """Makes the tree of the source distribution in a folder, anew; returns where it is.

    Args:
        folder: Where it is made; nothing else of it stays.
        pybind11: The .dist-info folder of pybind11.
        linked: Source folders of linked libraries, NAME-VERSION.
        source: The checkout.
    """
    shutil.rmtree(folder, ignore_errors=True)
    tree = folder / "tree"
    unwanted = shutil.ignore_patterns("__pycache__")
    for name in FOLDERS:
        shutil.copytree(source / name, tree / name, ignore=unwanted)
    for name in FILES:
        (tree / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(source / name, tree / name)
    (tree / "README.md").write_text(description(source))
    for library in linked:
        shutil.copytree(library, tree / "third_party" / library.name)
    metadata = (source / "pyproject.toml").read_text()
    listed = 'license-files = ["LICENSE", "third_party/*/LICENSE.txt", "third_party/*/NOTICE.txt"]'
    metadata = metadata.replace('license-files = ["LICENSE"]', listed)
    (tree / "pyproject.toml").write_text(metadata)
    (license_text,) = pybind11.glob("licenses/LICENSE")
    target = tree / "third_party" / pybind11.name.removesuffix(".dist-info")
    target.mkdir()
    shutil.copy(license_text, target / "LICENSE.txt")
    return tree


def main() -> int:
    """Runs the command line."""
    folder, pybind11, *linked = map(Path, sys.argv[1:])
    lay_out(folder, pybind11, linked)
    return 0


if __name__ == "__main__":
    sys.exit(main())
