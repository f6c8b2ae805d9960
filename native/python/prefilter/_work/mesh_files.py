# SPDX-License-Identifier: GPL-3.0-or-later

"""Mesh files, as trimesh reads them; it is imported when it is needed."""

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import prefilter

from .._border.staging import StagedFile, stage_bytes, stage_data
from .files.mesh_notes import with_note
from .matrices import product
from .wording import listed


@dataclass(frozen=True)
class Part:
    """A mesh of a file, in its place.

    Attributes:
        name: What the file calls it; the name of the file where it has one mesh.
        positions: (vertices, 3) float64.
        triangles: (triangles, 3) integers.
        uvs: (vertices, 2) float64; None for a mesh without a UV map.
    """

    name: str
    positions: NDArray[np.float64]
    triangles: NDArray[np.integer]
    uvs: NDArray[np.float64] | None


def read(argument: str, paths: Sequence[str]) -> list[Part]:
    """Reads the meshes of files, in the order of their names within each.

    Args:
        argument: What a path is called in messages.
        paths: The files.

    Raises:
        OSError: A file cannot be read, or trimesh is missing.
        ValueError: There is no triangle in one of them.
    """
    return [part for path in paths for part in _parts(argument, path)]


def chosen(parts: Sequence[Part], names: Sequence[str]) -> list[Part]:
    """Returns those of some names; all where none is given.

    Raises:
        ValueError: There is none of a name.
    """
    for name in names:
        if all(part.name != name for part in parts):
            known = listed(dict.fromkeys(part.name for part in parts))
            raise ValueError(f"--object: found no mesh '{name}'; there are {known}")
    return [part for part in parts if part.name in names] if names else list(parts)


def without_seams(part: Part) -> Part:
    """Returns a mesh in which vertices of one place are one: files have several where UVs part."""
    places, numbers = np.unique(part.positions, axis=0, return_inverse=True)
    triangles = numbers.reshape(-1)[part.triangles]
    return Part(part.name, places, np.asarray(triangles, np.int64), None)


def stage(
    target: Path, parts: Sequence[Part], metadata: Mapping[str, str] | None = None
) -> StagedFile:
    """Writes positions and triangles, in a format that the ending of the target says.

    Args:
        target: The file.
        parts: The meshes.
        metadata: What the file is to keep, by keys; see `with_note`.

    Raises:
        OSError: The file cannot be written.
    """
    trimesh = _trimesh()
    kind = target.suffix.lower().removeprefix(".")
    meshes = [trimesh.Trimesh(one.positions, one.triangles, process=False) for one in parts]
    if kind in {"ply", "stl"}:
        made = trimesh.util.concatenate(meshes)
    else:
        made = trimesh.Scene()
        for part, mesh in zip(parts, meshes, strict=True):
            made.add_geometry(mesh, node_name=part.name, geom_name=part.name)
    if not metadata:
        return stage_bytes(target, lambda file: made.export(file, file_type=kind))
    data = made.export(file_type=kind)
    data = data.encode() if isinstance(data, str) else data
    for key, text in metadata.items():
        data = with_note(kind, data, key, text)
    return stage_data(target, data)


def surfaces(parts: Sequence[Part]) -> tuple[list[prefilter.Surface], list[str], list[str]]:
    """Returns the surfaces of meshes with UV maps, their names, and warnings of those without.

    Raises:
        ValueError: None has a UV map, or one holds numbers that are not finite.
    """
    found: list[prefilter.Surface] = []
    names: list[str] = []
    without: list[str] = []
    for part in parts:
        if part.uvs is None:
            without.append(part.name)
            continue
        try:
            found.append(prefilter.Surface(part.positions, part.triangles, part.uvs))
        except ValueError as error:
            raise ValueError(f"mesh '{part.name}': {error}") from error
        names.append(part.name)
    if without and not found:
        raise ValueError(f"no mesh has a UV map; found {listed(without)}")
    told = [f"left out, because there is no UV map: {listed(without)}"] if without else []
    return found, names, told


def _parts(argument: str, path: str) -> list[Part]:
    if not os.path.isfile(path):
        raise OSError(f"{argument}: there is no file '{path}'")
    trimesh = _trimesh()
    more: dict[str, Any] = {}
    if path.lower().endswith(".obj"):
        more = {"split_objects": True, "group_material": False, "skip_materials": True}
    try:
        scene = trimesh.load_scene(path, process=False, **more)
    except Exception as error:  # Its readers raise whatever goes wrong in them.
        reason = " ".join(str(error).split())
        raise OSError(f"{argument}: '{path}' cannot be read as a mesh: {reason}") from error
    nodes = sorted(scene.graph.nodes_geometry, key=str)
    parts = [_part(scene, node) for node in nodes]
    parts = [part for part in parts if len(part.triangles)]
    if not parts:
        raise ValueError(f"{argument}: there is no triangle in '{path}'")
    if len(parts) == 1 and scene.graph[nodes[0]][1] == os.path.basename(path):
        stem = os.path.splitext(os.path.basename(path))[0]
        parts = [Part(stem, parts[0].positions, parts[0].triangles, parts[0].uvs)]
    return parts


def _part(scene: Any, node: Any) -> Part:
    matrix, geometry = scene.graph[node]
    mesh = scene.geometry[geometry]
    positions = _rounded(getattr(mesh, "vertices", np.empty((0, 3))))
    if not np.array_equal(matrix, np.eye(4)):
        positions = product(positions, matrix[:3, :3].T) + matrix[:3, 3]
    triangles = np.asarray(getattr(mesh, "faces", np.empty((0, 3))), np.int64).reshape(-1, 3)
    uvs = getattr(getattr(mesh, "visual", None), "uv", None)
    if uvs is not None:
        uvs = _rounded(uvs)[:, :2]
    return Part(str(geometry), positions, triangles, uvs)


def _rounded(numbers: Any) -> NDArray[np.float64]:
    """Returns numbers in single precision, as Blender keeps them: results are then the same."""
    return np.asarray(numbers, np.float32).astype(np.float64)


def _trimesh() -> Any:
    try:
        return import_module("trimesh")
    except ImportError as error:
        raise OSError(
            "meshes need trimesh, which is missing: pip install 'prefilter[command]'"
        ) from error
