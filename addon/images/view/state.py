# SPDX-License-Identifier: GPL-3.0-or-later

"""The settings of preview planes, in the window manager, so that undo does not change them."""

import math

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty

from ...bridge import editors
from ...core.choices import items
from ...core.properties import single_property
from ...core.registration import registration, state
from ...core.translations import CONTEXT
from ..choices import METHODS, PlaneSettings


class PREFILTER_PG_plane(bpy.types.PropertyGroup):
    """The settings of the panel."""

    use_plane: BoolProperty(
        name="Show Plane",
        translation_context=CONTEXT,
        description="Draw the plane over the image",
        default=True,
        update=editors.redraw_on_change,
    )
    filter: single_property(PlaneSettings, "filter")
    texels: EnumProperty(
        name="Table",
        translation_context=CONTEXT,
        description="Number of texels of the mipmap per pixel, to the right of the line",
        items=items({key: METHODS[key] for key in ("8", "6", "4")}),
        default="8",
        update=editors.redraw_on_change,
    )
    tilt: FloatProperty(
        name="Tilt",
        translation_context=CONTEXT,
        description="Angle of the plane away from the viewer",
        subtype="ANGLE",
        default=math.radians(75),
        min=0.0,
        max=math.radians(89.5),
        update=editors.redraw_on_change,
    )
    rotation: FloatProperty(
        name="Rotation",
        translation_context=CONTEXT,
        description="Angle of the image in the plane",
        subtype="ANGLE",
        default=0.0,
        update=editors.redraw_on_change,
    )
    tiles: FloatProperty(
        name="Tiles",
        translation_context=CONTEXT,
        description="Number of repetitions of the image over the height of the editor, "
        "without the tilt",
        default=2.0,
        min=0.01,
        soft_min=0.1,
        max=1000.0,
        soft_max=50.0,
        update=editors.redraw_on_change,
    )
    wipe: FloatProperty(
        name="Position",
        translation_context=CONTEXT,
        description="Position of the line between the two halves, from left to right",
        subtype="FACTOR",
        default=0.5,
        min=0.0,
        max=1.0,
        update=editors.redraw_on_change,
    )


register, unregister = registration(
    state(bpy.types.WindowManager, "prefilter_plane", PREFILTER_PG_plane)
)
