# SPDX-License-Identifier: GPL-3.0-or-later

"""Commands that process many files alike: naming the outputs, splitting tasks, skipping."""

import argparse
import os
from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from ..files.file_names import identities
from ..files.staging import check_target
from ..workflows.files import patterns
from ..workflows.up_to_date import KEY, PICTURES, fingerprint
from ..workflows.wording import listed
from . import cli_common, failures, outputs, tasks


@dataclass(frozen=True)
class Pair:
    """A file to read, and the one to write.

    Attributes:
        source: The path, as given.
        target: The path, with the source's name filled in.
        metadata: Key-value pairs to store in the file to write; None for none.
    """

    source: str
    target: str
    metadata: Mapping[str, str] | None = None

    def checked_target(self) -> Path:
        """Returns the absolute path of the file to write, symbolic links resolved.

        Raises:
            OSError: It cannot be written.
        """
        target = Path(os.path.realpath(self.target))
        check_target(target)
        return target


def add_arguments(
    parser: argparse.ArgumentParser, names: tuple[str, str], source: str, target: str
) -> None:
    """Adds the arguments that name the files.

    Args:
        parser: The parser that gets the arguments, and flags that split the work; see `run`.
        names: Metavars of the file to read and of the file to write.
        source: Description of the files that can be read.
        target: Description of the files that can be written.
    """
    parser.add_argument(
        "sources",
        metavar=names[0],
        nargs="+",
        help=f"{source}, or several with -o; of two without -o, the second is {names[1]}",
    )
    outputs.add_output(
        parser,
        names[1],
        f"the file to write: {target}. {{name}} in it stands for the name of {names[0]} without "
        f"its extension, and is needed for several",
    )
    parser.set_defaults(intermixed="sources", file_names=names)


def resolve_files(options: argparse.Namespace) -> None:
    """Determines which files are read and written; ends the program where that is ambiguous."""
    outputs.resolve_files(options, options.file_names, (outputs.NAME,))


def run(
    options: argparse.Namespace,
    process: Callable[[Pair], None],
    settings: Mapping[str, Any] | None = None,
    kinds: Sequence[str] = PICTURES,
    may_skip: Callable[[str], bool] = lambda _: True,
) -> None:
    """Processes each file of this task, or lists the tasks.

    A file that fails does not stop the others.

    Args:
        options: The arguments.
        process: Reads one file and writes another.
        settings: The settings that determine the result, if up-to-date files may be skipped;
            None if they may not.
        kinds: The extensions of files that can store the fingerprint of their inputs.
        may_skip: Tells whether a file and the settings alone determine the result.

    Raises:
        ValueError: Some files failed; for a single file, `process`'s own exception is raised.
    """
    tasks.check(options)
    pairs = _pairs(options)
    if settings is not None and options.skip_up_to_date:
        cli_common.check_stores_fingerprint(options, options.target, kinds)
        process = _skip_up_to_date(process, settings, may_skip)
    if options.list:
        _list(options, pairs)
        return
    chosen, failed = tasks.select(options, pairs), []
    for number, pair in enumerate(chosen):
        with cli_common.subtask(number, len(chosen)):
            try:
                process(pair)
            except Exception as error:
                if len(chosen) == 1 or cli_common.is_canceled(error):
                    raise
                cli_common.warn([f"'{pair.source}': {failures.describe(error)}"])
                failed.append(pair.source)
    if failed:
        raise ValueError(f"not done: {listed(failed)}")


def _skip_up_to_date(
    process: Callable[[Pair], None], settings: Mapping[str, Any], may_skip: Callable[[str], bool]
) -> Callable[[Pair], None]:
    """Returns a function like `process` that leaves up-to-date files alone."""

    def process_unless_up_to_date(pair: Pair) -> None:
        if not may_skip(pair.source):
            process(pair)
            return
        target = pair.checked_target()
        number = fingerprint([pair.source], settings)
        if not cli_common.are_up_to_date([target], number):
            process(replace(pair, metadata={KEY: number}))

    return process_unless_up_to_date


def _pairs(options: argparse.Namespace) -> list[Pair]:
    """Returns the pairs of files; ends the program where two would write the same file."""
    sources: Sequence[str] = options.sources
    if len(sources) > 1 and not patterns.has(options.target, outputs.NAME):
        options.usage_error(
            f"found '{options.target}' for {len(sources)} files; {{name}} is needed in it"
        )
    pairs = [Pair(source, outputs.path_for(options.target, source)) for source in sources]
    read = [(pair, identities(pair.source)) for pair in pairs]
    written: dict[Hashable, Pair] = {}
    for pair in pairs:
        own = identities(pair.target)
        for identity in own & written.keys():
            both = listed((written[identity].source, pair.source))
            options.usage_error(f"{both} would both become '{pair.target}'")
        written |= dict.fromkeys(own, pair)
        # Even with --overwrite: the file would be read after it was replaced.
        if any(other is not pair and not own.isdisjoint(names) for other, names in read):
            options.usage_error(f"'{pair.target}' is read; choose other files to write")
    outputs.check_not_replaced(
        options, [pair.target for pair in pairs], [*sources, *getattr(options, "also_read", ())]
    )
    return pairs


def _list(options: argparse.Namespace, pairs: Sequence[Pair]) -> None:
    if options.json:
        tasks.print_json([{"inputs": [pair.source], "files": [pair.target]} for pair in pairs])
        return
    width = max(len(pair.source) for pair in pairs)
    for pair in pairs:
        cli_common.print_line(f"{pair.source:<{width}}  {pair.target}")
