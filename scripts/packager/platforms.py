# SPDX-License-Identifier: GPL-3.0-or-later

"""The platforms that there are wheels for, by Blender's names, and what is allowed on each."""

import platform
import re
from collections.abc import Sequence
from dataclasses import dataclass

Version = tuple[int, int]


@dataclass(frozen=True)
class Platform:
    """A system and a processor.

    Attributes:
        name: Blender's, such as linux-x64.
        form: Of its modules: ELF, PE or Mach-O.
        machine: The processor, as modules.py names it.
        tag: Regular expression of the last part of a wheel's name; its groups are the lowest
            version of the system that the wheel is for: glibc's or macOS's. Windows has none.
        tag_format: The same to be filled in.
        libraries: Regular expression of the libraries that every such system has; `{python}` is
            Python's version, such as 311.
        newest: The newest version of the system that a module may ask for.
    """

    name: str
    form: str
    machine: str
    tag: str
    tag_format: str
    libraries: str
    newest: Version

    def tag_for(self, lowest: Version) -> str:
        """Returns the last part of the name of a wheel that needs at least that system."""
        return self.tag_format.format(*lowest)

    def allows(self, library: str, python: str) -> bool:
        """Whether a module for a Python, such as cp311, may need that library."""
        allowed = self.libraries.replace("{python}", python.removeprefix("cp"))
        return re.fullmatch(allowed, library) is not None


# What Blender 4.2 to 5.2 run on themselves: glibc 2.28, macOS 11 (arm64), Windows 8.1 or later.
_GLIBC = r"(libc|libm)\.so\.6|libpthread\.so\.0|libdl\.so\.2|ld-linux-(x86-64|aarch64)\.so\.[12]"
_GLIBC_NEWEST = (2, 28)

PLATFORMS = {
    each.name: each
    for each in (
        Platform(
            "linux-x64",
            "ELF",
            "x86_64",
            r"manylinux_(\d+)_(\d+)_x86_64",
            "manylinux_{}_{}_x86_64",
            _GLIBC,
            _GLIBC_NEWEST,
        ),
        Platform(
            "linux-arm64",
            "ELF",
            "arm64",
            r"manylinux_(\d+)_(\d+)_aarch64",
            "manylinux_{}_{}_aarch64",
            _GLIBC,
            _GLIBC_NEWEST,
        ),
        Platform(
            "windows-x64",
            "PE",
            "x86_64",
            "win_amd64",
            "win_amd64",
            r"python{python}\.dll|(?i:kernel32|ntdll|api-ms-win-(core|crt)-[a-z0-9-]+)\.dll",
            (6, 3),
        ),
        Platform(
            "macos-arm64",
            "Mach-O",
            "arm64",
            r"macosx_(\d+)_(\d+)_arm64",
            "macosx_{}_{}_arm64",
            r"/usr/lib/libSystem\.B\.dylib",
            (11, 0),
        ),
    )
}


def platform_of_wheel(name: str) -> tuple[Platform, Version] | None:
    """Returns the platform of a wheel's name, and the system that it is for; None for any other."""
    last = name.removesuffix(".whl").split("-")[-1]
    for each in PLATFORMS.values():
        if match := re.fullmatch(each.tag, last):
            lowest = tuple(map(int, match.groups()))
            return each, (lowest[0], lowest[1]) if lowest else each.newest
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
