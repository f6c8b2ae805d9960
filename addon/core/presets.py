# SPDX-License-Identifier: GPL-3.0-or-later

"""Presets of settings, in Blender's own preset menus and for commands and scripts.

The add-on's presets are in its folder presets/, user presets in Blender's. A preset is a Python
file with lines such as `settings.depth = 9`, like Blender's own; it is parsed, never executed.
"""

import ast
from collections.abc import Collection, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

import bpy
from bpy.props import StringProperty

from .options import Option, declared
from .preferences import preferred
from .properties import properties, set_unset
from .translations import CONTEXT
from .wording import listed

if TYPE_CHECKING:
    import argparse

    from prefilter.commands.host import Host

Settings = TypeVar("Settings")

_ROOT = "prefilter"
_BUILT_IN = Path(__file__).resolve().parents[1] / "presets" / _ROOT
SUFFIX = ".py"


class Kind(NamedTuple):
    """The presets of a property group.

    Attributes:
        name: The name of their folder.
        group: The scene property that they set.
        settings: The dataclasses of its settings, each with fields to exclude. Names, files and
            memory limits are always excluded.
        shared: The name of another kind whose built-in presets fit this one too; empty for none.
    """

    name: str
    group: str
    settings: Sequence[tuple[type, Collection[str]]]
    shared: str = ""

    @property
    def folder(self) -> str:
        """Its folder, relative to a folder of presets."""
        return f"{_ROOT}/{self.name}"

    @property
    def panel(self) -> str:
        """The name of their panel."""
        return f"PREFILTER_PT_{self.name}_presets"

    def options(self) -> Iterator[tuple[str, Any, Option]]:
        """Yields the name, the default and the option of each setting that a preset stores."""
        for settings, without in self.settings:
            for name, default, option in declared(settings):
                is_text = isinstance(default, str) and not option.choices
                is_machine = option.preference == "memory_limit"
                if option.label and name not in without and not (is_text or is_machine):
                    yield name, default, option

    def of_scene(self, context: bpy.types.Context) -> dict[str, Any]:
        """Returns all settings of the scene, including those that presets exclude."""
        group = getattr(context.scene, self.group)
        names = [name for settings, _ in self.settings for name in properties(settings)]
        return {name: getattr(group, name) for name in names if hasattr(group, name)}

    def search_paths(self) -> list[str]:
        """Returns the folders with its presets, those of the user first."""
        paths = bpy.utils.preset_paths(self.folder)
        return [*paths, str(_BUILT_IN / self.shared)] if self.shared else paths

    def files(self) -> dict[str, Path]:
        """Returns the files of all presets by name; user presets take precedence."""
        files: dict[str, Path] = {}
        for folder in self.search_paths():
            for path in sorted(Path(folder).glob(f"*{SUFFIX}")):
                files.setdefault(shown_name(path), path)
        return files

    def values(self, name: str) -> dict[str, Any]:
        """Returns the settings of a preset.

        Args:
            name: Its name; case does not matter, nor do spaces versus underscores.

        Raises:
            ValueError: No preset has this name, or it has an unknown setting or an invalid value.
        """
        files = self.files()
        path = next((files[key] for key in files if _plain(key) == _plain(name)), None)
        if path is None:
            known = listed(sorted(files)) or "none"
            raise ValueError(f"found no preset named '{name}'; there are {known}")
        return self.read(path)

    def read(self, path: Path) -> dict[str, Any]:
        """Returns the settings of a preset file.

        Raises:
            ValueError: It is not a preset, or has an unknown setting or an invalid value.
            OSError: The file cannot be read.
        """
        name = shown_name(path)
        assigned = _assigned(path)
        if not assigned:
            raise ValueError(f"preset '{name}': it sets none of these settings")
        options = {key: (default, option) for key, default, option in self.options()}
        for key, value in assigned.items():
            if key not in options:
                raise ValueError(f"preset '{name}': '{key}' is not a setting")
            default, option = options[key]
            if not (_has_type_of(value, default) and option.allows(value)):
                raise ValueError(
                    f"preset '{name}': {option.label}: found {value!r}; allowed: {option.allowed}"
                )
        return assigned

    def to_text(self, group: Any) -> str:
        """Returns the text of a preset with the settings of a property group."""
        lines = ["import bpy", "", f"settings = bpy.context.scene.{self.group}", ""]
        for name, default, option in self.options():
            value = getattr(group, name)
            if isinstance(default, tuple) and not option.choices:
                value = tuple(value)
            lines.append(f"settings.{name} = {value!r}")
        return "\n".join([*lines, ""])

    def complete(self, operator: bpy.types.Operator, preset: str) -> None:
        """Sets the properties that the caller has not set, from a preset, then from the
        preferences.

        Args:
            operator: The operator with the settings as properties.
            preset: The name of a preset; empty for none.

        Raises:
            ValueError: See `values`.
        """
        if preset:
            set_unset(operator, self.values(preset))
        known = operator.properties.bl_rna.properties
        for settings, _ in self.settings:
            defaults = preferred(settings).items()
            set_unset(operator, {name: value for name, value in defaults if name in known})


class PresetsOperator:
    """A mixin for operators with presets; list it before `BackgroundOperator`."""

    presets: Kind

    preset: StringProperty(
        name="Preset",
        translation_context=CONTEXT,
        description="Preset for the settings that are not given",
        options={"HIDDEN", "SKIP_SAVE"},
    )

    def follow_scene(self, context: bpy.types.Context) -> None:
        """Copies the settings of the scene, unless the caller gives settings or a preset."""
        is_set = self.properties.is_property_set
        if self.preset or any(is_set(name) for name, _, _ in self.presets.options()):
            return
        set_unset(self, self.presets.of_scene(context))

    def complete_settings(self) -> None:
        """Sets the properties that the caller has not set."""
        self.presets.complete(self, self.preset)


class PresetsPanel:
    """A mixin for panels of settings: a button for presets in the header."""

    presets: Kind

    def draw_header_preset(self, context: bpy.types.Context) -> None:
        """Draws the button."""
        del context
        getattr(bpy.types, self.presets.panel).draw_panel_header(self.layout)


def shown_name(path: Path) -> str:
    """Returns the name of a preset as users see it."""
    return bpy.path.display_name(path.name, title_case=False)


def add_flag(parser: "argparse.ArgumentParser") -> None:
    """Adds the flag --preset, which `settings_given` reads."""
    parser.add_argument(
        "--preset",
        metavar="NAME",
        default="",
        help="a preset, such as 'Game asset'; other arguments take precedence",
    )


def values_named(options: "argparse.Namespace", kind: Kind) -> dict[str, Any]:
    """Returns the settings of the preset of `--preset`; empty without one."""
    if not options.preset:
        return {}
    try:
        return kind.values(options.preset)
    except ValueError as error:
        options.usage_error(f"--preset: {error}")
        raise


def settings_given(
    options: "argparse.Namespace", kind: Kind, settings: type[Settings], **more: Any
) -> Settings:
    """Returns settings from `more`, else from flags, else from a preset, else from the preferences.

    Args:
        options: The arguments of a command.
        kind: The kind of presets for `--preset`.
        settings: The dataclass.
        more: Values of fields.
    """
    from . import flags

    names = {name for name, _, _ in declared(settings)}
    preset = values_named(options, kind).items()
    values = {name: value for name, value in preset if name in names}
    return flags.settings_given(options, settings, **values | flags.given(options, settings) | more)


def host(kind: Kind, **more: Any) -> "Host":
    """Returns the callbacks by which the package's commands use Blender.

    Args:
        kind: The kind of presets.
        more: More callbacks, such as `read`.
    """
    from prefilter.commands.host import Host

    from .flags import PREFERRED

    return Host(
        add_preset=add_flag,
        preset=lambda options: values_named(options, kind),
        settings=lambda options, settings, **found: settings_given(
            options, kind, settings, **found
        ),
        preferred=PREFERRED,
        **more,
    )


def _plain(name: str) -> str:
    return " ".join(name.replace("_", " ").split()).casefold()


def _has_type_of(value: Any, default: Any) -> bool:
    if isinstance(default, float):
        return isinstance(value, int | float) and not isinstance(value, bool)
    return type(value) is type(default)


def _assigned(path: Path) -> dict[str, Any]:
    """Returns the values that the lines of a preset assign to `settings`."""
    assigned: dict[str, Any] = {}
    try:
        for line in ast.parse(path.read_text(encoding="utf-8")).body:
            match line:
                case ast.Assign([ast.Attribute(ast.Name("settings"), name)], value):
                    assigned[name] = ast.literal_eval(value)
    except (SyntaxError, ValueError) as error:
        raise ValueError(f"preset '{path}': {error}") from error
    return assigned
