"""`blender --background --command prefilter ...`: the operators without a window."""

import argparse
import os
import re
import sys
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import bpy

from . import bake, texture_cache
from .bake import Choice
from .bridge import files, images, meshes
from .wording import listed

_PROGRAM = "blender --background --command prefilter"

_BAKE_HELP = "bake the mipmap levels of an image, weighted by the surface of the meshes that use it"


def _table(title: str, choices: dict[str, Choice]) -> str:
    rows = (f"  {key:<18}{choice.description}" for key, choice in choices.items())
    return "\n".join([f"{title}:", *rows])


_TABLES = (
    _table("filters", bake.FILTERS),
    _table("wrap modes", bake.WRAPS | bake.WRAPS_V),
    _table("value ranges", bake.BOUNDS),
)
_BAKE_NOTES = """\
Without --image, the image that the meshes use is baked; name it where they use several. A picture
file that no material uses is taken as the texture of all faces, with the active UV map.

examples:
  prefilter bake scene.blend --image Wood --save
  prefilter bake spot.obj --image spot.png --output spot.exr
  prefilter bake helmet.gltf --object Visor --filter pam-box --output visor.tif"""

_CACHE_HELP = "bake PAM into Cycles' texture cache, for every image of a scene"
_CACHE_NOTES = """\
Blender makes the cache files, in the folder of its preferences or beside the images; their levels
are then replaced. Files that are there are overwritten. When an image file changes, Blender makes
its cache file anew, and it has to be baked again. Needs Blender 5.2 LTS or later.

example:
  prefilter bake-cache scene.blend --save"""

_IMPORTERS: dict[str, Callable[[str], Any]] = {
    ".glb": lambda path: bpy.ops.import_scene.gltf(filepath=path),
    ".gltf": lambda path: bpy.ops.import_scene.gltf(filepath=path),
    ".obj": lambda path: bpy.ops.wm.obj_import(filepath=path),
}
_EXTENSIONS = (".blend", *_IMPORTERS)

_handles: list[object] = []


def register() -> None:
    """Makes the command known to Blender's command line."""
    _handles.append(bpy.utils.register_cli_command("prefilter", run))


def unregister() -> None:
    """Takes the command back."""
    while _handles:
        bpy.utils.unregister_cli_command(_handles.pop())


def run(arguments: Sequence[str]) -> int:
    """Runs `prefilter ARGUMENTS`.

    Returns:
        The exit status: 0, 1 for a failure that was told on stderr, 2 for wrong arguments.
    """
    try:
        options = _parser().parse_args(arguments)
        options.execute(options)
    except SystemExit as end:
        return end.code if isinstance(end.code, int) else 0
    except bake.FAILURES as error:
        print(f"prefilter: error: {error}", file=sys.stderr)
        return 1
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog=_PROGRAM, description="Filters images for the surfaces that wear them."
    )
    commands = parser.add_subparsers(title="commands", metavar="COMMAND", required=True)
    _add_bake(commands)
    _add_bake_cache(commands)
    return parser


def _add_bake(commands: Any) -> None:
    parser = commands.add_parser(
        "bake",
        help=_BAKE_HELP,
        description=f"{_BAKE_HELP[0].upper()}{_BAKE_HELP[1:]}.",
        epilog="\n\n".join([*_TABLES, _BAKE_NOTES]),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("file", metavar="FILE", help="a .blend, .glb, .gltf or .obj file")
    parser.add_argument(
        "--object",
        metavar="NAME",
        action="append",
        default=[],
        help="a mesh object or collection instance to bake for; repeat for several (default: all "
        "that use the image)",
    )
    parser.add_argument(
        "--image",
        metavar="NAME",
        help="the image: its name in the file, or the path of a picture file",
    )
    defaults = bake.Settings()
    for flag, choices, metavar, text in (
        ("filter", bake.FILTERS, "FILTER", "how a texel of a level is made"),
        ("wrap", bake.WRAPS, "MODE", "what lies outside of the image along u"),
        ("wrap-v", bake.WRAPS_V, "MODE", "the same along v"),
        ("bounds", bake.BOUNDS, "RANGE", "the values that texels of a level may have"),
    ):
        default = getattr(defaults, flag.replace("-", "_"))
        parser.add_argument(
            f"--{flag}",
            choices=choices,
            default=default,
            metavar=metavar,
            help=f"{text} (default: {default})",
        )
    parser.add_argument(
        "--levels",
        metavar="N",
        type=_count,
        default=defaults.levels,
        help="how many levels to make, the image itself included; 0 makes all (default: 0)",
    )
    parser.add_argument(
        "--threads",
        metavar="N",
        type=_count,
        default=defaults.threads,
        help="how many threads to use; 0 uses all (default: 0)",
    )
    parser.add_argument(
        "--importance",
        metavar="NAME",
        default=defaults.importance,
        help="a vertex group or attribute that areas are multiplied by",
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
        help="a tiled, mip-mapped .exr, .tif or .tx file to write; it gets every level",
    )
    parser.add_argument(
        "--save",
        action="store_true",
        help="keep the levels as packed images in the .blend FILE, and save it",
    )
    parser.set_defaults(execute=_bake, usage_error=parser.error)


def _add_bake_cache(commands: Any) -> None:
    parser = commands.add_parser(
        "bake-cache",
        help=_CACHE_HELP,
        description=f"{_CACHE_HELP[0].upper()}{_CACHE_HELP[1:]}.",
        epilog=_CACHE_NOTES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("file", metavar="FILE", help="a .blend file")
    parser.add_argument(
        "--scene", metavar="NAME", help="the scene that is rendered (default: the active one)"
    )
    parser.add_argument(
        "--threads",
        metavar="N",
        type=_count,
        default=0,
        help="how many threads to use; 0 uses all (default: 0)",
    )
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
        files.check_writable(Path(path))
    scene = bpy.context.scene if options.scene is None else bpy.data.scenes.get(options.scene)
    if scene is None:
        known = listed(other.name for other in bpy.data.scenes)
        raise ValueError(f"--scene: found no scene named '{options.scene}'; the file has {known}")
    bpy.context.window.scene = scene
    progress = _ProgressLine()
    try:
        outcome = texture_cache.bake(
            scene,
            bpy.context.evaluated_depsgraph_get(),
            threads=options.threads,
            progress=progress,
        )
    finally:
        progress.end()
    if options.save:
        _save(path)
    for warning in outcome.warnings:
        print(f"prefilter: warning: {warning}", file=sys.stderr)
    print(outcome.summary)


def _count(text: str) -> int:
    value = int(text) if text.isdecimal() else -1
    if value < 0:
        raise argparse.ArgumentTypeError(f"found '{text}'; a number from 0 up is needed")
    return value


def _frames(text: str) -> tuple[int, int, int]:
    found = re.fullmatch(r"(-?\d+):(-?\d+)(?::(\d+))?", text)
    if found is None:
        raise argparse.ArgumentTypeError(f"found '{text}'; START:END or START:END:STEP is needed")
    return int(found[1]), int(found[2]), int(found[3] or 1)


def _bake(options: argparse.Namespace) -> None:
    extension = os.path.splitext(options.file)[1].lower()
    if extension not in _EXTENSIONS:
        options.usage_error(f"FILE: found '{options.file}'; allowed are {', '.join(_EXTENSIONS)}")
    if options.save and extension != ".blend":
        options.usage_error(f"--save: needs a .blend FILE, found '{options.file}'")
    if not options.save and not options.output:
        options.usage_error("nothing to write: give --output FILE or --save")
    settings = bake.Settings(
        filter=options.filter,
        wrap=options.wrap,
        wrap_v=options.wrap_v,
        bounds=options.bounds,
        levels=options.levels,
        use_images=options.save,
        filepath=options.output,
        threads=options.threads,
        use_subdivision_limit=options.use_subdivision_limit,
        importance=options.importance,
    )
    if options.frames:
        start, end, step = options.frames
        settings = replace(
            settings, use_frames=True, frame_start=start, frame_end=end, frame_step=step
        )
    path = os.path.abspath(options.file)
    objects = _chosen(_load(path, extension), options.object)
    if options.save:
        files.check_writable(Path(path))
    depsgraph = bpy.context.evaluated_depsgraph_get()
    image, is_picture = _image(options.image, objects)
    progress = _ProgressLine()
    try:
        outcome = bake.bake(
            image, objects, settings, depsgraph, all_faces=is_picture, progress=progress
        )
    finally:
        progress.end()
    if options.save:
        _save(path)
    for warning in outcome.warnings:
        print(f"prefilter: warning: {warning}", file=sys.stderr)
    print(outcome.summary)


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
    return obj.type == "MESH" or obj.instance_type == "COLLECTION"


def _chosen(objects: list[bpy.types.Object], names: Sequence[str]) -> list[bpy.types.Object]:
    by_name = {obj.name: obj for obj in objects}
    for name in names:
        if name not in by_name:
            raise ValueError(
                f"--object: found no mesh named '{name}'; the file has {listed(by_name)}"
            )
    return [by_name[name] for name in names] if names else objects


def _image(name: str | None, objects: Sequence[bpy.types.Object]) -> tuple[bpy.types.Image, bool]:
    """Returns the image to bake, and whether it is a picture file from the command line."""
    if name is None:
        return _only_image(objects), False
    if name not in bpy.data.images and os.path.isfile(name):
        try:
            return bpy.data.images.load(os.path.abspath(name), check_existing=True), True
        except RuntimeError as error:
            raise OSError(f"--image: cannot load '{name}': {str(error).strip()}") from error
    return images.find(name), False


def _only_image(objects: Sequence[bpy.types.Object]) -> bpy.types.Image:
    used = meshes.images_of_objects(objects)
    if len(used) == 1:
        return used[0]
    found = listed(image.name for image in used) or "none"
    raise ValueError(f"--image: needed, as the meshes use {found}")


def _save(path: str) -> None:
    try:
        bpy.ops.wm.save_as_mainfile(filepath=path)
    except RuntimeError as error:
        raise OSError(f"--save: cannot write '{path}': {str(error).strip()}") from error


class _ProgressLine:
    """Shows progress on stderr: one line that changes on a terminal, else a line each quarter."""

    def __init__(self) -> None:
        self._step = 1 if sys.stderr.isatty() else 25
        self._shown = -1

    def __call__(self, fraction: float) -> bool:
        percent = int(100 * fraction) // self._step * self._step
        if percent > self._shown:
            self._shown = percent
            line = f"prefilter: {percent:3d} %"
            print(line, end="\r" if self._step == 1 else "\n", file=sys.stderr, flush=True)
        return True

    def end(self) -> None:
        if self._step == 1 and self._shown >= 0:
            print(file=sys.stderr)
