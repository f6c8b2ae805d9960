# SPDX-License-Identifier: GPL-3.0-or-later

"""Updates of results from their sources, including the results that they were made of."""

from typing import TYPE_CHECKING

import bpy

from ..bridge import kept_sources, new_meshes
from ..core.wording import Sentence
from . import memory
from .boolean import Boolean
from .choices import BooleanSettings
from .voxelization import Voxelization

if TYPE_CHECKING:
    from .steps import Result


class Update:
    """Update of a result, after the results that it was made of.

    No object changes before the last result is computed: until then temporary stand-in objects
    show the surfaces of the earlier ones.
    """

    def __init__(self, result: bpy.types.Object) -> None:
        """Collects the results to update, up to the given one."""
        chain = memory.chain(result)
        kept_sources.put_in_place(chain)
        self._names = [obj.name for obj in reversed(chain)]
        self._stand_ins: dict[str, str] = {}

    @property
    def is_last(self) -> bool:
        """Whether the object read last is the result itself."""
        return len(self._stand_ins) == len(self._names) - 1

    def read(self, context: bpy.types.Context) -> tuple[Voxelization | Boolean, list[str]]:
        """Copies the sources of the next object; returns the work on them, and warnings.

        Raises:
            ValueError: An object is gone.
        """
        name = self._names[len(self._stand_ins)]
        result = _find(name)
        recipe = memory.recall(result)
        source, operands, settings = recipe.source, recipe.operands, recipe.settings
        if source.name in self._stand_ins:
            source = _find(self._stand_ins[source.name])
        with kept_sources.evaluated([source, *operands], context) as depsgraph:
            if isinstance(settings, BooleanSettings):
                work = Boolean.read(source, operands, settings, depsgraph, name)
                return work, recipe.warnings
            return Voxelization.read([source], settings, depsgraph, name), recipe.warnings

    def put_aside(self, result: "Result") -> None:
        """Shows a computed result by a stand-in for its object."""
        assert result.contour is not None
        obj = _find(self._names[len(self._stand_ins)])
        stand_in = obj.copy()
        new_meshes.show_again(stand_in, result.contour)
        self._stand_ins[obj.name] = stand_in.name

    def commit(self) -> None:
        """Moves the meshes of stand-ins to their objects, once the last result is written."""
        for name, stand_in_name in self._stand_ins.items():
            obj, stand_in = _find(name), _find(stand_in_name)
            new_meshes.replace_data(obj, stand_in.data)
            bpy.data.objects.remove(stand_in)
            memory.remember_mesh(obj)
        self._stand_ins.clear()

    def discard(self) -> None:
        """Removes the stand-ins."""
        for name in self._stand_ins.values():
            stand_in = bpy.data.objects.get(name)
            if stand_in is not None:
                mesh = stand_in.data
                bpy.data.objects.remove(stand_in)
                bpy.data.meshes.remove(mesh)
        self._stand_ins.clear()


def _find(name: str) -> bpy.types.Object:
    obj = bpy.data.objects.get(name)
    if obj is None:
        raise ValueError(Sentence("object '{}' is gone", name))
    return obj
