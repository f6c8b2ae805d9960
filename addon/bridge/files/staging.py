# SPDX-License-Identifier: GPL-3.0-or-later

"""Where files go that the add-on writes; they are staged as the package does it."""

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
    """Returns the absolute path of a file that can be written, and whose name ends as needed.

    Raises:
        ValueError: The name does not end in `ending`.
        OSError: The folder is missing, or the file or its folder is read-only.
    """
    target = Path(os.path.realpath(path))
    if target.suffix.lower() != ending:
        raise ValueError(f"file '{path}': unsupported extension '{target.suffix}'; use {ending}")
    check_target(target)
    return target


def check_output(path: str) -> Path:
    """Returns the absolute path of a file of any kind that can be written.

    Raises:
        OSError: The folder is missing, or the file or its folder is read-only.
    """
    target = Path(os.path.realpath(path))
    check_target(target)
    return target
