# SPDX-License-Identifier: GPL-3.0-or-later

"""Settings of the operators on scans as properties, of operators and of the scene."""

from pathlib import Path
from typing import Any, ClassVar

import bpy
from bpy.props import CollectionProperty, StringProperty

from ..core import preset_menu, presets
from ..core.properties import preference_properties, properties, values
from ..core.registration import classes, registration, state
from ..core.sidebar import GroupedSettings, subpanel
from .choices import (
    AlignSettings,
    CropSettings,
    ImportSettings,
    OutlierSettings,
    PaintSettings,
    ScanSettings,
    SubsampleSettings,
    TrimSettings,
)

RECONSTRUCT = presets.Kind("reconstruct", "prefilter_reconstruct", [(ScanSettings, ())])


class ScanProperties(GroupedSettings):
    """The properties of `prefilter.reconstruct`."""

    __annotations__ = properties(ScanSettings)

    def to_settings(self) -> ScanSettings:
        """Returns the settings."""
        return values(self, ScanSettings)

    def draw_basic(self, layout: bpy.types.UILayout) -> None:
        """Draws the usual settings."""
        layout.prop(self, "resolution")
        if self.resolution != "auto":
            layout.prop(self, "depth" if self.resolution == "depth" else "voxel_size")
        layout.prop(self, "use_watertight")
        layout.prop(self, "trim", text="Trim (Cells)")
        layout.prop(self, "direction")
        layout.prop(self, "points")

    def draw_groups(self, layout: bpy.types.UILayout) -> None:
        """Draws the parts."""
        _, body = subpanel(layout, "scan_surface", "Surface")
        if body:
            column = body.column(align=True)
            for name in ("use_smooth", "use_fit", "use_smooth_shading"):
                column.prop(self, name)
            body.prop(self, "adaptivity")
            body.prop(self, "isovalue")
            if self.isovalue == "custom":
                body.prop(self, "custom_isovalue")
        _, body = subpanel(layout, "scan_performance", "Performance")
        if body:
            body.prop(self, "memory_limit", text="Memory (MiB)")
        _, body = subpanel(layout, "scan_advanced", "Advanced")
        if body:
            body.prop(self, "wavelet")


class SettingsProperties:
    """Base of properties made from the fields of a settings dataclass, `settings`."""

    settings: ClassVar[type[Any]]

    def to_settings(self) -> Any:
        """Returns the settings."""
        return values(self, self.settings)


class FilesProperties:
    """Files that an operator reads: one, or several in a folder, as Blender drops them."""

    filepath: StringProperty(subtype="FILE_PATH", options={"HIDDEN", "SKIP_SAVE"})
    directory: StringProperty(subtype="DIR_PATH", options={"HIDDEN", "SKIP_SAVE"})
    files: CollectionProperty(
        type=bpy.types.OperatorFileListElement, options={"HIDDEN", "SKIP_SAVE"}
    )

    def named_files(self) -> dict[str, Any]:
        """Returns the files as arguments of another operator."""
        files = [{"name": file.name} for file in self.files]
        return {"filepath": self.filepath, "directory": self.directory, "files": files}

    def paths(self) -> list[Path]:
        """Returns the files."""
        if self.directory and self.files:
            folder = Path(bpy.path.abspath(self.directory))
            return [folder / file.name for file in self.files if file.name]
        return [Path(bpy.path.abspath(self.filepath))] if self.filepath else []


class ImportProperties(FilesProperties, SettingsProperties):
    """The properties of `prefilter.import_points`."""

    settings = ImportSettings
    __annotations__ = properties(ImportSettings)


class TrimProperties(SettingsProperties):
    """The properties of `prefilter.trim_reconstruction`."""

    settings = TrimSettings
    __annotations__ = properties(TrimSettings)


class SubsampleProperties(SettingsProperties):
    """The properties of `prefilter.subsample_points`."""

    settings = SubsampleSettings
    __annotations__ = properties(SubsampleSettings)


class OutlierProperties(SettingsProperties):
    """The properties of `prefilter.remove_outliers`."""

    settings = OutlierSettings
    __annotations__ = properties(OutlierSettings)


class CropProperties(SettingsProperties):
    """The properties of `prefilter.crop_points`."""

    settings = CropSettings
    __annotations__ = properties(CropSettings)


class AlignProperties(SettingsProperties):
    """The properties of `prefilter.align_scans`."""

    settings = AlignSettings
    __annotations__ = properties(AlignSettings)


class PaintProperties(SettingsProperties):
    """The properties of `prefilter.paint_texture`."""

    settings = PaintSettings
    __annotations__ = properties(PaintSettings)


class PREFILTER_PG_reconstruct(ScanProperties, bpy.types.PropertyGroup):
    """The settings that the panel shows; they stay with the scene."""

    __annotations__ = preference_properties(ScanSettings)


register, unregister = registration(
    state(bpy.types.Scene, RECONSTRUCT.group, PREFILTER_PG_reconstruct),
    classes(preset_menu.panel(RECONSTRUCT)),
)
