# SPDX-License-Identifier: GPL-3.0-or-later

"""Files with objects, as Blender imports and exports them."""

import os
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from glob import escape, glob
from pathlib import Path
from typing import Any

import bpy
from prefilter.workflows.files.mesh_notes import with_note

from ...core.outcome import reason
from ...core.wording import listed
from . import damage, staging
from .complete import check_whole


@dataclass(frozen=True)
class Exporter:
    """An operator that writes files.

    Attributes:
        name: The operator.
        selection: Its option to export what is selected, and nothing else.
        options: More of its options.
    """

    name: str
    selection: str
    options: Mapping[str, Any] = field(default_factory=dict)

    @property
    def _operator(self) -> Any:
        module, _, name = self.name.partition(".")
        return getattr(getattr(bpy.ops, module), name)

    @property
    def is_available(self) -> bool:
        """Whether this Blender has the operator: its add-on may be disabled."""
        try:
            self._operator.get_rna_type()
        except KeyError:
            return False
        return True

    def export(self, path: Path, *, is_selection: bool, **options: Any) -> None:
        """Writes what is selected, or everything."""
        self._operator(
            filepath=str(path), **{self.selection: is_selection}, **self.options, **options
        )


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
EXPORTERS: dict[str, Exporter] = {
    ".obj": Exporter("wm.obj_export", "export_selected_objects"),
    ".ply": Exporter("wm.ply_export", "export_selected_objects"),
    ".stl": Exporter("wm.stl_export", "export_selected_objects"),
    ".glb": Exporter("export_scene.gltf", "use_selection", {"export_format": "GLB"}),
    ".gltf": Exporter("export_scene.gltf", "use_selection", {"export_format": "GLTF_SEPARATE"}),
    ".fbx": Exporter("export_scene.fbx", "use_selection"),
}
_POSED = (".glb", ".gltf", ".fbx")
"""Files that keep what moves objects."""
_BASES = ("ARMATURE", "EMPTY")
_OF_GLTF_SCENES = {
    "export_cameras": True,
    "export_lights": True,
    "export_extras": True,
    "export_all_influences": True,
    "use_mesh_edges": True,
    "use_mesh_vertices": True,
}
"""What the exporter of glTF leaves out unless it is told."""


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
        damage.check(path)
        try:
            _load_one(os.path.abspath(path), is_first=i == 0)
        except (RuntimeError, UnicodeError) as error:
            reason = damage.why(path, error)
            raise OSError(f"FILE: cannot load '{path}': {reason}") from error
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


def check_target(path: str) -> Path:
    """Returns the absolute path of a file that objects can be written to.

    Raises:
        OSError: It cannot be written, or this Blender has no exporter for it.
    """
    target = staging.check_output(path)
    exporter = EXPORTERS.get(target.suffix.lower())
    if exporter is not None and not exporter.is_available:
        raise OSError(
            f"file '{path}': this Blender has no exporter for {target.suffix.lower()} files; "
            "enable its add-on"
        )
    return target


def save(target: Path, names: Sequence[str], metadata: Mapping[str, str] | None = None) -> None:
    """Writes objects, or for a .blend file all there is, beside the target, and renames it.

    Args:
        target: The file.
        names: Those of the objects.
        metadata: What the file is to keep, by keys, of a format that `with_note` can give one.

    Raises:
        OSError: The file cannot be written.
    """
    _select(_with_bases(names) if target.suffix.lower() in _POSED else names)
    _save(target, partial(_export, metadata or {}))


def save_gltf(target: Path, names: Sequence[str] = ()) -> None:
    """Writes a glTF file with cameras, lights, and custom properties.

    Args:
        target: The file.
        names: Those of the objects. Without names, everything is written.

    Raises:
        OSError: The file cannot be written.
    """
    _select(_with_bases(names))

    def export(path: Path) -> None:
        EXPORTERS[path.suffix.lower()].export(path, is_selection=bool(names), **_OF_GLTF_SCENES)
        check_whole(path.parent, 0, 0)

    _save(target, export)


def _with_bases(names: Sequence[str]) -> list[str]:
    """Returns the names of objects with those of the armatures and empties that move them."""
    found: dict[bpy.types.Object, None] = {}
    pending = [bpy.data.objects[name] for name in names]
    while pending:
        obj = pending.pop(0)
        if obj in found:
            continue
        found[obj] = None
        bases = [one.object for one in obj.modifiers if one.type == "ARMATURE"]
        bases += [obj.parent] if obj.parent and obj.parent.type in _BASES else []
        pending += [base for base in bases if base is not None and base not in found]
    return [obj.name for obj in found]


def _select(names: Sequence[str]) -> None:
    """Selects objects, and nothing else, also those that users must not select."""
    wanted = set(names)
    for obj in bpy.context.view_layer.objects:
        if obj.name in wanted:
            obj.hide_select = False
        obj.select_set(obj.name in wanted)


def _save(target: Path, export: Callable[[Path], None]) -> None:
    staged: staging.StagedFile | staging.StagedFolder
    try:
        if target.suffix.lower() == ".blend":
            staged = staging.stage_with(target, _write_blend)
        else:
            staged = staging.stage_folder(target, export)
    except (RuntimeError, OSError) as error:
        raise OSError(f"file '{target}': cannot write it: {_last_line(error)}") from error
    try:
        staged.commit()
    finally:
        staged.discard()


def _export(metadata: Mapping[str, str], path: Path) -> None:
    """Writes the selected objects to a file in a folder of its own."""
    kind = path.suffix.lower()
    EXPORTERS[kind].export(path, is_selection=True)
    counts = _selected_counts() if kind == ".obj" else (0, 0)
    check_whole(path.parent, *counts)
    for key, text in metadata.items():
        path.write_bytes(with_note(kind.removeprefix("."), path.read_bytes(), key, text))
        check_whole(path.parent, *counts)


def _selected_counts() -> tuple[int, int]:
    """Returns how many vertices and faces the selected meshes have, their instances too."""
    vertices = faces = 0
    for one in bpy.context.evaluated_depsgraph_get().object_instances:
        base = one.parent if one.is_instance else one.object
        if one.object.type == "MESH" and base.original.select_get():
            vertices += len(one.object.data.vertices)
            faces += len(one.object.data.polygons)
    return vertices, faces


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
            yield staging.stage_link(names[number], names[number + 1])


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
