# SPDX-License-Identifier: GPL-3.0-or-later

"""`blender --background --command prefilter ...`: the operators without a window."""

from collections.abc import Sequence
from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING

import bpy

if TYPE_CHECKING:
    import argparse

_PROGRAM = "blender --background --command prefilter"


class Commands:
    """The commands of all subjects, from the function `add` of their optional module `command`."""

    def __init__(self, subjects: Sequence[str]) -> None:
        """Stores the folders of the subjects."""
        self._subjects = subjects
        self._handle: object = None

    def register(self) -> None:
        """Registers the command `prefilter` with Blender."""
        self._handle = bpy.utils.register_cli_command("prefilter", self.run)

    def unregister(self) -> None:
        """Unregisters it."""
        bpy.utils.unregister_cli_command(self._handle)

    def run(self, arguments: Sequence[str]) -> int:
        """Runs `prefilter ARGUMENTS`.

        Returns:
            The exit status: 0, 1 for a failure reported on stderr, 2 for wrong arguments, 130 after
            Ctrl-C, 143 after SIGTERM.
        """
        from prefilter.commands.program import execute, parse_arguments, run_to_status

        return run_to_status(
            lambda: execute(parse_arguments(self.parser(), arguments)), is_end=True
        )

    def parser(self) -> "argparse.ArgumentParser":
        """Returns the argument parser."""
        from prefilter.commands.cli_common import add_progress
        from prefilter.commands.program import Parser

        parser = Parser(
            prog=_PROGRAM,
            description=(
                "Filters images for the surfaces that use them, resizes and warps them; makes "
                "meshes of voxels and scans, and images of vector shapes."
            ),
        )
        commands = parser.add_subparsers(title="commands", metavar="COMMAND", required=True)
        for subject in self._subjects:
            name = f"{__package__}.{subject}.command"
            if find_spec(name) is not None:
                import_module(name).add(commands)
        for command in commands.choices.values():
            add_progress(command)
        return parser
