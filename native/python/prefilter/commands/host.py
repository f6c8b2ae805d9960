# SPDX-License-Identifier: GPL-3.0-or-later

"""What is different where a command runs: with Blender, or without."""

import argparse
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from ..options.flags import given
from ..workflows import picture_files
from ..workflows.picture import Picture


def _nothing(parser: argparse.ArgumentParser) -> None:
    del parser


def _no_preset(options: argparse.Namespace) -> dict[str, Any]:
    del options
    return {}


def _settings(options: argparse.Namespace, settings: type, **more: Any) -> Any:
    return settings(**given(options, settings) | more)


@dataclass(frozen=True)
class Host:
    """Where a command runs; by default without Blender.

    Attributes:
        read: Reads a picture, as `picture_files.read` does.
        add_preset: Adds the flag that names a preset, where there are any.
        preset: Returns what the preset sets that the arguments name.
        settings: Returns settings: by keywords, else by flags, else by what the host knows.
        preferred: See `add_flags`.
    """

    read: Callable[..., Picture] = picture_files.read
    add_preset: Callable[[argparse.ArgumentParser], None] = _nothing
    preset: Callable[[argparse.Namespace], dict[str, Any]] = _no_preset
    settings: Callable[..., Any] = _settings
    preferred: str = ""


PLAIN = Host()
"""Without Blender."""
