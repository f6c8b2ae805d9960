# SPDX-License-Identifier: GPL-3.0-or-later

"""Where commands write: the flag -o, patterns in it, and files that stay as they are."""

import argparse
import os
from collections.abc import Iterable, Sequence
from pathlib import Path

from ..files.file_names import check_windows_names, identities, stem_of
from ..workflows.files import patterns

NAME = "name"
"""The placeholder that stands for the name of what is read."""


def add_output(
    parser: argparse.ArgumentParser,
    metavar: str,
    description: str,
    *,
    is_required: bool = False,
    destination: str = "target",
) -> None:
    """Adds -o, and the flag that lets it name a file that is read.

    Args:
        parser: Gets them.
        metavar: What the file to write is called.
        description: What may be written.
        is_required: Whether there is no other way to name that file.
        destination: The attribute of the arguments that gets the path.
    """
    parser.add_argument(
        "-o",
        "--output",
        dest=destination,
        metavar=metavar,
        required=is_required,
        help=description,
    )
    add_overwrite(parser)


def add_overwrite(parser: argparse.ArgumentParser) -> None:
    """Adds the flag that lets files be replaced that are read."""
    parser.add_argument(
        "--overwrite",
        action="store_true",
        help="replace a file even if it is one of those that are read, or was named without -o "
        "and exists",
    )


def settle(
    options: argparse.Namespace,
    names: tuple[str, str],
    placeholders: Sequence[str] = (),
) -> None:
    """Finds out which file is written: that of -o, the second of two, or a pattern behind several.

    A pattern of the shell becomes names of files that exist, none of which has a placeholder.

    Args:
        options: The arguments: `sources` and `target`, which are set as they were meant.
        names: What the file to read and the one to write are called.
        placeholders: Those that the path to write may have.
    """
    source, target = names
    options.is_positional = options.target is None
    if options.target is None:
        count = len(options.sources)
        if count == 1:
            options.usage_error(f"nothing to write: give -o {target}")
        last = options.sources[-1]
        is_pattern = bool(placeholders) and patterns.has(last, NAME) and not Path(last).exists()
        if count > 2 and not is_pattern:
            if placeholders:
                last = "FOLDER/{name}.EXTENSION"
            options.usage_error(
                f"found {count} files without -o: give every {source}, and -o '{last}'"
            )
        options.is_positional = not is_pattern
        *options.sources, options.target = options.sources
    check_path(options, target, options.target, placeholders)


def check_path(
    options: argparse.Namespace, argument: str, path: str, placeholders: Sequence[str] = ()
) -> None:
    """Ends the program for a path to write with unknown placeholders, or that Windows reserves."""
    try:
        patterns.check(argument, path, placeholders)
        check_windows_names(path, f"{argument}: ")
    except ValueError as error:
        options.usage_error(str(error))


def resolved(
    options: argparse.Namespace, argument: str, path: str, source: str | None = None
) -> str:
    """Returns the path to write that a user gives, with the name of what is read in it.

    Args:
        options: The arguments.
        argument: What the path is called in messages.
        path: The path.
        source: The file that `{name}` stands for; None where there is no such placeholder.
    """
    check_path(options, argument, path, () if source is None else (NAME,))
    return for_source(path, source or "")


def for_source(pattern: str, source: str) -> str:
    """Returns the path to write for a file that is read."""
    return patterns.filled(pattern, {NAME: stem_of(source)})


def check_kept(
    options: argparse.Namespace,
    targets: Iterable[str | os.PathLike[str]],
    sources: Iterable[str | os.PathLike[str]],
) -> None:
    """Ends the program where a file that is read would be replaced, or one that may be meant so.

    Args:
        options: The arguments: `overwrite` allows it, and `is_positional` tells that the file was
            named without -o.
        targets: The files to write.
        sources: The files that are read.
    """
    if options.overwrite:
        return
    read = [(path, identities(path)) for path in sources]
    for target in targets:
        own = identities(target)
        for path, other in read:
            if not own.isdisjoint(other):
                same = "" if os.fspath(path) == os.fspath(target) else f" as '{path}'"
                options.usage_error(
                    f"'{target}' is read{same}; choose another file to write, or give --overwrite"
                )
        if getattr(options, "is_positional", False) and Path(target).exists():
            options.usage_error(
                f"'{target}' exists, and was named without -o, as files of a pattern are; "
                f"give -o '{target}' to replace it"
            )
