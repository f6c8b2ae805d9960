# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.remove_outliers`: removes outliers from the selected scans."""

from typing import TYPE_CHECKING

import bpy

from ...core.operator import WorkOperator
from ..properties import OutlierProperties
from .selected import SelectedScans

if TYPE_CHECKING:
    from ..cleaning import Cleaning


class PREFILTER_OT_remove_outliers(
    OutlierProperties, SelectedScans, WorkOperator, bpy.types.Operator
):
    """Removes outliers from the selected scans."""

    bl_idname = "prefilter.remove_outliers"
    bl_label = "Remove Outliers"
    bl_description = (
        "Remove points of the selected scans that lie by themselves, judged by the points around "
        "them. Scans count as one cloud"
    )
    bl_options = {"REGISTER", "UNDO"}
    activity = "Removing outliers"

    if TYPE_CHECKING:
        work: Cleaning | None

    def read_work(self, context: bpy.types.Context) -> "Cleaning":
        """Copies the positions of the points."""
        from ..cleaning import without_outliers

        return without_outliers(self.targets(context), self.to_settings())
