# SPDX-License-Identifier: GPL-3.0-or-later

"""Options as properties of Blender: of operators, and of the scene."""

import math
from collections.abc import Callable, Collection, Mapping
from typing import Any

import bpy
from bpy.props import (
    BoolProperty,
    EnumProperty,
    FloatProperty,
    FloatVectorProperty,
    IntProperty,
    StringProperty,
)

from .choices import flag_items, items, number_of
from .options import Option, declared, option
from .preferences import preference
from .translations import CONTEXT

_ABOVE = 1e-3
"""How far above a limit that it must not have a property begins."""
_PATHS = frozenset({"FILE_PATH", "DIR_PATH"})
_SET = "_set"
"""What follows the name of an option where a scene keeps it that otherwise follows a preference."""


def properties(settings: type, without: Collection[str] = ()) -> dict[str, Any]:
    """Returns the annotations of a class that has the options of a dataclass as properties.

    Args:
        settings: The dataclass.
        without: Fields to leave out.
    """
    return {
        name: _property(default, found)
        for name, default, found in declared(settings)
        if found.label and name not in without
    }


def following(settings: type, **more: Mapping[str, Any]) -> dict[str, Any]:
    """Returns the annotations that let options in scenes follow the preferences until they are set.

    They stand for those of the same name that `properties` returns. What a user sets is kept in a
    second property, as a property of its own functions has no value of its own.

    Args:
        settings: A dataclass.
        more: For a field, more arguments of its property, such as `update`.
    """
    found: dict[str, Any] = {}
    for name, default, declaration in declared(settings):
        if declaration.label and declaration.preference:
            found[f"{name}{_SET}"] = _property(default, declaration, options={"HIDDEN"})
            get, put = _accessors(name, default, declaration)
            found[name] = _property(default, declaration, get=get, set=put, **more.get(name, {}))
    return found


def shared(
    settings: type, owner: str, without: Collection[str] = (), **more: Mapping[str, Any]
) -> dict[str, Any]:
    """Returns the annotations of options that a scene keeps in another of its groups.

    They stand for those of the same name that `properties` returns: both groups show one value.

    Args:
        settings: A dataclass.
        owner: The property of the scene that has the values.
        without: Fields to leave out.
        more: For a field, more arguments of its property.
    """
    found: dict[str, Any] = {}
    for name, default, declaration in declared(settings):
        if declaration.label and name not in without:
            get, put = _shared_accessors(owner, name, declaration)
            found[name] = _property(default, declaration, get=get, set=put, **more.get(name, {}))
    return found


def set_unset(operator: bpy.types.Operator, values: Mapping[str, Any]) -> None:
    """Sets those of an operator's properties that its caller has not set."""
    for name, value in values.items():
        if not operator.properties.is_property_set(name):
            setattr(operator, name, value)


def single_property(settings: type, name: str, **more: Any) -> Any:
    """Returns one option as a property, with more arguments such as `update`."""
    return _property(*option(settings, name), **more)


def values(source: Any, settings: type, without: Collection[str] = ()) -> Any:
    """Returns the settings that properties have; paths are absolute.

    Fields in `without` keep their defaults, and those that are no properties the preferences.
    """
    found = {}
    for name, default, declaration in declared(settings):
        if not declaration.label and declaration.preference:
            found[name] = preference(declaration.preference, default)
        if declaration.label and name not in without:
            value = getattr(source, name)
            if declaration.subtype in _PATHS:
                value = bpy.path.abspath(value)
            elif isinstance(default, tuple) and not declaration.choices:
                value = tuple(value)
            found[name] = value
    return settings(**found)


def copy(source: Any, target: Any, settings: type, without: Collection[str] = ()) -> None:
    """Copies the options of a dataclass between a property group and an operator's properties."""
    for name in properties(settings, without):
        setattr(target, name, getattr(source, name))


def reset(group: bpy.types.PropertyGroup, defaults: Mapping[str, Any]) -> None:
    """Sets properties of a group to defaults, or has them follow the preferences again."""
    for name, default in defaults.items():
        kept = f"{name}{_SET}"
        if kept in group.bl_rna.properties:
            group.property_unset(kept)
        else:
            setattr(group, name, default)


def _shared_accessors(
    owner: str, name: str, declaration: Option
) -> tuple[Callable[[Any], Any], Callable[[Any, Any], None]]:
    """Returns the functions of a property whose value another group of the scene has."""
    keys = {number_of(key): key for key in declaration.choices}

    def get(group: Any) -> Any:
        value = getattr(getattr(group.id_data, owner), name)
        return number_of(value) if keys else value

    def put(group: Any, value: Any) -> None:
        setattr(getattr(group.id_data, owner), name, keys[value] if keys else value)

    return get, put


def _accessors(
    name: str, default: Any, declaration: Option
) -> tuple[Callable[[Any], Any], Callable[[Any, Any], None]]:
    """Returns the functions of a property that follows a preference."""
    keys = {number_of(key): key for key in declaration.choices}
    kept = f"{name}{_SET}"

    def get(group: Any) -> Any:
        is_set = group.is_property_set(kept)
        value = getattr(group, kept) if is_set else preference(declaration.preference, default)
        return number_of(value) if keys else value

    def put(group: Any, value: Any) -> None:
        setattr(group, kept, keys[value] if keys else value)

    return get, put


def _property(default: Any, declaration: Option, **more: Any) -> Any:
    common = {
        "name": declaration.label,
        "description": declaration.description,
        "translation_context": CONTEXT,
        **declaration.display,
        **more,
    }
    if declaration.choices:
        if isinstance(default, tuple):
            common |= {"options": {"ENUM_FLAG"}, "default": set(default)}
            return EnumProperty(items=flag_items(declaration.choices), **common)
        return EnumProperty(items=items(declaration.choices), default=default, **common)
    common["default"] = default
    if isinstance(default, bool):
        return BoolProperty(**common)
    common["subtype"] = declaration.subtype
    if declaration.subtype in _PATHS and bpy.app.version >= (4, 5, 0):
        common["options"] = {"ANIMATABLE", "PATH_SUPPORTS_BLEND_RELATIVE"}
    if declaration.subtype == "COLOR":
        return FloatVectorProperty(size=len(default), min=0.0, max=1.0, **common)
    if isinstance(default, str):
        return StringProperty(**common)
    low = declaration.low + _ABOVE if declaration.is_above else declaration.low
    limits = {"min": low, "max": declaration.high}
    common = {name: value for name, value in limits.items() if math.isfinite(value)} | common
    if isinstance(default, tuple):
        return FloatVectorProperty(size=len(default), **common)
    return (IntProperty if isinstance(default, int) else FloatProperty)(**common)
