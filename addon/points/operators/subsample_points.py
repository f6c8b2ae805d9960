# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.subsample_points`: subsamples the points of the selected scans."""

from typing import TYPE_CHECKING

import bpy

from ...core.operator import WorkOperator
from ..properties import SubsampleProperties
from .selected import SelectedScans

if TYPE_CHECKING:
    from ..cleaning import Cleaning


class PREFILTER_OT_subsample_points(
    SubsampleProperties, SelectedScans, WorkOperator, bpy.types.Operator
):
    """Subsamples the points of the selected scans."""

    bl_idname = "prefilter.subsample_points"
    bl_label = "Subsample Points"
    bl_description = (
        "Keep fewer points of the selected scans, spread evenly. Scans count as one cloud"
    )
    bl_options = {"REGISTER", "UNDO"}
    activity = "Subsampling"

    if TYPE_CHECKING:
        work: Cleaning | None

    def read_work(self, context: bpy.types.Context) -> "Cleaning":
        """Copies the positions of the points."""
        from ..cleaning import subsampling

        return subsampling(self.targets(context), self.to_settings())
