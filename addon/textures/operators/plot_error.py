# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.plot_error`: the errors of filters by mip value, as a figure and a table."""

from typing import TYPE_CHECKING

import bpy

from ...bridge import editors
from ...core.operator_hooks import Compute
from ...core.properties import single_property
from ...core.wording import Sentence
from .. import choices
from .source import SurfaceOperator, read_source

if TYPE_CHECKING:
    from ..view import errors


class PREFILTER_OT_plot_error(SurfaceOperator, bpy.types.Operator):
    """Measures the levels of filters, and plots their errors."""

    bl_idname = "prefilter.plot_error"
    bl_label = "Plot Error"
    bl_description = (
        "Measure how far the levels of each filter are from the image over the surface of the "
        "meshes that use it, and plot it against the mip value, as an image and a text with the "
        "values"
    )
    bl_options = {"REGISTER", "UNDO"}
    activity = "Measuring errors"

    filters: single_property(choices.PlotSettings, "filters")

    def read(self, context: bpy.types.Context) -> Compute:
        """Copies the image and its surfaces."""
        from ..view import errors

        self._source = read_source(context, self.image, context.scene.prefilter_bake.to_settings())
        self.warn(self._source.warnings)
        chosen = [name for name in choices.FILTERS if name in self.filters]
        return lambda progress: errors.measure(self._source, chosen, progress)

    def finish(self, context: bpy.types.Context, result: "errors.ErrorCurves") -> str:
        """Draws the figure and writes the table."""
        from ...bridge import derived
        from ..view import figure

        picture = self._source.picture
        plot = derived.write_picture(picture, "error", figure.draw(result))
        table = derived.write_text(picture, "error.csv", result.table())
        editors.show(context, plot)
        return Sentence(
            "{}; plotted in '{}', values in text '{}'", result.summary(), plot.name, table.name
        )
