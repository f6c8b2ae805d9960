# SPDX-License-Identifier: GPL-3.0-or-later

"""Blender's own commands for extensions."""

import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from packager.project import PackagingError

_REPOSITORY = "user_default"  # Blender's, of extensions that come from files.


def run_blender(blender: Sequence[str], *arguments: str, resources: Path | None = None) -> None:
    """Runs one of Blender's commands with factory settings; shows its output if it fails.

    Args:
        blender: The command that starts Blender.
        arguments: What follows `--command`.
        resources: The folder for its settings and extensions.
    """
    command = [*blender, "--background", "--factory-startup", "--command", *arguments]
    environment = dict(os.environ)
    if resources is not None:
        environment["BLENDER_USER_RESOURCES"] = str(resources)
    done = subprocess.run(
        command,
        env=environment,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    if done.returncode != 0:
        sys.stderr.write(done.stdout)
        raise PackagingError(f"blender --command {' '.join(arguments[:2])} failed")


def validate(extension: Path, blender: Sequence[str]) -> None:
    """Lets Blender say whether it accepts a zip."""
    run_blender(blender, "extension", "validate", str(extension))


def install(extension: Path, resources: Path, blender: Sequence[str]) -> None:
    """Installs and enables an extension, as a user would."""
    arguments = ("extension", "install-file", "-r", _REPOSITORY, "-e", str(extension))
    run_blender(blender, *arguments, resources=resources)
