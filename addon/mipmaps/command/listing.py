# SPDX-License-Identifier: GPL-3.0-or-later

"""What `bake --all --list` says: what would be done with each image, and which tasks there are."""

import argparse
import os
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import bpy
from prefilter.commands import tasks
from prefilter.workflows.files import target_files

from ...core import command
from ...core.doing import read_at_once
from ...core.wording import listed
from .. import udim
from ..choices import Settings
from ..model import table
from ..model.bake import Compute, ModelBake
from ..model.plan import Plan
from ..model.results import Results
from ..model.table import Row


def say(
    options: argparse.Namespace, planned: Plan, settings: Settings, files: dict[str, str]
) -> None:
    """Says what a bake would do: reads each image and its surfaces, and computes nothing.

    Raises:
        ValueError: There is no image to bake, or one cannot be baked.
    """
    results, found, warnings = Results(list(planned.left_out)), list[list[Row]](), list[str]()
    for job in planned.jobs():
        alone = replace(planned, left_out=[])
        model = ModelBake(alone, settings, files, jobs=[job], is_rehearsal=True)
        while model.next_name:
            read(model)
        found.append(model.rows)
        warnings += model.warnings
        results.left_out += model.results.left_out
        results.failed += model.results.failed
    if options.json:
        tasks.print_json(
            [{"images": [_image(row) for row in rows]} for rows in found],
            left_out=[asdict(one) for one in results.left_out],
            failed=[asdict(one) for one in results.failed],
        )
    else:
        rows = [row for rows in found for row in rows]
        for line in (*table.lines(rows), *results.lines_of_left_out()):
            command.print_line(line)
    command.warn(dict.fromkeys(warnings))
    command.warn(f"image '{one.image}' cannot be baked: {one.reason}" for one in results.failed)
    if not any(found):
        raise ValueError("there is no image to bake")
    if results.failed:
        raise ValueError(f"cannot be baked: {listed(one.image for one in results.failed)}")


def read(model: ModelBake) -> Compute:
    """Reads the next image of a model; see `ModelBake.reading`."""
    return read_at_once(model.reading(bpy.context.evaluated_depsgraph_get()))


def _image(row: Row) -> dict[str, Any]:
    """Returns what is known of an image, by the keys of a manifest; with absolute paths."""
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
