# SPDX-License-Identifier: GPL-3.0-or-later

"""Options as flags of commands."""

import argparse
import math
from collections.abc import Collection, Iterator, Mapping
from functools import partial
from types import MappingProxyType
from typing import Any

from .colors import from_hex
from .options import Option, declared

_LONGEST_SHOWN = 60


def add_flags(
    parser: argparse.ArgumentParser,
    settings: type,
    *names: str,
    exclusive: Collection[str] = (),
    without_default: Collection[str] = (),
    short: Mapping[str, str] = MappingProxyType({}),
    preferred: str = "",
) -> None:
    """Adds the flags of options to a parser.

    Args:
        parser: The parser that gets the flags; `given` returns their values.
        settings: A dataclass.
        names: The fields; all if none is named.
        exclusive: Fields of which a user may set only one.
        without_default: Fields whose default does not apply when their flag is absent.
        short: One-letter aliases of flags, by field.
        preferred: Note that the help adds to the default of an option that follows a preference.
    """
    group = parser.add_mutually_exclusive_group() if exclusive else parser
    for name, default, flag, option in _flags(settings, names):
        more: dict[str, Any] = {"default": argparse.SUPPRESS, "dest": name}
        description = option.flag_description or option.description
        text = description[:1].lower() + description[1:]
        if isinstance(default, bool):
            more["action"] = argparse.BooleanOptionalAction
            text += f" (default: {'on' if default else 'off'})"
        else:
            more |= {"type": partial(_read, default, option), "metavar": option.metavar}
            if isinstance(default, tuple) and option.choices:
                more["nargs"] = "+"
            elif isinstance(default, tuple) and option.subtype != "COLOR":
                more["nargs"] = len(default)
            notes = [option.allowed] if option.has_limits else []
            # Another option says which color applies without the flag.
            if default != "" and option.subtype != "COLOR" and name not in without_default:
                follows = preferred if option.preference else ""
                notes.append(f"default: {option.shown(default)}{follows}")
            if notes:
                text += f" ({'; '.join(notes)})"
        target = group if name in exclusive else parser
        named = [flag, short[name]] if name in short else [flag]
        target.add_argument(*named, help=text.replace("%", "%%"), **more)


def given(options: argparse.Namespace, settings: type) -> dict[str, Any]:
    """Returns the values of the flags that the user gave, by field name."""
    return {
        name: tuple(value) if isinstance(default, tuple) else value
        for name, default, _, _ in _flags(settings, ())
        if (value := getattr(options, name, None)) is not None
    }


def tables(settings: type, *names: str) -> list[str]:
    """Returns the choices of each flag that has any, for the end of a help text."""
    return [
        "\n".join(
            [
                f"{flag}:",
                *(f"  {key:<18}{choice.description}" for key, choice in option.choices.items()),
            ]
        )
        for _, _, flag, option in _flags(settings, names)
        if option.choices
    ]


def _flags(settings: type, names: tuple[str, ...]) -> Iterator[tuple[str, Any, str, Option]]:
    """Yields name, default, flag and option of the fields that have flags."""
    for name, default, option in declared(settings):
        if option.flag == "" or (names and name not in names):
            continue
        flag = name.removeprefix("use_").replace("_", "-")
        yield name, default, option.flag or f"--{flag}", option


def _read(default: Any, declaration: Option, text: str) -> Any:
    if isinstance(default, str) or declaration.choices:
        value: Any = text
    elif declaration.subtype == "COLOR":
        value = from_hex(text) or ()
    else:
        kind = float if isinstance(default, tuple) else type(default)
        try:
            value = kind(text)
        except ValueError:
            value = math.nan
        if declaration.subtype == "ANGLE":
            value = math.radians(value)
    if not declaration.allows(value):
        shown = text if len(text) <= _LONGEST_SHOWN else f"{text[:_LONGEST_SHOWN]}..."
        raise argparse.ArgumentTypeError(f"found '{shown}'; allowed: {declaration.allowed}")
    return value
