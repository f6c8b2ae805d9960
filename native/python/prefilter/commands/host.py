# SPDX-License-Identifier: GPL-3.0-or-later

"""Differences between commands run inside Blender and without it."""

import argparse
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from ..options.flags import given
from ..workflows import picture_files
from ..workflows.picture import Picture


def _settings(options: argparse.Namespace, settings: type, **more: Any) -> Any:
    return settings(**given(options, settings) | more)


@dataclass(frozen=True)
class Host:
    """The environment that a command runs in; by default without Blender.

    Attributes:
        read: Reads a picture, as `picture_files.read` does.
        add_preset: Adds the flag that names a preset, where there are any.
        preset: Returns the values set by the preset that the arguments name.
        settings: Returns settings from keywords, else from flags, else from the host's defaults.
        preferred: See `add_flags`.
    """

    read: Callable[..., Picture] = picture_files.read
    add_preset: Callable[[argparse.ArgumentParser], None] = lambda _: None
    preset: Callable[[argparse.Namespace], dict[str, Any]] = lambda _: {}
    settings: Callable[..., Any] = _settings
    preferred: str = ""


PLAIN = Host()
"""Without Blender."""
