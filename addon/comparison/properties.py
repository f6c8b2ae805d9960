# SPDX-License-Identifier: GPL-3.0-or-later

"""What objects know of what they were made of; see `bridge.kept_sources`."""

import bpy
from bpy.props import BoolProperty, CollectionProperty, PointerProperty

from ..core.registration import classes, registration, state


class PREFILTER_PG_source_object(bpy.types.PropertyGroup):
    """An object that another was made of."""

    obj: PointerProperty(type=bpy.types.Object)


class PREFILTER_PG_made_of(bpy.types.PropertyGroup):
    """What an object was made of, and whether that is shown.

    Attributes:
        sources: Of a result: what it was made of.
        is_source_shown: Of a result: whether these are shown instead.
        is_source: Whether something was made of the object.
        is_copy: Whether the object is a copy of what a result was, which nothing else uses.
    """

    sources: CollectionProperty(type=PREFILTER_PG_source_object)
    is_source_shown: BoolProperty()
    is_source: BoolProperty()
    is_copy: BoolProperty()


register, unregister = registration(
    classes(PREFILTER_PG_source_object),
    state(bpy.types.Object, "prefilter_made_of", PREFILTER_PG_made_of),
)
