# SPDX-License-Identifier: GPL-3.0-or-later

"""The output of `bake --all --list`: the bake of each image, and the tasks."""

import argparse
import os
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import bpy
from prefilter.commands import tasks
from prefilter.workflows.files import target_files

from ...core import command
from ...core.operator_hooks import run_steps
from ...core.wording import listed
from .. import udim
from ..choices import Settings
from ..model import table
from ..model.bake import Compute, ModelBake
from ..model.plan import Plan
from ..model.results import Results
from ..model.table import Row


def print_listing(
    options: argparse.Namespace, planned: Plan, settings: Settings, files: dict[str, str]
) -> None:
    """Prints the images of a bake: reads each image and its surfaces, and computes nothing.

    Raises:
        ValueError: There is no image to bake, or one cannot be baked.
    """
    results = Results(list(planned.left_out))
    rows_of_jobs, warnings = list[list[Row]](), list[str]()
    for job in planned.jobs():
        alone = replace(planned, left_out=[])
        model = ModelBake(alone, settings, files, jobs=[job], is_dry_run=True)
        while model.next_name:
            read(model)
        rows_of_jobs.append(model.rows)
        warnings += model.warnings
        results.left_out += model.results.left_out
        results.failed += model.results.failed
    if options.json:
        tasks.print_json(
            [{"images": [_image(row) for row in rows]} for rows in rows_of_jobs],
            left_out=[asdict(image) for image in results.left_out],
            failed=[asdict(image) for image in results.failed],
        )
    else:
        rows = [row for rows in rows_of_jobs for row in rows]
        for line in (*table.lines(rows), *results.left_out_lines()):
            command.print_line(line)
    command.warn(dict.fromkeys(warnings))
    command.warn(f"image '{one.image}' cannot be baked: {one.reason}" for one in results.failed)
    if not any(rows_of_jobs):
        raise ValueError("there is no image to bake")
    if results.failed:
        raise ValueError(f"cannot be baked: {listed(one.image for one in results.failed)}")


def read(model: ModelBake) -> Compute:
    """Reads the next image of a model at once; see `ModelBake.read_steps`."""
    return run_steps(model.read_steps(bpy.context.evaluated_depsgraph_get()))


def _image(row: Row) -> dict[str, Any]:
    """Returns the entry of an image, with the keys of a manifest and absolute paths."""
    levels = max(row.sides).bit_length()
    files = [
        str(file)
        for path in udim.paths(row.file, row.tiles)
        for file in target_files.files_of(Path(os.path.realpath(path)))[:levels]
    ]
    return {
        "image": row.image,
        "role": row.content,
        "uses": list(row.uses),
        "objects": list(row.objects),
        "files": files,
        "size": list(row.sides),
        "format": row.format,
    }
