"""The commands `bake`, `plot` and `bake-cache`."""

import argparse
import os
import re
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import bpy

from ..bridge import images, meshes, new_images
from ..bridge.files import engines, scenes, staging, textures
from ..core import command
from ..core.flags import add_flags, given, tables
from ..core.outcome import FAILURES
from ..core.wording import either, listed
from . import reading, texture_cache, udim, unnamed, users
from .bake import Bake
from .choices import PlotSettings, Settings
from .view import errors, figure

_WANTED = "mesh object"
_PLOTTED = ("wrap", "wrap_v", "bounds", "reader")
"""The settings of a bake that matter to a plot."""
_BAKE_HELP = "bake the mipmap levels of an image, weighted by the surface of the meshes that use it"
_PLOT_HELP = "plot the error of filters over the mip value, on the meshes that use an image"
_BAKE_NOTES = """\
Without --image, the images are baked that are base colors of the meshes' materials; or all that
the materials show where none is. Of several, each gets a file: texture.exr becomes
texture.NAME.exr. A picture file that no material uses is taken as the texture of all faces, with
the active UV map.

examples:
  prefilter bake scene.blend --image Wood --save
  prefilter bake spot.obj --image spot.png --output spot.exr
  prefilter bake helmet.gltf --object Visor --filter pam-box --output visor.tif
  prefilter bake helmet.gltf --object Visor --output visor.ktx2 --texture-format bc3"""

_PLOT_NOTES = """\
The figure is that of the dissertation (7.7): solid lines are the root mean square errors over the
surface at each mip value, dashed ones those over all mip values. The image is chosen as for bake,
and has to be named where that would bake several.

examples:
  prefilter plot spot.obj --image spot.png --output error.png
  prefilter plot scene.blend --image Wood --filters box pam-bilinear --table error.csv"""
_CACHE_HELP = "bake PAM into Cycles' texture cache, for every image of a scene"
_CACHE_NOTES = """\
Blender makes the cache files, in the folder of its preferences or beside the images; their levels
are then replaced. Files that are there are overwritten. When an image file changes, Blender makes
its cache file anew, and it has to be baked again. Needs Blender 5.2 LTS or later.

example:
  prefilter bake-cache scene.blend --save"""


def add(commands: Any) -> None:
    """Adds the commands."""
    _add_bake(commands)
    _add_plot(commands)
    _add_bake_cache(commands)


def _add_bake(commands: Any) -> None:
    parser = command.add_command(commands, "bake", _BAKE_HELP, *tables(Settings), _BAKE_NOTES)
    _add_scene(parser)
    add_flags(parser, Settings)
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
    parser.set_defaults(execute=_bake, usage_error=parser.error)


def _add_scene(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("file", metavar="FILE", help=f"a file: {either(scenes.SOURCES)}")
    parser.add_argument(
        "--object",
        metavar="NAME",
        action="append",
        default=[],
        help="a mesh object or collection instance that counts; repeat for several (default: all "
        "visible ones that use the image)",
    )
    parser.add_argument(
        "--image",
        metavar="NAME",
        help="the image: its name in the file, or the path of a picture file",
    )


def _add_plot(commands: Any) -> None:
    notes = (*tables(PlotSettings), *tables(Settings, *_PLOTTED), _PLOT_NOTES)
    parser = command.add_command(commands, "plot", _PLOT_HELP, *notes)
    _add_scene(parser)
    add_flags(parser, PlotSettings)
    add_flags(parser, Settings, *_PLOTTED)
    parser.add_argument("--output", metavar="FILE", default="", help="a .png file to write")
    parser.add_argument(
        "--table", metavar="FILE", default="", help="a .csv file to write the values to"
    )
    parser.set_defaults(execute=_plot, usage_error=parser.error)


def _add_bake_cache(commands: Any) -> None:
    parser = command.add_command(commands, "bake-cache", _CACHE_HELP, _CACHE_NOTES)
    parser.add_argument("file", metavar="FILE", help="a .blend file")
    parser.add_argument(
        "--scene", metavar="NAME", help="the scene that is rendered (default: the active one)"
    )
    parser.add_argument(
        "--unpack",
        action="store_true",
        help="write packed images to the folder textures beside FILE first, and bake these; FILE "
        "uses them if it is saved",
    )
    add_flags(parser, Settings, "threads")
    parser.add_argument(
        "--save", action="store_true", help="save FILE with the scene's texture cache turned on"
    )
    parser.set_defaults(execute=_bake_cache, usage_error=parser.error)


def _bake_cache(options: argparse.Namespace) -> None:
    command.check_ending(options, "FILE", options.file, [".blend"])
    path = os.path.abspath(options.file)
    scenes.load([path], meshes.may_show_image, _WANTED)
    if options.save:
        staging.check_writable(Path(path))
    scene = bpy.context.scene if options.scene is None else bpy.data.scenes.get(options.scene)
    if scene is None:
        known = listed(other.name for other in bpy.data.scenes)
        raise ValueError(f"--scene: found no scene named '{options.scene}'; the file has {known}")
    bpy.context.window.scene = scene
    depsgraph = bpy.context.evaluated_depsgraph_get()
    work = texture_cache.CacheBake.read(
        scene, depsgraph, unpack=options.unpack, **given(options, Settings)
    )
    outcome = command.done(work)
    if options.save:
        scenes.save_open(path)
    command.tell(outcome)


def _frames(text: str) -> tuple[int, int, int]:
    found = re.fullmatch(r"(-?\d+):(-?\d+)(?::(\d+))?", text)
    if found is None:
        raise argparse.ArgumentTypeError(f"found '{text}'; START:END or START:END:STEP is needed")
    return int(found[1]), int(found[2]), int(found[3] or 1)


def _plot(options: argparse.Namespace) -> None:
    command.check_ending(options, "FILE", options.file, scenes.SOURCES)
    if not options.output and not options.table:
        options.usage_error("nothing to write: give --output FILE or --table FILE")
    targets = [
        staging.check_plain_target(path, ending)
        for path, ending in ((options.output, ".png"), (options.table, ".csv"))
        if path
    ]
    objects = _objects(options)
    chosen, is_picture = _images(options.image, objects, "auto")
    if len(chosen) > 1:
        found = listed(image.name for image in chosen)
        raise ValueError(f"--image: needed, as the meshes use {found}")
    image = chosen[0]
    images.check_untiled(image)
    depsgraph = bpy.context.evaluated_depsgraph_get()
    objects, warnings = _users(image, objects, options.object)
    command.warn(warnings)
    settings = Settings(**given(options, Settings))
    filters = given(options, PlotSettings).get("filters", errors.default_filters(settings.reader))
    source = reading.read(
        image,
        objects,
        settings,
        depsgraph,
        all_faces=is_picture,
        needs_surface=True,
    )
    assert isinstance(source, Bake)
    progress = command.ProgressLine()
    try:
        curves = errors.measure(source, list(dict.fromkeys(filters)), progress)
    finally:
        progress.end()
    staged = []
    try:
        for target in targets:
            if target.suffix.lower() == ".png":
                draw = partial(new_images.save_png, pixels=figure.draw(curves))
                staged.append(staging.stage_with(target, draw))
            else:
                write = partial(Path.write_text, data=curves.table())
                staged.append(staging.stage_with(target, write))
        staging.commit_all(staged)
    finally:
        for file in staged:
            file.discard()
    command.warn(source.warnings)
    print(curves.summary())


def _bake(options: argparse.Namespace) -> None:
    extension = command.check_ending(options, "FILE", options.file, scenes.SOURCES)
    settings = _settings(options)
    if options.save and extension != ".blend":
        options.usage_error(f"--save: needs a .blend FILE, found '{options.file}'")
    if not options.save and not settings.filepath:
        options.usage_error("nothing to write: give --output FILE or --save")
    paths = (settings.filepath, settings.roughness_filepath)
    if settings.texture_format != "auto" and not any(map(engines.has_formats, paths)):
        options.usage_error(
            f"--texture-format: found '{settings.texture_format}', which is for .dds and .ktx2 "
            f"files"
        )
    path = os.path.abspath(options.file)
    objects = _objects(options)
    if options.save:
        staging.check_writable(Path(path))
    chosen, is_picture = _images(options.image, objects, settings.content)
    if len(chosen) > 1 and (settings.roughness or settings.roughness_filepath):
        raise ValueError(f"--roughness: needs --image, as {len(chosen)} images are baked without")
    targets = unnamed.output_paths(settings.filepath, chosen)
    for image, target in zip(chosen, targets, strict=True):
        for file in udim.paths(target, images.tile_numbers(image)):
            textures.check_target(file)
    settings = replace(settings, roughness=_roughness_name(settings.roughness))
    failed: list[str] = []
    for image, target in zip(chosen, targets, strict=True):
        users_of_it, warnings = _users(image, objects, options.object)
        command.warn(warnings)
        try:
            work = reading.read(
                image,
                users_of_it,
                replace(settings, filepath=target),
                bpy.context.evaluated_depsgraph_get(),
                all_faces=is_picture,
            )
            command.tell(command.done(work))
        except FAILURES as error:
            if len(chosen) == 1:
                raise
            command.warn([str(error)])
            failed.append(image.name)
    if options.save and len(failed) < len(chosen):
        scenes.save_open(path)
    if failed:
        raise ValueError(f"not baked: {listed(failed)}")


def _settings(options: argparse.Namespace) -> Settings:
    settings = Settings(**given(options, Settings), use_images=options.save)
    if not options.frames:
        return settings
    start, end, step = options.frames
    return replace(settings, use_frames=True, frame_start=start, frame_end=end, frame_step=step)


def _objects(options: argparse.Namespace) -> list[bpy.types.Object]:
    (objects,) = scenes.load([options.file], meshes.may_show_image, _WANTED)
    return scenes.chosen(objects, options.object, _WANTED)


def _users(
    image: bpy.types.Image,
    objects: list[bpy.types.Object],
    names: Sequence[str],
) -> tuple[list[bpy.types.Object], list[str]]:
    """Returns those that use the image of objects that nobody has named, and warnings.

    Where none does, all are returned.
    """
    if names:
        return objects, []
    shown, warnings = users.users_of(image, bpy.context)
    return [obj for obj in objects if obj in shown] or objects, warnings


def _images(
    name: str | None, objects: Sequence[bpy.types.Object], content: str
) -> tuple[list[bpy.types.Image], bool]:
    """Returns the images to bake, and whether it is a picture file from the command line."""
    if name is None:
        chosen, line = unnamed.images_to_bake(objects)
        if line:
            print(line)
        return chosen, False
    if name not in bpy.data.images and os.path.isfile(name):
        return [images.load("--image", name, is_data=content in {"normal", "data"})], True
    return [images.find(name)], False


def _roughness_name(name: str) -> str:
    """Returns the name of the image; a picture file is loaded as data."""
    if not name or name in bpy.data.images or not os.path.isfile(name):
        return name
    return images.load("--roughness", name, is_data=True).name
