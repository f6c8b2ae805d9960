# SPDX-License-Identifier: GPL-3.0-or-later

"""Checks of output files, and the package's staging of files."""

import os
from pathlib import Path

from prefilter.files.staging import (
    StagedFile,
    StagedFolder,
    check_target,
    check_writable,
    commit_all,
    stage_data,
    stage_folder,
    stage_link,
    stage_with,
)

__all__ = (
    "StagedFile",
    "StagedFolder",
    "check_output",
    "check_plain_target",
    "check_target",
    "check_writable",
    "commit_all",
    "stage_data",
    "stage_folder",
    "stage_link",
    "stage_with",
)


def check_plain_target(path: str, ending: str) -> Path:
    """Returns the absolute path of an output file, after checking its extension.

    Raises:
        ValueError: The extension is not `ending`.
        OSError: The folder is missing, or the file or its folder is read-only.
    """
    target = Path(os.path.realpath(path))
    if target.suffix.lower() != ending:
        raise ValueError(f"file '{path}': unsupported extension '{target.suffix}'; use {ending}")
    check_target(target)
    return target


def check_output(path: str) -> Path:
    """Returns the absolute path of an output file with any extension.

    Raises:
        OSError: The folder is missing, or the file or its folder is read-only.
    """
    target = Path(os.path.realpath(path))
    check_target(target)
    return target
