# SPDX-License-Identifier: GPL-3.0-or-later

"""The command `bake-cache`."""

import argparse
import os
from pathlib import Path
from typing import Any

import bpy
from prefilter.commands import tasks

from ..bridge import meshes
from ..bridge.files import scenes, staging
from ..core import command
from ..core.flags import add_flags, settings_given
from ..core.wording import listed
from .bake import CacheBake
from .choices import CacheSettings

_HELP = "bake PAM into Cycles' texture cache, for every image of a scene"
_NOTES = """\
Blender makes the cache files, in the folder of its preferences or beside the images; their levels
are then replaced. Existing files are overwritten. When an image file changes, Blender generates its
cache file again, and you need to bake again. Needs Blender 5.2 LTS or later.

examples:
  prefilter bake-cache scene.blend --save
  prefilter bake-cache scene.blend --task 3/40"""


def add(commands: Any) -> None:
    """Adds the command."""
    parser = command.add_command(commands, "bake-cache", _HELP, _NOTES)
    parser.add_argument("file", metavar="FILE", help="a .blend file")
    parser.add_argument(
        "--scene", metavar="NAME", help="the scene that is rendered (default: the active one)"
    )
    parser.add_argument(
        "--unpack",
        action="store_true",
        help="write packed images to the folder textures beside FILE first, and bake these; with "
        "--save, FILE uses them",
    )
    add_flags(parser, CacheSettings)
    parser.add_argument(
        "--save", action="store_true", help="save FILE with the scene's texture cache turned on"
    )
    command.add_skip_flag(parser)
    tasks.add_flags(parser, "image file")
    parser.set_defaults(execute=_bake_cache, usage_error=parser.error)


def _bake_cache(options: argparse.Namespace) -> None:
    command.check_extension(options, "FILE", options.file, [".blend"])
    tasks.check(options)
    for name in ("save", "unpack"):
        if getattr(options, name) and (options.task or options.list):
            options.usage_error(f"--{name}: not allowed with --task and --list, but for the whole")
    path = os.path.abspath(options.file)
    scenes.load([path], meshes.may_show_image, "mesh object")
    if options.save:
        staging.check_writable(Path(path))
    scene = bpy.context.scene if options.scene is None else bpy.data.scenes.get(options.scene)
    if scene is None:
        names = listed(other.name for other in bpy.data.scenes)
        raise ValueError(f"--scene: found no scene named '{options.scene}'; the file has {names}")
    bpy.context.window.scene = scene
    depsgraph = bpy.context.evaluated_depsgraph_get()
    work = CacheBake.read(
        scene,
        depsgraph,
        unpack=options.unpack,
        threads=settings_given(options, CacheSettings).threads,
    )
    work.may_skip = options.skip_up_to_date
    if options.list:
        _list(options, work)
        return
    if options.task is not None:
        work.keep(tasks.select(options, list(work.tasks)))
        if not work.tasks:
            return
    outcome = command.run_work(work)
    if options.save:
        scenes.save_open(path)
    command.report_outcome(outcome)


def _list(options: argparse.Namespace, work: CacheBake) -> None:
    if options.json:
        items = work.tasks.items()
        tasks.print_json([{"inputs": [str(path)], "images": names} for path, names in items])
    else:
        for path, names in work.tasks.items():
            command.print_line(f"{path}  {', '.join(names)}")
    command.warn(work.warnings)
