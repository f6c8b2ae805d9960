# SPDX-License-Identifier: GPL-3.0-or-later

"""The settings of previews, in the window manager, so that undo does not change them."""

import bpy
from bpy.props import BoolProperty, FloatProperty

from ...bridge import editors
from ...core.properties import single_property
from ...core.registration import registration, state
from ...core.translations import CONTEXT
from ..choices import PlotSettings, PreviewSettings


class PREFILTER_PG_view(bpy.types.PropertyGroup):
    """The settings of the panels that show levels and errors."""

    use_preview: BoolProperty(
        name="Show Level",
        translation_context=CONTEXT,
        description="Draw a level in place of the image",
        default=True,
        update=editors.redraw_on_change,
    )
    mip_value: FloatProperty(
        name="Mip Value",
        translation_context=CONTEXT,
        description="Level that is drawn: 0 is the image, 1 has half its width and height. Values "
        "in between mix two levels, as on a GPU",
        default=1.0,
        min=0.0,
        max=16.0,
        soft_max=10.0,
        step=100,
        precision=2,
        update=editors.redraw_on_change,
    )
    use_wipe: BoolProperty(
        name="Wipe",
        translation_context=CONTEXT,
        description="Draw the levels of another filter in the left part of the editor",
        default=False,
        update=editors.redraw_on_change,
    )
    wipe: FloatProperty(
        name="Position",
        translation_context=CONTEXT,
        description="Position of the wipe, from the left to the right edge of the editor",
        subtype="FACTOR",
        default=0.5,
        min=0.0,
        max=1.0,
        update=editors.redraw_on_change,
    )
    use_model: BoolProperty(
        name="Show Levels",
        translation_context=CONTEXT,
        description="Draw levels over the objects that show the image, in the 3D views",
        default=True,
        update=editors.redraw_on_change,
    )
    choice: single_property(PreviewSettings, "choice", update=editors.redraw_on_change)
    distance: single_property(PreviewSettings, "distance", update=editors.redraw_on_change)
    compare: single_property(PreviewSettings, "compare", update=editors.redraw_on_change)
    plot_filters: single_property(
        PlotSettings, "filters", description="The filters to compare; Shift-click to choose several"
    )


register, unregister = registration(
    state(bpy.types.WindowManager, "prefilter_view", PREFILTER_PG_view)
)
