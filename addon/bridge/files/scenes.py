# SPDX-License-Identifier: GPL-3.0-or-later

"""Import and export of objects by Blender's importers and exporters."""

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
        selection: Name of its option to export only selected objects.
        options: Other options.
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
        """Whether the operator exists; its add-on may be disabled."""
        try:
            self._operator.get_rna_type()
        except KeyError:
            return False
        return True

    def export(self, path: Path, *, is_selection: bool, **options: Any) -> None:
        """Writes the selected objects, or all."""
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
"""Formats that include the armatures and parents of objects."""
_BASES = ("ARMATURE", "EMPTY")
_GLTF_SCENE_OPTIONS = {
    "export_cameras": True,
    "export_lights": True,
    "export_extras": True,
    "export_all_influences": True,
    "use_mesh_edges": True,
    "use_mesh_vertices": True,
}
"""Contents that the glTF exporter omits by default."""


SOURCES = (".blend", *IMPORTERS)
TARGETS = (".blend", *EXPORTERS)

_LAYERED = (".usd", ".usda", ".usdc", ".usdz")
"""Formats that may refer to other files, which Blender does not remember."""
_MATERIAL_FILES = re.compile(rb"^\s*mtllib\s+(.+)$", re.MULTILINE)
_PATTERN = re.compile("<(UDIM|UVTILE)>")


def load(
    paths: Sequence[str], is_wanted: Callable[[bpy.types.Object], bool], wanted: str
) -> list[list[bpy.types.Object]]:
    """Loads files into one scene.

    The first file is opened if it is a .blend file; of other .blend files the visible objects of
    the first scene are appended.

    Args:
        paths: Files with extensions in `SOURCES`.
        is_wanted: Whether to return an object.
        wanted: Description of such objects, for messages.

    Returns:
        The wanted objects of each file.

    Raises:
        OSError: A file is missing or cannot be read.
        ValueError: A file has no such object.
    """
    for path in paths:
        if not os.path.isfile(path):
            raise OSError(f"FILE: there is no file '{path}'")
    if Path(paths[0]).suffix.lower() != ".blend":
        bpy.ops.wm.read_homefile(use_empty=True)
    groups = []
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
        groups.append(objects)
    return groups


def decisive_files(path: str) -> list[str] | None:
    """Returns a loaded file and the files that it refers to; None if they are not known.

    Paths with a pattern, such as of UDIM tiles, include all matching files.
    """
    source = Path(path)
    if source.suffix.lower() in _LAYERED:
        return None
    files = {source, *material_files(source)}
    for name in bpy.utils.blend_paths(absolute=True, packed=False, local=False):
        files.update(map(Path, glob(_PATTERN.sub("*", escape(name)))))
    return [str(file) for file in sorted(files) if file.is_file()]


def material_files(path: Path) -> list[Path]:
    """Returns the material files that an OBJ file names; none for other formats."""
    if path.suffix.lower() != ".obj":
        return []
    names = _MATERIAL_FILES.findall(path.read_bytes())
    return [path.parent / os.fsdecode(name.strip()) for name in names]


def chosen(
    objects: list[bpy.types.Object], names: Sequence[str], wanted: str
) -> list[bpy.types.Object]:
    """Returns the named objects, in the order of the names; all objects without names.

    Args:
        objects: Objects to choose from.
        names: Names from the user.
        wanted: Description of the objects, for messages.

    Raises:
        ValueError: A name is unknown.
    """
    by_name = {obj.name: obj for obj in objects}
    for name in names:
        if name not in by_name:
            raise ValueError(
                f"--object: found no {wanted} named '{name}'; there are {listed(by_name)}"
            )
    return [by_name[name] for name in dict.fromkeys(names)] if names else objects


def as_one(name: str, objects: Sequence[bpy.types.Object]) -> bpy.types.Object:
    """Returns a single object, or makes an instance of a collection of several objects."""
    if len(objects) == 1:
        return objects[0]
    collection = bpy.data.collections.new(name)
    for obj in objects:
        collection.objects.link(obj)
    instance = bpy.data.objects.new(name, None)
    instance.instance_type, instance.instance_collection = "COLLECTION", collection
    bpy.context.scene.collection.objects.link(instance)
    return instance


def check_target(path: str) -> Path:
    """Returns the absolute path of an output file, after checking that it can be written.

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
    """Writes objects, or everything for a .blend file, to a staged file, and renames that.

    Args:
        target: The file.
        names: Names of the objects.
        metadata: Notes to store in the file, by key, for formats that `with_note` supports.

    Raises:
        OSError: The file cannot be written.
    """
    _select(_with_bases(names) if target.suffix.lower() in _POSED else names)
    _save(target, partial(_export, metadata or {}))


def save_gltf(target: Path, names: Sequence[str] = ()) -> None:
    """Writes a glTF file with cameras, lights, and custom properties.

    Args:
        target: The file.
        names: Names of the objects; everything is written without names.

    Raises:
        OSError: The file cannot be written.
    """
    _select(_with_bases(names))

    def export(path: Path) -> None:
        EXPORTERS[path.suffix.lower()].export(path, is_selection=bool(names), **_GLTF_SCENE_OPTIONS)
        check_whole(path.parent, 0, 0)

    _save(target, export)


def _with_bases(names: Sequence[str]) -> list[str]:
    """Adds the armatures and empties that move objects to the objects' names."""
    included: dict[bpy.types.Object, None] = {}
    pending = [bpy.data.objects[name] for name in names]
    while pending:
        obj = pending.pop(0)
        if obj in included:
            continue
        included[obj] = None
        bases = [modifier.object for modifier in obj.modifiers if modifier.type == "ARMATURE"]
        bases += [obj.parent] if obj.parent and obj.parent.type in _BASES else []
        pending += [base for base in bases if base is not None and base not in included]
    return [obj.name for obj in included]


def _select(names: Sequence[str]) -> None:
    """Selects only these objects, even if selecting them is disabled."""
    selected = set(names)
    for obj in bpy.context.view_layer.objects:
        if obj.name in selected:
            obj.hide_select = False
        obj.select_set(obj.name in selected)


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
    """Number of vertices and faces of the selected meshes, including instances."""
    vertices = faces = 0
    for instance in bpy.context.evaluated_depsgraph_get().object_instances:
        base = instance.parent if instance.is_instance else instance.object
        if instance.object.type == "MESH" and base.original.select_get():
            vertices += len(instance.object.data.vertices)
            faces += len(instance.object.data.polygons)
    return vertices, faces


def _last_line(error: RuntimeError | OSError) -> str:
    """Last line of an operator's error message: the message of a Python traceback."""
    lines = [
        line for line in reason(error).splitlines() if line and not line.startswith("Location:")
    ]
    return lines[-1] if lines else type(error).__name__


def save_open(path: str) -> None:
    """Saves the open .blend file; keeps earlier versions as Blender does.

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
        path.with_name(f"{path.name}@").unlink(missing_ok=True)  # Blender's temporary file.
        raise


def _earlier_versions(target: Path, count: int) -> Iterator[staging.StagedFile]:
    """Stages earlier files as .blend1, .blend2 and so on, the oldest first."""
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
    """Appends the visible objects of the first scene of a .blend file."""
    with bpy.data.libraries.load(path, link=False) as (library, appended):
        appended.scenes = library.scenes[:1]
    for scene in appended.scenes:
        layer = scene.view_layers[0]
        for obj in layer.objects:
            if obj.visible_get(view_layer=layer):
                bpy.context.scene.collection.objects.link(obj)
        bpy.data.scenes.remove(scene)
