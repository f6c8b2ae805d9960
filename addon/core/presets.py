# SPDX-License-Identifier: GPL-3.0-or-later

"""Presets: settings for a purpose, by Blender's own menus of them, for commands and scripts too.

Those that come with the add-on lie in its folder presets/, those of users in Blender's. A preset is
a program of lines such as `settings.depth = 9`, as those of Blender are; the values are read, and
nothing is run.
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

_ROOM = "prefilter"
SUFFIX = ".py"


class Kind(NamedTuple):
    """What presets are for.

    Attributes:
        name: The folder that they are in.
        group: The settings of the scene that they set, a property of it.
        settings: The dataclasses of these settings, each with fields that no preset sets; nor does
            any set names, files or what depends on the memory of the machine.
    """

    name: str
    group: str
    settings: Sequence[tuple[type, Collection[str]]]

    @property
    def folder(self) -> str:
        """The folder below those of all presets."""
        return f"{_ROOM}/{self.name}"

    @property
    def panel(self) -> str:
        """The name of the panel that shows them."""
        return f"PREFILTER_PT_{self.name}_presets"

    def options(self) -> Iterator[tuple[str, Any, Option]]:
        """Yields the name, the default and the option of what a preset sets."""
        for settings, without in self.settings:
            for name, default, option in declared(settings):
                is_text = isinstance(default, str) and not option.choices
                is_machine = option.preference == "memory_limit"
                if option.label and name not in without and not (is_text or is_machine):
                    yield name, default, option

    def of_scene(self, context: bpy.types.Context) -> dict[str, Any]:
        """Returns all settings that the scene has, also those that no preset sets."""
        group = getattr(context.scene, self.group)
        names = [name for settings, _ in self.settings for name in properties(settings)]
        return {name: getattr(group, name) for name in names if hasattr(group, name)}

    def files(self) -> dict[str, Path]:
        """Returns the files of all presets by their names; one of the user goes first."""
        found: dict[str, Path] = {}
        for folder in bpy.utils.preset_paths(self.folder):
            for path in sorted(Path(folder).glob(f"*{SUFFIX}")):
                found.setdefault(shown_name(path), path)
        return found

    def values(self, name: str) -> dict[str, Any]:
        """Returns what a preset sets.

        Args:
            name: Its name; upper and lower case, spaces and underscores are the same.

        Raises:
            ValueError: There is none of that name, or it sets what is no setting or not allowed.
        """
        files = self.files()
        path = next((files[key] for key in files if _plain(key) == _plain(name)), None)
        if path is None:
            known = listed(sorted(files)) or "none"
            raise ValueError(f"found no preset named '{name}'; there are {known}")
        return self.read(path)

    def read(self, path: Path) -> dict[str, Any]:
        """Returns what the preset of a file sets.

        Args:
            path: The file.

        Raises:
            ValueError: It is no preset, or sets what is no setting or not allowed.
            OSError: The file cannot be read.
        """
        name = shown_name(path)
        found = _assigned(path)
        if not found:
            raise ValueError(f"preset '{name}': it sets none of these settings")
        options = {key: (default, option) for key, default, option in self.options()}
        for key, value in found.items():
            if key not in options:
                raise ValueError(f"preset '{name}': '{key}' is not a setting")
            default, option = options[key]
            if not (_is_alike(value, default) and option.allows(value)):
                raise ValueError(
                    f"preset '{name}': {option.label}: found {value!r}; allowed: {option.allowed}"
                )
        return found

    def written(self, group: Any) -> str:
        """Returns the text of a preset.

        Args:
            group: The settings of a scene that it is to set.
        """
        lines = ["import bpy", "", f"settings = bpy.context.scene.{self.group}", ""]
        for name, default, option in self.options():
            value = getattr(group, name)
            if isinstance(default, tuple) and not option.choices:
                value = tuple(value)
            lines.append(f"settings.{name} = {value!r}")
        return "\n".join([*lines, ""])

    def complete(self, operator: bpy.types.Operator, preset: str) -> None:
        """Sets what the caller of an operator has not: by a preset, then by the preferences.

        Args:
            operator: Has the settings as properties.
            preset: The name of a preset; empty for none.

        Raises:
            ValueError: See `values`.
        """
        if preset:
            set_unset(operator, self.values(preset))
        known = operator.properties.bl_rna.properties
        for settings, _ in self.settings:
            followed = preferred(settings).items()
            set_unset(operator, {name: value for name, value in followed if name in known})


class PresetsOperator:
    """A mixin for operators that a preset sets; it comes before `BackgroundOperator`."""

    presets: Kind

    preset: StringProperty(
        name="Preset",
        translation_context=CONTEXT,
        description="Preset for the settings that are not given",
        options={"HIDDEN", "SKIP_SAVE"},
    )

    def follow_scene(self, context: bpy.types.Context) -> None:
        """Sets the settings as the scene has them, if the caller names none and no preset."""
        named = self.properties.is_property_set
        if self.preset or any(named(name) for name, _, _ in self.presets.options()):
            return
        set_unset(self, self.presets.of_scene(context))

    def complete_settings(self) -> None:
        """Sets what the caller has left."""
        self.presets.complete(self, self.preset)


class PresetsPanel:
    """A mixin for panels of settings: the button of the presets, in the header."""

    presets: Kind

    def draw_header_preset(self, context: bpy.types.Context) -> None:
        """Draws the button."""
        del context
        getattr(bpy.types, self.presets.panel).draw_panel_header(self.layout)


def shown_name(path: Path) -> str:
    """Returns what users see of the name of a preset's file."""
    return bpy.path.display_name(path.name, title_case=False)


def add_flag(parser: "argparse.ArgumentParser") -> None:
    """Adds the flag that names a preset; `settings_given` heeds it."""
    parser.add_argument(
        "--preset",
        metavar="NAME",
        default="",
        help="a preset, such as 'Game asset'; other arguments take precedence",
    )


def values_named(options: "argparse.Namespace", kind: Kind) -> dict[str, Any]:
    """Returns what the preset sets that `--preset` names; nothing without one."""
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
    """Returns settings: by `more`, else by flags, else by a preset, else by the preferences.

    Args:
        options: The arguments of a command.
        kind: That of `--preset`.
        settings: The dataclass.
        more: Fields that are given otherwise.
    """
    from . import flags

    names = {name for name, _, _ in declared(settings)}
    named = values_named(options, kind).items()
    found = {name: value for name, value in named if name in names}
    return flags.settings_given(options, settings, **found | flags.given(options, settings) | more)


def host(kind: Kind, **more: Any) -> "Host":
    """Returns what commands with presets of a kind know of Blender.

    Args:
        kind: That of the presets.
        more: More of it, such as `read`.
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


def _is_alike(value: Any, default: Any) -> bool:
    """Tells whether a value is of the type of an option."""
    if isinstance(default, float):
        return isinstance(value, int | float) and not isinstance(value, bool)
    return type(value) is type(default)


def _assigned(path: Path) -> dict[str, Any]:
    """Returns the values that the lines of a preset assign to `settings`."""
    found: dict[str, Any] = {}
    try:
        for line in ast.parse(path.read_text(encoding="utf-8")).body:
            match line:
                case ast.Assign([ast.Attribute(ast.Name("settings"), name)], value):
                    found[name] = ast.literal_eval(value)
    except (SyntaxError, ValueError) as error:
        raise ValueError(f"preset '{path}': {error}") from error
    return found
