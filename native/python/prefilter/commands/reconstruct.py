# SPDX-License-Identifier: GPL-3.0-or-later

"""The command `reconstruct`."""

import argparse
import os
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from ..files.staging import check_target
from ..options.flags import add_flags, given, tables
from ..options.points import ScanSettings
from ..points.extensions import POINT_EXTENSIONS
from ..points.steps import STEPS, Steps
from ..workflows.outcome import up_to_date
from ..workflows.points import STREAMED_TARGET, StepWork, Streaming
from ..workflows.points import options as scan_options
from ..workflows.wording import either, listed
from . import cli_common, outputs, tasks
from .host import PLAIN, Host

_MOST_PARTS = 4096
_NOTES = """\
Several SOURCEs count as one cloud. Points without normals are read into memory, and their normals
are estimated. All other points are read, and the surface is written, piece by piece, so that
neither has to fit into memory; with --memory-limit, the rest goes to temporary files.

examples:
  prefilter reconstruct scan.ply -o surface.ply
  prefilter reconstruct city.laz -o city.ply --depth 11 --memory-limit 600
  prefilter reconstruct left.ply right.ply -o hall.ply --viewpoint 0 0 1.5 --viewpoint 8 0 1.5
  prefilter reconstruct tile.laz -o ground.ply --classes 2 --returns last --trim 8
  prefilter reconstruct *.laz -o city.ply --depth 12 --work steps/ --step count --task 3/40"""


def add(commands: Any, purpose: str) -> None:
    """Adds the command."""
    parser = cli_common.add_command(commands, "reconstruct", purpose, *tables(ScanSettings), _NOTES)
    add_files(parser, POINT_EXTENSIONS, (STREAMED_TARGET,))
    add_settings(parser, PLAIN)
    add_steps(parser)
    parser.set_defaults(execute=partial(_reconstruct, PLAIN), usage_error=parser.error)


def add_files(
    parser: argparse.ArgumentParser, sources: Sequence[str], targets: Sequence[str]
) -> None:
    """Adds the arguments that name files, with the extensions of files to read and to write."""
    parser.add_argument(
        "sources",
        metavar="SOURCE",
        nargs="+",
        help=f"a file of points: {either(sources)}; repeat for several with -o, or name a folder "
        "of such; of two without -o, the second is TARGET",
    )
    outputs.add_output(parser, "TARGET", f"the file to write: {either(targets)}")
    parser.set_defaults(intermixed="sources")
    parser.add_argument(
        "--viewpoint",
        nargs=3,
        type=float,
        action="append",
        metavar=("X", "Y", "Z"),
        help="where the scanner stood: normals point there; repeat for each SOURCE where that "
        "differs (default: what the files say)",
    )


def resolve_files(options: argparse.Namespace) -> None:
    """Determines which files are read and written; a folder stands for its point files.

    Ends the program if it would replace a file that it reads.
    """
    outputs.resolve_files(options, ("SOURCE", "TARGET"))
    options.target = outputs.path_for(options.target, "")
    _expand_folders(options)
    outputs.check_not_replaced(options, [options.target], options.sources)
    if all(os.path.isfile(path) and not os.path.getsize(path) for path in options.sources):
        raise ValueError(f"SOURCE: {listed(options.sources)}: there is nothing in it")


def _expand_folders(options: argparse.Namespace) -> None:
    """Replaces each folder among the sources by its files of points, sorted by name."""
    paths: list[str] = []
    for source in options.sources:
        if not os.path.isdir(source):
            paths.append(source)
            continue
        files = sorted(
            path for path in Path(source).iterdir() if path.name.lower().endswith(POINT_EXTENSIONS)
        )
        if not files:
            options.usage_error(f"SOURCE: found no file of points in the folder '{source}'")
        paths += map(str, files)
    options.sources = paths


def add_settings(parser: argparse.ArgumentParser, host: Host) -> None:
    """Adds the flags of the settings."""
    host.add_preset(parser)
    sizes = ("depth", "voxel_size")
    add_flags(
        parser,
        ScanSettings,
        exclusive=sizes,
        without_default=(*sizes, "box"),
        preferred=host.preferred,
    )


def add_steps(parser: argparse.ArgumentParser) -> None:
    """Adds the flags for work in steps."""
    parser.add_argument(
        "--step",
        choices=STEPS,
        metavar="STEP",
        help=f"do one step of the work, as machines of a farm do: {', '.join(STEPS)}, in this "
        "order. The result is the same",
    )
    parser.add_argument(
        "--work", metavar="FOLDER", help="with --step, the folder of what steps leave each other"
    )
    parser.add_argument(
        "--parts",
        metavar="N",
        type=int,
        default=16,
        help=f"with --step, how many parts the surface is made in (1 to {_MOST_PARTS}; "
        "default: 16)",
    )
    tasks.add_flags(parser, "run of the step", needs="with --step, ")


def check_steps(options: argparse.Namespace) -> None:
    """Ends the program if the flags of steps contradict one another."""
    tasks.check(options)
    for name in ("work", "task", "list"):
        if options.step is None and getattr(options, name):
            options.usage_error(f"--{name}: needs --step")
    if options.step is not None and options.work is None:
        options.usage_error("--step: needs --work FOLDER")
    if not 1 <= options.parts <= _MOST_PARTS:
        options.usage_error(f"--parts: found {options.parts}; allowed: 1 to {_MOST_PARTS}")


def do_step(
    options: argparse.Namespace,
    target: Path,
    settings: ScanSettings,
    length: Callable[[float], str],
) -> None:
    """Does, or lists, this task's runs of a step."""
    sources = [Path(path) for path in options.sources]
    known = scan_options(settings) | {"viewpoint": options.viewpoint}
    steps = Steps(sources, Path(options.work), options.parts, known)
    step, runs = options.step, list(range(steps.count(options.step)))
    if options.list:
        files = [str(target if step == "join" else steps.file(step, run)) for run in runs]
        if options.json:
            tasks.print_json([{"step": step, "files": [file]} for file in files])
        else:
            for file in files:
                cli_common.print_line(file)
        return
    chosen = tasks.select(options, runs)
    for number, run in enumerate(chosen):
        with cli_common.subtask(number, len(chosen)):
            if step != "join" and steps.is_done(step, run):
                cli_common.print_line(up_to_date([steps.file(step, run)]))
            else:
                cli_common.run_and_report(StepWork(steps, step, run, target, length))


def settings_of(options: argparse.Namespace, host: Host) -> ScanSettings:
    """Returns the given settings, with those that follow from them."""
    values, more = given(options, ScanSettings), {}
    for name, resolution in (("depth", "depth"), ("voxel_size", "size")):
        if name in values:
            more["resolution"] = resolution
    if "custom_isovalue" in values:
        more["isovalue"] = "custom"
    settings: ScanSettings = host.settings(options, ScanSettings, **more)
    return settings


def _reconstruct(host: Host, options: argparse.Namespace) -> None:
    resolve_files(options)
    for path in options.sources:
        cli_common.check_extension(options, "SOURCE", path, POINT_EXTENSIONS)
    cli_common.check_extension(options, "TARGET", options.target, (STREAMED_TARGET,))
    check_steps(options)
    target = Path(os.path.realpath(options.target))
    check_target(target)
    sources = [Path(path) for path in options.sources]
    settings = settings_of(options, host)
    if options.step is not None:
        do_step(options, target, settings, "{:.4g}".format)
        return
    work = Streaming(sources, target, settings, "{:.4g}".format, options.viewpoint)
    cli_common.run_and_report(work)
