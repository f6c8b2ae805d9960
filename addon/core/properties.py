# SPDX-License-Identifier: GPL-3.0-or-later

"""Options as Blender properties, of operators and of the scene."""

import math
from collections.abc import Collection, Mapping
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
"""Distance of a property's minimum from an exclusive lower limit."""
_PATHS = frozenset({"FILE_PATH", "DIR_PATH"})
_SET = "_set"
"""Suffix of the property that stores a value set by the user, for an option that otherwise follows
a preference."""


def properties(settings: type, without: Collection[str] = ()) -> dict[str, Any]:
    """Returns annotations with a property for each option of a dataclass.

    Args:
        settings: The dataclass.
        without: Fields to leave out.
    """
    return {
        name: _property(default, declaration)
        for name, default, declaration in declared(settings)
        if declaration.label and name not in without
    }


def preference_properties(settings: type, **more: Mapping[str, Any]) -> dict[str, Any]:
    """Returns annotations for options of a scene that follow the preferences until they are set.

    They replace the annotations of the same names from `properties`. A second property stores the
    user's value, because a property with a getter has no storage.

    Args:
        settings: A dataclass.
        more: For a field, more arguments of its property, such as `update`.
    """
    annotations: dict[str, Any] = {}
    for name, default, declaration in declared(settings):
        if declaration.label and declaration.preference:
            annotations[f"{name}{_SET}"] = _property(default, declaration, options={"HIDDEN"})
            accessors = _accessors(name, default, declaration)
            annotations[name] = _property(default, declaration, **accessors, **more.get(name, {}))
    return annotations


def shared_properties(
    settings: type, owner: str, without: Collection[str] = (), **more: Mapping[str, Any]
) -> dict[str, Any]:
    """Returns annotations for options whose values another property group of the scene stores.

    They replace the annotations of the same names from `properties`: both groups show one value.

    Args:
        settings: A dataclass.
        owner: The scene property that stores the values.
        without: Fields to leave out.
        more: For a field, more arguments of its property.
    """
    annotations: dict[str, Any] = {}
    for name, default, declaration in declared(settings):
        if declaration.label and name not in without:
            accessors = _shared_accessors(owner, name, declaration)
            annotations[name] = _property(default, declaration, **accessors, **more.get(name, {}))
    return annotations


def set_unset(operator: bpy.types.Operator, values: Mapping[str, Any]) -> None:
    """Sets the properties of an operator that its caller has not set."""
    for name, value in values.items():
        if not operator.properties.is_property_set(name):
            setattr(operator, name, value)


def single_property(settings: type, name: str, **more: Any) -> Any:
    """Returns one option as a property, with more arguments such as `update`."""
    return _property(*option(settings, name), **more)


def values(source: Any, settings: type, without: Collection[str] = ()) -> Any:
    """Returns the settings stored in properties, with absolute paths.

    Fields in `without` get their defaults; fields without a property get their preference.
    """
    fields = {}
    for name, default, declaration in declared(settings):
        if not declaration.label and declaration.preference:
            fields[name] = preference(declaration.preference, default)
        if declaration.label and name not in without:
            value = getattr(source, name)
            if declaration.subtype in _PATHS:
                value = bpy.path.abspath(value)
            elif isinstance(default, tuple) and not declaration.choices:
                value = tuple(value)
            fields[name] = value
    return settings(**fields)


def copy(source: Any, target: Any, settings: type, without: Collection[str] = ()) -> None:
    """Copies the options of a dataclass between a property group and an operator's properties."""
    for name in properties(settings, without):
        setattr(target, name, getattr(source, name))


def reset(group: bpy.types.PropertyGroup, defaults: Mapping[str, Any]) -> None:
    """Sets properties of a group to their defaults, or makes them follow the preferences again."""
    for name, default in defaults.items():
        storage = f"{name}{_SET}"
        if storage in group.bl_rna.properties:
            group.property_unset(storage)
        else:
            setattr(group, name, default)


def _shared_accessors(owner: str, name: str, declaration: Option) -> dict[str, Any]:
    """Returns the getter and setter of a property whose value another group stores."""
    keys = {number_of(key): key for key in declaration.choices}

    def get(group: Any) -> Any:
        value = getattr(getattr(group.id_data, owner), name)
        return number_of(value) if keys else value

    def put(group: Any, value: Any) -> None:
        setattr(getattr(group.id_data, owner), name, keys[value] if keys else value)

    return {"get": get, "set": put}


def _accessors(name: str, default: Any, declaration: Option) -> dict[str, Any]:
    """Returns the getter and setter of a property that follows a preference."""
    keys = {number_of(key): key for key in declaration.choices}
    storage = f"{name}{_SET}"

    def get(group: Any) -> Any:
        is_set = group.is_property_set(storage)
        value = getattr(group, storage) if is_set else preference(declaration.preference, default)
        return number_of(value) if keys else value

    def put(group: Any, value: Any) -> None:
        setattr(group, storage, keys[value] if keys else value)

    return {"get": get, "set": put}


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
