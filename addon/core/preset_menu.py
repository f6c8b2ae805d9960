# SPDX-License-Identifier: GPL-3.0-or-later

"""The panel of the presets: choose, add, remove, reset to the defaults, share as a file."""

from pathlib import Path
from typing import Any

import bpy
from bl_operators.presets import AddPresetBase
from bl_ui.utils import PresetPanel
from bpy.props import StringProperty

from .outcome import reason
from .presets import SUFFIX, Kind, shown_name
from .properties import reset
from .registration import Step, classes, registration
from .translations import report
from .wording import Sentence

_HERE = str(Path(__file__).resolve().parents[1])


class _OfKind:
    """A mixin for operators on the presets of a kind, that of a panel."""

    panel: StringProperty(options={"HIDDEN", "SKIP_SAVE"})

    @property
    def kind(self) -> Kind:
        """The kind."""
        return getattr(bpy.types, self.panel).kind


class PREFILTER_OT_apply_preset(bpy.types.Operator):
    """Sets the settings of a scene to those of a preset: a step of its own to undo."""

    bl_idname = "prefilter.apply_preset"
    bl_label = "Apply Preset"
    bl_description = "Set the settings to those of this preset"
    bl_options = frozenset({"UNDO", "INTERNAL"})

    # As Blender's panels of presets name them.
    filepath: StringProperty(subtype="FILE_PATH", options={"HIDDEN", "SKIP_SAVE"})
    menu_idname: StringProperty(options={"HIDDEN", "SKIP_SAVE"})

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Sets them."""
        kind = getattr(bpy.types, self.menu_idname).kind
        try:
            found = kind.read(Path(self.filepath))
        except (ValueError, OSError) as error:
            self.report({"ERROR"}, reason(error))
            return {"CANCELLED"}
        group = getattr(context.scene, kind.group)
        for name, value in found.items():
            setattr(group, name, value)
        return {"FINISHED"}


class PREFILTER_OT_add_preset(_OfKind, AddPresetBase, bpy.types.Operator):
    """Keeps the settings of a panel as a preset, or removes one."""

    bl_idname = "prefilter.add_preset"
    bl_label = "Add Preset"
    bl_description = "Add or remove a preset"

    @property
    def preset_menu(self) -> str:
        """The panel of the presets."""
        return self.panel

    @property
    def preset_subdir(self) -> str:
        """Their folder."""
        return self.kind.folder

    def add(self, context: bpy.types.Context, filepath: str) -> None:
        """Writes a preset; Blender 4.x cannot where Python is 3.13."""
        text = self.kind.written(getattr(context.scene, self.kind.group))
        _write(Path(filepath), text.encode())


class PREFILTER_OT_reset_settings(_OfKind, bpy.types.Operator):
    """Sets what presets set back to the defaults."""

    bl_idname = "prefilter.reset_settings"
    bl_label = "Reset to Defaults"
    bl_description = "Set all settings that presets set to their defaults"
    bl_options = frozenset({"UNDO", "INTERNAL"})

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Resets them."""
        kind = self.kind
        defaults = {name: default for name, default, _ in kind.options()}
        reset(getattr(context.scene, kind.group), defaults)
        return {"FINISHED"}


class _PresetFile(_OfKind):
    """A mixin for operators that ask for the file of a preset."""

    filepath: StringProperty(subtype="FILE_PATH", options={"HIDDEN", "SKIP_SAVE"})
    filter_glob: StringProperty(default=f"*{SUFFIX}", options={"HIDDEN"})

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Asks for the file."""
        del event
        if not self.filepath:
            self.filepath = f"{self.kind.name}{SUFFIX}"
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Does it, and reports what fails."""
        try:
            done = self.transfer(context, Path(bpy.path.abspath(self.filepath)))
            self.report({"INFO"}, report(done))
        except (ValueError, OSError) as error:
            self.report({"ERROR"}, report(reason(error)))
            return {"CANCELLED"}
        return {"FINISHED"}

    def transfer(self, context: bpy.types.Context, path: Path) -> str:
        """Reads or writes the file; returns what to report."""
        raise NotImplementedError


class PREFILTER_OT_export_preset(_PresetFile, bpy.types.Operator):
    """Writes the settings of a panel to a file for others."""

    bl_idname = "prefilter.export_preset"
    bl_label = "Export Preset"
    bl_description = "Write these settings to a file that others can import"
    bl_options = frozenset({"INTERNAL"})

    check_existing: bpy.props.BoolProperty(default=True, options={"HIDDEN"})

    def transfer(self, context: bpy.types.Context, path: Path) -> str:
        """Writes the file."""
        path = path.with_suffix(SUFFIX)
        text = self.kind.written(getattr(context.scene, self.kind.group))
        _write(path, text.encode())
        return Sentence("Wrote {}", path.name)


class PREFILTER_OT_import_preset(_PresetFile, bpy.types.Operator):
    """Adds the preset of a file to those of the user."""

    bl_idname = "prefilter.import_preset"
    bl_label = "Import Preset"
    bl_description = "Add the preset of a file to your own"
    bl_options = frozenset({"INTERNAL"})

    def transfer(self, context: bpy.types.Context, path: Path) -> str:
        """Checks the file, and copies it."""
        del context
        self.kind.read(path)
        folder = bpy.utils.user_resource("SCRIPTS", path=f"presets/{self.kind.folder}", create=True)
        target = Path(folder) / path.name
        if target.exists():
            text = "there is a preset '{}' already; remove it first"
            raise ValueError(Sentence(text, shown_name(target)))
        _write(target, path.read_bytes())
        return Sentence("Added the preset '{}'", shown_name(target))


def _write(target: Path, data: bytes) -> None:
    """Replaces a file, or makes a new one."""
    from prefilter.files.staging import write_output

    write_output(target, lambda file: file.write(data))


def panel(kind: Kind) -> type[bpy.types.Panel]:
    """Returns the panel that opens from a header, with the presets of a kind."""
    return type(
        kind.panel,
        (_KindPanel, PresetPanel, bpy.types.Panel),
        {
            "__doc__": "The presets, and how to add one.",
            "bl_label": "Presets",
            "kind": kind,
            "preset_subdir": kind.folder,
            "preset_operator": PREFILTER_OT_apply_preset.bl_idname,
            "preset_add_operator": PREFILTER_OT_add_preset.bl_idname,
            "preset_add_operator_properties": {"panel": kind.panel},
        },
    )


class _KindPanel:
    kind: Kind
    layout: bpy.types.UILayout

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the presets, and what else is done with settings."""
        PresetPanel.draw(self, context)
        self.layout.separator()
        column = self.layout.column(align=True)
        column.operator_context = "INVOKE_DEFAULT"
        made: list[Any] = [
            column.operator(PREFILTER_OT_reset_settings.bl_idname, icon="LOOP_BACK"),
            column.operator(PREFILTER_OT_import_preset.bl_idname, icon="IMPORT"),
            column.operator(PREFILTER_OT_export_preset.bl_idname, icon="EXPORT"),
        ]
        for one in made:
            one.panel = self.kind.panel


register, unregister = registration(
    classes(
        PREFILTER_OT_apply_preset,
        PREFILTER_OT_add_preset,
        PREFILTER_OT_reset_settings,
        PREFILTER_OT_import_preset,
        PREFILTER_OT_export_preset,
    ),
    Step(
        lambda: bpy.utils.register_preset_path(_HERE),
        lambda: bpy.utils.unregister_preset_path(_HERE),
    ),
)
