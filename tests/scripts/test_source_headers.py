# SPDX-License-Identifier: GPL-3.0-or-later

"""Every source file says its license in its first lines."""

import subprocess
from pathlib import Path

import pytest

CHECKOUT = Path(__file__).resolve().parents[2]
LICENSE = "SPDX-License-Identifier: GPL-3.0-or-later"
COMMENTS = {
    **dict.fromkeys((".py", ".pyi", ".sh", ".cmake"), "#"),
    **dict.fromkeys((".cpp", ".h", ".c", ".rs"), "//"),
    ".map": "/*",
}


def comment_of(path: Path) -> str | None:
    """How the comments of a file begin; None where it is no source file."""
    if path.name == "CMakeLists.txt":
        return "#"
    if path.suffix:
        return COMMENTS.get(path.suffix)
    with path.open("rb") as file:
        return "#" if file.read(2) == b"#!" else None


def says_license(text: str, comment: str) -> bool:
    """Whether the first line that is not a shebang says the license."""
    lines = text.splitlines()
    if lines and lines[0].startswith("#!"):
        lines = lines[1:]
    return bool(lines) and lines[0].removesuffix(" */") == f"{comment} {LICENSE}"


def sources() -> list[Path]:
    command = ("git", "-C", str(CHECKOUT), "ls-files", "--cached", "--others", "--exclude-standard")
    listed = subprocess.run(command, capture_output=True, text=True)
    if listed.returncode != 0:
        pytest.skip(f"git does not list the files: {listed.stderr.strip()}")
    return [path for name in listed.stdout.splitlines() if (path := CHECKOUT / name).is_file()]


def test_every_source_file_says_its_license() -> None:
    comments = {path: comment_of(path) for path in sources()}
    checked = {path: comment for path, comment in comments.items() if comment is not None}
    assert len(checked) > 1000
    missing = [
        str(path.relative_to(CHECKOUT))
        for path, comment in checked.items()
        if not says_license(path.read_text(), comment)
    ]
    assert missing == []


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (f"# {LICENSE}\n", True),
        (f"#!/bin/bash\n# {LICENSE}\n\necho\n", True),
        ("", False),
        ("#!/bin/bash\n", False),
        (f"import os\n# {LICENSE}\n", False),
        (f"// {LICENSE}\n", False),
        ("# SPDX-License-Identifier: MIT\n", False),
    ],
)
def test_a_missing_license_is_found(text: str, says: bool) -> None:
    assert says_license(text, "#") is says
