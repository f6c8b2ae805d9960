# SPDX-License-Identifier: GPL-3.0-or-later

"""The command `bake --all`: every image of a model."""

import argparse
import os
from dataclasses import replace
from pathlib import Path

import bpy
from prefilter.commands import tasks
from prefilter.workflows.files import target_files
from prefilter.workflows.up_to_date import LEVELS

from ...bridge import meshes
from ...bridge.files import scenes, staging
from ...core import command, presets
from ...core.flags import given
from ...core.wording import listed
from .. import file_names
from ..choices import NOT_OF_MODELS, ModelSettings, Settings
from ..model import manifest
from ..model.bake import ModelBake
from ..model.plan import Job, Plan, image_of, plan
from ..properties import MODEL
from . import listing, source
from .listing import read
from .source import WANTED


def bake_all(options: argparse.Namespace, settings: Settings) -> None:
    """Bakes all images, or lists them."""
    chosen = presets.settings_given(options, MODEL, ModelSettings)
    pattern = _pattern(options, chosen)
    settings = source.fit_to_files(options, settings, [pattern.text])
    _check(options, settings, pattern)
    path = os.path.abspath(options.file)
    (objects,) = scenes.load([options.file], meshes.may_show_image, WANTED)
    if options.save:
        staging.check_writable(Path(path))
    chosen_objects = scenes.chosen(objects, options.object, WANTED) if options.object else None
    view_layer, depsgraph = bpy.context.view_layer, bpy.context.evaluated_depsgraph_get()
    is_for_files = bool(pattern.text) and not options.save
    planned = plan(
        view_layer, depsgraph, chosen_objects, material=chosen.material, by_role=is_for_files
    )
    images = [image_of(item.key) for item in planned.items]
    parts = [item.part for item in planned.items]
    paths = file_names.paths(pattern, images, [Path(path)], parts)
    files = {item.key: file for item, file in zip(planned.items, paths, strict=True)}
    settings = replace(settings, use_images=options.save, filepath="")
    if options.list:
        listing.print_listing(options, planned, settings, files)
        return
    jobs = _jobs(options, planned)
    if not jobs and options.task is not None:
        return
    target = manifest.check_target(options.manifest) if options.manifest else None
    if _is_part(options):
        planned = replace(planned, left_out=[])  # Only the whole bake reports them.
    skips = options.skip_up_to_date
    model = ModelBake(planned, settings, files, jobs=jobs, manifest=target, may_skip=skips)
    _finish(options, model, path)


def _is_part(options: argparse.Namespace) -> bool:
    return options.task is not None or options.image is not None


def _jobs(options: argparse.Namespace, planned: Plan) -> list[Job]:
    """Returns the jobs to do: all, those of a task, or that of one image."""
    jobs = planned.jobs()
    if options.image is not None:
        jobs = [job for job in jobs if options.image in job.images]
        if not jobs:
            names = listed(item.image for item in planned.items)
            raise ValueError(
                f"--image: found no image '{options.image}' to bake; there are {names}"
            )
    return tasks.select(options, jobs)


def _finish(options: argparse.Namespace, model: ModelBake, path: str) -> None:
    """Bakes, and reports the results."""
    try:
        _bake(model)
    finally:
        model.discard()
    for line in model.results.left_out_lines():
        command.print_line(line)
    if _is_part(options) and not (model.results.failed or model.results.outcomes):
        return
    outcome = model.results.outcome()
    if options.save:
        scenes.save_open(path)
    command.print_line(outcome.summary)
    if model.results.failed:
        raise ValueError(f"not baked: {listed(one.image for one in model.results.failed)}")


def _pattern(options: argparse.Namespace, chosen: ModelSettings) -> file_names.Pattern:
    """Returns the pattern of the files; for --list without --output, in the current folder."""
    output = given(options, Settings).get("filepath", "")
    if "file_format" in given(options, ModelSettings) and file_names.is_texture(output):
        options.usage_error(f"--format: not allowed with the extension of --output, '{output}'")
    if not output and options.list and not options.save:
        output = "."
    return file_names.Pattern.of(output, f".{chosen.file_format}")


def _check(options: argparse.Namespace, settings: Settings, pattern: file_names.Pattern) -> None:
    if options.image is not None and (options.task or options.list):
        options.usage_error("--image: not allowed with --task and --list, which are of all images")
    if options.skip_up_to_date and options.save:
        options.usage_error("--skip-up-to-date: not allowed with --save; it looks at files alone")
    if options.skip_up_to_date:
        command.check_stores_fingerprint(options, pattern.text, LEVELS)
    for name in ("save", "manifest"):
        if _is_part(options) and getattr(options, name):
            options.usage_error(f"--{name}: not allowed with --task and --image, but for the whole")
    for name in given(options, Settings):
        if name in NOT_OF_MODELS and name != "filepath":
            flag = f"--{name.replace('_', '-')}".replace("filepath", "output")
            options.usage_error(f"{flag}: not allowed with --all, which finds it for each image")
    if not (options.save or options.list or pattern.text):
        options.usage_error("nothing to write: give --output FOLDER, --save or --list")
    if options.manifest and (options.list or not pattern.text):
        options.usage_error("--manifest: needs --output FOLDER, and no --list")
    if pattern.text and not file_names.is_texture(pattern.text):
        options.usage_error(f"--output: '{pattern.text}' has no extension of a texture file")
    if settings.texture_format != "auto" and not target_files.has_formats(pattern.text):
        options.usage_error(
            f"--texture-format: found '{settings.texture_format}', which is for .dds and .ktx2 "
            f"files"
        )
    if settings.effort != "normal" and not target_files.has_formats(pattern.text):
        options.usage_error(
            f"--effort: found '{settings.effort}', which is for .dds and .ktx2 files"
        )
    if settings.supercompression != "none" and not target_files.has_supercompression(pattern.text):
        options.usage_error(
            f"--supercompression: found '{settings.supercompression}', which is for .ktx2 files"
        )


def _bake(model: ModelBake) -> None:
    """Bakes one image after another, writes all of them together, and reports each."""
    with command.progress_line() as progress:
        while model.next_name:
            read(model)(progress)
            model.stage_images()
        written = model.write()
    for outcome in written:
        command.report_outcome(outcome)
    command.warn(f"image '{one.image}' is not baked: {one.reason}" for one in model.results.failed)
