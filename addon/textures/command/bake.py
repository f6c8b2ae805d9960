# SPDX-License-Identifier: GPL-3.0-or-later

"""The command `bake`."""

import argparse
import os
import re
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import Any

import bpy
from prefilter.commands import outputs, tasks
from prefilter.workflows.files import patterns, target_files
from prefilter.workflows.up_to_date import LEVELS

from ...bridge import images
from ...bridge.files import scenes, staging
from ...core import command, presets
from ...core.flags import add_flags, given, tables
from ...core.outcome import FAILURES, reason
from ...core.wording import listed
from .. import bake_inputs, default_images, file_names, udim
from ..choices import ModelSettings, Settings
from ..gltf.choices import GltfSettings
from ..properties import BAKE, MODEL
from . import source
from .bake_all import bake_all
from .bake_gltf import bake_gltf, is_gltf

_HELP = "bake the mipmap levels of an image, weighted by the surface of the meshes that use it"
_NOTES = """\
With --all, the nodes of the materials tell what each image holds: color, normals, roughness and
other data, cut-outs. In --output, {name} stands for the name of the image; the extension of a file
takes precedence over --format. .dds and .ktx2 files get block formats by content. With a .glb or
.gltf file as --output, the model itself is exported, with KTX 2 textures (UASTC and Zstandard, or
ETC1S) whose levels are fitted to what that file shows.

Without --image, the base colors of the meshes' materials are baked, or all their images if none is
a base color. If there are several, each gets a file: texture.exr becomes texture.NAME.exr. A
picture file that no material uses is treated as the texture of all faces, with the active UV map.

examples:
  prefilter bake helmet.gltf --all --list
  prefilter bake helmet.gltf --all --output textures/
  prefilter bake helmet.gltf --all --output textures/ --task 3/5
  prefilter bake helmet.blend --all --output helmet.glb
  prefilter bake scene.blend --image Wood --save
  prefilter bake spot.obj --image spot.png -o spot.exr
  prefilter bake helmet.gltf --object Visor --filter pam-box --output visor.tif
  prefilter bake helmet.gltf --object Visor --output visor.ktx2 --texture-format bc3"""


def add(commands: Any) -> None:
    """Adds the command."""
    parser = command.add_command(
        commands,
        "bake",
        _HELP,
        *tables(Settings),
        *tables(ModelSettings),
        *tables(GltfSettings),
        _NOTES,
    )
    source.add_arguments(parser, "; with --all, bake this one alone, as the whole does")
    presets.add_flag(parser)
    add_flags(parser, Settings, short={"filepath": "-o"})
    outputs.add_overwrite(parser)
    parser.add_argument(
        "--frames",
        metavar="START:END[:STEP]",
        type=_frames,
        help="average over these frames of the animation (default: the current frame only)",
    )
    parser.add_argument(
        "--save",
        action="store_true",
        help="keep the levels as packed images in the .blend FILE, and save it",
    )
    parser.add_argument(
        "--all",
        action="store_true",
        help="bake every image of the model, each according to its content, to separate files in "
        "the folder that --output names, or into a .glb or .gltf file with that name",
    )
    add_flags(parser, ModelSettings)
    add_flags(parser, GltfSettings)
    parser.add_argument(
        "--manifest",
        metavar="FILE",
        help="with --all, a .json file that says of each image its content, size and format, and "
        "which file has it",
    )
    command.add_skip_flag(parser)
    tasks.add_flags(parser, "image, or a normal map and its roughness", needs="with --all, ")
    parser.set_defaults(execute=_bake, usage_error=parser.error)


def _bake(options: argparse.Namespace) -> None:
    extension = command.check_extension(options, "FILE", options.file, scenes.SOURCES)
    tasks.check(options)
    settings = _settings(options)
    for argument, path in _outputs(settings):
        outputs.check_path(options, argument, path, (outputs.NAME,))
    if options.save and extension != ".blend":
        options.usage_error(f"--save: needs a .blend FILE, found '{options.file}'")
    if given(options, GltfSettings) and not (options.all and is_gltf(settings.filepath)):
        options.usage_error("--fallback: needs --all, and a .glb or .gltf file as --output")
    if options.all and is_gltf(settings.filepath):
        bake_gltf(options, settings)
    elif options.all:
        bake_all(options, settings)
    else:
        _bake_some(options, settings)


def _outputs(settings: Settings) -> list[tuple[str, str]]:
    """Returns the flags of the files to write, with their values."""
    return [("--output", settings.filepath), ("--roughness-output", settings.roughness_filepath)]


def _bake_some(options: argparse.Namespace, settings: Settings) -> None:
    """Bakes one image, or the base colors."""
    for name in ("list", "file_format", "material", "manifest", "task"):
        if getattr(options, name, None):
            flag = name.removeprefix("file_")
            options.usage_error(f"--{flag}: needs --all")
    if not options.save and not settings.filepath:
        options.usage_error("nothing to write: give --output FILE or --save")
    paths = (settings.filepath, settings.roughness_filepath)
    if any(patterns.has(path, outputs.NAME) for path in paths):
        options.usage_error(f"--output: {file_names.PLACE} needs --all")
    filled = [
        outputs.checked_path(options, argument, path) for argument, path in _outputs(settings)
    ]
    settings = replace(settings, filepath=filled[0], roughness_filepath=filled[1])
    settings = source.fit_to_files(options, settings, paths)
    if settings.texture_format != "auto" and not any(map(target_files.has_formats, paths)):
        options.usage_error(
            f"--texture-format: found '{settings.texture_format}', which is for .dds and .ktx2 "
            f"files"
        )
    if settings.effort != "normal" and not any(map(target_files.has_formats, paths)):
        options.usage_error(
            f"--effort: found '{settings.effort}', which is for .dds and .ktx2 files"
        )
    if settings.supercompression != "none" and not any(
        map(target_files.has_supercompression, paths)
    ):
        options.usage_error(
            f"--supercompression: found '{settings.supercompression}', which is for .ktx2 files"
        )
    if options.skip_up_to_date:
        _check_skipping(options, paths)
    path = os.path.abspath(options.file)
    objects = source.objects_of(options)
    if options.save:
        staging.check_writable(Path(path))
    chosen, is_picture = source.images_of(options.image, objects, settings.content)
    if len(chosen) > 1 and (settings.roughness or settings.roughness_filepath):
        raise ValueError(
            f"--roughness: give --image too; without it, {len(chosen)} images are baked"
        )
    targets = default_images.output_paths(settings.filepath, chosen)
    for image, target in zip(chosen, targets, strict=True):
        for file in udim.paths(target, images.tile_numbers(image)):
            target_files.check_target(file)
    _check_sources(options, [*targets, settings.roughness_filepath])
    settings = replace(settings, roughness=_roughness_name(settings.roughness))
    failed: list[str] = []
    for image, target in zip(chosen, targets, strict=True):
        users_of_it, warnings = source.users_of(image, objects, options.object)
        command.warn(warnings)
        try:
            request = bake_inputs.Request(
                image,
                users_of_it,
                replace(settings, filepath=target),
                bpy.context.evaluated_depsgraph_get(),
                all_faces=is_picture,
                may_skip=options.skip_up_to_date,
            )
            work = bake_inputs.read(request)
            command.run_and_report(work)
        except FAILURES as error:
            if len(chosen) == 1:
                raise
            command.warn([reason(error)])
            failed.append(image.name)
    if options.save and len(failed) < len(chosen):
        scenes.save_open(path)
    if failed:
        raise ValueError(f"not baked: {listed(failed)}")


def _check_sources(options: argparse.Namespace, paths: Iterable[str]) -> None:
    """Ends the program if a file to read would be overwritten."""
    written = [file for path in paths if path for file in target_files.files_of(Path(path))]
    outputs.check_not_replaced(options, written, [options.file, *file_names.source_files()])


def _check_skipping(options: argparse.Namespace, paths: Iterable[str]) -> None:
    if options.save:
        options.usage_error("--skip-up-to-date: not allowed with --save; it looks at files alone")
    for path in filter(None, paths):
        command.check_stores_fingerprint(options, path, LEVELS)


def _frames(text: str) -> tuple[int, int, int]:
    match = re.fullmatch(r"(-?\d+):(-?\d+)(?::(\d+))?", text)
    if match is None:
        raise argparse.ArgumentTypeError(f"found '{text}'; START:END or START:END:STEP is needed")
    return int(match[1]), int(match[2]), int(match[3] or 1)


def _settings(options: argparse.Namespace) -> Settings:
    kind = MODEL if options.all else BAKE
    settings = presets.settings_given(options, kind, Settings, use_images=options.save)
    if not options.frames:
        return settings
    start, end, step = options.frames
    return replace(settings, use_frames=True, frame_start=start, frame_end=end, frame_step=step)


def _roughness_name(name: str) -> str:
    """Returns the name of the roughness image; loads a picture file as data."""
    if not name or name in bpy.data.images or not os.path.isfile(name):
        return name
    return images.load("--roughness", name, is_data=True).name
