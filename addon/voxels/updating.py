# SPDX-License-Identifier: GPL-3.0-or-later

"""Results made again: one after another, where one was made of another."""

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
    """A result, and before it those that it was made of.

    Nothing that is there changes before the last is computed: until then the surfaces of those
    before are shown by objects that stand in for them.
    """

    def __init__(self, result: bpy.types.Object) -> None:
        """Takes the object that is made again."""
        chain = memory.chain(result)
        kept_sources.put_in_place(chain)
        self._names = [obj.name for obj in reversed(chain)]
        self._stand_ins: dict[str, str] = {}

    @property
    def is_last(self) -> bool:
        """Whether what was read last is the result itself."""
        return len(self._stand_ins) == len(self._names) - 1

    def read(self, context: bpy.types.Context) -> tuple[Voxelization | Boolean, list[str]]:
        """Copies what the next object was made of; returns what is to do, and warnings.

        Raises:
            ValueError: Something is gone.
        """
        name = self._names[len(self._stand_ins)]
        result = _found(name)
        request = memory.recall(result)
        source, operands, settings = request.source, request.operands, request.settings
        if source.name in self._stand_ins:
            source = _found(self._stand_ins[source.name])
        with kept_sources.evaluated([source, *operands], context) as depsgraph:
            if isinstance(settings, BooleanSettings):
                work = Boolean.read(source, operands, settings, depsgraph, name)
                return work, request.warnings
            return Voxelization.read([source], settings, depsgraph, name), request.warnings

    def put_aside(self, result: "Result") -> None:
        """Has an object show what was computed that stands in for the one it was made for."""
        assert result.contour is not None
        obj = _found(self._names[len(self._stand_ins)])
        made = obj.copy()
        new_meshes.show_again(made, result.contour)
        self._stand_ins[obj.name] = made.name

    def commit(self) -> None:
        """Gives what stands in to those before the result, once that is written."""
        for name, stand_in in self._stand_ins.items():
            obj, made = _found(name), _found(stand_in)
            new_meshes.replace_data(obj, made.data)
            bpy.data.objects.remove(made)
            memory.remember_mesh(obj)
        self._stand_ins.clear()

    def discard(self) -> None:
        """Removes what stands in."""
        for stand_in in self._stand_ins.values():
            made = bpy.data.objects.get(stand_in)
            if made is not None:
                mesh = made.data
                bpy.data.objects.remove(made)
                bpy.data.meshes.remove(mesh)
        self._stand_ins.clear()


def _found(name: str) -> bpy.types.Object:
    obj = bpy.data.objects.get(name)
    if obj is None:
        raise ValueError(Sentence("object '{}' is gone", name))
    return obj
