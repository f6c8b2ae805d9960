"""What the commands share: options, files, progress."""

import argparse
import os
import sys
from collections.abc import Callable, Sequence
from typing import Any

import bpy

from ..choices import Choice, Settings
from ..wording import listed

IMPORTERS: dict[str, Callable[[str], Any]] = {
    ".glb": lambda path: bpy.ops.import_scene.gltf(filepath=path),
    ".gltf": lambda path: bpy.ops.import_scene.gltf(filepath=path),
    ".obj": lambda path: bpy.ops.wm.obj_import(filepath=path),
}
EXTENSIONS = (".blend", *IMPORTERS)


def table(title: str, options: dict[str, Choice]) -> str:
    """Returns choices with their descriptions, for the end of a help text."""
    rows = (f"  {key:<18}{choice.description}" for key, choice in options.items())
    return "\n".join([f"{title}:", *rows])


def add_command(commands: Any, name: str, purpose: str, *notes: str) -> argparse.ArgumentParser:
    """Adds a command whose help ends in notes, which keep their lines."""
    return commands.add_parser(
        name,
        help=purpose,
        description=f"{purpose[0].upper()}{purpose[1:]}.",
        epilog="\n\n".join(notes),
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )


def add_threads(parser: argparse.ArgumentParser) -> None:
    """Adds the option `--threads`."""
    parser.add_argument(
        "--threads",
        metavar="N",
        type=count,
        default=Settings.threads,
        help="how many threads to use; 0 uses all (default: 0)",
    )


def count(text: str) -> int:
    """Reads a number from 0 up."""
    value = int(text) if text.isdecimal() else -1
    if value < 0:
        raise argparse.ArgumentTypeError(f"found '{text}'; a number from 0 up is needed")
    return value


def checked_extension(options: argparse.Namespace) -> str:
    """Returns the extension of FILE; ends the program where it is not a known one."""
    extension = os.path.splitext(options.file)[1].lower()
    if extension not in EXTENSIONS:
        options.usage_error(f"FILE: found '{options.file}'; allowed are {', '.join(EXTENSIONS)}")
    return extension


def load(path: str, extension: str) -> list[bpy.types.Object]:
    """Loads a file and returns its mesh objects and collection instances."""
    if not os.path.isfile(path):
        raise OSError(f"FILE: there is no file '{path}'")
    before: set[bpy.types.Object] = set()
    try:
        if extension == ".blend":
            bpy.ops.wm.open_mainfile(filepath=path, load_ui=False, use_scripts=False)
        else:
            before = set(bpy.data.objects)
            IMPORTERS[extension](path)
    except RuntimeError as error:
        raise OSError(f"FILE: cannot load '{path}': {str(error).strip()}") from error
    objects = bpy.context.view_layer.objects
    loaded = [obj for obj in objects if obj not in before and has_surface(obj)]
    if not loaded:
        raise ValueError(f"FILE: found no mesh object in '{path}'")
    return loaded


def has_surface(obj: bpy.types.Object) -> bool:
    """Returns whether an object is a mesh or an instance of a collection."""
    return obj.type == "MESH" or obj.instance_type == "COLLECTION"


def chosen(objects: list[bpy.types.Object], names: Sequence[str]) -> list[bpy.types.Object]:
    """Returns the objects with these names, in their order; without names, all of them."""
    by_name = {obj.name: obj for obj in objects}
    for name in names:
        if name not in by_name:
            raise ValueError(
                f"--object: found no mesh named '{name}'; the file has {listed(by_name)}"
            )
    return [by_name[name] for name in names] if names else objects


def save(path: str) -> None:
    """Saves the open .blend file."""
    try:
        bpy.ops.wm.save_as_mainfile(filepath=path)
    except RuntimeError as error:
        raise OSError(f"--save: cannot write '{path}': {str(error).strip()}") from error


class ProgressLine:
    """Shows progress on stderr: one line that changes on a terminal, else a line each quarter."""

    def __init__(self) -> None:
        """Shows nothing yet."""
        self._step = 1 if sys.stderr.isatty() else 25
        self._shown = -1

    def __call__(self, fraction: float) -> bool:
        """Shows how much is done, and says to go on."""
        percent = int(100 * fraction) // self._step * self._step
        if percent > self._shown:
            self._shown = percent
            line = f"prefilter: {percent:3d} %"
            print(line, end="\r" if self._step == 1 else "\n", file=sys.stderr, flush=True)
        return True

    def end(self) -> None:
        """Leaves the line."""
        if self._step == 1 and self._shown >= 0:
            print(file=sys.stderr)
