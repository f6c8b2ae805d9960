# SPDX-License-Identifier: GPL-3.0-or-later

"""The platforms that there are wheels for, by Blender's names, and the limits of each."""

import platform
import re
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from packager.project import SOURCE

Version = tuple[int, int]
_TABLE = tomllib.loads((SOURCE / "scripts/platforms.toml").read_text())
_FORMS = {"Linux": "ELF", "Windows": "PE", "Darwin": "Mach-O"}

OFFICIAL_TAGS: tuple[str, ...] = tuple(_TABLE["pythons"])
"""The Pythons of official Blenders."""


@dataclass(frozen=True)
class Platform:
    """A system and a processor: a table of scripts/platforms.toml, which says more.

    Attributes:
        name: Blender's, such as linux-x64.
        form: Of its modules: ELF, PE or Mach-O.
        machine: The processor, as modules.py names it.
        wheel: The last part of a wheel's name, to be filled in with the lowest version of the
            system that the wheel is for: glibc's or macOS's. Windows has none.
        suffix: Of a module's name, to be filled in with Python's version.
        libraries: Regular expression of the libraries that every such system has; `{python}` is
            Python's version, such as 311.
        others: The same of those that modules of others may need, too.
        newest: The newest version of the system that a module may ask for.
    """

    name: str
    form: str
    machine: str
    wheel: str
    suffix: str
    libraries: str
    others: str
    newest: Version

    def tag_for(self, lowest: Version) -> str:
        """Returns the last part of the name of a wheel that needs at least that system."""
        return self.wheel.format(*lowest)

    def system_of(self, tag: str) -> Version | None:
        """Returns what system the last part of a wheel's name is for; None for another's."""
        match = re.fullmatch(self.wheel.replace("{}", r"(\d+)"), tag)
        if match is None:
            return None
        lowest = tuple(map(int, match.groups()))
        return (lowest[0], lowest[1]) if lowest else self.newest

    def suffix_for(self, python: str) -> str:
        """Returns how the file of a module for a Python, such as cp311, ends."""
        return self.suffix.format(python.removeprefix("cp"))

    def allows(self, library: str, python: str, *, is_of_others: bool = False) -> bool:
        """Whether a module for a Python, such as cp311, may need that library."""
        allowed = self.libraries.replace("{python}", python.removeprefix("cp"))
        if is_of_others:
            allowed = f"{allowed}|{self.others}"
        return re.fullmatch(allowed, library) is not None


def _platform(name: str, row: Mapping[str, str]) -> Platform:
    major, minor = row["newest"].split(".")
    return Platform(
        name,
        _FORMS[row["system"]],
        row["processor"].replace("aarch64", "arm64"),
        row["wheel"],
        row["suffix"],
        row["libraries"],
        row["others"],
        (int(major), int(minor)),
    )


PLATFORMS = {name: _platform(name, row) for name, row in _TABLE.items() if isinstance(row, dict)}


def platform_of_wheel(name: str) -> tuple[Platform, Version] | None:
    """Returns the platform of a wheel's name, and the system that it is for; None for any other."""
    # One wheel may have several names for its platform, with dots between them.
    for last in name.removesuffix(".whl").split("-")[-1].split("."):
        for each in PLATFORMS.values():
            if lowest := each.system_of(last):
                return each, lowest
    return None


def here() -> Platform:
    """Returns the platform of this machine."""
    machine = {"x86_64": "x64", "aarch64": "arm64"}.get(platform.machine(), platform.machine())
    return PLATFORMS[f"{platform.system().lower()}-{machine}"]


def glibc_here() -> Version:
    """Returns the version of this machine's glibc."""
    major, minor = platform.libc_ver()[1].split(".")[:2]
    return int(major), int(minor)


def later(first: Sequence[int], second: Sequence[int]) -> bool:
    """Whether the first of two versions is the later one."""
    return tuple(first) > tuple(second)
