# SPDX-License-Identifier: GPL-3.0-or-later

"""The command `plot`."""

import argparse
from functools import partial
from typing import Any

import bpy
from prefilter.commands import outputs

from ...bridge import images, new_images
from ...bridge.files import scenes, staging
from ...core import command
from ...core.flags import add_flags, given, settings_given, tables
from ...core.wording import listed
from .. import bake_inputs, file_names
from ..bake import Bake
from ..choices import PlotSettings, Settings
from ..view import errors, figure
from . import source

_PLOTTED = ("wrap", "wrap_v", "bounds", "reader")
"""The settings of a bake that affect a plot."""
_HELP = "plot the error of filters over the mip value, on the meshes that use an image"
_NOTES = """\
The figure is that of the dissertation (7.7): solid lines are the root mean square errors over the
surface at each mip value, dashed ones those over all mip values. The image is chosen as
for bake; name one if bake would bake several.

examples:
  prefilter plot spot.obj --image spot.png -o error.png
  prefilter plot scene.blend --image Wood --filters box pam-bilinear --table error.csv"""


def add(commands: Any) -> None:
    """Adds the command."""
    notes = (*tables(PlotSettings), *tables(Settings, *_PLOTTED), _NOTES)
    parser = command.add_command(commands, "plot", _HELP, *notes)
    source.add_arguments(parser)
    add_flags(parser, PlotSettings)
    add_flags(parser, Settings, *_PLOTTED)
    outputs.add_output(parser, "FILE", "a .png file to write", destination="output")
    parser.add_argument(
        "--table", metavar="FILE", default="", help="a .csv file to write the values to"
    )
    parser.set_defaults(execute=_plot, usage_error=parser.error)


def _plot(options: argparse.Namespace) -> None:
    command.check_extension(options, "FILE", options.file, scenes.SOURCES)
    if not options.output and not options.table:
        options.usage_error("nothing to write: give --output FILE or --table FILE")
    for name in ("output", "table"):
        if getattr(options, name):
            path = outputs.checked_path(options, f"--{name}", getattr(options, name))
            setattr(options, name, path)
    targets = [
        staging.check_plain_target(path, extension)
        for path, extension in ((options.output, ".png"), (options.table, ".csv"))
        if path
    ]
    objects = source.objects_of(options)
    chosen, is_picture = source.images_of(options.image, objects, "auto")
    outputs.check_not_replaced(options, targets, [options.file, *file_names.source_files()])
    if len(chosen) > 1:
        names = listed(image.name for image in chosen)
        raise ValueError(f"--image: choose one; the meshes use {names}")
    image = chosen[0]
    images.check_untiled(image)
    depsgraph = bpy.context.evaluated_depsgraph_get()
    objects, warnings = source.users_of(image, objects, options.object)
    command.warn(warnings)
    settings = settings_given(options, Settings)
    filters = given(options, PlotSettings).get("filters", errors.default_filters(settings.reader))
    work = bake_inputs.read(
        bake_inputs.Request(
            image, objects, settings, depsgraph, all_faces=is_picture, needs_surface=True
        )
    )
    assert isinstance(work, Bake)
    with command.progress_line() as progress:
        curves = errors.measure(work.source, list(dict.fromkeys(filters)), progress)
    staged = []
    try:
        for target in targets:
            if target.suffix.lower() == ".png":
                draw = partial(new_images.save_png, pixels=figure.draw(curves))
                staged.append(staging.stage_with(target, draw))
            else:
                staged.append(staging.stage_data(target, curves.table().encode()))
        staging.commit_all(staged)
    finally:
        for file in staged:
            file.discard()
    command.warn(work.warnings)
    command.print_line(curves.summary())
