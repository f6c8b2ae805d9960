# SPDX-License-Identifier: GPL-3.0-or-later

"""Where things are in the checkout, its version, and the errors of packaging."""

import re
import sys
import tomllib
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]
BUILD = SOURCE / "build"
NAME = "prefilter"


class PackagingError(Exception):
    """What was built cannot be packaged; the message says why."""


def note(text: str) -> None:
    """Tells what goes on."""
    print(f"prefilter: {text}", file=sys.stderr, flush=True)


def project_version(source: Path = SOURCE) -> str:
    """Returns the version, on which the manifest and CMake have to agree."""
    manifest = tomllib.loads((source / "blender_manifest.toml").read_text())["version"]
    project = re.search(
        r"^project\(.*VERSION ([0-9.]+)", (source / "CMakeLists.txt").read_text(), re.M
    )
    cmake = project[1] if project else ""
    if manifest != cmake:
        raise PackagingError(
            f"blender_manifest.toml has version '{manifest}', CMakeLists.txt '{cmake}': they must "
            "be equal"
        )
    return str(manifest)


def files_in(folder: Path) -> list[Path]:
    """Returns the files below a folder, in order, without those that Python keeps for itself."""
    return sorted(
        path
        for path in folder.rglob("*")
        if path.is_file() and "__pycache__" not in path.relative_to(folder).parts
    )
