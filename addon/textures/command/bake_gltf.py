# SPDX-License-Identifier: GPL-3.0-or-later

"""The command `bake --all` with a glTF file as output: the model with fitted textures."""

import argparse
import os
from pathlib import Path

from prefilter.commands import outputs

from ...bridge import meshes
from ...bridge.files import scenes
from ...core import command
from ...core.flags import given
from ...core.wording import counted, listed
from .. import file_names
from ..choices import ModelSettings, Settings
from ..gltf import hooks
from ..gltf.choices import TEXTURE_FORMATS, GltfSettings
from ..gltf.export import Export
from .source import WANTED

_EXTENSIONS = (".glb", ".gltf")
_SUPPORTED = {
    *("filepath", "filter", "lookups", "bounds", "seam_budget", "threads"),
    *("texture_format", "effort", "supercompression", "quality"),
}


def is_gltf(path: str) -> bool:
    """Returns whether a path has the extension of a glTF file."""
    return path.lower().endswith(_EXTENSIONS)


def bake_gltf(options: argparse.Namespace, settings: Settings) -> None:
    """Exports the model by Blender's exporter with Prefilter Mipmaps."""
    _check(options)
    target = scenes.check_target(outputs.checked_path(options, "--output", settings.filepath))
    (objects,) = scenes.load([options.file], meshes.may_show_image, WANTED)
    if not options.overwrite:
        _check_sources(options, target)
    chosen_objects = scenes.chosen(objects, options.object, WANTED) if options.object else []
    shared = {"texture_format", "effort", "supercompression", "quality"}
    chosen = {key: value for key, value in given(options, Settings).items() if key in shared}
    fallback = given(options, GltfSettings)
    export = Export(settings, GltfSettings(use_mipmaps=True, **chosen, **fallback))
    with hooks.exporting(export):
        scenes.save_gltf(target, [obj.name for obj in chosen_objects])
    command.warn(export.warnings)
    for note in export.notes:
        command.print_line(note)
    command.print_line(f"Baked {counted(export.baked, 'image')} into '{target}'")
    if export.failed:
        raise ValueError(f"not baked: {listed(export.failed)}")


def _check(options: argparse.Namespace) -> None:
    """Refuses flags that do not apply to glTF files."""
    unsupported = {*given(options, Settings), *given(options, ModelSettings)} - _SUPPORTED
    unsupported |= {
        name
        for name in ("image", "frames", "save", "list", "manifest", "task", "skip_up_to_date")
        if getattr(options, name, None)
    }
    flags = [
        f"--{name.removeprefix('use_').removeprefix('file_').replace('_', '-')}"
        for name in sorted(unsupported)
    ]
    if flags:
        options.usage_error(f"{flags[0]}: not allowed with a .glb or .gltf file as --output")
    texture_format = given(options, Settings).get("texture_format")
    if texture_format not in (None, *TEXTURE_FORMATS):
        options.usage_error(
            f"--texture-format: found '{texture_format}'; with a .glb or .gltf file as --output, "
            f"{' or '.join(TEXTURE_FORMATS)} is needed"
        )


def _check_sources(options: argparse.Namespace, target: Path) -> None:
    """Raises ValueError if the export could overwrite files of the model."""
    sources = [Path(os.path.realpath(path)) for path in (options.file, *file_names.source_files())]
    folders = {source.parent for source in sources} if target.suffix.lower() == ".gltf" else set()
    if target in sources or target.parent in folders:
        raise ValueError(
            f"--output: '{target}' is among the files of the model, which stay as they are; "
            "choose another folder, or give --overwrite"
        )
