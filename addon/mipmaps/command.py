"""The commands `bake`, `plot` and `bake-cache`."""

import argparse
import math
import os
import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import bpy

from ..bridge import images, new_images
from ..bridge.files import engines, staging, textures
from ..core import command
from ..core.wording import listed
from . import choices, reading, texture_cache, udim, unnamed, users
from .view import errors, figure

_IMPORTERS: dict[str, Callable[[str], Any]] = {
    ".glb": lambda path: bpy.ops.import_scene.gltf(filepath=path),
    ".gltf": lambda path: bpy.ops.import_scene.gltf(filepath=path),
    ".obj": lambda path: bpy.ops.wm.obj_import(filepath=path),
}
_EXTENSIONS = (".blend", *_IMPORTERS)


_BAKE_HELP = "bake the mipmap levels of an image, weighted by the surface of the meshes that use it"
_PLOT_HELP = "plot the error of filters over the mip value, on the meshes that use an image"


_TABLES = (
    command.table("filters", choices.FILTERS),
    command.table("wrap modes", choices.WRAPS | choices.WRAPS_V),
    command.table("value ranges", choices.BOUNDS),
    command.table("readers", choices.READERS),
    command.table("contents", choices.CONTENTS),
)
_FORMAT_TABLE = command.table("texture formats, for .dds and .ktx2", choices.TEXTURE_FORMATS)
_CHOSEN = {
    "filter": (choices.FILTERS, "FILTER", "how a texel of a level is made"),
    "wrap": (choices.WRAPS, "MODE", "what lies outside of the image along u"),
    "wrap-v": (choices.WRAPS_V, "MODE", "the same along v"),
    "bounds": (choices.BOUNDS, "RANGE", "the values that texels of a level may have"),
    "reader": (choices.READERS, "READER", "what looks up the levels of an 8-bit sRGB image"),
    "content": (choices.CONTENTS, "CONTENT", "what the image holds"),
    "roughness-channel": (
        choices.ROUGHNESS_CHANNELS,
        "CHANNEL",
        "where the roughness image holds roughness",
    ),
    "texture-format": (choices.TEXTURE_FORMATS, "FORMAT", "how a .dds or .ktx2 file holds texels"),
}
"""Options with a table of choices: the table, what stands for a value, and help."""
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
    parser = command.add_command(commands, "bake", _BAKE_HELP, *_TABLES, _FORMAT_TABLE, _BAKE_NOTES)
    _add_scene(parser)
    defaults = choices.Settings()
    _add_choices(parser, *_CHOSEN)
    parser.add_argument(
        "--levels",
        metavar="N",
        type=command.count,
        default=defaults.levels,
        help="how many levels to make, the image itself included; 0 makes all (default: 0)",
    )
    parser.add_argument(
        "--threshold",
        metavar="ALPHA",
        type=_alpha,
        default=defaults.threshold,
        help="the alpha from which on a cut-out is shown; above 0, at most 1 (default: 0.5)",
    )
    parser.add_argument(
        "--roughness",
        metavar="NAME",
        default="",
        help="an image that gets what the levels of a normal map lose: its name in the file, or "
        "the path of a picture file",
    )
    parser.add_argument(
        "--roughness-output",
        metavar="FILE",
        default="",
        help="a file of the roughness to write, like --output",
    )
    command.add_threads(parser)
    parser.add_argument(
        "--importance",
        metavar="NAME",
        default=defaults.importance,
        help="a vertex group or attribute that areas are multiplied by",
    )
    parser.add_argument(
        "--seams",
        metavar="WEIGHT",
        type=_weight,
        default=defaults.seam_weight,
        help="how much it counts that the two sides of a UV seam agree: 0 leaves seams alone, 1 "
        "halves what shows of them (default: 0)",
    )
    parser.add_argument(
        "--no-subdivision-limit",
        dest="use_subdivision_limit",
        action="store_false",
        help="take Catmull-Clark modifiers as they are, not as their limit surface",
    )
    parser.add_argument(
        "--frames",
        metavar="START:END[:STEP]",
        type=_frames,
        help="average over these frames of the animation (default: the current frame only)",
    )
    parser.add_argument(
        "--output",
        metavar="FILE",
        default="",
        help="a file of all levels to write: .exr, .tif or .tx for renderers, .dds or .ktx2 for "
        "engines; .png makes NAME.00.png, NAME.01.png, ...",
    )
    parser.add_argument(
        "--save",
        action="store_true",
        help="keep the levels as packed images in the .blend FILE, and save it",
    )
    parser.set_defaults(execute=_bake, usage_error=parser.error)


def _add_scene(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("file", metavar="FILE", help="a .blend, .glb, .gltf or .obj file")
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


def _add_choices(parser: argparse.ArgumentParser, *flags: str) -> None:
    defaults = choices.Settings()
    for flag in flags:
        table, metavar, text = _CHOSEN[flag]
        default = getattr(defaults, flag.replace("-", "_"))
        parser.add_argument(
            f"--{flag}",
            choices=table,
            default=default,
            metavar=metavar,
            help=f"{text} (default: {default})",
        )


def _add_plot(commands: Any) -> None:
    parser = command.add_command(commands, "plot", _PLOT_HELP, *_TABLES, _PLOT_NOTES)
    _add_scene(parser)
    parser.add_argument(
        "--filters",
        metavar="FILTER",
        nargs="+",
        choices=choices.FILTERS,
        help=f"the filters to compare (default: {' '.join(errors.DEFAULT_FILTERS)}; without "
        f"pam-trilinear for --reader srgb-after)",
    )
    _add_choices(parser, "wrap", "wrap-v", "bounds", "reader")
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
    command.add_threads(parser)
    parser.add_argument(
        "--save", action="store_true", help="save FILE with the scene's texture cache turned on"
    )
    parser.set_defaults(execute=_bake_cache, usage_error=parser.error)


def _bake_cache(options: argparse.Namespace) -> None:
    extension = os.path.splitext(options.file)[1].lower()
    if extension != ".blend":
        options.usage_error(f"FILE: found '{options.file}'; a .blend file is needed")
    path = os.path.abspath(options.file)
    _load(path, extension)
    if options.save:
        staging.check_writable(Path(path))
    scene = bpy.context.scene if options.scene is None else bpy.data.scenes.get(options.scene)
    if scene is None:
        known = listed(other.name for other in bpy.data.scenes)
        raise ValueError(f"--scene: found no scene named '{options.scene}'; the file has {known}")
    bpy.context.window.scene = scene
    depsgraph = bpy.context.evaluated_depsgraph_get()
    outcome = command.done(texture_cache.CacheBake.read(scene, depsgraph, threads=options.threads))
    if options.save:
        _save(path)
    command.tell(outcome)


def _weight(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = -1.0
    if not 0.0 <= value < math.inf:
        raise argparse.ArgumentTypeError(f"found '{text}'; a number of at least 0 is needed")
    return value


def _frames(text: str) -> tuple[int, int, int]:
    found = re.fullmatch(r"(-?\d+):(-?\d+)(?::(\d+))?", text)
    if found is None:
        raise argparse.ArgumentTypeError(f"found '{text}'; START:END or START:END:STEP is needed")
    return int(found[1]), int(found[2]), int(found[3] or 1)


def _alpha(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 0.0 < value <= 1.0:
        raise argparse.ArgumentTypeError(
            f"found '{text}'; a number above 0 and at most 1 is needed"
        )
    return value


def _plot(options: argparse.Namespace) -> None:
    extension = _checked_extension(options)
    if not options.output and not options.table:
        options.usage_error("nothing to write: give --output FILE or --table FILE")
    targets = [
        staging.check_plain_target(path, ending)
        for path, ending in ((options.output, ".png"), (options.table, ".csv"))
        if path
    ]
    objects = _chosen(_load(os.path.abspath(options.file), extension), options.object)
    chosen, is_picture = _images(options.image, objects, "auto")
    if len(chosen) > 1:
        found = listed(image.name for image in chosen)
        raise ValueError(f"--image: needed, as the meshes use {found}")
    image = chosen[0]
    images.check_untiled(image)
    depsgraph = bpy.context.evaluated_depsgraph_get()
    objects, warnings = _users(image, objects, options.object)
    command.warn(warnings)
    filters = list(dict.fromkeys(options.filters or errors.default_filters(options.reader)))
    source = reading.read(
        image,
        objects,
        choices.Settings(
            wrap=options.wrap, wrap_v=options.wrap_v, bounds=options.bounds, reader=options.reader
        ),
        depsgraph,
        all_faces=is_picture,
        needs_surface=True,
    )
    progress = command.ProgressLine()
    try:
        curves = errors.measure(source, filters, progress)
    finally:
        progress.end()
    staged = []
    try:
        for target in targets:
            if target.suffix.lower() == ".png":
                write = partial(new_images.save_png, pixels=figure.draw(curves))
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
    extension = _checked_extension(options)
    if options.save and extension != ".blend":
        options.usage_error(f"--save: needs a .blend FILE, found '{options.file}'")
    if not options.save and not options.output:
        options.usage_error("nothing to write: give --output FILE or --save")
    paths = (options.output, options.roughness_output)
    if options.texture_format != "auto" and not any(map(engines.has_formats, paths)):
        options.usage_error(
            f"--texture-format: found '{options.texture_format}', which is for .dds and .ktx2 files"
        )
    path = os.path.abspath(options.file)
    objects = _chosen(_load(path, extension), options.object)
    if options.save:
        staging.check_writable(Path(path))
    chosen, is_picture = _images(options.image, objects, options.content)
    if len(chosen) > 1 and (options.roughness or options.roughness_output):
        raise ValueError(f"--roughness: needs --image, as {len(chosen)} images are baked without")
    targets = unnamed.output_paths(options.output, chosen)
    for image, target in zip(chosen, targets, strict=True):
        for file in udim.paths(target, images.tile_numbers(image)):
            textures.check_target(file)
    settings = choices.Settings(
        filter=options.filter,
        wrap=options.wrap,
        wrap_v=options.wrap_v,
        bounds=options.bounds,
        reader=options.reader,
        levels=options.levels,
        use_images=options.save,
        threads=options.threads,
        use_subdivision_limit=options.use_subdivision_limit,
        importance=options.importance,
        seam_weight=options.seams,
        content=options.content,
        threshold=options.threshold,
        roughness=_roughness_name(options.roughness),
        roughness_channel=options.roughness_channel,
        roughness_filepath=options.roughness_output,
        texture_format=options.texture_format,
    )
    if options.frames:
        start, end, step = options.frames
        settings = replace(
            settings, use_frames=True, frame_start=start, frame_end=end, frame_step=step
        )
    for image, target in zip(chosen, targets, strict=True):
        users_of_it, warnings = _users(image, objects, options.object)
        command.warn(warnings)
        work = reading.read(
            image,
            users_of_it,
            replace(settings, filepath=target),
            bpy.context.evaluated_depsgraph_get(),
            all_faces=is_picture,
        )
        command.tell(command.done(work))
    if options.save:
        _save(path)


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
        return [_loaded("--image", name, is_data=content in {"normal", "data"})], True
    return [images.find(name)], False


def _roughness_name(name: str) -> str:
    """Returns the name of the image; a picture file is loaded as data."""
    if not name or name in bpy.data.images or not os.path.isfile(name):
        return name
    return _loaded("--roughness", name, is_data=True).name


def _loaded(option: str, path: str, *, is_data: bool) -> bpy.types.Image:
    """Loads a picture file; one that the .blend file uses already stays as it is there."""
    before = set(bpy.data.images)
    try:
        image = bpy.data.images.load(os.path.abspath(path), check_existing=True)
    except RuntimeError as error:
        raise OSError(f"{option}: cannot load '{path}': {str(error).strip()}") from error
    if is_data and image not in before:
        image.colorspace_settings.is_data = True
    return image


def _checked_extension(options: argparse.Namespace) -> str:
    """Returns the extension of FILE; ends the program where it is not a known one."""
    extension = os.path.splitext(options.file)[1].lower()
    if extension not in _EXTENSIONS:
        options.usage_error(f"FILE: found '{options.file}'; allowed are {', '.join(_EXTENSIONS)}")
    return extension


def _load(path: str, extension: str) -> list[bpy.types.Object]:
    """Loads a file and returns its mesh objects and collection instances."""
    if not os.path.isfile(path):
        raise OSError(f"FILE: there is no file '{path}'")
    before: set[bpy.types.Object] = set()
    try:
        if extension == ".blend":
            bpy.ops.wm.open_mainfile(filepath=path, load_ui=False, use_scripts=False)
        else:
            before = set(bpy.data.objects)
            _IMPORTERS[extension](path)
    except RuntimeError as error:
        raise OSError(f"FILE: cannot load '{path}': {str(error).strip()}") from error
    objects = bpy.context.view_layer.objects
    loaded = [obj for obj in objects if obj not in before and _has_surface(obj)]
    if not loaded:
        raise ValueError(f"FILE: found no mesh object in '{path}'")
    return loaded


def _has_surface(obj: bpy.types.Object) -> bool:
    """Returns whether an object is a mesh or an instance of a collection."""
    return obj.type == "MESH" or obj.instance_type == "COLLECTION"


def _chosen(objects: list[bpy.types.Object], names: Sequence[str]) -> list[bpy.types.Object]:
    """Returns the objects with these names, in their order; without names, all of them."""
    by_name = {obj.name: obj for obj in objects}
    for name in names:
        if name not in by_name:
            raise ValueError(
                f"--object: found no mesh named '{name}'; the file has {listed(by_name)}"
            )
    return [by_name[name] for name in names] if names else objects


def _save(path: str) -> None:
    """Saves the open .blend file."""
    try:
        bpy.ops.wm.save_as_mainfile(filepath=path)
    except RuntimeError as error:
        raise OSError(f"--save: cannot write '{path}': {str(error).strip()}") from error
