# SPDX-License-Identifier: GPL-3.0-or-later

"""Properties of objects that link a result and its sources; see `bridge.kept_sources`."""

import bpy
from bpy.props import BoolProperty, CollectionProperty, PointerProperty

from ..core.registration import classes, registration, state


class PREFILTER_PG_source_object(bpy.types.PropertyGroup):
    """A source object of a result."""

    obj: PointerProperty(type=bpy.types.Object)


class PREFILTER_PG_made_of(bpy.types.PropertyGroup):
    """The sources of an object.

    Attributes:
        sources: For a result, its source objects.
        is_source_shown: For a result, whether the sources are shown instead of it.
        is_source: Whether the object is the source of a result.
        is_copy: Whether the object is a private copy of the object that the result replaced.
    """

    sources: CollectionProperty(type=PREFILTER_PG_source_object)
    is_source_shown: BoolProperty()
    is_source: BoolProperty()
    is_copy: BoolProperty()


register, unregister = registration(
    classes(PREFILTER_PG_source_object),
    state(bpy.types.Object, "prefilter_made_of", PREFILTER_PG_made_of),
)
