# SPDX-License-Identifier: GPL-3.0-or-later

"""The command `resample`."""

import argparse
from functools import partial
from typing import Any

import numpy as np

from ..options.flags import add_flags, given, tables
from ..options.images import CORNERS, ResampleSettings
from ..options.options import check
from ..workflows.images.resampling import Resampling
from ..workflows.up_to_date import fingerprint
from . import batch, cli_common, picture_arguments
from .batch import Pair
from .host import PLAIN, Host

_SIZES = ("width", "height")
_TRANSFORM = {
    "--rotate": "rotation",
    "--scale": "scale",
    "--scale-x": "scale_x",
    "--scale-y": "scale_y",
    "--offset-x": "offset_x",
    "--offset-y": "offset_y",
}
_WITHOUT_DEFAULT = ("rotation", "scale_x", "scale_y", "offset_x", "offset_y", "aspect", *_SIZES)
_NOTES = f"""\
Corners are eight numbers, x and y of the lower left, lower right, upper right and upper left one:
shares of the width and height of OUTPUT, or of INPUT for --rectify and if the size is fitted; with
--pixels they are in pixels. x points to the right and y up.

{picture_arguments.NOTE}

examples:
  prefilter resample photo.png -o turned.png --rotate 30 --scale 0.5
  prefilter resample poster.png -o pinned.png --size image --corners 0.1 0 1 0.1 0.9 0.9 0 1
  prefilter resample facade.png -o front.png --pixels --rectify 310 95 902 140 881 700 295 655"""


def add(commands: Any, purpose: str, host: Host = PLAIN) -> None:
    """Adds the command."""
    parser = cli_common.add_command(
        commands, "resample", purpose, *tables(ResampleSettings), _NOTES
    )
    picture_arguments.add_arguments(parser)
    parser.add_argument(
        "--corners",
        nargs=8,
        type=float,
        metavar="N",
        help="where the corners of INPUT go in OUTPUT",
    )
    parser.add_argument(
        "--rectify",
        nargs=8,
        type=float,
        metavar="N",
        help="which places of INPUT go to the corners of OUTPUT",
    )
    parser.add_argument(
        "--scale", type=float, metavar="FACTOR", help="the factor along both x and y"
    )
    host.add_preset(parser)
    add_flags(parser, ResampleSettings, without_default=_WITHOUT_DEFAULT, preferred=host.preferred)
    parser.set_defaults(execute=partial(_resample, host), usage_error=parser.error)


def _resample(host: Host, options: argparse.Namespace) -> None:
    picture_arguments.check_target(options)
    settings = _settings(options, host)
    options.also_read = [settings.table] if settings.table else []
    result_settings = picture_arguments.result_settings(options, host, ResampleSettings)
    if settings.table and options.skip_up_to_date:
        result_settings["table"] = fingerprint([settings.table], {})
    batch.run(options, partial(_resample_one, host, options, settings), result_settings)


def _resample_one(
    host: Host, options: argparse.Namespace, settings: ResampleSettings, pair: Pair
) -> None:
    picture, target = picture_arguments.read_source(options, host, pair)
    work = Resampling(picture, settings, target=target)
    work.metadata = pair.metadata
    cli_common.run_and_report(work)


def _settings(options: argparse.Namespace, host: Host) -> ResampleSettings:
    values = given(options, ResampleSettings)
    warps = [name for name in ("corners", "rectify") if getattr(options, name) is not None]
    moves = [flag for flag, name in _TRANSFORM.items() if getattr(options, name, None) is not None]
    if len(warps + moves[:1]) > 1:
        first, second = [*(f"--{name}" for name in warps), *moves][:2]
        options.usage_error(f"{first}: not allowed with {second}")
    if values.get("use_pixels") and not warps:
        options.usage_error("--pixels: give --corners or --rectify too")
    sizes = [name for name in _SIZES if name in values]
    if sizes and "size" in values and values["size"] != "pixels":
        options.usage_error(f"--{sizes[0]}: not allowed with --size {values['size']}")
    if len(sizes) == 1 or (values.get("size") == "pixels" and not sizes):
        options.usage_error("give both --width and --height")
    if sizes:
        values["size"] = "pixels"
    if (values.get("method") == "table") != ("table" in values):
        options.usage_error(
            "--table: not allowed without --method table"
            if "table" in values
            else "--method table: give --table too"
        )
    if "max_probes" in values and values.get("filter") != "gaussian":
        options.usage_error("--max-probes: not allowed without --filter gaussian")
    _complete_proportions(options, values)
    if moves:
        values["warp"] = "affine"
    if options.scale is not None:
        values = {"scale_x": options.scale, "scale_y": options.scale, **values}
    for name in warps:
        corners = np.reshape(getattr(options, name), (4, 2)).tolist()
        values |= {"warp": name, **dict(zip(CORNERS, map(tuple, corners), strict=True))}
    settings: ResampleSettings = host.settings(options, ResampleSettings, **values)
    try:
        check(settings)
    except ValueError as error:
        options.usage_error(str(error))
    return settings


def _complete_proportions(options: argparse.Namespace, values: dict[str, Any]) -> None:
    """Makes --aspect imply --proportions given; ends the program if flags contradict that."""
    for name in ("aspect", "proportions"):
        if name in values and options.rectify is None:
            options.usage_error(f"--{name}: not allowed without --rectify")
    if "aspect" in values and values.setdefault("proportions", "given") != "given":
        options.usage_error(f"--aspect: not allowed with --proportions {values['proportions']}")
    if values.get("proportions") == "given" and "aspect" not in values:
        options.usage_error("--proportions given: give --aspect too")
