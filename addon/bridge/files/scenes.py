# SPDX-License-Identifier: GPL-3.0-or-later

"""Files with objects, as Blender imports and exports them."""

import os
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from glob import escape, glob
from pathlib import Path
from typing import Any

import bpy
from prefilter._work.files.mesh_notes import with_note

from ...core.outcome import reason
from ...core.wording import listed
from . import staging
from .complete import check_whole


def _import_usd(path: str) -> None:
    if not bpy.app.build_options.usd:
        raise OSError(f"FILE: cannot load '{path}': this Blender was built without USD")
    bpy.ops.wm.usd_import(filepath=path)


IMPORTERS: dict[str, Callable[[str], Any]] = {
    ".obj": lambda path: bpy.ops.wm.obj_import(filepath=path),
    ".ply": lambda path: bpy.ops.wm.ply_import(filepath=path),
    ".stl": lambda path: bpy.ops.wm.stl_import(filepath=path),
    ".glb": lambda path: bpy.ops.import_scene.gltf(filepath=path),
    ".gltf": lambda path: bpy.ops.import_scene.gltf(filepath=path),
    ".fbx": lambda path: bpy.ops.import_scene.fbx(filepath=path),
    ".usd": _import_usd,
    ".usda": _import_usd,
    ".usdc": _import_usd,
    ".usdz": _import_usd,
}
EXPORTERS: dict[str, Callable[[str], Any]] = {
    ".obj": lambda path: bpy.ops.wm.obj_export(filepath=path, export_selected_objects=True),
    ".ply": lambda path: bpy.ops.wm.ply_export(filepath=path, export_selected_objects=True),
    ".stl": lambda path: bpy.ops.wm.stl_export(filepath=path, export_selected_objects=True),
    ".glb": lambda path: bpy.ops.export_scene.gltf(
        filepath=path, use_selection=True, export_format="GLB"
    ),
    ".gltf": lambda path: bpy.ops.export_scene.gltf(
        filepath=path, use_selection=True, export_format="GLTF_SEPARATE"
    ),
    ".fbx": lambda path: bpy.ops.export_scene.fbx(filepath=path, use_selection=True),
}


SOURCES = (".blend", *IMPORTERS)
TARGETS = (".blend", *EXPORTERS)

_LAYERED = (".usd", ".usda", ".usdc", ".usdz")
"""Such files may refer to others, of which Blender keeps nothing."""
_MATERIAL_FILES = re.compile(rb"^\s*mtllib\s+(.+)$", re.MULTILINE)
_PATTERN = re.compile("<(UDIM|UVTILE)>")


def load(
    paths: Sequence[str], is_wanted: Callable[[bpy.types.Object], bool], wanted: str
) -> list[list[bpy.types.Object]]:
    """Loads files into one scene.

    A .blend file that comes first is opened; what the first scene of others shows is appended.

    Args:
        paths: Their endings are in `SOURCES`.
        is_wanted: Tells which objects count.
        wanted: What they are called.

    Returns:
        The objects of each file that count.

    Raises:
        OSError: A file is missing or cannot be read.
        ValueError: A file has no such object.
    """
    for path in paths:
        if not os.path.isfile(path):
            raise OSError(f"FILE: there is no file '{path}'")
    if Path(paths[0]).suffix.lower() != ".blend":
        bpy.ops.wm.read_homefile(use_empty=True)
    found = []
    for i, path in enumerate(paths):
        before = set() if i == 0 else set(bpy.data.objects)
        try:
            _load_one(os.path.abspath(path), is_first=i == 0)
        except RuntimeError as error:
            raise OSError(f"FILE: cannot load '{path}': {str(error).strip()}") from error
        everything = bpy.context.view_layer.objects
        objects = [obj for obj in everything if obj not in before and is_wanted(obj)]
        if not objects:
            raise ValueError(f"FILE: found no {wanted} in '{path}'")
        found.append(objects)
    return found


def decisive_files(path: str) -> list[str] | None:
    """Returns what a file that was loaded holds and refers to; None where that is not known.

    Of paths with a pattern, such as those of UDIM tiles, all files that fit are among them.
    """
    source = Path(path)
    if source.suffix.lower() in _LAYERED:
        return None
    found = {source, *material_files(source)}
    for name in bpy.utils.blend_paths(absolute=True, packed=False, local=False):
        found.update(map(Path, glob(_PATTERN.sub("*", escape(name)))))
    return [str(one) for one in sorted(found) if one.is_file()]


def material_files(path: Path) -> list[Path]:
    """Returns the files of materials that an OBJ file names; of others there are none."""
    if path.suffix.lower() != ".obj":
        return []
    names = _MATERIAL_FILES.findall(path.read_bytes())
    return [path.parent / os.fsdecode(name.strip()) for name in names]


def chosen(
    objects: list[bpy.types.Object], names: Sequence[str], wanted: str
) -> list[bpy.types.Object]:
    """Returns the objects with these names, in their order; without names, all of them.

    Args:
        objects: Those that count.
        names: What a user gives.
        wanted: What objects that count are called.

    Raises:
        ValueError: There is no such object.
    """
    by_name = {obj.name: obj for obj in objects}
    for name in names:
        if name not in by_name:
            raise ValueError(
                f"--object: found no {wanted} named '{name}'; there are {listed(by_name)}"
            )
    return [by_name[name] for name in dict.fromkeys(names)] if names else objects


def as_one(name: str, objects: Sequence[bpy.types.Object]) -> bpy.types.Object:
    """Returns the only object of several, or an instance of a collection of all of them."""
    if len(objects) == 1:
        return objects[0]
    collection = bpy.data.collections.new(name)
    for obj in objects:
        collection.objects.link(obj)
    made = bpy.data.objects.new(name, None)
    made.instance_type, made.instance_collection = "COLLECTION", collection
    bpy.context.scene.collection.objects.link(made)
    return made


def save(target: Path, names: Sequence[str], metadata: Mapping[str, str] | None = None) -> None:
    """Writes objects, or for a .blend file all there is, beside the target, and renames it.

    Args:
        target: The file.
        names: Those of the objects.
        metadata: What the file is to keep, by keys, of a format that `with_note` can give one.

    Raises:
        OSError: The file cannot be written.
    """
    extension = target.suffix.lower()
    for obj in bpy.context.view_layer.objects:
        obj.select_set(obj.name in names)
    staged: staging.StagedFile | staging.StagedFolder
    try:
        if extension == ".blend":
            staged = staging.stage_with(target, _write_blend)
        else:
            staged = staging.stage_folder(target, partial(_export, metadata or {}))
    except (RuntimeError, OSError) as error:
        raise OSError(f"file '{target}': cannot write it: {_last_line(error)}") from error
    try:
        staged.commit()
    finally:
        staged.discard()


def _export(metadata: Mapping[str, str], path: Path) -> None:
    """Writes the selected objects to a file in a folder of its own."""
    EXPORTERS[path.suffix.lower()](str(path))
    depsgraph = bpy.context.evaluated_depsgraph_get()
    meshes = [obj.evaluated_get(depsgraph).data for obj in bpy.context.selected_objects]
    counts = (
        sum(len(mesh.vertices) for mesh in meshes),
        sum(len(mesh.polygons) for mesh in meshes),
    )
    check_whole(path.parent, *counts)
    for key, text in metadata.items():
        kind = path.suffix.lower().removeprefix(".")
        path.write_bytes(with_note(kind, path.read_bytes(), key, text))
        check_whole(path.parent, *counts)


def _last_line(error: RuntimeError | OSError) -> str:
    """Returns what an operator says of its failure; of one in Python, its last line."""
    lines = [
        line for line in reason(error).splitlines() if line and not line.startswith("Location:")
    ]
    return lines[-1] if lines else type(error).__name__


def save_open(path: str) -> None:
    """Saves the .blend file that is open; its earlier versions are kept as Blender keeps them.

    Raises:
        OSError: It cannot be written.
    """
    target = Path(os.path.realpath(path))
    staged: list[staging.StagedFile] = []
    try:
        staged.append(staging.stage_with(target, _write_blend))
        for version in _earlier_versions(target, bpy.context.preferences.filepaths.save_version):
            staged.insert(-1, version)
        staging.commit_all(staged)
    except (RuntimeError, OSError) as error:
        raise OSError(f"--save: cannot write '{path}': {_last_line(error)}") from error
    finally:
        for file in staged:
            file.discard()


def _write_blend(path: Path) -> None:
    try:
        bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True)
    except RuntimeError:
        path.with_name(f"{path.name}@").unlink(missing_ok=True)  # As Blender calls it until then.
        raise


def _earlier_versions(target: Path, count: int) -> Iterator[staging.StagedFile]:
    """Stages earlier files under the endings .blend1, .blend2 and so on, the oldest first."""
    names = [Path(f"{target}{number or ''}") for number in range(count + 1)]
    for number in reversed(range(count)):
        if names[number].exists():
            yield staging.stage_other_name(names[number], names[number + 1])


def _load_one(path: str, *, is_first: bool) -> None:
    extension = Path(path).suffix.lower()
    if extension != ".blend":
        IMPORTERS[extension](path)
    elif is_first:
        bpy.ops.wm.open_mainfile(filepath=path, load_ui=False, use_scripts=False)
    else:
        _append_visible(path)
    bpy.context.view_layer.update()


def _append_visible(path: str) -> None:
    """Adds what the first scene of a .blend file shows."""
    with bpy.data.libraries.load(path, link=False) as (there, here):
        here.scenes = there.scenes[:1]
    for scene in here.scenes:
        layer = scene.view_layers[0]
        for obj in layer.objects:
            if obj.visible_get(view_layer=layer):
                bpy.context.scene.collection.objects.link(obj)
        bpy.data.scenes.remove(scene)
