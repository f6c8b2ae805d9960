# SPDX-License-Identifier: GPL-3.0-or-later

"""Measures the processor time of `bake --all`, for one or more installed versions in turns.

Usage: python3 bench/textures/whole_model.py MODEL NAME=FOLDER...  (--help lists the options)

A FOLDER is the BLENDER_USER_RESOURCES of an installed version: `scripts/run blender` of a checkout
installs its own in build/blender. Blender must be on PATH. Times are for the whole command over all
threads, with Blender's start and the reading of the model; "nothing" is the time of `--list`, which
neither fits nor writes a file.
"""

import argparse
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from bench import turns
from bench.peers import Measurement, run_measured
from bench.report import Report, add_json_option


class Command:
    """A bake of a model by an installed version."""

    def __init__(self, name: str, folder: Path, model: Path, flags: list[str]) -> None:
        """Stores the version and its task."""
        self.name = name
        self._environment = {"BLENDER_USER_RESOURCES": str(folder)}
        self._line = ["blender", "--background", "--command", "prefilter", "bake", str(model)]
        self._line += ["--all", *flags]

    def measure(self) -> Measurement:
        """Runs it once, to files that are then removed."""
        with tempfile.TemporaryDirectory() as folder:
            found, _ = run_measured([*self._line, "--output", folder + "/"], self._environment)
        return replace(found, seconds=found.cpu_seconds)


def main() -> None:
    """Measures the versions of the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("model", type=Path)
    parser.add_argument("versions", nargs="+", metavar="NAME=FOLDER")
    parser.add_argument("--format", default="ktx2", help="of the files (default: %(default)s)")
    parser.add_argument("--rounds", type=int, default=3, help="default: %(default)s")
    add_json_option(parser)
    options = parser.parse_args()
    flags = ["--format", options.format]
    commands = []
    for version in options.versions:
        name, _, folder = version.partition("=")
        commands.append(Command(name, Path(folder), options.model, flags))
    commands.append(Command("nothing", Path(folder), options.model, [*flags, "--list"]))
    found = turns.measure({one.name: one for one in commands}, options.rounds, uncounted=0)
    report = Report()
    title = f"bake {options.model.name} --all, processor time"
    turns.add_table(report, title, found, commands[0].name, "times")
    report.write(options.json)


if __name__ == "__main__":
    main()
