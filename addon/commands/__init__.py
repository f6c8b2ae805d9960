"""`blender --background --command prefilter ...`: the operators without a window."""

import argparse
import sys
from collections.abc import Sequence

import bpy

from .. import bake
from . import mipmaps, voxels

_PROGRAM = "blender --background --command prefilter"

_handles: list[object] = []


def register() -> None:
    """Makes the command known to Blender's command line."""
    _handles.append(bpy.utils.register_cli_command("prefilter", run))


def unregister() -> None:
    """Takes the command back."""
    while _handles:
        bpy.utils.unregister_cli_command(_handles.pop())


def run(arguments: Sequence[str]) -> int:
    """Runs `prefilter ARGUMENTS`.

    Returns:
        The exit status: 0, 1 for a failure that was told on stderr, 2 for wrong arguments.
    """
    try:
        options = _parser().parse_args(arguments)
        options.execute(options)
    except SystemExit as end:
        return end.code if isinstance(end.code, int) else 0
    except bake.FAILURES as error:
        print(f"prefilter: error: {error}", file=sys.stderr)
        return 1
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog=_PROGRAM,
        description="Filters images for the surfaces that wear them, and meshes in voxels.",
    )
    commands = parser.add_subparsers(title="commands", metavar="COMMAND", required=True)
    mipmaps.add(commands)
    voxels.add(commands)
    return parser
