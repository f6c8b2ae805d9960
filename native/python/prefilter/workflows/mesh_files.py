# SPDX-License-Identifier: GPL-3.0-or-later

"""Reading and writing mesh files as triangles; trimesh reads STL and writes, if installed."""

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import prefilter

from .. import _native
from ..files.file_names import portable
from ..files.staging import StagedFile, stage_bytes, stage_data
from ..files.undecodable_names import is_text, readable_name
from .damage import why_unreadable
from .files.gltf import read_gltf
from .files.mesh_notes import with_note
from .files.obj import read_obj
from .files.off import read_off
from .files.polygons import PolygonMesh, rounded
from .wording import counted, listed


@dataclass(frozen=True)
class NamedMesh:
    """A mesh of a file, in world coordinates.

    Attributes:
        name: Its name in the file; the file's name if there is only one mesh without a name.
        positions: (vertices, 3) float64.
        triangles: (triangles, 3) integers.
        uvs: (triangles, 3, 2) float64 of the triangles' corners, NaN for one without, or
            (vertices, 2); None for a mesh without a UV map.
        bare: (triangles,) whether a triangle has corners without UVs; None if no triangle has.
    """

    name: str
    positions: NDArray[np.float64]
    triangles: NDArray[np.integer]
    uvs: NDArray[np.float64] | None
    bare: NDArray[np.bool_] | None = None

    def mapped(self) -> tuple[NDArray[np.integer], NDArray[np.float64]]:
        """Returns the triangles with UVs, and UVs of their corners, (triangles, 3, 2)."""
        assert self.uvs is not None
        uvs = self.uvs if self.uvs.ndim == 3 else self.uvs[self.triangles]
        if self.bare is None:
            return self.triangles, uvs
        return self.triangles[~self.bare], uvs[~self.bare]


def read(argument: str, paths: Sequence[str]) -> list[NamedMesh]:
    """Reads the meshes of files, sorted by name within each.

    Raises:
        OSError: A file cannot be read, or trimesh is missing.
        ValueError: A file has no triangle.
    """
    return [part for path in paths for part in _read_file(argument, path)]


def select(parts: Sequence[NamedMesh], names: Sequence[str]) -> list[NamedMesh]:
    """Returns the meshes with the given names; all if no name is given.

    Raises:
        ValueError: No mesh has one of the names.
    """
    for name in names:
        if all(part.name != name for part in parts):
            known = listed(dict.fromkeys(part.name for part in parts))
            raise ValueError(f"--object: found no mesh '{name}'; there are {known}")
    return [part for part in parts if part.name in names] if names else list(parts)


def name_of(path: str) -> str:
    """Returns a mesh name from a file's name, made portable if it is no valid text."""
    stem = os.path.splitext(os.path.basename(path))[0]
    return stem if is_text(stem) else portable(stem)


def merge_seams(part: NamedMesh) -> NamedMesh:
    """Merges vertices of equal position, which files split along UV seams."""
    places, numbers = np.unique(part.positions, axis=0, return_inverse=True)
    triangles = numbers.reshape(-1)[part.triangles]
    return NamedMesh(part.name, places, np.asarray(triangles, np.int64), None)


def stage(
    target: Path, parts: Sequence[NamedMesh], metadata: Mapping[str, str] | None = None
) -> StagedFile:
    """Stages positions and triangles in the format of the target's extension."""
    trimesh = _trimesh()
    kind = target.suffix.lower().removeprefix(".")
    meshes = [trimesh.Trimesh(one.positions, one.triangles, process=False) for one in parts]
    if kind in {"ply", "stl"}:
        scene = trimesh.util.concatenate(meshes)
    else:
        scene = trimesh.Scene()
        for part, mesh in zip(parts, meshes, strict=True):
            scene.add_geometry(mesh, node_name=part.name, geom_name=part.name)
    if not metadata:
        return stage_bytes(target, lambda file: scene.export(file, file_type=kind))
    data = scene.export(file_type=kind)
    data = data.encode() if isinstance(data, str) else data
    for key, text in metadata.items():
        data = with_note(kind, data, key, text)
    return stage_data(target, data)


def surfaces(parts: Sequence[NamedMesh]) -> tuple[list[prefilter.Surface], list[str], list[str]]:
    """Returns the surfaces of meshes with UV maps, their names, and warnings about the others.

    Raises:
        ValueError: No mesh has a UV map, or a number is not finite.
    """
    mapped_surfaces: list[prefilter.Surface] = []
    names: list[str] = []
    without: list[str] = []
    warnings: list[str] = []
    for part in parts:
        if part.uvs is None:
            without.append(part.name)
            continue
        try:
            mapped_surfaces.append(prefilter.Surface(part.positions, *part.mapped()))
        except ValueError as error:
            raise ValueError(f"mesh '{part.name}': {error}") from error
        if part.bare is not None:
            count = counted(range(int(part.bare.sum())), "triangle")
            warnings.append(f"mesh '{part.name}': left out {count} without UVs")
        names.append(part.name)
    if without and not mapped_surfaces:
        raise ValueError(f"no mesh has a UV map; found {listed(without)}")
    if without:
        warnings.insert(0, f"left out, because there is no UV map: {listed(without)}")
    return mapped_surfaces, names, warnings


def _read_file(argument: str, path: str) -> list[NamedMesh]:
    if not os.path.isfile(path):
        raise OSError(f"{argument}: there is no file '{path}'")
    reader = _READERS.get(os.path.splitext(path)[1].lower(), _read_by_trimesh)
    try:
        meshes = reader(path)
    except MissingModuleError:
        raise
    except Exception as error:  # Readers may raise anything.
        reason = why_unreadable(error, path)
        raise OSError(f"{argument}: '{path}' cannot be read as a mesh: {reason}") from error
    parts = [_triangulated(mesh) for mesh in sorted(meshes, key=lambda mesh: mesh.name)]
    parts = [part for part in parts if len(part.triangles)]
    if not parts:
        raise ValueError(f"{argument}: there is no triangle in '{path}'")
    return [part if part.name else replace(part, name=name_of(path)) for part in parts]


def _triangulated(mesh: PolygonMesh) -> NamedMesh:
    corners = mesh.triangle_corners()
    triangles = mesh.corners[corners]
    if mesh.uvs is None:
        return NamedMesh(mesh.name, mesh.positions, triangles, None)
    uvs = mesh.uvs[corners]
    bare = np.asarray(np.isnan(uvs).any(axis=(1, 2)), np.bool_)
    if bare.all():
        return NamedMesh(mesh.name, mesh.positions, triangles, None)
    return NamedMesh(mesh.name, mesh.positions, triangles, uvs, bare if bare.any() else None)


def _read_by_trimesh(path: str) -> list[PolygonMesh]:
    """Reads a file whose faces are triangles without UVs."""
    trimesh = _trimesh()
    with readable_name(path) as known:
        scene = trimesh.load_scene(known, process=False)
        nodes = list(scene.graph.nodes_geometry)
    meshes = []
    for node in nodes:
        mesh = scene.geometry[scene.graph[node][1]]
        triangles = np.asarray(getattr(mesh, "faces", np.empty((0, 3))), np.int64).reshape(-1, 3)
        points = rounded(getattr(mesh, "vertices", np.empty((0, 3))))
        name = str(scene.graph[node][1])
        name = "" if name == os.path.basename(known) else name
        sizes = np.full(len(triangles), 3, np.int64)
        meshes.append(PolygonMesh(name, points, triangles.reshape(-1), sizes, None))
    return meshes


def _read_ply(path: str) -> list[PolygonMesh]:
    positions, corners, sizes, uvs = _native.read_ply_mesh(os.fsencode(path), None)
    uvs = None if uvs is None else rounded(uvs)
    return [PolygonMesh("", rounded(positions), corners, sizes, uvs)]


_READERS: dict[str, Callable[[str], list[PolygonMesh]]] = {
    ".obj": lambda path: read_obj(Path(path).read_bytes()),
    ".off": lambda path: read_off(Path(path).read_bytes()),
    ".ply": _read_ply,
    ".glb": read_gltf,
    ".gltf": read_gltf,
}


class MissingModuleError(OSError):
    """A Python module that a file format needs is missing."""


def _trimesh() -> Any:
    try:
        return import_module("trimesh")
    except ImportError as error:
        raise MissingModuleError(
            "meshes need trimesh, which is missing: pip install 'prefilter[command]'"
        ) from error
