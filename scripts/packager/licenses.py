# SPDX-License-Identifier: GPL-3.0-or-later

"""The license texts of everything that is linked into a module."""

import re
from collections.abc import Collection, Iterable
from pathlib import Path

from packager.platforms import Platform
from packager.project import SOURCE, PackagingError

_DOCUMENTS = Path("/usr/share/doc")
_NOT_LINKED = {"cross", "prefilter", "python"}  # Folders of native/ that are no other's library.
# Zig links these in: its compiler's runtime, the C++ runtime, and parts of each C library.
_ZIG = {
    "zig/LICENSE": "LICENSE",
    "libcxx/LICENSE.TXT": "lib/libcxx/LICENSE.TXT",
    "libcxxabi/LICENSE.TXT": "lib/libcxxabi/LICENSE.TXT",
    "libunwind/LICENSE.TXT": "lib/libunwind/LICENSE.TXT",
}
_ZIG_OF_SYSTEM = {
    "linux": {"glibc/LICENSES": "lib/libc/glibc/LICENSES"},
    "windows": {"mingw-w64/COPYING": "lib/libc/mingw/COPYING"},
    "macos": {},
}


def _system(platform: Platform) -> str:
    return platform.name.split("-")[0]


def _zig_texts(platform: Platform) -> dict[str, str]:
    return _ZIG | _ZIG_OF_SYSTEM[_system(platform)]


def license_texts(
    linked: Iterable[Path], platform: Platform, zig: Path | None = None
) -> dict[str, Path]:
    """Returns the license texts to include, by name: ours and the linked libraries'.

    Args:
        linked: Source folders of linked libraries, with LICENSE.txt and perhaps NOTICE.txt.
        platform: The module's platform.
        zig: The folder that ziglang's package is installed in; None if the host's GCC compiled.

    Raises:
        PackagingError: One is missing.
    """
    found = {"LICENSE": SOURCE / "LICENSE"}
    for library in linked:
        found[f"{library.name}/LICENSE.txt"] = library / "LICENSE.txt"
        if (library / "NOTICE.txt").exists():
            found[f"{library.name}/NOTICE.txt"] = library / "NOTICE.txt"
    found["pybind11/copyright"] = _DOCUMENTS / "pybind11-dev/copyright"
    if zig is None:
        found["gcc/copyright"] = _DOCUMENTS / "libstdc++6/copyright"
    else:
        (texts,) = zig.glob("ziglang-*.dist-info/licenses/ziglang")
        found |= {name: texts / path for name, path in _zig_texts(platform).items()}
    for path in found.values():
        if not path.is_file():
            raise PackagingError(f"{path}: there is no such license text")
    return found


def missing_licenses(
    names: Collection[str], platform: Platform, source: Path = SOURCE
) -> list[str]:
    """Returns the libraries whose license text a wheel lacks.

    Args:
        names: The names of its texts, below the folder of licenses.
        platform: The wheel's platform.
        source: The checkout, where each folder of native/ except ours is a linked library.
    """
    libraries = sorted(
        path.parent.name
        for path in (source / "native").glob("*/CMakeLists.txt")
        if path.parent.name not in _NOT_LINKED
    )
    missing = [name for name in ("LICENSE", "pybind11/copyright") if name not in names]
    missing += [
        library
        for library in libraries
        if not any(re.fullmatch(rf"{library}-[^/]+/LICENSE.txt", name) for name in names)
    ]
    by_gcc = _system(platform) == "linux" and "gcc/copyright" in names
    if not by_gcc:
        missing += [name for name in _zig_texts(platform) if name not in names]
    return missing
