# SPDX-License-Identifier: GPL-3.0-or-later

"""The entry point `prefilter`: its commands, their arguments, and their exit status."""

import argparse
import sys
from collections.abc import Callable, Sequence
from importlib import import_module
from typing import Any

from .. import _native
from .._border import stopping
from . import cli_common, failures, streams

COMMANDS = {
    "mipmaps": "make the mipmap levels of a texture, weighted by the meshes that wear it",
    "resize": "make a picture larger or smaller",
    "resample": "scale, rotate, or warp a picture between corners",
    "sampling-table": "make a sampling table, as a file and as shader code",
    "voxelize": "make closed surfaces, or volumes, of any meshes, through voxels",
    "boolean": "combine meshes by union, intersection or difference, through voxels",
    "rasterize": "make an image of curves and texts, of an SVG file, or of a UV map",
    "reconstruct": "make the surface of points that a scanner has measured",
}
"""Purpose of each command; the module of that name, with underscores, adds its arguments."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs `prefilter ARGUMENTS`.

    Returns:
        The exit status: 0, 1 for a failure reported on stderr, 2 for wrong arguments, 130
        after Ctrl-C, 143 after SIGTERM.
    """
    words = list(sys.argv[1:] if arguments is None else arguments)
    return run_to_status(lambda: execute(parse_arguments(make_parser(words[:1]), words)))


class Parser(argparse.ArgumentParser):
    """An argument parser that prints help and errors to the streams of the commands."""

    def _print_message(self, message: str, file: Any = None) -> None:
        stream = streams.output() if file is sys.stdout else streams.errors()
        streams.write(stream, message, "")


def parse_arguments(reader: argparse.ArgumentParser, words: Sequence[str]) -> argparse.Namespace:
    """Returns the arguments; files may come before, between and after flags."""
    options, left = reader.parse_known_args(words)
    name = getattr(options, "intermixed", "")
    if left and (not name or any(word.startswith("-") for word in left)):
        reader.error(f"unrecognized arguments: {' '.join(left)}")
    if left:
        setattr(options, name, [*getattr(options, name), *left])
    return options


def execute(options: argparse.Namespace) -> None:
    """Runs the chosen command and reports progress in the chosen format."""
    cli_common.use_reporter(options.progress)
    options.execute(options)


def run_to_status(run: Callable[[], object], *, is_end: bool = False) -> int:
    """Runs a command and returns its exit status; stderr says why it is not 0.

    Args:
        run: Parses the arguments and runs the command.
        is_end: Whether to discard everything that the process prints afterwards.
    """
    cli_common.use_reporter()
    with streams.redirected(is_end=is_end), stopping.handled():
        status = _status_of(run)
        if (failure := streams.failure()) is not None:
            cli_common.fail(f"not all that was said could be written: {failure.strerror}")
            status = status or 1
    return status


def _status_of(run: Callable[[], object]) -> int:
    try:
        run()
    except SystemExit as end:
        return end.code if isinstance(end.code, int) else 0
    except BaseException as error:
        if cli_common.is_canceled(error):
            cli_common.cancel()
            return stopping.status()
        cli_common.fail(failures.describe(error))
        return 1
    return 0


def make_parser(chosen: Sequence[str] = tuple(COMMANDS)) -> argparse.ArgumentParser:
    """Returns the parser of the command line.

    Args:
        chosen: The commands whose arguments are needed; the modules of others are not imported.
    """
    command_line = Parser(
        prog="prefilter",
        description=(
            "Filters images for the surfaces that use them. In Blender the same options, and more "
            "commands: blender --background --command prefilter --help"
        ),
    )
    command_line.add_argument("--version", action="version", version=f"prefilter {_native.VERSION}")
    commands = command_line.add_subparsers(title="commands", metavar="COMMAND", required=True)
    for name, purpose in COMMANDS.items():
        if name in chosen:
            import_module(f".{name.replace('-', '_')}", __package__).add(commands, purpose)
            cli_common.add_progress(commands.choices[name])
        else:
            commands.add_parser(name, help=purpose)
    return command_line
