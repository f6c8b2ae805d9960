# SPDX-License-Identifier: GPL-3.0-or-later

"""The panel of presets: apply, add, remove, reset to the defaults, export and import."""

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

_ADDON = str(Path(__file__).resolve().parents[1])


class _KindOperator:
    """A mixin for operators on the presets of a panel."""

    panel: StringProperty(options={"HIDDEN", "SKIP_SAVE"})

    @property
    def kind(self) -> Kind:
        """The kind of presets of the panel."""
        return getattr(bpy.types, self.panel).kind


class PREFILTER_OT_apply_preset(bpy.types.Operator):
    """Applies a preset to the scene, as one undo step."""

    bl_idname = "prefilter.apply_preset"
    bl_label = "Apply Preset"
    bl_description = "Set the settings to those of this preset"
    bl_options = frozenset({"UNDO", "INTERNAL"})

    # The names that Blender's PresetPanel uses.
    filepath: StringProperty(subtype="FILE_PATH", options={"HIDDEN", "SKIP_SAVE"})
    menu_idname: StringProperty(options={"HIDDEN", "SKIP_SAVE"})

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Applies it."""
        kind = getattr(bpy.types, self.menu_idname).kind
        try:
            values = kind.read(Path(self.filepath))
        except (ValueError, OSError) as error:
            self.report({"ERROR"}, reason(error))
            return {"CANCELLED"}
        group = getattr(context.scene, kind.group)
        for name, value in values.items():
            setattr(group, name, value)
        return {"FINISHED"}


class PREFILTER_OT_add_preset(_KindOperator, AddPresetBase, bpy.types.Operator):
    """Saves the settings of a panel as a preset, or removes a preset."""

    bl_idname = "prefilter.add_preset"
    bl_label = "Add Preset"
    bl_description = "Add or remove a preset"

    @property
    def preset_menu(self) -> str:
        """The panel of presets."""
        return self.panel

    @property
    def preset_subdir(self) -> str:
        """Their folder."""
        return self.kind.folder

    def add(self, context: bpy.types.Context, filepath: str) -> None:
        """Writes a preset, which Blender 4.x with Python 3.13 cannot do itself."""
        text = self.kind.to_text(getattr(context.scene, self.kind.group))
        _write(Path(filepath), text.encode())


class PREFILTER_OT_reset_settings(_KindOperator, bpy.types.Operator):
    """Resets the settings that presets store to their defaults."""

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


class _PresetFileOperator(_KindOperator):
    """A mixin for operators that ask for a preset file."""

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
        """Reads or writes the file, and reports the result."""
        try:
            summary = self.transfer(context, Path(bpy.path.abspath(self.filepath)))
            self.report({"INFO"}, report(summary))
        except (ValueError, OSError) as error:
            self.report({"ERROR"}, report(reason(error)))
            return {"CANCELLED"}
        return {"FINISHED"}

    def transfer(self, context: bpy.types.Context, path: Path) -> str:
        """Reads or writes the file; returns the message to report."""
        raise NotImplementedError


class PREFILTER_OT_export_preset(_PresetFileOperator, bpy.types.Operator):
    """Writes the settings of a panel to a preset file."""

    bl_idname = "prefilter.export_preset"
    bl_label = "Export Preset"
    bl_description = "Write these settings to a file that others can import"
    bl_options = frozenset({"INTERNAL"})

    check_existing: bpy.props.BoolProperty(default=True, options={"HIDDEN"})

    def transfer(self, context: bpy.types.Context, path: Path) -> str:
        """Writes the file."""
        path = path.with_suffix(SUFFIX)
        text = self.kind.to_text(getattr(context.scene, self.kind.group))
        _write(path, text.encode())
        return Sentence("Wrote {}", path.name)


class PREFILTER_OT_import_preset(_PresetFileOperator, bpy.types.Operator):
    """Adds a preset file to the user's presets."""

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
    """Writes or replaces a file."""
    from prefilter.files.staging import write_output

    write_output(target, lambda file: file.write(data))


def panel(kind: Kind) -> type[bpy.types.Panel]:
    """Returns the popover panel with the presets of a kind."""
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

    def path_menu(self, searchpaths: list[str], operator: str, **options: Any) -> None:
        """Draws the presets of all folders of the kind, instead of one folder as Blender does."""
        del searchpaths
        PresetPanel.path_menu(self, self.kind.search_paths(), operator, **options)

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the presets, and the operators on them."""
        PresetPanel.draw(self, context)
        self.layout.separator()
        column = self.layout.column(align=True)
        column.operator_context = "INVOKE_DEFAULT"
        for operator, icon in (
            (PREFILTER_OT_reset_settings, "LOOP_BACK"),
            (PREFILTER_OT_import_preset, "IMPORT"),
            (PREFILTER_OT_export_preset, "EXPORT"),
        ):
            column.operator(operator.bl_idname, icon=icon).panel = self.kind.panel


register, unregister = registration(
    classes(
        PREFILTER_OT_apply_preset,
        PREFILTER_OT_add_preset,
        PREFILTER_OT_reset_settings,
        PREFILTER_OT_import_preset,
        PREFILTER_OT_export_preset,
    ),
    Step(
        lambda: bpy.utils.register_preset_path(_ADDON),
        lambda: bpy.utils.unregister_preset_path(_ADDON),
    ),
)
