# SPDX-License-Identifier: GPL-3.0-or-later

"""The checkout's paths and version, and the errors of packaging."""

import re
import sys
import tomllib
from collections.abc import Iterable
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]
BUILD = SOURCE / "build"
NAME = "prefilter"


class PackagingError(Exception):
    """The build cannot be packaged; the message says why."""


def note(text: str) -> None:
    """Prints progress."""
    print(f"prefilter: {text}", file=sys.stderr, flush=True)


def project_version(source: Path = SOURCE) -> str:
    """Returns the version, which the manifest says; CMake and pip read it there, too."""
    return str(tomllib.loads((source / "blender_manifest.toml").read_text())["version"])


def description(source: Path = SOURCE) -> str:
    """Returns what PyPI shows: how the README opens, and the first example of docs/python.md.

    Pictures and links that are files of the checkout are left out.
    """
    opening = (source / "README.md").read_text().partition("\n## ")[0]
    opening = re.sub(r"^!\[[^\]]*\]\([^)]*\)\n\n(\*[^*]+\*\n\n)?", "", opening, flags=re.M)
    opening = re.sub(r"\[([^\]]*)\]\((?!https?:)[^)]*\)", r"\1", opening)
    page = (source / "docs/python.md").read_text()
    example = re.search(r"^```python\n.*?^```\n", page, re.M | re.S)
    return f"{opening.rstrip()}\n" + (f"\n{example[0]}" if example else "")


def core_metadata(version: str, licenses: Iterable[str], source: Path = SOURCE) -> str:
    """Returns METADATA of a wheel, from pyproject.toml.

    Args:
        version: The wheel's.
        licenses: Names of the license texts in it.
        source: The checkout.
    """
    project = tomllib.loads((source / "pyproject.toml").read_text())["project"]
    lines = ["Metadata-Version: 2.4", f"Name: {project['name']}", f"Version: {version}"]
    lines.append(f"Summary: {project['description']}")
    lines.append(f"Keywords: {','.join(project['keywords'])}")
    lines.append(f"Author: {', '.join(author['name'] for author in project['authors'])}")
    lines.append(f"License-Expression: {project['license']}")
    lines += [f"License-File: {name}" for name in licenses]
    lines += [f"Classifier: {name}" for name in project["classifiers"]]
    lines += [f"Project-URL: {name}, {url}" for name, url in project.get("urls", {}).items()]
    lines.append(f"Requires-Python: {project['requires-python']}")
    lines += [f"Requires-Dist: {name}" for name in project["dependencies"]]
    for extra, names in project.get("optional-dependencies", {}).items():
        lines.append(f"Provides-Extra: {extra}")
        lines += [f"Requires-Dist: {name}; extra == '{extra}'" for name in names]
    lines += ["Description-Content-Type: text/markdown", "", description(source)]
    return "\n".join(lines)


def entry_points(source: Path = SOURCE) -> str:
    """Returns entry_points.txt of a wheel: the commands that pyproject.toml names."""
    project = tomllib.loads((source / "pyproject.toml").read_text())["project"]
    return "\n".join(
        ["[console_scripts]", *(f"{name} = {place}" for name, place in project["scripts"].items())]
    )


def files_in(folder: Path) -> list[Path]:
    """Returns the files below a folder, in order, without those that Python keeps for itself."""
    return sorted(
        path
        for path in folder.rglob("*")
        if path.is_file() and "__pycache__" not in path.relative_to(folder).parts
    )
