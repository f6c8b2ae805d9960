# SPDX-License-Identifier: GPL-3.0-or-later

"""Output paths of commands: the flag -o, patterns in it, and protection of input files."""

import argparse
import os
from collections.abc import Iterable, Sequence
from pathlib import Path

from ..files.file_names import check_windows_names, identities, stem_of
from ..workflows.files import patterns

NAME = "name"
"""The placeholder that stands for the name of the input."""


def add_output(
    parser: argparse.ArgumentParser,
    metavar: str,
    description: str,
    *,
    is_required: bool = False,
    destination: str = "target",
) -> None:
    """Adds -o, and the flag that lets it replace an input file.

    Args:
        parser: The parser that gets the flags.
        metavar: Placeholder of the path in help texts.
        description: Description of the files that can be written.
        is_required: Whether -o is the only way to name that file.
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
    """Adds the flag that lets input files be replaced."""
    parser.add_argument(
        "--overwrite",
        action="store_true",
        help="replace a file even if it is one of those that are read, or was named without -o "
        "and exists",
    )


def resolve_files(
    options: argparse.Namespace,
    names: tuple[str, str],
    placeholders: Sequence[str] = (),
) -> None:
    """Determines the output path: that of -o, the second of two paths, or a pattern after several.

    A shell has replaced its own patterns by existing files, so only ours have placeholders.

    Args:
        options: The arguments; sets their `sources` and `target` to the resolved ones.
        names: Metavars of the file to read and of the file to write.
        placeholders: Placeholders that the output path may have.
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
    """Ends the program if an output path has unknown placeholders, or Windows reserves it."""
    try:
        patterns.check(argument, path, placeholders)
        check_windows_names(path, f"{argument}: ")
    except ValueError as error:
        options.usage_error(str(error))


def checked_path(
    options: argparse.Namespace, argument: str, path: str, source: str | None = None
) -> str:
    """Returns a user's output path, with the input's name filled in.

    Args:
        options: The arguments.
        argument: The path's name in messages.
        path: The path.
        source: The file that `{name}` stands for; None if that placeholder is not allowed.
    """
    check_path(options, argument, path, () if source is None else (NAME,))
    return path_for(path, source or "")


def path_for(pattern: str, source: str) -> str:
    """Returns the output path for an input file."""
    return patterns.filled(pattern, {NAME: stem_of(source)})


def check_not_replaced(
    options: argparse.Namespace,
    targets: Iterable[str | os.PathLike[str]],
    sources: Iterable[str | os.PathLike[str]],
) -> None:
    """Ends the program if it would replace an input file, or a file that may be one by mistake.

    Args:
        options: The arguments: `overwrite` allows it, and `is_positional` says that the output was
            named without -o, where a shell's pattern may have put an existing file.
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
