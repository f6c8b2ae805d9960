# SPDX-License-Identifier: GPL-3.0-or-later

"""The command `mipmaps`."""

import argparse
from dataclasses import asdict
from pathlib import Path
from typing import Any

from ..options.flags import add_flags, given, tables
from ..options.textures import FILTERS, TEXTURE_SPACE_FILTERS, Settings
from ..workflows import mesh_extensions
from ..workflows.files import target_files
from ..workflows.up_to_date import KEY, LEVELS, fingerprint
from ..workflows.wording import either
from . import cli_common, color_arguments, outputs

FLAGS = (
    *("filter", "reader", "lookups", "wrap", "wrap_v", "content", "threshold", "roughness"),
    *("roughness_channel", "bounds", "seam_budget", "filepath", "roughness_filepath"),
    *("texture_format", "effort", "supercompression", "quality", "use_multiples_of_4", "threads"),
)
"""The options of a bake that need no Blender."""
_WITHOUT_MESH = "ls-bilinear"
_NOTES = """\
TEXTURE is taken as the texture of all faces of every MESH. Materials are not read: --content says
what the texture holds, where it is not color, and --wrap auto is repeat. Without a MESH the filter
is ls-bilinear unless --filter says otherwise. Files get all levels.

examples:
  prefilter mipmaps spot.png spot.obj -o spot.ktx2 --texture-format blocks
  prefilter mipmaps normal.png helmet.glb --object Visor -o normal.dds --content normal
  prefilter mipmaps tiles.png -o tiles.exr"""


def add(commands: Any, purpose: str) -> None:
    """Adds the command."""
    notes = (*tables(Settings, *FLAGS), _NOTES)
    parser = cli_common.add_command(commands, "mipmaps", purpose, *notes)
    parser.add_argument("texture", metavar="TEXTURE", help="a picture file")
    parser.add_argument(
        "meshes",
        metavar="MESH",
        nargs="*",
        help=f"a file of meshes that wear it: {either(mesh_extensions.READABLE)}; "
        "repeat for several",
    )
    parser.add_argument(
        "--object",
        metavar="NAME",
        action="append",
        default=[],
        help="a mesh of the files that counts; repeat for several (default: all)",
    )
    add_flags(parser, Settings, *FLAGS, short={"filepath": "-o"})
    color_arguments.add_flags(parser, "TEXTURE")
    outputs.add_overwrite(parser)
    cli_common.add_skip_flag(parser)
    parser.set_defaults(intermixed="meshes", execute=_run, usage_error=parser.error)


def _run(options: argparse.Namespace) -> None:
    for path in options.meshes:
        cli_common.check_extension(options, "MESH", path, mesh_extensions.READABLE)
    settings = _settings(options)
    _check_files(options, settings)
    number = _fingerprint(options, settings) if options.skip_up_to_date else None
    if number is not None:
        targets = [target_files.check_target(path) for path in _paths(settings)]
        if cli_common.are_up_to_date(targets, number):
            return
    metadata = None if number is None else {KEY: number}
    from . import mipmap_levels  # Imported late: a run in which all is up to date needs none of it.

    work = mipmap_levels.read(
        options.texture, options.meshes, options.object, settings, metadata, options
    )
    cli_common.run_and_report(work)


def _check_files(options: argparse.Namespace, settings: Settings) -> None:
    """Ends the program if it would replace a file that it reads."""
    written = [file for path in _paths(settings) for file in target_files.files_of(Path(path))]
    sources = [options.texture, settings.roughness, *options.meshes]
    outputs.check_not_replaced(options, written, filter(None, sources))


def _paths(settings: Settings) -> list[str]:
    return [path for path in (settings.filepath, settings.roughness_filepath) if path]


def _fingerprint(options: argparse.Namespace, settings: Settings) -> str:
    """Returns the fingerprint of all inputs; ends the program if a file cannot store it."""
    for path in _paths(settings):
        cli_common.check_stores_fingerprint(options, path, LEVELS)
    chosen = asdict(settings)
    for name in ("filepath", "roughness_filepath", "roughness", "threads"):
        del chosen[name]
    sources = [options.texture, *([settings.roughness] if settings.roughness else [])]
    chosen |= {name: getattr(options, name) for name in ("colorspace", "clip")}
    chosen["objects of the meshes"] = options.object
    chosen["sources"] = [len(sources), len(options.meshes)]
    return fingerprint([*sources, *options.meshes], chosen)


def _settings(options: argparse.Namespace) -> Settings:
    """Returns the settings; ends the program if flags contradict one another."""
    values = given(options, Settings)
    if not values.get("filepath"):
        options.usage_error("nothing to write: give -o FILE")
    for name, flag in (("filepath", "-o"), ("roughness_filepath", "--roughness-output")):
        if values.get(name):
            values[name] = outputs.checked_path(options, flag, values[name], options.texture)
    if options.object and not options.meshes:
        options.usage_error("--object: needs a MESH")
    if not options.meshes and values.setdefault("filter", _WITHOUT_MESH) not in (
        TEXTURE_SPACE_FILTERS
    ):
        options.usage_error(
            f"--filter {values['filter']}: needs a MESH; without: {', '.join(_without_mesh())}"
        )
    settings = Settings(**values, use_images=False)
    paths = (settings.filepath, settings.roughness_filepath)
    for name, may in (
        ("texture_format", target_files.has_formats),
        ("effort", target_files.has_formats),
        ("supercompression", target_files.has_supercompression),
    ):
        if name in values and not any(map(may, paths)):
            flag = f"--{name.replace('_', '-')}"
            endings = ".ktx2" if name == "supercompression" else ".dds and .ktx2"
            options.usage_error(f"{flag}: found '{values[name]}', which is for {endings} files")
    return settings


def _without_mesh() -> list[str]:
    return [name for name in FILTERS if name in TEXTURE_SPACE_FILTERS]
