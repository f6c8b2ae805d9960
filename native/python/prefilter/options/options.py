# SPDX-License-Identifier: GPL-3.0-or-later

"""Options, each declared once as a field of a settings dataclass.

    @dataclass(frozen=True)
    class Settings:
        depth: int = number(8, "Depth", "How often the cube is halved", low=1, high=12)

Blender's property, the flag of commands (`flags`), the check of a value and the row of the table in
docs/ (`table`) all derive from the field.
"""

import dataclasses
import inspect
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from .colors import Color, to_hex

_KEY = "option"
_ROUNDING = 2.0**-24


class Choice(NamedTuple):
    """One of the values of an option that has a fixed set of them."""

    label: str
    description: str


@dataclass(frozen=True)
class Option:
    """Presentation of an option, and the values it may have.

    Attributes:
        label: The name that users see; empty if only commands have the option.
        description: A sentence without a full stop.
        choices: The allowed values, if there is a fixed set of them.
        low: The least allowed number.
        high: The greatest allowed number.
        is_above: Whether `low` itself is excluded.
        subtype: What a number or a text means, as in bpy.props. An ANGLE is in radians; users see
            degrees. A COLOR is scene-linear, with straight alpha; commands take it as #RRGGBBAA.
        display: Further arguments of the Blender property.
        flag: The flag of commands; None for the field's name with dashes, empty for no flag.
        metavar: Placeholder for the value in help texts.
        flag_description: Description of the flag, if it differs from `description`.
        preference: The preference of the add-on that supplies the value until a user sets it; empty
            for none.
    """

    label: str
    description: str
    choices: Mapping[str, Choice] = field(default_factory=dict)
    low: float = -math.inf
    high: float = math.inf
    is_above: bool = False
    subtype: str = "NONE"
    display: Mapping[str, Any] = field(default_factory=dict)
    flag: str | None = None
    metavar: str = ""
    flag_description: str = ""
    preference: str = ""

    @property
    def allowed(self) -> str:
        """The allowed values, in words."""
        if self.choices:
            return ", ".join(self.choices)
        if self.subtype == "COLOR":
            return "#RRGGBB or #RRGGBBAA, with values from 0 to 1"
        low, high = self.shown(self.low), self.shown(self.high)
        if self.is_above:
            return f"above {low}" + (f", up to {high}" if self.high < math.inf else "")
        return f"{low} to {high}" if self.high < math.inf else f"{low} and up"

    @property
    def has_limits(self) -> bool:
        """Whether a number has a lower or an upper limit."""
        return self.low > -math.inf or self.high < math.inf

    def allows(self, value: Any) -> bool:
        """Returns whether a value is allowed."""
        if self.choices:
            chosen = {value} if isinstance(value, str) else set(value)
            return chosen <= self.choices.keys()
        if self.subtype == "COLOR":
            return len(value) == 4 and all(
                0.0 <= component <= 1.0 + _ROUNDING for component in value
            )
        if isinstance(value, tuple):
            return all(self.allows(component) for component in value)
        if not isinstance(value, int | float):
            return True
        # Blender stores numbers in single precision.
        slack = _ROUNDING * abs(value) if isinstance(value, float) else 0
        is_finite = isinstance(value, int) or math.isfinite(value)
        if not is_finite or (self.is_above and value <= self.low):
            return False
        return self.low - slack <= value <= self.high + slack

    def shown(self, value: Any) -> str:
        """Returns a value as a user of a command writes it."""
        if isinstance(value, float):
            return f"{math.degrees(value) if self.subtype == 'ANGLE' else value:.7g}"
        if self.subtype == "COLOR":
            return to_hex(value)
        if isinstance(value, tuple):
            return " ".join(self.shown(component) for component in value)
        return str(value)


def one_of(
    default: str | tuple[str, ...],
    label: str,
    description: str,
    choices: Mapping[str, Choice],
    **more: Any,
) -> Any:
    """Declares an option that is a key of `choices`, or several where the default is a tuple."""
    return _declared(default, Option(label, description, choices=choices, **more))


def number(default: float, label: str, description: str, **more: Any) -> Any:
    """Declares a numeric option: an integer if the default is one."""
    return _declared(default, Option(label, description, **more))


def numbers(default: tuple[float, ...], label: str, description: str, **more: Any) -> Any:
    """Declares an option of as many numbers as the default has."""
    return _declared(default, Option(label, description, **more))


def switch(default: bool, label: str, description: str, **more: Any) -> Any:
    """Declares an option that is on or off; commands have --NAME and --no-NAME."""
    return _declared(default, Option(label, description, **more))


def text(default: str, label: str, description: str, **more: Any) -> Any:
    """Declares an option that is a text: a name, or with the subtype FILE_PATH a file."""
    return _declared(default, Option(label, description, **more))


def rgba(default: Color, label: str, description: str, **more: Any) -> Any:
    """Declares a color with alpha, each component from 0 to 1."""
    return _declared(default, Option(label, description, subtype="COLOR", **more))


def threads() -> Any:
    """Declares the number of threads, which users set by commands only."""
    return number(
        0,
        "",
        "How many threads to use; 0 uses all",
        low=0,
        metavar="N",
        preference="threads",
    )


def declared(settings: type) -> Iterator[tuple[str, Any, Option]]:
    """Yields the name, the default and the option of each field of a dataclass."""
    for setting in dataclasses.fields(settings):
        yield setting.name, setting.default, setting.metadata[_KEY]


def option(settings: type, name: str) -> tuple[Any, Option]:
    """Returns the default and the option of a field of a dataclass."""
    return next(
        (default, declaration)
        for other, default, declaration in declared(settings)
        if other == name
    )


def check(settings: Any) -> None:
    """Raises ValueError if a setting has a value that is not allowed."""
    for name, _, declaration in declared(type(settings)):
        value = getattr(settings, name)
        if not declaration.allows(value):
            raise ValueError(
                f"{declaration.label or name}: found {declaration.shown(value)}; "
                f"allowed: {declaration.allowed}"
            )


def table(settings: type) -> str:
    """Returns a Markdown table of the options that users see.

    Args:
        settings: A dataclass; options that it inherits are left out.
    """
    own = inspect.get_annotations(settings)
    rows = ["| Setting | Default | Meaning |", "|---|---|---|"]
    for name, default, option in declared(settings):
        if option.label and name in own:
            rows.append(
                f"| {option.label} | {_shown_default(default, option)} | {_meaning(option)} |"
            )
    return "\n".join(rows)


def _declared(default: Any, declaration: Option) -> Any:
    return field(default=default, metadata={_KEY: declaration})


def _shown_default(default: Any, declaration: Option) -> str:
    if isinstance(default, bool):
        return "on" if default else "off"
    if declaration.choices:
        keys = default if isinstance(default, tuple) else (default,)
        return ", ".join(declaration.choices[key].label for key in keys)
    if declaration.subtype == "ANGLE":
        return f"{declaration.shown(default)}°"
    return declaration.shown(default)


def _meaning(declaration: Option) -> str:
    parts = [f"{declaration.description}."]
    if declaration.has_limits:
        parts[0] += f" Allowed: {declaration.allowed}."
    for key, choice in declaration.choices.items():
        parts.append(f"**{choice.label}** (`{key}`): {choice.description}.")
    return "<br>".join(parts)
