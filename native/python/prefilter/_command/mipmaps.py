# SPDX-License-Identifier: GPL-3.0-or-later

"""The command `mipmaps`."""

import argparse
import os
from collections.abc import Mapping
from dataclasses import asdict, replace
from functools import partial
from pathlib import Path
from typing import Any

from .._border.replacing import recover
from .._border.staging import StagedFile, commit_all
from .._options.flags import add_flags, given, tables
from .._options.mipmaps import FILTERS, TEXTURE_SPACE_FILTERS, Settings
from .._work import mesh_files, picture_files
from .._work.files import engines, textures
from .._work.mipmaps import checks, contents, levels, stretching
from .._work.mipmaps.checks import Rough
from .._work.mipmaps.outputs import Outputs, staged, summary
from .._work.mipmaps.source import Source
from .._work.outcome import Outcome
from .._work.picture import Encoding, Picture
from .._work.progress import Progress, go_on, share
from .._work.up_to_date import ENDING, KEY, fingerprint, is_up_to_date
from .._work.wording import either, listed
from . import telling

FLAGS = (
    *("filter", "reader", "lookups", "wrap", "wrap_v", "content", "threshold", "roughness"),
    *("roughness_channel", "bounds", "seam_budget", "filepath", "roughness_filepath"),
    *("texture_format", "effort", "supercompression", "quality", "use_multiples_of_4", "threads"),
)
"""The options of a bake that need no Blender."""
_WITHOUT_MESH = "ls-bilinear"
_FILTERED = 0.9  # What the progress is once the levels are filtered.
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
    parser = telling.add_command(commands, "mipmaps", purpose, *notes)
    parser.add_argument("texture", metavar="TEXTURE", help="a picture file")
    parser.add_argument(
        "meshes",
        metavar="MESH",
        nargs="*",
        help=f"a file of meshes that wear it: {either(mesh_files.ENDINGS)}; repeat for several",
    )
    parser.add_argument(
        "--object",
        metavar="NAME",
        action="append",
        default=[],
        help="a mesh of the files that counts; repeat for several (default: all)",
    )
    add_flags(parser, Settings, *FLAGS, short={"filepath": "-o"})
    parser.add_argument(
        "--skip-up-to-date",
        action="store_true",
        help="do nothing where the .ktx2 files were made of the same inputs, by their contents, "
        "with the same settings; the files then keep a number that tells",
    )
    parser.set_defaults(execute=_run, usage_error=parser.error)


class Levels:
    """The levels of one texture, to a file."""

    def __init__(
        self,
        source: Source,
        outputs: Outputs,
        warnings: list[str],
        metadata: Mapping[str, str] | None = None,
    ) -> None:
        """Takes what was read, and what KTX 2 files are to keep, by keys."""
        self._metadata = metadata
        self._source = source
        self._outputs = outputs
        self._warnings = warnings
        self._notes: list[str] = []
        self._staged: list[StagedFile] = []

    def compute(self, progress: Progress) -> None:
        """Filters, encodes and stages the files.

        Raises:
            prefilter.Cancelled: `progress` returned False.
            ValueError: The library refuses the image or the surfaces.
            OSError: A file cannot be written.
        """
        source = self._source
        go_on(progress, 0.0)
        outputs, told = stretching.stretch(source, self._outputs, progress)
        rough = outputs.roughness
        self._notes += told
        made, made_rough, note = levels.filtered(
            source, rough, share(progress, 0.0, _FILTERED), all_levels=True
        )
        self._notes += [note] if note else []
        check = partial(go_on, progress, _FILTERED)
        stage = partial(
            staged,
            settings=source.settings,
            wrap=source.wrap,
            check=check,
            metadata=self._metadata,
        )
        files, _ = stage(source.picture, made, outputs.target, source.settings.texture_format)
        self._staged += files
        if rough is not None:
            target = outputs.roughness_target
            files, _ = stage(rough.picture, made_rough, target, rough.texture_format)
            self._staged += files
        go_on(progress, 1.0)

    def write(self) -> Outcome:
        """Puts the files into place: all, or none."""
        commit_all(self._staged)
        return Outcome(
            summary(self._source, self._outputs),
            files=[str(path) for path in self._outputs.targets],
            warnings=self._warnings,
            notes=self._notes,
        )

    def discard(self) -> None:
        """Removes what was staged, if it was not put into place."""
        for file in self._staged:
            file.discard()


def _run(options: argparse.Namespace) -> None:
    for path in options.meshes:
        telling.check_ending(options, "MESH", path, mesh_files.ENDINGS)
    settings = _settings(options)
    number = _fingerprint(options, settings) if options.skip_up_to_date else None
    if number is not None:
        targets = [textures.check_target(path) for path in _paths(settings)]
        for target in targets:
            recover(target.parent)
        if is_up_to_date(targets, number):
            print(f"Up to date: {listed(map(str, targets))}")
            return
    metadata = None if number is None else {KEY: number}
    telling.tell(telling.done(_read(options, settings, metadata)))


def _paths(settings: Settings) -> list[str]:
    return [path for path in (settings.filepath, settings.roughness_filepath) if path]


def _fingerprint(options: argparse.Namespace, settings: Settings) -> str:
    """Returns what the files keep; ends the program where one cannot."""
    for path in _paths(settings):
        if not path.lower().endswith(ENDING):
            options.usage_error(f"--skip-up-to-date: found '{path}', and only .ktx2 files can tell")
    chosen = asdict(settings)
    for name in ("filepath", "roughness_filepath", "roughness", "threads"):
        del chosen[name]
    sources = [options.texture, *([settings.roughness] if settings.roughness else [])]
    chosen["objects of the meshes"] = options.object
    chosen["sources"] = [len(sources), len(options.meshes)]
    return fingerprint([*sources, *options.meshes], chosen)


def _settings(options: argparse.Namespace) -> Settings:
    """Returns the settings; ends the program where flags do not go together."""
    found = given(options, Settings)
    if not found.get("filepath"):
        options.usage_error("nothing to write: give -o FILE")
    if options.object and not options.meshes:
        options.usage_error("--object: needs a MESH")
    if not options.meshes and found.setdefault("filter", _WITHOUT_MESH) not in (
        TEXTURE_SPACE_FILTERS
    ):
        options.usage_error(
            f"--filter {found['filter']}: needs a MESH; without: {', '.join(_without_mesh())}"
        )
    settings = Settings(**found, use_images=False)
    paths = (settings.filepath, settings.roughness_filepath)
    for name, may in (
        ("texture_format", engines.has_formats),
        ("effort", engines.has_formats),
        ("supercompression", engines.has_supercompression),
    ):
        if name in found and not any(map(may, paths)):
            flag = f"--{name.replace('_', '-')}"
            endings = ".ktx2" if name == "supercompression" else ".dds and .ktx2"
            options.usage_error(f"{flag}: found '{found[name]}', which is for {endings} files")
    return settings


def _without_mesh() -> list[str]:
    return [name for name in FILTERS if name in TEXTURE_SPACE_FILTERS]


def _read(
    options: argparse.Namespace, settings: Settings, metadata: Mapping[str, str] | None
) -> Levels:
    """Reads the files, and checks what the settings say of them."""
    target = textures.check_target(settings.filepath)
    is_data = settings.content in {"normal", "data"}
    picture = picture_files.read("TEXTURE", options.texture, is_data=is_data)
    _check_sources([options.texture, settings.roughness, *options.meshes], settings)
    content = settings.content
    if content == "auto":
        content = "data" if picture.is_data else "color"
    is_encoded = picture.encoding is not Encoding.NONE
    picture = contents.as_content(picture, content)
    if content == "cutout":
        contents.check_cutout(picture)
    blocks = settings.texture_format == "blocks"
    if blocks:
        chosen = checks.suiting_blocks([picture], content)
        settings = replace(settings, texture_format=chosen)
    threshold = settings.threshold if content == "cutout" else None
    told = engines.checked(
        picture,
        target,
        settings.texture_format,
        threshold,
        may_lose_channels=blocks,
        is_stretched=settings.use_multiples_of_4,
    )
    rough = checks.roughness_of(settings, picture, content, [target], partial(_rough, settings))
    if rough.roughness is not None:
        told += engines.checked(
            rough.roughness.picture,
            rough.target,
            rough.roughness.texture_format,
            may_lose_channels=blocks,
            is_stretched=settings.use_multiples_of_4,
        )
    told += checks.odd_uses(settings, picture, content, [target], rough, is_encoded=is_encoded)
    outputs = Outputs(target, *_of(rough))
    return Levels(_on_meshes(options, settings, picture, content, told), outputs, told, metadata)


def _on_meshes(
    options: argparse.Namespace,
    settings: Settings,
    picture: Picture,
    content: str,
    told: list[str],
) -> Source:
    """Returns the picture on its surfaces; `told` gets what is to be known of these, first."""
    parts = mesh_files.chosen(mesh_files.read("MESH", options.meshes), options.object)
    surfaces, names, without = mesh_files.surfaces(parts)
    wrap = "repeat" if settings.wrap == "auto" else settings.wrap
    wraps = (wrap, wrap if settings.wrap_v == "same" else settings.wrap_v)
    told[:0] = without
    return Source(picture, surfaces, names, settings, content, wraps)


def _rough(settings: Settings) -> Picture:
    return picture_files.read("--roughness", settings.roughness, is_data=True)


def _of(rough: Rough) -> tuple[contents.Roughness | None, Path | None]:
    return rough.roughness, rough.target


def _check_sources(sources: list[str], settings: Settings) -> None:
    """Raises ValueError where a file that is read would be replaced."""
    read = {os.path.realpath(path) for path in sources if path}
    for path in (settings.filepath, settings.roughness_filepath):
        if path and os.path.realpath(path) in read:
            raise ValueError(f"'{path}' is read; choose another file to write")
